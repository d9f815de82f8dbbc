"""The Python module: the same edits, journals and errors as the program."""
import inspect
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import rebake

ROOT = Path(__file__).resolve().parents[2]
FICUS = ROOT / "samples/scenes/ficus"


def files(folder):
    return {p.relative_to(folder): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


class Module(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.at = Path(self.folder.name)
        self.document = rebake.open(FICUS)

    def tearDown(self):
        self.folder.cleanup()

    def test_arrays_are_views_that_outlive_the_document(self):
        vertices = self.document.vertices("ficus")
        faces = self.document.faces("ficus")
        uvs = self.document.uvs("ficus")
        self.assertEqual(vertices.shape, (uvs.shape[0], 3))
        self.assertEqual(vertices.dtype, np.float64)
        self.assertLess(faces.max(), len(vertices))
        self.assertEqual(len(faces), self.document.nodes[0]["triangles"])
        self.assertEqual(vertices.ctypes.data, self.document.vertices("ficus").ctypes.data, "Positions in object space, n × 3; a read-only")
        with self.assertRaises(ValueError):
            vertices[0] = 0
        before = vertices.copy()
        self.document.transform(node="ficus", translate=[1, 0, 0])
        del self.document
        np.testing.assert_array_equal(vertices, before)

    def test_tiles_are_the_texture(self):
        texture = self.document.texture("ficus")
        tiles = self.document.tiles("ficus")
        joined = np.concatenate([np.concatenate(row, axis=1) for row in tiles])
        np.testing.assert_array_equal(joined[: texture.shape[0], : texture.shape[1]], texture)

    def test_selecting_gives_masks(self):
        masks = self.document.select(node="ficus", box={"min": np.array([0, 0.5, 0]), "max": [1, 1, 1]}, frame="bounds")
        centres = self.document.vertices("ficus")[self.document.faces("ficus")].mean(axis=1)
        low, high = (f(self.document.vertices("ficus")[np.unique(self.document.faces("ficus"))], axis=0) for f in (np.min, np.max))
        height = (centres[:, 1] - low[1]) / (high[1] - low[1])
        clear = np.abs(height - 0.5) > 1e-9
        np.testing.assert_array_equal(masks["ficus"][clear], height[clear] > 0.5)
        np.testing.assert_array_equal(self.document.selection("ficus"), masks["ficus"])

    def test_a_mask_becomes_the_selection(self):
        mask = np.zeros(self.document.nodes[0]["triangles"], bool)
        mask[[0, 1, 2, 7]] = True
        np.testing.assert_array_equal(self.document.select_mask("ficus", mask)["ficus"], mask)
        self.assertEqual(self.document.edits()[-1]["triangles"], [[0, 2], 7])
        self.document.select_mask("ficus", ~mask, mode="add")
        self.assertTrue(self.document.selection("ficus").all())
        with self.assertRaisesRegex(rebake.FieldError, "values, one per triangle of"):
            self.document.select_mask("ficus", mask[1:])

    def test_cages_move_arrays(self):
        points, faces = self.document.vertices("ficus"), self.document.faces("ficus")
        vertices, triangles = rebake.wrap(points, faces, 0.2)
        turned = vertices[:, [1, 2, 0]] * 2 + [1, 2, 3]
        moved = rebake.move_by_cage(points, vertices, triangles, turned)
        np.testing.assert_allclose(moved, points[:, [1, 2, 0]] * 2 + [1, 2, 3], atol=1e-12)
        with self.assertRaisesRegex(rebake.Error, "open"):
            rebake.move_by_cage(points, vertices, triangles[:-1], turned)
        with self.assertRaisesRegex(rebake.FieldError, "as many rows as vertices"):
            rebake.move_by_cage(points, vertices, triangles, turned[:-1])

    def test_edits_have_typed_parameters(self):
        parameters = inspect.signature(rebake.Document.grow).parameters
        self.assertEqual(parameters["steps"].default, 1)
        self.assertEqual(parameters["steps"].annotation, "int")
        with self.assertRaisesRegex(rebake.FieldError, 'did you mean "steps"'):
            self.document.grow(stepps=2)

    def test_the_same_bytes_as_a_script(self):
        self.document.select(node="ficus", box={"min": [0, 0.5, 0], "max": [1, 1, 1]}, frame="bounds")
        self.document.delete()
        self.document.export(self.at / "module")
        script = self.at / "s.jsonl"
        script.write_text(
            '{"op": "select", "node": "scene", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"}\n{"op": "delete"}\n'
        )
        subprocess.run(
            [Path(rebake.__file__).parent / "rebake", "run", script, "--scene", FICUS, "--out", self.at / "program"],
            check=True, stderr=subprocess.DEVNULL,
        )
        self.assertEqual(files(self.at / "module"), files(self.at / "program"))

    def test_one_plain_folder(self):
        self.document.duplicate(node="ficus", translate=[2, 0, 0])
        self.document.transform(node="ficus.2", rotate={"axis": [0, 1, 0], "degrees": 90})
        said = self.document.export(self.at / "plain", plain=True, width=40, report=self.at / "report.json")
        self.assertTrue(any("texels" in line for line in said), said)
        self.assertFalse((self.at / "plain" / "scene.json").exists())
        self.assertGreater(json.loads((self.at / "report.json").read_text())["texels"]["psnr_db"], 45)
        with self.assertRaisesRegex(rebake.FieldError, "4 to 256"):
            self.document.export(self.at / "plain", plain=True, width=3)

    def test_export_options(self):
        parameters = inspect.signature(rebake.Document.export).parameters
        self.assertEqual(list(parameters)[1:6], ["path", "layout", "format", "plain", "width"])
        self.document.duplicate(node="ficus", translate=[2, 0, 0])
        self.assertEqual(self.document.export(self.at / "unsplit", "unsplit", nodes=["ficus.2"]), [])
        self.assertIn("was replaced", self.document.export(self.at / "unsplit", "unsplit", nodes=["ficus.2"])[0])
        self.assertTrue((self.at / "unsplit" / "shape.obj").is_file())
        self.document.export(self.at / "scene", format="rebake")
        self.assertTrue((self.at / "scene" / "scene.json").is_file())
        for wrong in ({"format": "obj"}, {"page_size": 0}, {"psnr": 40}, {"nodes": ["nobody"]}):
            with self.assertRaisesRegex(rebake.FieldError, next(iter(wrong)) if "nodes" not in wrong else "nobody"):
                self.document.export(self.at / "none", **wrong)
        self.assertFalse((self.at / "none").exists())

    def test_publish(self):
        notes = self.document.publish(self.at / "page.html", single_file=True, title="A & B")
        self.assertIn("2328 triangles", notes[0])
        self.assertIn("<title>A &amp; B</title>", (self.at / "page.html").read_text())
        with self.assertRaisesRegex(rebake.Error, "must end in .html"):
            self.document.publish(self.at / "page", single_file=True)

    def test_films_and_pictures_with_passes(self):
        self.document.key(time=0, node="ficus", interpolation="linear")
        self.document.key(time=1, node="ficus", position=[0, 1, 0])
        notes = self.document.film(self.at / "film", fps=4, width=32, height=24)
        self.assertIn("wrote 5 pictures", notes[-1])
        self.assertEqual(len(list((self.at / "film").glob("*.png"))), 5)
        self.document.write_picture(self.at / "p.exr", passes=["depth", "node"], width=32, height=24)
        self.assertTrue((self.at / "p.exr").is_file())
        with self.assertRaisesRegex(rebake.FieldError, "known: color"):
            self.document.write_picture(self.at / "q.exr", passes=["dept"])

    def test_history_journal_and_project(self):
        self.document.keep_journal(self.at / "j")
        self.document.transform(node="ficus", translate=[0, 1, 0])
        self.document.rename(node="ficus", name="tree")
        self.assertTrue(self.document.undo())
        self.assertEqual(self.document.nodes[0]["name"], "ficus")
        edits = self.document.edits()
        self.assertEqual([e["op"] for e in edits], ["import", "transform"])
        self.document.save(self.at / "p.rebake")
        del self.document
        self.assertEqual(rebake.recover(self.at / "j").edits(), edits)
        project = rebake.open(self.at / "p.rebake")
        np.testing.assert_allclose(project.nodes[0]["to_world"][:3, 3], [0, 1, 0])

    def test_a_journal_needs_a_name(self):
        with self.assertRaisesRegex(rebake.Error, "path"):
            self.document.keep_journal("")

    def test_saving_does_not_replace_a_project_with_more_edits(self):
        self.document.transform(node="ficus", translate=[0, 1, 0])
        self.document.save(self.at / "p.rebake")
        before = (self.at / "p.rebake").read_bytes()
        with self.assertRaisesRegex(rebake.FileError, "contains 2 edits, more than the 0 to be saved"):
            rebake.Document().save(self.at / "p.rebake")
        self.assertEqual((self.at / "p.rebake").read_bytes(), before)
        self.document.undo()
        self.document.save(self.at / "p.rebake")
        opened = rebake.open(self.at / "p.rebake")
        opened.undo()
        opened.save(self.at / "p.rebake")
        self.assertEqual(rebake.open(self.at / "p.rebake").edits(), [])

    def test_documents_do_not_replace_the_sources_of_others(self):
        source = str(self.at / "source")
        rebake.open(FICUS).export(source)
        reader, writer = rebake.open(source), rebake.open(FICUS)
        writer.export(source)  # an own export, which no edit needs
        reader = rebake.open(source)
        reader.keep_journal(self.at / "j")
        with self.assertRaisesRegex(rebake.Error, "a source of another open document"):
            writer.export(source)
        reader.rename(node=reader.nodes[0]["name"], name="edited")
        for write in (writer.save, lambda out: writer.export(out)):
            with self.assertRaisesRegex(rebake.Error, "a source of another open document"):
                write(source)
        del reader
        writer.export(source)
        capture = self.at / "capture"
        shutil.copytree(FICUS, capture)
        reader = rebake.open(capture)
        with self.assertRaisesRegex(rebake.Error, "a source of another open document"):
            writer.export(capture)  # not made by this process

    def test_exports_are_known_by_place_and_content(self):
        writer = rebake.open(FICUS)
        before = os.getcwd()
        for name in ("one", "two"):
            os.mkdir(self.at / name)
        shutil.copytree(FICUS, self.at / "two" / "scene")
        try:
            os.chdir(self.at / "one")
            writer.export("scene")
            os.chdir(self.at / "two")
            reader = rebake.open("scene")
            writer.select(none=True)  # the relative name of the export must not be taken for this folder
            with self.assertRaisesRegex(rebake.Error, "a source of another open document"):
                writer.export("scene")
        finally:
            os.chdir(before)
        del reader
        export = self.at / "one" / "scene"
        shutil.rmtree(export)
        shutil.copytree(FICUS, export)
        decoder = json.loads((export / "mlp.json").read_text())
        (export / "mlp.json").write_text(json.dumps(decoder | {"mine": 1}))
        reader = rebake.open(export)
        with self.assertRaisesRegex(rebake.Error, "a source of another open document"):
            writer.export(export)  # replaced by another program since
        del reader
        writer.export(export)
        reader = rebake.open(export)
        writer.export(export)

    def test_saving_keeps_what_was_saved_meanwhile(self):
        path = str(self.at / "shared.rebake")
        rebake.open(FICUS).save(path)
        one, other = rebake.open(path), rebake.open(path)
        for name in ("a", "b"):
            one.rename(node=one.nodes[0]["name"], name=name)
        one.save(path)
        with self.assertRaisesRegex(rebake.Error, "was changed by another program"):
            other.save(path)
        self.assertEqual(len(rebake.open(path).edits()), 3)

    def test_green_coordinates_warn_of_points_outside(self):
        vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
        faces = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                          [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]], np.uint32)
        points = np.array([[0.5, 0.5, 0.5], [3, 0.5, 0.5]])
        with self.assertWarnsRegex(UserWarning, "1 point is outside the cage.*stays .first: row 1"):
            moved = rebake.move_by_cage(points, vertices, faces, vertices + [1, 0, 0], "green")
        np.testing.assert_allclose(moved, [[1.5, 0.5, 0.5], [3, 0.5, 0.5]])

    def test_what_is_dropped_is_warned_of(self):
        self.document.select(node=self.document.nodes[0]["name"], all=True)
        self.document.store_selection(name="s")
        with self.assertWarnsRegex(UserWarning, "stored selection"):
            self.document.save(self.at / "scene")
        self.document.view(name="v", camera={"eye": [0, 0, 3], "target": [0, 0, 0]})
        self.document.save(self.at / "other")
        self.document.view(name="v", camera={"eye": [0, 0, 4], "target": [0, 0, 0]})
        with self.assertWarnsRegex(UserWarning, 'not imported, because the scene has its own: the view "v"'):
            self.document.import_(path=self.at / "other", as_="second")
        with self.assertRaisesRegex(rebake.Error, "in small letters"):
            self.document.save(self.at / "p.REBAKE")

    def test_warnings_as_errors_do_not_undo_what_is_done(self):
        name = self.document.nodes[0]["name"]
        self.document.hide(node=name)
        seen, before = [], len(self.document.edits())
        hook, sys.unraisablehook = sys.unraisablehook, lambda what: seen.append(what.exc_value)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self.document.transform(node=name, translate=[1, 0, 0])
        finally:
            sys.unraisablehook = hook
        self.assertIn("is hidden", str(seen[0]))
        self.assertEqual(len(self.document.edits()), before + 1)

    def test_an_opened_scene_keeps_its_background(self):
        self.document.background(color=[1, 0, 0])
        self.document.save(self.at / "scene")
        np.testing.assert_array_equal(rebake.open(self.at / "scene").render(16, 16, 1)[0, 0], [255, 0, 0])

    def test_recovery_says_when_it_writes_no_journal(self):
        (self.at / "was").symlink_to(FICUS)
        script = "import os, rebake; d = rebake.Document(); d.keep_journal('j'); d.import_(path='was', as_='f'); os._exit(9)"
        environment = {**os.environ, "PYTHONPATH": str(Path(rebake.__file__).resolve().parent)}
        subprocess.run([sys.executable, "-c", script], cwd=self.at, env=environment, check=False)
        (self.at / "was").unlink()
        with self.assertWarnsRegex(UserWarning, "is not changed, and further edits are not in a"):
            rebake.recover(self.at / "j", {str(self.at / "was"): str(FICUS)})

    def test_a_project_opens_with_sources_that_were_moved(self):
        shutil.copytree(FICUS, self.at / "scene")
        document = rebake.Document()
        document.import_(path=self.at / "scene")
        document.save(self.at / "p.rebake")
        (self.at / "scene").rename(self.at / "moved")
        with self.assertRaisesRegex(rebake.FileError, "sources are missing or have changed; restore"):
            rebake.open(self.at / "p.rebake")
        opened = rebake.open(self.at / "p.rebake", sources={self.at / "scene": self.at / "moved"})
        self.assertEqual(len(opened.edits()), 1)
        with self.assertRaisesRegex(rebake.FieldError, "sources"):
            rebake.open(FICUS, sources={"a": "b"})
        with self.assertRaisesRegex(rebake.FieldError, "must map paths"):
            rebake.open(self.at / "p.rebake", sources={self.at / "scene": 7})

    def test_text_that_is_not_utf8_names_its_field(self):
        with self.assertRaisesRegex(rebake.FieldError, 'field "path".*UTF-8'):
            rebake.Document().import_(path="scene\udcff")

    def test_render(self):
        picture = self.document.render(64, 48)
        self.assertEqual((picture.shape, picture.dtype), ((48, 64, 3), np.uint8))
        self.assertGreater(np.ptp(picture), 50)
        self.document.hide(node="ficus")
        self.assertTrue((self.document.render(64, 48) == 255).all())

    def test_other_threads_go_on_and_every_thread_may_draw(self):
        pictures, ticks, stop = {}, [0], threading.Event()

        def tick():
            while not stop.wait(0.001):
                ticks[0] += 1

        def draw(k):
            pictures[k] = self.document.render(64, 48)

        ticker = threading.Thread(target=tick)
        ticker.start()
        drawers = [threading.Thread(target=draw, args=(k,)) for k in range(4)]
        for thread in drawers:
            thread.start()
        for thread in drawers:
            thread.join()
        before = ticks[0]
        vertices, triangles = rebake.wrap(self.document.vertices("ficus"), self.document.faces("ficus"), 0.02)
        stop.set()
        ticker.join()
        self.assertGreater(ticks[0] - before, 3, "the interpreter's lock is let go during long work")
        for picture in pictures.values():
            np.testing.assert_array_equal(picture, pictures[0])
        del self.document  # deleted by a thread other than the one that drew first

    def test_progress_is_told_and_may_stop(self):
        told = []
        document = rebake.open(FICUS, progress=lambda what, share: told.append((what, share)))
        edits = document.edits()

        def stop(what, share):
            raise ValueError(what)

        document.progress = stop
        with self.assertRaises(ValueError):
            document.cage(node="ficus", wrap=0.01, moves=[{"points": [[0, 9]], "translate": [0, 1, 0]}])
        self.assertEqual(document.edits(), edits, "nothing was done")
        for what, share in told:
            self.assertIsInstance(what, str)
            self.assertTrue(0 <= share <= 1)

    def test_an_exception_of_progress_does_not_undo_what_is_done(self):
        """Either the work stops without a change and the exception arrives, or it is complete and none does."""
        unraisable = []
        sys.unraisablehook, kept = unraisable.append, sys.unraisablehook
        try:
            for after in range(12):
                told = 0

                def stop(what, share):
                    nonlocal told
                    told += 1
                    if told > after:
                        raise ValueError(what)

                self.document.progress = None
                before = len(self.document.edits())
                self.document.progress = stop
                try:
                    self.document.slim(node="ficus", psnr=30)
                    done = True
                except ValueError:
                    done = False
                self.assertEqual(len(self.document.edits()) - before, int(done))
                out = self.at / f"out{after}"
                told = 0
                try:
                    self.document.export(out)
                    self.assertTrue((out / "mlp.json").exists())
                except ValueError:
                    self.assertFalse(out.exists())
                if done:
                    self.document.progress = None
                    self.document.undo()
        finally:
            sys.unraisablehook = kept

    def test_the_interpreter_ends_while_threads_are_at_work(self):
        for daemon, end in ((True, "pass"), (True, "raise SystemExit(3)"), (False, "os.kill(os.getpid(), signal.SIGINT)")):
            work = (
                "import os, rebake, signal, sys, threading, time\n"
                "d = rebake.open(sys.argv[1])\n"
                "def go():\n"
                "    try:\n"
                "        d.cage(node='ficus', wrap=0.012, moves=[{'points': [[0, 9]], 'translate': [0, 1, 0]}])\n"
                "    except rebake.Error:\n"
                "        pass\n"
                f"thread = threading.Thread(target=go, daemon={daemon})\n"
                "thread.start()\n"
                "time.sleep(0.3)\n"
                "if not thread.is_alive():\n"
                "    os._exit(77)\n"
                f"{end}\n"
                f"{'' if daemon else 'thread.join()'}\n"
            )
            process = subprocess.run([sys.executable, "-c", work, FICUS], stderr=subprocess.DEVNULL, timeout=100)
            self.assertIn(process.returncode, (0, 1, 3, -signal.SIGINT), f"{end}: no abort")

    def test_arrays_of_wrong_kinds_are_refused_by_name(self):
        points, faces = np.eye(4, 3), np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
        good = {"points": np.full((1, 3), 0.2), "vertices": points, "faces": faces, "moved": points}
        rebake.move_by_cage(**good)
        for name, bad in (("faces", faces.astype(float)), ("faces", faces - 1), ("faces", faces + 2 ** 32),
                          ("faces", faces.astype(complex)), ("points", np.full((1, 3), np.nan)),
                          ("points", np.full((1, 3), 1j)), ("points", "text"), ("points", None), ("points", np.full((1, 3), 1e90)), ("moved", points[:, :2]),
                          ("vertices", points * np.inf)):
            with self.assertRaisesRegex((rebake.Error, ValueError), name, msg=f"{name}: {bad}"):
                rebake.move_by_cage(**{**good, name: bad})

    def test_interrupts_stop_long_work(self):
        work = (
            "import rebake, sys\n"
            "d = rebake.open(sys.argv[1])\n"
            "print('ready', flush=True)\n"
            "try:\n"
            "    d.cage(node='ficus', wrap=0.012, moves=[{'points': [[0, 9]], 'translate': [0, 1, 0]}])\n"
            "except KeyboardInterrupt:\n"
            "    print(len(d.edits()), flush=True)\n"
        )
        process = subprocess.Popen([sys.executable, "-c", work, FICUS], stdout=subprocess.PIPE, text=True)
        self.assertEqual(process.stdout.readline(), "ready\n")
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=60)[0], "1\n")

    def test_a_forked_process_is_refused_and_does_not_hang(self):
        self.document.render(32, 32)
        child = os.fork()
        if child == 0:
            try:
                self.document.render(32, 32)
            except rebake.Error:
                os._exit(7)
            os._exit(0)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 7)

    def test_endless_arguments_are_refused(self):
        loop = []
        loop.append(loop)
        with self.assertRaises((ValueError, rebake.Error, RecursionError)):
            self.document.select(triangles=loop)
        with self.assertRaises((TypeError, ValueError, rebake.Error)):
            self.document.select(triangles=(k for k in iter(int, 1)))

    def test_errors(self):
        with self.assertRaisesRegex(rebake.FieldError, 'did you mean "ficus"'):
            self.document.remove(node="ficsu")
        with self.assertRaisesRegex(rebake.FieldError, 'did you mean "box"'):
            self.document.select(bx={})
        with self.assertRaisesRegex(rebake.EditError, "no triangle is selected"):
            self.document.delete()
        with self.assertRaises(rebake.FileError):
            rebake.open(self.at / "nothing")
        with self.assertRaises(TypeError):
            self.document.rename(node="ficus", name=object())
        self.assertEqual(len(self.document.edits()), 1, "nothing was done")
        self.assertTrue(issubclass(rebake.FileError, rebake.Error))

    def test_every_edit_has_a_method_with_help_and_the_stub_is_current(self):
        stub = (ROOT / "editor/python/rebake.pyi").read_text()
        self.assertEqual(stub, rebake.python_stub(), "run samples/regenerate")
        compile(stub, "rebake.pyi", "exec")
        for name in ("import_", "select", "select_picture", "erase", "merge", "transform"):
            self.assertIn("\n", getattr(rebake.Document, name).__doc__)


if __name__ == "__main__":
    unittest.main()
