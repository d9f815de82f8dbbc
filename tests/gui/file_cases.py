"""Files: opening, saving, exporting, recovering, and file dialogs."""

import fcntl
import json
import os
import shutil
import subprocess
import time

from screen import read_picture, until
from window_case import WindowCase, FICUS, KETTLE, PROGRAM, green, write_square


class FileTest(WindowCase):
    def test_save_quit_and_open_again(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        project = self.folder / "plant.rebake"
        editor.key("ctrl+q")
        self.assertIsNone(editor.process.poll(), "there are unsaved changes")
        # "Save" quits after saving. If saving fails, the dialog stays, and a later save does not quit.
        editor.click("dialog/save")
        editor.answer("/nowhere/plant.rebake")
        self.assertTrue(editor.state()["asks"], "there is no such folder: it stays open")
        editor.key("Escape", "ctrl+s")
        editor.answer(str(self.folder / "first.rebake"))
        until((self.folder / "first.rebake").is_file, "the project")
        editor.settle()
        self.assertIsNone(editor.process.poll(), "only what was asked for")
        editor.key("ctrl+i", "ctrl+q")
        x, y = editor.where("dialog/save")
        editor.move(x, y)
        editor.tool("click", 1)
        self.assertEqual(editor.process.wait(20), 0)
        editor = self.open(FICUS)
        editor.until_ops("import")
        editor.key("ctrl+a", "ctrl+q")
        editor.click("dialog/save")
        editor.key("ctrl+a")
        editor.type(str(project))
        editor.tool("key", "Return")
        self.assertEqual(editor.process.wait(20), 0)
        self.assertTrue(project.is_file())
        self.assertEqual(list((self.screen.home / "state/rebake/journals").iterdir()), [], "the work is safe in the project")
        editor = self.open(project)
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "select"])
        # Replacing an undone edit by another one is an unsaved change too.
        editor.key("ctrl+z", "ctrl+i")
        editor.until_ops("import", "select", "undo", "select")
        editor.key("ctrl+q")
        editor.click("dialog/cancel")
        self.assertIsNone(editor.process.poll())
        editor.key("ctrl+q")
        x, y = editor.where("dialog/do-not-save")
        editor.move(x, y)
        editor.tool("click", 1)
        self.assertEqual(editor.process.wait(20), 0)

    def test_closing_stops_when_nothing_can_open_the_saved_project(self):
        source = self.folder / "source"
        shutil.copytree(KETTLE, source)
        editor = self.open(source)
        editor.until_ops("import")
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        source.rename(self.folder / "moved")
        editor.key("ctrl+q")
        editor.click("dialog/save")
        editor.answer(str(self.folder / "kettle.rebake"))
        until((self.folder / "kettle.rebake").is_file, "the project")
        editor.settle()
        self.assertIsNone(editor.process.poll(), "the window has the only copy of the work")
        journals = list((self.screen.home / "state/rebake/journals").iterdir())
        self.assertEqual(len(journals), 1)
        # Nor is the scene of the import safe, which the project does not show.
        editor.key("ctrl+z", "ctrl+q")
        self.assertTrue(editor.state()["asks"], "the work is unsaved")
        editor.click("dialog/cancel")

    def test_edits_during_the_save_before_closing_are_asked_about(self):
        editor = self.open(KETTLE)
        editor.until_ops("import")
        folder = self.folder / "slow"
        folder.mkdir()
        project = folder / "kettle.rebake"
        editor.key("ctrl+a", "ctrl+s")
        editor.answer(str(project))
        until(project.is_file, "the project")
        editor.settle()
        editor.key("ctrl+i")
        # A save waits for other programs that save there.
        other = os.open(folder, os.O_RDONLY)
        fcntl.flock(other, fcntl.LOCK_EX)
        editor.key("ctrl+q")
        x, y = editor.where("dialog/save")
        editor.move(x, y)
        editor.tool("click", 1)
        time.sleep(0.5)
        editor.tool("key", "ctrl+i")
        time.sleep(0.3)
        os.close(other)
        until(lambda: editor.state()["asks"] and editor.state()["items"].get("dialog/save"), "the question")
        self.assertIsNone(editor.process.poll())
        self.assertEqual(editor.ops(), ["import", "select", "select", "select"])
        x, y = editor.where("dialog/save")
        editor.move(x, y)
        editor.tool("click", 1)
        self.assertEqual(editor.process.wait(20), 0)
        self.assertEqual(len(json.loads(project.read_text())["edits"]), 4)

    def test_a_project_of_which_everything_was_deleted_is_saved(self):
        project = self.folder / "empty.rebake"
        editor = self.open(FICUS)
        editor.until_ops("import")
        editor.key("ctrl+a", "Delete")
        editor.until_ops("import", "select", "delete")
        editor.key("ctrl+s")
        editor.click("dialog/path")
        editor.answer(str(project))
        until(project.is_file, "the project", 20)

    def test_a_web_page_is_published_and_opened(self):
        # Stands for the desktop's way to open files.
        opener, opened = self.folder / "bin/xdg-open", self.folder / "opened"
        opener.parent.mkdir()
        opener.write_text(f"#!/bin/sh\necho \"$1\" >{opened}\n")
        opener.chmod(0o755)
        self.screen.environment["PATH"] = f"{opener.parent}:{os.environ['PATH']}"
        editor = self.open(FICUS)
        editor.until_ops("import")
        editor.command("publish")
        editor.click("dialog/path")
        page = self.folder / "page.html"
        editor.answer(str(page))
        until(opened.is_file, "the browser", 30)
        self.assertIn("<title>page</title>", page.read_text())
        until(lambda: opened.read_text().strip() == str(page), "its file", 5)

    def test_what_was_opened_before_has_a_picture(self):
        self.open_ficus()
        kept = self.screen.home / "cache" / "rebake" / "pictures"
        self.assertEqual(len(list(kept.glob("*.png"))), 1)
        self.editor.tool("key", "ctrl+q")
        self.editor.process.wait(timeout=20)
        editor = self.open()
        x, y, width, height = (round(v) for v in editor.state()["items"]["start/recent/ficus"])
        self.assertGreater(green(editor.picture()[y:y + height, x:x + width]).sum(), 200)
        editor.click("start/recent/ficus")
        editor.until_ops("import")

    def test_the_file_dialog_completes_filters_and_takes_several(self):
        scenes = self.folder / "scenes"
        for name in ("plant", "pot", "mug"):
            shutil.copytree(KETTLE, scenes / name)
        editor = self.open()
        editor.key("ctrl+o")
        editor.key("ctrl+a")
        editor.type(str(scenes) + "/P")
        self.assertEqual(set(editor.items("dialog/entries")), {"..", "plant", "pot"})
        editor.type("L")
        editor.key("Tab", "Return")
        editor.until_ops("import")
        self.assertTrue(editor.last_edit()["path"].endswith("scenes/plant"))
        # Arrow keys move through the list.
        editor.key("ctrl+o", "Down", "Down", "Down", "Return")
        editor.until_ops("import", "import")
        self.assertTrue(editor.last_edit()["path"].endswith("scenes/pot"))
        # Ctrl selects several.
        editor.key("ctrl+o")
        editor.click("dialog/entries/plant")
        editor.click("dialog/entries/mug", held="ctrl")
        # Ctrl on a selected entry deselects it.
        editor.click("dialog/entries/pot", held="ctrl")
        editor.click("dialog/entries/pot", held="ctrl")
        editor.click("dialog/confirm")
        editor.until_ops("import", "import", "import", "import")
        self.assertEqual([edit["edit"]["path"].rsplit("/", 1)[1] for edit in editor.journal()],
                         ["plant", "pot", "mug", "plant"])

    def test_the_desktops_own_dialog(self):
        self.program("zenity", f"echo \"$@\" > '{self.folder}/asked'; sleep 0.3; echo '{FICUS}'; echo '{KETTLE}'")
        editor = self.open()
        editor.key("ctrl+o")
        editor.click("dialog/folders")
        editor.until_ops("import", "import")
        self.assertIn("--directory --multiple", (self.folder / "asked").read_text())
        # A path that it returns for writing must still be confirmed.
        out = self.folder / "chosen"
        self.program("zenity", f"echo '{out}'")
        editor.key("ctrl+e")
        editor.click("dialog/browse")
        self.assertFalse(out.exists())
        editor.click("dialog/confirm")
        until(out.is_dir, "the export")

    def test_one_plain_folder(self):
        editor = self.open(write_square(self.folder / "one", 1), write_square(self.folder / "other", -1))
        editor.until_ops("import", "import")
        editor.key("1")
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x + 150, y)])
        editor.key("ctrl+e")
        editor.click("dialog/plain")
        editor.click("dialog/compare")
        # Escape closes the comparison only.
        editor.key("Escape")
        self.assertTrue(editor.state()["asks"], "the export's own dialog stays")
        editor.click("dialog/compare")
        until(lambda: "dialog/plain/wipe" in editor.state()["items"], "the comparison", 180)
        until(lambda: editor.state()["settled"], "the preview", 180)
        before = editor.picture()
        x, y = editor.where("dialog/plain/wipe")
        editor.drag([(x, y), (x - 200, y)])
        self.assertGreater(int((editor.picture() != before).sum()), 500, "the wipe follows")
        editor.click("dialog/plain/way 0")
        editor.click("dialog/plain/use")
        out = self.folder / "plain"
        editor.click("dialog/path")
        editor.answer(str(out))
        until(lambda: (out / "mlp.json").is_file(), "the export", 180)
        editor.settle()
        self.assertFalse((out / "scene.json").exists())

    def test_pictures_do_not_replace_photographs_nor_saves_the_work_of_others(self):
        editor = self.open(FICUS)
        editor.until_ops("import")
        images = self.folder / "cap/images"
        linked = self.folder / "linked"
        images.mkdir(parents=True)
        linked.mkdir()
        for k in range(3):
            (images / f"{k:03}.png").write_bytes(b"\x89PNG of somebody")
            (linked / f"{k:03}.png").symlink_to(images / f"{k:03}.png")
        (self.folder / "cap/transforms.json").write_text(json.dumps({
            "camera_angle_x": 0.7, "w": 16, "h": 16, "frames": [
                {"file_path": f"images/{k:03}.png", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}
                for k in range(3)]}))
        for question, path in (("turntable", images), ("turntable", linked), ("screenshot", images / "000.png")):
            editor.command(question)
            editor.answer(str(path))
            editor.key("Return")  # also confirms replacing it
            editor.settle()
            for k in range(3):
                self.assertEqual((images / f"{k:03}.png").read_bytes(), b"\x89PNG of somebody", question)
            editor.key("Escape", "Escape", "Escape")
        project = self.folder / "p.rebake"
        editor.key("ctrl+shift+s")
        editor.answer(str(project))
        until(project.is_file, "the project")
        editor.settle()
        changed = project.read_text().replace('"edits"', '"edits" ', 1)
        project.write_text(changed)
        editor.key("ctrl+shift+s")
        editor.answer(str(self.folder / "cap" / ".." / "p.rebake"))
        editor.key("Return")
        editor.settle()
        self.assertEqual(project.read_text(), changed)

    def test_videos_of_others_are_not_replaced(self):
        self.program("ffmpeg", "for last; do :; done\nprintf 'a video' > \"$last\"\n")
        editor = self.open(FICUS)
        editor.until_ops("import")
        own = self.folder / "own.mp4"
        editor.command("turntable")
        editor.answer(str(own))
        until(lambda: own.is_file() and own.read_bytes().startswith(b"a video"), "the video")
        mine = self.folder / "mine.mp4"
        mine.write_bytes(own.read_bytes() + b" with music")
        before = mine.read_bytes()
        editor.command("turntable")
        editor.answer(str(mine))
        editor.key("Return")  # also confirms replacing it
        editor.settle()
        self.assertTrue(editor.state()["asks"], "refused")
        self.assertEqual(mine.read_bytes(), before)

    def test_folders_of_other_tools_have_import_options(self):
        editor = self.open()
        editor.key("ctrl+o")
        editor.click("dialog/options")
        editor.click("dialog/options/half_direction")
        editor.key("Escape")
        self.assertTrue(editor.state()["asks"], "Escape closes the options only")
        editor.click("dialog/path")
        editor.answer(str(FICUS))
        editor.until_ops("import")
        self.assertTrue(editor.journal()[0]["edit"]["half_direction"])

    def test_exports_in_another_format_and_layout(self):
        editor = self.open(FICUS)
        editor.until_ops("import")
        editor.key("ctrl+e")
        editor.click("dialog/options")
        editor.click("dialog/options/layout")
        editor.click("dialog/options/layout unsplit")
        editor.key("Escape")
        self.assertTrue(editor.state()["asks"], "Escape closes the options only")
        out = self.folder / "unsplit"
        editor.click("dialog/path")
        editor.answer(str(out))
        until(lambda: (out / "mlp.json").is_file(), "the export")
        editor.settle()
        self.assertTrue((out / "shape.obj").is_file(), list(out.iterdir()))
        editor.key("ctrl+e")
        editor.click("dialog/format")
        editor.click("dialog/format rebake")
        self.assertNotIn("dialog/plain", editor.state()["items"])
        out = self.folder / "scene"
        editor.click("dialog/path")
        editor.answer(str(out))
        until(lambda: (out / "scene.json").is_file(), "the export")

    def test_screenshots_have_the_format_of_their_name(self):
        editor = self.open_ficus()
        for name, start in (("a.jpg", b"\xff\xd8\xff"), ("b.webp", b"RIFF"), ("c", b"\x89PNG")):
            editor.key("F12")
            editor.answer(str(self.folder / name))
            picture = self.folder / (name if "." in name else name + ".png")
            until(picture.exists, name)
            editor.settle()
            self.assertTrue(picture.read_bytes().startswith(start), name)

    def test_only_what_is_picked_is_exported(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        self.assertEqual(editor.state()["picked"], ["kettle"])
        out = self.folder / "kettle alone"
        editor.key("ctrl+e")
        editor.click("dialog/only-picked")
        editor.click("dialog/path")
        editor.answer(str(out))
        until(lambda: out.is_dir(), "the export")
        editor.settle()
        told = subprocess.run([PROGRAM, "info", out], capture_output=True, text=True).stdout
        alone = subprocess.run([PROGRAM, "info", KETTLE], capture_output=True, text=True).stdout
        geometry = lambda text: [line for line in text.splitlines() if "geometry  " in line]
        self.assertEqual(geometry(told), geometry(alone), told)
        self.assertEqual(len(geometry(told)), 1)
        # Screenshots too: a picture of the kettle alone shows no leaves.
        both, one = self.folder / "both.png", self.folder / "one.png"
        for picture in (both, one):
            editor.key("F12")
            if picture == one:
                editor.click("dialog/only-picked")
                editor.click("dialog/path")
            editor.answer(str(picture))
            until(picture.exists, "a screenshot")
            editor.settle()
        leaves = lambda file: int(green(read_picture(file)).sum())
        self.assertGreater(leaves(both), 1000)
        self.assertEqual(leaves(one), 0)

    def test_a_full_disk_is_said_and_nothing_is_lost(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        project = self.folder / "plant.rebake"

        def save():
            editor.key("ctrl+s")
            editor.answer(str(project))

        editor.fill_disk()
        save()
        editor.until(lambda state: any("File too large" in text for text in state["messages"]), "said")
        self.assertEqual(list(self.folder.glob("plant*")), [], "no half of a file")
        editor.key("Escape")
        # An edit that cannot be written to the journal is not applied.
        editor.key("ctrl+i")
        self.assertEqual(editor.ops(), ["import", "select"])
        editor.key("Escape")
        editor.fill_disk(False)
        save()
        until(project.is_file, "the project")
        editor.key("ctrl+i")
        editor.until_ops("import", "select", "select")

    def test_a_script_replaces_only_scripts(self):
        editor = self.open_ficus()
        project = self.folder / "plant.rebake"
        editor.key("ctrl+s")
        editor.answer(str(project))
        until(project.is_file, "the project")
        link = self.folder / "plant.jsonl"
        link.symlink_to(project)
        other = self.folder / "cameras.jsonl"
        other.write_text('{"frames": []}\n')
        script = self.folder / "script.jsonl"
        script.write_text("# mine\n" + '{"op": "undo"}\n')
        before = {file: file.read_bytes() for file in (project, other)}
        for file, why in ((link, "is a project"), (other, "is not a script")):
            editor.command("save as script")
            editor.answer(str(file))
            editor.key("Return")
            editor.until(lambda state: why in " ".join(state["messages"]), why)
            editor.key("Escape")
        self.assertEqual({file: file.read_bytes() for file in before}, before)
        editor.command("save as script")
        editor.answer(str(script))
        editor.key("Return")
        until(lambda: "import" in script.read_text(), "the script")

    def test_an_export_never_replaces_what_was_imported(self):
        source = self.folder / "plant"
        shutil.copytree(FICUS, source)
        before = {file.name: file.read_bytes() for file in source.iterdir()}
        editor = self.open(source)
        editor.until_ops("import")
        editor.key("ctrl+a", "Delete")
        editor.until_ops("import", "select", "delete")
        editor.key("ctrl+z", "ctrl+e")
        editor.answer(str(source))
        self.assertIn("dialog/problem", editor.state()["items"], "refused before it is asked whether to replace it")
        editor.key("Return")
        self.assertTrue(editor.state()["asks"])
        self.assertEqual({file.name: file.read_bytes() for file in source.iterdir()}, before)

    def test_export_and_replay_give_the_same_bytes(self):
        editor = self.open_ficus()
        editor.key("b")
        editor.drag([editor.in_viewport(0.6, 0.28), editor.in_viewport(0.68, 0.32)])
        editor.key("Delete")
        editor.key("n")
        x, y = editor.where("bend/tip")
        editor.drag([(x, y), (x + 60, y + 20)])
        editor.click("properties/Scale/Y")
        editor.type("1.25")
        editor.key("Return")
        editor.until_ops("import", "select_picture", "delete", "bend", "place")
        exported, script = self.folder / "exported", self.folder / "session.jsonl"
        editor.key("ctrl+e")
        editor.answer(str(exported))
        until(lambda: (exported / "mlp.json").is_file() or list(exported.glob("*/mlp.json")), "the export")
        editor.settle()
        editor.command("save as script")
        editor.answer(str(script))
        until(script.is_file, "the script")
        with script.open("a") as lines:
            lines.write('{"op": "export", "out": "%s"}\n' % (self.folder / "replayed"))
        subprocess.run([PROGRAM, "run", script], check=True, capture_output=True)
        subprocess.run(["diff", "-r", exported, self.folder / "replayed"], check=True)

    def test_recover_after_a_kill(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        editor.kill()
        editor = self.open(FICUS)  # the dialog waits while a scene is read
        editor.click("dialog/recover")
        editor.key("shift+t")  # tint of the selection
        self.assertGreater(self.leaves(), 1000, "the scene is back")
        editor.key("ctrl+i")
        until(lambda: editor.ops() == ["import", "select", "select"], "the recovered work, going on")

    def test_discarded_work_is_asked_about_and_stays_in_the_trash(self):
        editor = self.open_ficus()
        editor.key("ctrl+a", "ctrl+i", "ctrl+a")
        editor.until_ops("import", "select", "select", "select")
        editor.key("ctrl+z")
        editor.until_ops("import", "select", "select", "select", "undo")
        editor.kill()
        editor = self.open()
        said = [item for item in editor.state()["items"] if item.startswith("dialog/")]
        self.assertIn("dialog/sources: ficus", said)
        self.assertTrue(any("words: 3 steps, " in item and str(time.localtime().tm_year) in item for item in said), said)
        self.assertIn("dialog/thumbnail", said)
        # Discard asks first; Cancel and Escape keep the work.
        editor.click("dialog/ask-discard")
        editor.click("dialog/cancel")
        editor.click("dialog/ask-discard")
        editor.key("Escape")
        editor.click("dialog/ask-discard")
        editor.click("dialog/discard")
        editor.settle()
        self.assertFalse(editor.state()["asks"], "nothing else is left to recover")
        editor.command("discarded work")
        editor.click("dialog/recover")
        until(lambda: self.leaves() > 1000, "the work is back from the trash")
        editor.key("ctrl+i")
        until(lambda: editor.ops()[-1] == "select", "and goes on")
        editor.command("discarded work")
        editor.settle()
        self.assertFalse(editor.state()["asks"], "the trash is empty")

    def test_what_cannot_be_read_is_said_and_the_rest_is_there(self):
        bad = self.folder / "bad"
        bad.mkdir()
        editor = self.open(bad, FICUS)
        editor.until_ops("import")
        self.assertGreater(self.leaves(), 1000)
        self.assertTrue(any("bad" in text for text in editor.state()["messages"]))
        editor.key("Escape")
        self.assertFalse(any("bad" in text for text in editor.state()["messages"]), "read and closed")
        editor.key("Escape", "Escape", "Escape")
        self.assertIsNone(editor.process.poll(), "Escape never quits")
