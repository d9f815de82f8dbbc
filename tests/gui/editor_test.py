"""The editor as people use it: each test asserts the edits that arrived in the document, and what is seen."""

import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from screen import Editor, Screen, until

PROGRAM = sys.argv.pop(1)
HERE = pathlib.Path(__file__).resolve().parent
FICUS = HERE.parents[1] / "samples" / "scenes" / "ficus"
KETTLE = FICUS.parent / "kettle"
# Where things stand in a window of 1280 x 800.
LEAVES = [(560, 160), (700, 160), (700, 300), (560, 300)]
NODE_IN_OUTLINE, SECOND_NODE = (1030, 74), (1030, 92)
MAKE_CAGE = (475, 38)
MOVE_TOOL = (32, 206)
Y_KNOB = (910, 75)
RECOVER = (490, 406)
DEGREES = (960, 231)
APPLY = (877, 375)


def leaf_pixels(editor):
    picture = editor.picture()[60:570, 75:950]
    return int(((picture[..., 1] > picture[..., 0] + 25) & (picture[..., 1] > picture[..., 2] + 25)).sum())


class EditorTest(unittest.TestCase):
    def setUp(self):
        self.screen = Screen()
        self.editor = None
        self.folder = pathlib.Path(tempfile.mkdtemp())

    def tearDown(self):
        if self.editor and self.editor.process.poll() is None:
            self.editor.kill()
        self.screen.close()

    def open(self, *paths):
        self.editor = Editor(PROGRAM, self.screen, *paths)
        return self.editor

    def open_ficus(self):
        editor = self.open(FICUS)
        editor.until_ops("import")
        return editor

    def expect_like(self, name, decibels):
        """The whole window against a kept picture. Without the tint, or without the grid, it is at 30 dB, without the
        leaves at 23; 40 leaves room for rounding of another processor."""
        kept, seen = HERE / "pictures" / (name + ".png"), self.folder / (name + ".png")
        # What was done is in the journal before the window shows it.
        for _ in range(20):
            self.editor.save_picture(seen)
            result = subprocess.run([PROGRAM, "compare", kept, seen, "--min-psnr", str(decibels)], capture_output=True, text=True)
            if result.returncode == 0:
                return
            time.sleep(0.5)
        self.fail(f"{result.stdout}{result.stderr} (seen: {seen})")

    def test_turn_the_view_lasso_leaves_delete_undo_redo(self):
        editor = self.open_ficus()
        self.expect_like("opened", 40)
        all_leaves = leaf_pixels(editor)
        editor.drag(2, [(400, 500), (430, 490)])
        editor.key("l")
        editor.drag(1, LEAVES + LEAVES[:1])
        editor.until_ops("import", "select_picture")
        selected = editor.journal()[-1]["edit"]
        self.assertGreater(len(selected["polygon"]), 10)
        self.assertFalse(selected["through"])
        self.expect_like("selected", 40)
        editor.key("Delete")
        editor.until_ops("import", "select_picture", "delete")
        fewer = leaf_pixels(editor)
        self.assertLess(fewer, 0.85 * all_leaves)
        editor.key("ctrl+z")
        editor.until_ops("import", "select_picture", "delete", "undo")
        editor.key("ctrl+shift+z")
        editor.until_ops("import", "select_picture", "delete", "undo", "redo")
        self.assertAlmostEqual(leaf_pixels(editor), fewer, delta=50)

    def test_what_is_seen_is_selected_from_near_far_and_flat(self):
        editor = self.open_ficus()
        seen = []
        for look in (lambda: [editor.click_wheel(530, 230, 4) for _ in range(8)],
                     lambda: [editor.click_wheel(530, 230, 5) for _ in range(14)], lambda: editor.key("f", "5")):
            look()
            editor.settle()
            editor.key("r")
            editor.drag(1, [(80, 70), (950, 560)])
            editor.until_ops("import", *["select_picture"] * (len(seen) + 1))
            seen.append(editor.journal()[-1]["edit"]["camera"])
            self.assertGreater(self.share_tinted(), 0.7, seen[-1])
            editor.key("v")

    def share_tinted(self):
        """Of the pixels that are not the white background or the grey grid, those that are orange."""
        picture = self.editor.picture()[200:560, 75:940]
        coloured = picture.max(axis=2) - picture.min(axis=2) > 60
        orange = coloured & (picture[..., 0] > picture[..., 1]) & (picture[..., 1] > picture[..., 2])
        return orange.sum() / max(1, coloured.sum())

    def test_save_quit_and_open_again(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        project = self.folder / "plant.rebake"
        editor.key("ctrl+q")
        editor.settle()
        editor.key("Escape")
        editor.settle()
        self.assertIsNone(editor.process.poll(), "there are unsaved changes")
        editor.key("ctrl+s")
        editor.settle()
        editor.key("ctrl+a")
        editor.type(str(project))
        editor.key("Return")
        until(project.is_file, "the project")
        editor.settle()
        editor.key("ctrl+q")
        self.assertEqual(editor.process.wait(20), 0)
        self.assertEqual(list((self.screen.home / "state/rebake/journals").iterdir()), [], "the work is safe in the project")
        editor = self.open(project)
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "select"])
        # Another edit in place of an undone one is a change too.
        editor.key("ctrl+z", "ctrl+i")
        editor.until_ops("import", "select", "undo", "select")
        editor.key("ctrl+q")
        editor.settle()
        self.assertIsNone(editor.process.poll())

    def test_move_with_the_gizmo_and_by_typing(self):
        editor = self.open_ficus()
        editor.click(*NODE_IN_OUTLINE)
        editor.key("1")
        editor.settle()
        handle = editor.find_color((235, 70, 70))[0]
        editor.drag(1, [handle, (handle[0] + 60, handle[1] + 5)])
        editor.until_ops("import", "transform")
        moved = editor.journal()[-1]["edit"]["translate"]
        self.assertGreater(moved[0], 0.05)
        self.assertEqual(moved[1:], [0, 0])
        # A number typed during the drag counts in place of the pointer's way.
        handle = editor.find_color((235, 70, 70))[0]
        editor.drag(1, [handle, (handle[0] - 30, handle[1])], meanwhile=lambda: editor.key("minus", "0", "period", "2", "5"))
        editor.until_ops("import", "transform", "transform")
        self.assertEqual(editor.journal()[-1]["edit"]["translate"], [-0.25, 0, 0])
        # Escape lets go of a drag and changes nothing.
        handle = editor.find_color((235, 70, 70))[0]
        editor.drag(1, [handle, (handle[0] + 80, handle[1])], meanwhile=lambda: editor.key("Escape"))
        editor.settle()
        self.assertEqual(len(editor.ops()), 3)
        # A field takes expressions.
        editor.click(1000, 396)
        editor.key("ctrl+a")
        editor.type("3/2")
        editor.key("Return")
        editor.until_ops("import", "transform", "transform", "transform")
        self.assertNotEqual(editor.journal()[-1]["edit"]["translate"][0], 0)
        # Angles say how the node stands: 90 and then 0 is there and back.
        for angle, half in (("90", 45), ("0", -45)):
            editor.click(1093, 438)
            editor.key("ctrl+a")
            editor.type(angle)
            editor.key("Return")
            editor.settle()
            w, x, y, z = editor.journal()[-1]["edit"]["rotate"]
            self.assertAlmostEqual(w, math.cos(math.radians(half)), places=12)
            self.assertAlmostEqual(y, math.sin(math.radians(half)), places=12)
            self.assertEqual([x, z], [0, 0])
        self.assertEqual(len(editor.ops()), 6)

    def test_keys_of_blender_begin_a_drag(self):
        settings = self.screen.home / "config/rebake/settings.json"
        settings.parent.mkdir(parents=True)
        settings.write_text('{"blender_keys": true}')
        editor = self.open_ficus()
        editor.click(*NODE_IN_OUTLINE)
        editor.move(500, 300)
        editor.key("g", "x", "1", "period", "5", "Return")
        editor.until_ops("import", "transform")
        self.assertEqual(editor.journal()[-1]["edit"]["translate"], [1.5, 0, 0])
        editor.key("r")
        editor.move(560, 400)
        editor.key("Escape", "s")
        editor.move(450, 400)
        editor.tool("click", 3)
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "transform"], "Escape and the right button let go")
        # About the line of sight, with a click at the end.
        editor.key("r")
        editor.move(400, 350)
        editor.tool("click", 1)
        editor.until_ops("import", "transform", "transform")
        self.assertLess(editor.journal()[-1]["edit"]["rotate"][0], 0.999)
        # With another handle in hand too; and only for as long as the drag.
        editor.click(*MOVE_TOOL)
        editor.move(500, 300)
        editor.key("r")
        editor.move(400, 350)
        editor.key("Return")
        editor.until_ops("import", "transform", "transform", "transform")
        turned = editor.journal()[-1]["edit"]
        self.assertEqual(turned["translate"], [0, 0, 0])
        self.assertLess(turned["rotate"][0], 0.999)
        handle = editor.find_color((235, 70, 70))[0]
        editor.drag(1, [handle, (handle[0] + 60, handle[1] + 5)])
        editor.until_ops("import", *["transform"] * 4)
        self.assertGreater(editor.journal()[-1]["edit"]["translate"][0], 0.05)
        # X alone deletes, as in Blender.
        editor.key("x")
        editor.until_ops("import", *["transform"] * 4, "remove")

    def test_several_nodes_are_one_step(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.click(*NODE_IN_OUTLINE)
        editor.tool("keydown", "shift")
        editor.click(*SECOND_NODE)
        editor.tool("keyup", "shift")
        editor.key("h")
        editor.until_ops("import", "import", "hide", "hide")
        self.assertLess(leaf_pixels(editor), 1000, "but for the green axis")
        editor.key("ctrl+z")
        editor.until_ops("import", "import", "hide", "hide", "undo")
        self.assertEqual(editor.journal()[-1]["undo"], 2)
        self.assertGreater(leaf_pixels(editor), 1000)

    def test_stored_views_and_turntable(self):
        editor = self.open_ficus()
        editor.command("store view")
        editor.until_ops("import", "view")
        before = editor.picture()[60:570, 75:850]
        editor.drag(2, [(400, 500), (600, 400)])
        editor.settle()
        self.assertGreater((abs(editor.picture()[60:570, 75:850] - before).max(axis=2) > 30).sum(), 10000)
        editor.command("view 1")
        editor.settle()
        self.assertLess((abs(editor.picture()[60:570, 75:850] - before).max(axis=2) > 30).sum(), 100)
        around = self.folder / "around"
        editor.command("turntable")
        editor.key("ctrl+a")
        editor.type(str(around))
        editor.key("Return")
        until(lambda: len(list(around.glob("*.png"))) == 36, "36 pictures", 60)
        editor.settle()
        compared = lambda a, b: subprocess.run([PROGRAM, "compare", around / a, around / b, "--min-psnr", "30"],
                                                capture_output=True).returncode
        self.assertEqual(compared("000.png", "009.png"), 3, "a quarter turn shows")

    def test_graphics_made_anew_lose_nothing(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        editor.key("shift+t")
        editor.settle()
        before = editor.picture()[:570]
        old = editor.window
        editor.command("restart graphics")
        until(lambda: editor.tool("search", "--onlyvisible", "--name", "Rebake").split() not in ([], [old]), "another window")
        time.sleep(1)
        editor.settle()
        self.assertLess((abs(editor.picture()[:570] - before).max(axis=2) > 30).sum(), 500)
        editor.window = editor.tool("search", "--onlyvisible", "--name", "Rebake").split()[0]
        editor.tool("windowfocus", "--sync", editor.window)
        editor.key("ctrl+i")
        editor.until_ops("import", "select", "select")

    def test_windows_of_any_size(self):
        editor = self.open_ficus()
        for width, height in ((700, 500), (1000, 790), (640, 480)):
            editor.resize(width, height)
            picture = editor.picture()[:height, :width]
            green = (picture[..., 1] > picture[..., 0] + 25) & (picture[..., 1] > picture[..., 2] + 25)
            self.assertGreater(green.sum(), 300, f"the plant is seen at {width} x {height}")
        # What leaves the window while the button is held goes on where the pointer is.
        editor.resize(900, 600)
        editor.key("r")
        editor.drag(1, [(200, 150), (1100, 700)])
        editor.until_ops("import", "select_picture")
        x, y = editor.journal()[-1]["edit"]["polygon"][2]
        self.assertAlmostEqual(x, 1100 - 66, delta=3)
        self.assertAlmostEqual(y, 700 - 56, delta=3)
        editor.key("ctrl+z", "v")
        editor.resize(1280, 800)
        editor.until_ops("import", "select_picture", "undo")
        editor.picture()

    def test_a_full_disk_is_said_and_nothing_is_lost(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        project = self.folder / "plant.rebake"

        def save():
            editor.key("ctrl+s", "ctrl+a")
            editor.type(str(project))
            editor.key("Return")
            editor.settle()

        calm = editor.picture()
        editor.fill_disk()
        save()
        said = (abs(editor.picture() - calm).max(axis=2) > 30)[200:600, 200:1000].sum()
        self.assertGreater(said, 3000, "it is said in the window")
        self.assertEqual(list(self.folder.glob("plant*")), [], "no half of a file")
        editor.key("Escape")
        # What cannot be kept safe is not done.
        editor.key("ctrl+i")
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "select"])
        editor.key("Escape")
        editor.settle()
        editor.fill_disk(False)
        save()
        until(project.is_file, "the project")
        editor.key("ctrl+i")
        editor.until_ops("import", "select", "select")

    def test_axis_knobs_and_menus(self):
        editor = self.open_ficus()
        editor.click(*Y_KNOB)
        editor.settle()
        editor.command("store view")
        editor.until_ops("import", "view")
        camera = editor.journal()[-1]["edit"]["camera"]
        self.assertGreater(camera["eye"][1] - camera["target"][1], 1)
        self.assertLess(abs(camera["eye"][0] - camera["target"][0]), 0.1, "from above")
        # Escape closes a menu; keys work again then.
        editor.click(110, 10)
        editor.key("Escape")
        editor.key("ctrl+a")
        editor.until_ops("import", "view", "select")

    def test_an_export_never_replaces_what_was_imported(self):
        source = self.folder / "plant"
        shutil.copytree(FICUS, source)
        before = {file.name: file.read_bytes() for file in source.iterdir()}
        editor = self.open(source)
        editor.until_ops("import")
        editor.key("ctrl+a", "Delete")
        editor.until_ops("import", "select", "delete")
        editor.key("ctrl+z", "ctrl+e", "ctrl+a")
        editor.type(str(source))
        editor.key("Return", "Return")
        editor.settle()
        self.assertEqual({file.name: file.read_bytes() for file in source.iterdir()}, before)

    def test_bend_by_a_cage(self):
        editor = self.open_ficus()
        editor.key("c")
        editor.settle()
        editor.click(*MAKE_CAGE)
        points = until(lambda: [p for p in editor.find_color((120, 190, 255)) if p], "the cage's points")
        self.assertGreaterEqual(len(points), 8)
        top = min(points, key=lambda p: p[1])
        editor.drag(1, [top, (top[0] + 70, top[1] + 40)])
        self.assertEqual(editor.ops(), ["import"], "a drag is a preview")
        editor.key("Return")
        editor.until_ops("import", "cage")
        edit = editor.journal()[-1]["edit"]
        self.assertEqual(edit["lattice"], [2, 2, 2])
        self.assertEqual(len(edit["moves"]), 1)
        editor.key("ctrl+z")
        editor.until_ops("import", "cage", "undo")

    def test_bend_by_its_end(self):
        editor = self.open_ficus()
        editor.key("n")
        editor.settle()
        tip = editor.find_color((255, 120, 200))[0]
        before = leaf_pixels(editor)
        editor.drag(1, [tip, (tip[0] + 120, tip[1] + 30)])
        editor.until_ops("import", "bend")
        edit = editor.journal()[-1]["edit"]
        self.assertGreater(edit["degrees"], 20)
        self.assertGreater(edit["direction"][0], 0.5, "to the right, as the pointer went")
        editor.key("ctrl+z")
        editor.until_ops("import", "bend", "undo")
        self.assertAlmostEqual(leaf_pixels(editor), before, delta=50)

    def test_bend_a_branch_by_a_number(self):
        editor = self.open_ficus()
        editor.key("l")
        editor.drag(1, LEAVES + LEAVES[:1])
        editor.until_ops("import", "select_picture")
        editor.key("n")
        editor.settle()
        tip = editor.find_color((255, 120, 200))[0]
        editor.drag(1, [tip, (tip[0] - 20, tip[1] - 60)], meanwhile=lambda: editor.key("9", "0", "slash", "2"))
        editor.until_ops("import", "select_picture", "bend")
        edit = editor.journal()[-1]["edit"]
        self.assertEqual(edit["degrees"], 45)
        self.assertEqual(edit["axis"], [1, 0, 0], "along the branch, which goes to the right, held at the stem")
        self.assertTrue(edit["selection"])

    def test_bend_by_numbers_is_seen_before_it_is_applied(self):
        editor = self.open_ficus()
        before = editor.picture()[60:570, 75:700]
        editor.command("bend by")
        editor.click(*DEGREES)
        editor.type("30*2")
        changed = lambda: int((abs(editor.picture()[60:570, 75:700] - before).max(axis=2) > 30).sum())
        until(lambda: changed() > 10000, "a bent plant")
        self.assertEqual(editor.ops(), ["import"], "it is a preview")
        editor.key("Escape")
        editor.settle()
        self.assertLess(changed(), 100, "closed, it is gone")
        editor.command("bend by")
        editor.click(*DEGREES)
        editor.type("60")
        editor.click(*APPLY)
        editor.until_ops("import", "bend")
        self.assertEqual(editor.journal()[-1]["edit"]["degrees"], 60)

    def test_export_and_replay_give_the_same_bytes(self):
        editor = self.open_ficus()
        editor.key("b")
        editor.drag(1, [(600, 200), (660, 230)])
        editor.until_ops("import", "select_picture")
        editor.key("Delete")
        editor.until_ops("import", "select_picture", "delete")
        exported, script = self.folder / "exported", self.folder / "session.jsonl"
        editor.key("ctrl+e", "ctrl+a")
        editor.type(str(exported))
        editor.key("Return")
        until(lambda: (exported / "mlp.json").is_file() or list(exported.glob("*/mlp.json")), "the export")
        editor.settle()
        editor.command("save as script")
        editor.key("ctrl+a")
        editor.type(str(script))
        editor.key("Return")
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
        editor = self.open(FICUS)  # the question waits while something is read
        editor.settle()
        editor.click(*RECOVER)
        editor.settle()
        editor.key("shift+t")  # the tint of what is selected
        editor.settle()
        self.assertGreater(leaf_pixels(editor), 1000, "the scene is back")
        editor.key("ctrl+i")
        until(lambda: editor.ops() == ["import", "select", "select"], "the recovered work, going on")

    def test_what_cannot_be_read_is_said_and_the_rest_is_there(self):
        bad = self.folder / "bad"
        bad.mkdir()
        editor = self.open(bad, FICUS)
        editor.until_ops("import")
        self.assertGreater(leaf_pixels(editor), 1000)
        self.assertIsNone(editor.process.poll())
        editor.key("Escape")
        editor.key("Escape")
        editor.settle()
        self.assertIsNone(editor.process.poll(), "Escape never quits")


class NoWindowTest(unittest.TestCase):
    def test_without_a_display_the_headless_commands_are_named(self):
        result = subprocess.run([PROGRAM, "edit"], env={"PATH": "/usr/bin:/bin", "HOME": tempfile.mkdtemp()},
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("rebake run", result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
