"""The editor as people use it: each test asserts the edits that arrived in the document, and what is seen."""

import math
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from screen import Editor, Screen, read_picture, until

PROGRAM = sys.argv.pop(1)
HERE = pathlib.Path(__file__).resolve().parent
FICUS = HERE.parents[1] / "samples" / "scenes" / "ficus"
KETTLE = FICUS.parent / "kettle"
# Shares of the viewport: around the branch that goes to the right.
BRANCH = [(0.57, 0.22), (0.78, 0.22), (0.78, 0.46), (0.62, 0.46), (0.57, 0.38)]


def green(picture):
    """Which pixels are leaves: green, and not the green of an axis."""
    return (picture[..., 1] > picture[..., 0] + 20) & (picture[..., 1] > picture[..., 2] + 20) & (picture[..., 1] < 190)


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

    def leaves(self):
        return int(green(self.editor.viewport()).sum())

    def select_branch(self):
        """With the lasso; how many triangles."""
        editor = self.editor
        editor.key("l")
        corners = [editor.in_viewport(*corner) for corner in BRANCH]
        editor.drag(corners + corners[:1])
        return editor.state()["selected"]

    def expect_like(self, name, decibels):
        """The whole window against a kept picture. Without the tint, or without the grid, it is at 30 dB, without the
        leaves at 23; 40 leaves room for rounding of another processor."""
        kept, seen = HERE / "pictures" / (name + ".png"), self.folder / (name + ".png")
        self.editor.settle()
        self.editor.save_picture(seen)
        result = subprocess.run([PROGRAM, "compare", kept, seen, "--min-psnr", str(decibels)], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, f"{result.stdout}{result.stderr} (seen: {seen})")

    # Selecting and deleting

    def test_turn_the_view_lasso_leaves_delete_undo_redo(self):
        editor = self.open_ficus()
        self.expect_like("opened", 40)
        all_leaves = self.leaves()
        editor.drag([editor.in_viewport(0.4, 0.8), editor.in_viewport(0.43, 0.78)], button=2)
        selected = self.select_branch()
        self.assertGreater(selected, 100)
        editor.until_ops("import", "select_picture")
        edit = editor.last_edit()
        self.assertGreater(len(edit["polygon"]), 10)
        self.assertFalse(edit["through"])
        self.assertEqual(editor.state()["status"], f"Selected {selected} triangles in ficus")
        self.expect_like("selected", 40)
        editor.key("Delete")
        editor.until_ops("import", "select_picture", "delete")
        self.assertEqual(editor.state()["status"], f"Deleted {selected} triangles of ficus")
        fewer = self.leaves()
        self.assertLess(fewer, 0.85 * all_leaves)
        editor.key("ctrl+z")
        editor.until_ops("import", "select_picture", "delete", "undo")
        editor.key("ctrl+shift+z")
        editor.until_ops("import", "select_picture", "delete", "undo", "redo")
        self.assertAlmostEqual(self.leaves(), fewer, delta=50)
        # History's lines say what was done, and never change.
        editor.click("status/History")
        editor.click("tabs/history/1")
        self.assertEqual(editor.state()["steps"], 1)

    def test_tools_work_on_what_is_picked(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        self.assertEqual(editor.state()["picked"], ["kettle"], "import picks what it made")
        everything = [editor.in_viewport(0.02, 0.02), editor.in_viewport(0.98, 0.98)]
        editor.key("r", "t")
        editor.drag(everything)
        self.assertEqual(editor.state()["scope"], "in kettle")
        self.assertIn("in kettle", editor.state()["status"])
        kettle = editor.last_edit()["node"]
        # The same with nothing picked takes both.
        editor.key("Escape", "Escape")
        self.assertEqual(editor.state()["scope"], "in all")
        editor.key("r")
        editor.drag(everything)
        self.assertNotIn("node", editor.last_edit())
        both = editor.state()["selected"]
        # Only what is picked is deleted, and only of that is chosen.
        editor.click("outline/kettle/name")
        editor.key("ctrl+i")
        self.assertEqual(editor.last_edit()["node"], kettle)
        self.assertLess(editor.state()["selected"], both)
        editor.click("outline/ficus/name")
        editor.key("Delete")
        self.assertEqual(editor.last_edit()["op"], "delete")
        self.assertNotEqual(editor.last_edit()["node"], kettle)

    def test_visible_only_is_remembered_for_each_tool(self):
        editor = self.open_ficus()
        editor.key("l")
        editor.click("options/Visible only")
        self.select_branch()
        self.assertTrue(editor.last_edit()["through"])
        editor.key("r")
        editor.drag([editor.in_viewport(0.6, 0.25), editor.in_viewport(0.7, 0.4)])
        self.assertFalse(editor.last_edit()["through"], "each tool has its own")
        editor.key("l")
        self.select_branch()
        self.assertTrue(editor.last_edit()["through"])

    def test_flood_takes_what_touches_or_all_of_a_colour(self):
        editor = self.open_ficus()
        editor.key("o")
        leaf = editor.in_viewport(0.63, 0.3)
        editor.click(*leaf)
        touching = editor.state()["selected"]
        self.assertTrue(editor.last_edit()["contiguous"])
        editor.click("options/Everywhere")
        editor.click(*leaf)
        self.assertFalse(editor.last_edit()["contiguous"])
        self.assertGreater(editor.state()["selected"], 2 * touching)

    def test_a_box_and_a_ball_select_what_they_hold(self):
        editor = self.open_ficus()
        editor.key("u")
        x, y = editor.where("volume/+Y")
        editor.drag([(x, y), (x, y + 40)])
        editor.key("Return")
        edit = editor.last_edit()
        self.assertEqual(edit["op"], "select")
        self.assertEqual(edit["mode"], "set")
        inside = editor.state()["selected"]
        self.assertGreater(inside, 50)
        editor.click("options/Ball")
        x, y = editor.where("volume/middle")
        editor.drag([(x, y), (x + 60, y - 120)])
        editor.click("options/Add")
        edit = editor.last_edit()
        self.assertEqual(edit["mode"], "add")
        self.assertIn("radius", edit["sphere"])
        self.assertGreater(editor.state()["selected"], inside)
        editor.click("options/Take away")
        self.assertEqual(editor.last_edit()["mode"], "remove")
        # Escape lets go of a side.
        before = editor.items("volume")
        x, y = editor.where("volume/+X")
        editor.drag([(x, y), (x + 80, y)], meanwhile=lambda: editor.key("Escape"))
        self.assertEqual(editor.items("volume"), before)

    def test_what_is_seen_is_selected_from_near_far_and_flat(self):
        editor = self.open_ficus()
        middle = editor.in_viewport(0.5, 0.35)
        for k, look in enumerate((lambda: [editor.wheel(*middle, away=True) for _ in range(8)],
                                  lambda: [editor.wheel(*middle, away=False) for _ in range(14)],
                                  lambda: editor.key("f", "5"))):
            look()
            editor.key("r")
            editor.drag([editor.in_viewport(0.02, 0.02), editor.in_viewport(0.98, 0.98)])
            editor.until_ops("import", *["select_picture"] * (k + 1))
            picture = editor.viewport()[150:]
            coloured = picture.max(axis=2) - picture.min(axis=2) > 60
            orange = coloured & (picture[..., 0] > picture[..., 1]) & (picture[..., 1] > picture[..., 2])
            self.assertGreater(orange.sum() / max(1, coloured.sum()), 0.7, editor.last_edit()["camera"])
            editor.key("v")

    # Nodes

    def test_move_with_the_gizmo_and_by_typing(self):
        editor = self.open_ficus()
        self.assertEqual(editor.state()["picked"], ["ficus"])
        editor.key("1")
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x + 60, y + 5)])
        editor.until_ops("import", "transform")
        moved = editor.last_edit()["translate"]
        self.assertGreater(moved[0], 0.05)
        self.assertEqual(moved[1:], [0, 0])
        # A number typed during the drag counts in place of the pointer's way.
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x - 30, y)], meanwhile=lambda: editor.key("minus", "0", "period", "2", "5"))
        editor.until_ops("import", "transform", "transform")
        self.assertEqual(editor.last_edit()["translate"], [-0.25, 0, 0])
        # Escape lets go of a drag and changes nothing.
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x + 80, y)], meanwhile=lambda: editor.key("Escape"))
        self.assertEqual(len(editor.ops()), 3)

    def test_a_node_has_a_place_by_numbers(self):
        editor = self.open_ficus()

        def type_into(field, text):
            editor.click("properties/" + field)
            editor.type(text)
            editor.key("Return")
            return editor.last_edit()

        self.assertEqual(type_into("Position/X", "3/2")["position"], [1.5, 0, 0])
        turned = type_into("Rotation/Y", "90")["rotation"]
        self.assertAlmostEqual(turned[0], math.cos(math.pi / 4), places=12)
        self.assertAlmostEqual(turned[2], math.sin(math.pi / 4), places=12)
        # Its size is along its own axes: nothing shears.
        self.assertEqual(type_into("Scale/X", "2")["scale"], [2, 1, 1])
        self.assertEqual(type_into("Rotation/Y", "0")["rotation"], [1, 0, 0, 0])
        # Tab goes on to the next; dragging scrubs.
        editor.click("properties/Position/X")
        editor.type("1")
        editor.key("Tab")
        editor.type("2")
        editor.key("Return")
        self.assertEqual(editor.last_edit()["position"], [1, 2, 0])
        steps = editor.state()["steps"]
        x, y = editor.where("properties/Rotation/Y")
        editor.drag([(x, y), (x + 60, y)])
        half = math.radians(30)
        self.assertAlmostEqual(editor.last_edit()["rotation"][2], math.sin(half), places=12, msg="a degree a pixel, to its end")
        self.assertEqual(editor.state()["steps"], steps + 1, "a drag is one step")
        # Escape lets go of a drag, and of what is typed; the node stays picked, and keys go on working.
        x, y = editor.where("properties/Position/Z")
        editor.drag([(x, y), (x + 40, y)], meanwhile=lambda: editor.key("Escape"))
        editor.click("properties/Position/X")
        editor.type("5")
        editor.key("Escape")
        self.assertEqual(editor.state()["picked"], ["ficus"])
        self.assertEqual(editor.state()["steps"], steps + 1)
        editor.key("l")
        self.assertEqual(editor.state()["tool"], "Lasso")

    def test_keys_of_blender_begin_a_drag(self):
        self.screen.settings(blender_keys=True)
        editor = self.open_ficus()
        editor.move(500, 300)
        editor.key("g", "x", "0", "period", "5", "Return")
        editor.until_ops("import", "transform")
        self.assertEqual(editor.last_edit()["translate"], [0.5, 0, 0])
        editor.key("r")
        editor.move(560, 400)
        editor.key("Escape", "s")
        editor.move(450, 400)
        editor.press(3)
        editor.press(3, down=False)
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "transform"], "Escape and the right button let go")
        # About the line of sight, with a click at the end.
        editor.key("r")
        editor.move(300, 150)
        editor.press()
        editor.press(down=False)
        editor.until_ops("import", "transform", "transform")
        self.assertLess(editor.last_edit()["rotate"][0], 0.999)
        # With another handle in hand too; and only for as long as the drag.
        editor.click("tool/Move")
        editor.move(500, 300)
        editor.key("r")
        editor.move(400, 350)
        editor.key("Return")
        editor.until_ops("import", "transform", "transform", "transform")
        turned = editor.last_edit()
        self.assertEqual(turned["translate"], [0, 0, 0])
        self.assertLess(turned["rotate"][0], 0.999)
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x + 60, y + 5)])
        editor.until_ops("import", *["transform"] * 4)
        self.assertGreater(editor.last_edit()["translate"][0], 0.05)
        # X alone deletes, as in Blender.
        editor.key("x")
        editor.until_ops("import", *["transform"] * 4, "remove")

    def test_a_plane_handle_moves_along_two_axes_and_alt_drags_a_copy(self):
        editor = self.open_ficus()
        editor.key("1")
        x, y = editor.where("gizmo/x plane")
        editor.drag([(x, y), (x + 40, y - 30)])
        editor.until_ops("import", "transform")
        moved = editor.last_edit()["translate"]
        self.assertEqual(moved[0], 0)
        self.assertGreater(min(abs(moved[1]), abs(moved[2])), 0.01)
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x + 60, y + 5)], held="alt")
        editor.until_ops("import", "transform", "duplicate")
        copy = editor.last_edit()["translate"]
        self.assertGreater(copy[0], 0.05)
        self.assertEqual(copy[1:], [0, 0])
        self.assertEqual(editor.state()["picked"], ["ficus.2"])

    def test_several_nodes_are_one_step(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.click("outline/ficus/name")
        editor.tool("keydown", "shift")
        editor.click("outline/kettle/name")
        editor.tool("keyup", "shift")
        editor.key("h")
        editor.until_ops("import", "import", "hide", "hide")
        self.assertEqual(editor.state()["status"], "Hid ficus and kettle")
        self.assertLess(self.leaves(), 1000)
        editor.key("ctrl+z")
        editor.until_ops("import", "import", "hide", "hide", "undo")
        self.assertEqual(editor.journal()[-1]["undo"], 2)
        self.assertGreater(self.leaves(), 1000)

    def test_what_is_made_is_picked(self):
        editor = self.open_ficus()
        self.select_branch()
        editor.key("ctrl+j")
        self.assertEqual(editor.state()["picked"], ["ficus.2"])
        editor.key("ctrl+d")
        self.assertEqual(editor.state()["picked"], ["ficus.2.2"])
        # A name is kept however its field is left.
        editor.double_click(*editor.where("outline/ficus.2/name"))
        editor.key("ctrl+a")
        editor.type("branch")
        editor.click("outline/ficus.2.2/name")
        self.assertEqual(editor.last_edit(), {"op": "rename", "node": 2, "name": "branch"})
        # Dropped once, it is one step.
        editor.click("outline/branch/name")
        editor.key("ctrl+g")
        steps = editor.state()["steps"]
        editor.drag([editor.where("outline/ficus.2.2/name"), editor.where("outline/group/name")])
        self.assertEqual(editor.state()["steps"], steps + 1)
        editor.drag([editor.where("outline/ficus.2.2/name"), editor.where("outline/below")])
        self.assertEqual(editor.state()["steps"], steps + 2)
        self.assertTrue(editor.last_edit()["top"])
        editor.click(*editor.where("outline/ficus.2.2/name"), button=3)
        editor.click("context/Remove picked nodes")
        self.assertEqual(editor.last_edit()["op"], "remove")

    # Bending

    def test_a_cage_keeps_every_release(self):
        editor = self.open_ficus()
        editor.key("c")
        editor.click("options/Make cage")
        points = editor.items("cage")
        self.assertGreaterEqual(len(points), 8)

        def drag_top(dx, dy):
            x, y, _, _ = min(editor.items("cage").values(), key=lambda box: box[1])
            editor.drag([(round(x), round(y)), (round(x) + dx, round(y) + dy)])

        drag_top(70, 40)
        editor.until_ops("import", "cage")
        edit = editor.last_edit()
        self.assertEqual(edit["lattice"], [2, 2, 2])
        self.assertEqual(len(edit["moves"]), 1)
        first = editor.items("cage")
        drag_top(-50, -40)
        self.assertEqual(editor.ops(), ["import", "cage", "adjust", "cage"], "the same step, done again")
        self.assertEqual(editor.state()["steps"], 2)
        second = editor.items("cage")
        self.assertNotEqual(first, second)
        # Undo takes the releases back one by one, redo brings the cage back with its points.
        editor.key("ctrl+z")
        self.assertEqual(editor.items("cage"), first)
        self.assertEqual(editor.state()["steps"], 2)
        editor.key("ctrl+z")
        self.assertEqual(editor.items("cage"), points)
        self.assertEqual(editor.state()["steps"], 1)
        editor.key("ctrl+y", "ctrl+y")
        self.assertEqual(editor.items("cage"), second)
        # Its border stays adjustable, and the cage with it.
        editor.click("adjust/Soft border/value")
        editor.type("0.1")
        editor.key("Return")
        self.assertEqual(editor.last_edit()["falloff"], 0.1)
        self.assertEqual(editor.items("cage"), second)
        # However the tool is left, what was done stays; Escape takes back the present drag only.
        x, y, _, _ = min(editor.items("cage").values(), key=lambda box: box[1])
        editor.drag([(round(x), round(y)), (round(x) + 60, round(y))], meanwhile=lambda: editor.key("Escape"))
        self.assertEqual(editor.items("cage"), second)
        editor.key("v")
        self.assertEqual(editor.state()["steps"], 2)
        self.assertEqual(editor.last_edit()["op"], "cage")

    def test_cage_points_turn_together_and_on_both_sides(self):
        editor = self.open_ficus()
        editor.key("KP_1", "c")
        editor.click("options/Make cage")
        rest = editor.items("cage")

        def moves():
            """Of each point, by its number: how far it was moved."""
            found = {}
            for move in editor.last_edit()["moves"]:
                for part in move["points"]:
                    first, last = part if isinstance(part, list) else (part, part)
                    for number in range(first, last + 1):
                        found[number] = move["translate"]
            return found

        # A lasso around the upper row of points, seen from the front, and then a turn by one of them.
        top = min(box[1] for box in rest.values())
        row = [box for box in rest.values() if box[1] < top + 40]
        left, right = min(box[0] for box in row) - 25, max(box[0] for box in row) + 25
        low, high = max(box[1] for box in row) + 25, top - 25
        corners = [(round(x), round(y)) for x, y in ((left, high), (right, high), (right, low), (left, low))]
        editor.drag(corners, held="ctrl")
        editor.click("options/Turn")
        x, y = max((round(box[0]), round(box[1])) for box in row)
        editor.drag([(x, y), (x, y + 60)])
        turned = moves()
        self.assertGreater(len(turned), 5, "all of the row")
        middle = [sum(move[axis] for move in turned.values()) / len(turned) for axis in range(3)]
        self.assertLess(max(map(abs, middle)), 1e-9, "they turn about their own middle")
        editor.key("ctrl+z")
        # One point, both sides.
        editor.click("options/Move")
        editor.click("options/X")
        editor.click(*corners[2])
        editor.drag([(x, y), (x + 40, y - 30)])
        both = moves()
        self.assertEqual(len(both), 2)
        a, b = both.values()
        self.assertAlmostEqual(a[0], -b[0], places=12)
        self.assertEqual(a[1:], b[1:])

    def test_handles_hold_and_pull(self):
        editor = self.open_ficus()
        editor.key("k")
        editor.click(*editor.in_viewport(0.45, 0.72))  # the pot
        editor.click("options/Pull")
        editor.click(*editor.in_viewport(0.70, 0.33))  # the branch's end
        self.assertEqual(len(editor.items("handle")), 2)
        before = self.leaves()
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x, y - 60)])
        editor.until_ops("import", "handles")
        edit = editor.last_edit()
        self.assertEqual([len(edit["moves"]), len(edit["fixed"])], [1, 1])
        self.assertGreater(edit["moves"][0]["translate"][1], 0.1)
        # Again: the same step.
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x, y - 20)])
        self.assertEqual(editor.state()["steps"], 2)
        self.assertGreater(editor.last_edit()["moves"][0]["translate"][1], edit["moves"][0]["translate"][1])
        # Escape takes back the present drag only.
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x + 50, y)], meanwhile=lambda: editor.key("Escape"))
        self.assertEqual(editor.where("handle/1"), (x, y))
        # Another point set on what is bent holds that, where it is.
        editor.click("options/Hold")
        editor.click(*editor.in_viewport(0.37, 0.28))
        self.assertEqual(len(editor.items("handle")), 3)
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x, y + 10)])
        self.assertEqual(len(editor.last_edit()["moves"]) + len(editor.last_edit()["fixed"]), 3)
        # Undo takes the releases back one by one; redo brings the points back.
        third = editor.items("handle")
        editor.key("ctrl+z", "ctrl+z")
        self.assertEqual(editor.state()["steps"], 2)
        editor.key("ctrl+z")
        self.assertEqual(editor.state()["steps"], 1)
        self.assertAlmostEqual(self.leaves(), before, delta=0.02 * before)
        editor.key("ctrl+y", "ctrl+y", "ctrl+y")
        self.assertEqual(editor.items("handle"), third)
        editor.key("v")
        self.assertEqual(editor.state()["steps"], 2, "what was done stays")

    def test_a_kettle_is_put_onto_the_pot(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.key("1", "m")
        x, y = editor.where("gizmo/middle")
        editor.drag([(x, y), editor.in_viewport(0.8, 0.8)])
        moved = editor.last_edit()
        self.assertEqual(moved["op"], "transform")
        editor.key("End")
        self.assertEqual(editor.last_edit()["op"], "drop")
        self.assertEqual(editor.state()["status"], "Dropped kettle")

    def test_bend_a_branch_from_its_stem(self):
        editor = self.open_ficus()
        editor.key("l", "t")
        self.select_branch()
        editor.key("n")
        x, y = editor.where("bend/tip")
        stem = editor.where("bend/from")
        self.assertGreater(x, stem[0] + 60, "it goes to the right, held at the stem")
        picture = editor.viewport()
        held = (picture[..., 0] > 200) & (picture[..., 1] < 110) & (picture[..., 2] < 80)
        left = editor.state()["items"]["viewport"][0]
        held[:, :150] = held[:, -150:] = False  # the axes' ball
        self.assertGreater(held.sum(), 200, "what the soft border holds is shaded")
        self.assertLess(abs(held.nonzero()[1].mean() + left - stem[0]), 0.5 * abs(x - stem[0]), "near the stem")
        before = self.leaves()
        editor.drag([(x, y), (x - 20, y - 60)], meanwhile=lambda: editor.key("9", "0", "slash", "2"))
        editor.until_ops("import", "select_picture", "bend")
        edit = editor.last_edit()
        self.assertEqual(edit["degrees"], 45)
        self.assertTrue(edit["selection"])
        self.assertGreater(edit["axis"][0], 0.7)
        self.assertGreater(abs(edit["axis"][1]) + abs(edit["axis"][2]), 0.1, "along the branch, not along a world axis")
        self.assertGreater(edit["falloff"], 0, "no rip at the border")
        # What was done last stays adjustable, without another step.
        editor.click("adjust/Angle/value")
        editor.type("30")
        editor.key("Return")
        editor.until_ops("import", "select_picture", "bend", "adjust", "bend")
        self.assertEqual(editor.last_edit()["degrees"], 30)
        self.assertEqual(editor.state()["steps"], 3)
        # A second bend goes on from the first's axis.
        x, y = editor.where("bend/tip")
        editor.drag([(x, y), (x - 10, y + 50)])
        self.assertEqual(editor.last_edit()["axis"], edit["axis"])
        self.assertEqual(editor.state()["steps"], 4)
        editor.key("ctrl+z", "ctrl+z")
        self.assertAlmostEqual(self.leaves(), before, delta=0.02 * before)

    def test_bend_along_a_curve(self):
        editor = self.open_ficus()
        editor.key("l", "t")
        self.select_branch()
        editor.key("n")
        editor.click("options/Curved")
        x, y = editor.where("bend/tip")
        editor.drag([(x, y), (x - 20, y - 60)], meanwhile=lambda: editor.key("5", "0"))
        edit = editor.last_edit()
        self.assertEqual(edit["degrees"], 50)
        self.assertGreaterEqual(len(edit["spine"]), 5)
        self.assertNotIn("origin", {name for name, value in edit.items() if value is not None})
        tip = editor.where("bend/tip")
        self.assertLess(tip[1], y - 20, "the handle went with it")
        # A second one starts where the first ended, along the same curve.
        editor.drag([tip, (tip[0] - 10, tip[1] - 30)])
        self.assertEqual(editor.ops()[-2:], ["bend", "bend"])
        self.assertEqual(editor.last_edit()["spine"], edit["spine"])

    def test_a_bend_of_what_is_seen_offers_the_rest(self):
        editor = self.open_ficus()
        seen = self.select_branch()
        editor.key("n")
        editor.click("options/Take the back sides too")
        self.assertGreater(editor.state()["selected"], 1.3 * seen)
        self.assertNotIn("options/Take the back sides too", editor.state()["items"])
        # The handles follow what was bent.
        x, y = editor.where("bend/tip")
        editor.drag([(x, y), (x - 10, y - 70)])
        after = editor.where("bend/tip")
        self.assertLess(abs(after[0] - x + 10) + abs(after[1] - y + 70), 25, "it stays where it was dragged to")

    def test_bend_a_whole_node_by_its_end(self):
        editor = self.open_ficus()
        editor.key("n")
        x, y = editor.where("bend/tip")
        editor.drag([(x, y), (x + 120, y + 30)])
        editor.until_ops("import", "bend")
        edit = editor.last_edit()
        self.assertGreater(edit["degrees"], 20)
        self.assertGreater(edit["direction"][0], 0.5, "to the right, as the pointer went")
        self.assertEqual(edit["axis"], [0, 1, 0], "objects stand")

    def test_bend_by_numbers_is_seen_before_it_is_applied(self):
        editor = self.open_ficus()
        before = editor.viewport()[:, :500]
        editor.command("bend by")
        editor.click("form/degrees")
        editor.type("30*2")
        editor.until(lambda state: state["preview"], "a preview")
        changed = lambda: int((abs(editor.viewport()[:, :500] - before).max(axis=2) > 30).sum())
        self.assertGreater(changed(), 10000, "a bent plant")
        self.assertEqual(editor.ops(), ["import"])
        editor.key("Escape")
        self.assertLess(changed(), 100, "closed, it is gone")
        editor.command("bend by")
        editor.click("form/degrees")
        editor.type("60")
        editor.click("form/Apply")
        editor.until_ops("import", "bend")
        self.assertEqual(editor.last_edit()["degrees"], 60)

    # Views and pictures

    def test_stored_views_and_turntable(self):
        editor = self.open_ficus()
        editor.command("store view")
        editor.until_ops("import", "view")
        before = editor.viewport()
        editor.drag([editor.in_viewport(0.4, 0.8), editor.in_viewport(0.6, 0.6)], button=2)
        self.assertGreater((abs(editor.viewport() - before).max(axis=2) > 30).sum(), 10000)
        editor.command("view 1")
        self.assertLess((abs(editor.viewport() - before).max(axis=2) > 30).sum(), 100)
        around = self.folder / "around"
        editor.command("turntable")
        editor.answer(str(around))
        until(lambda: len(list(around.glob("*.png"))) == 36, "36 pictures")
        editor.settle()
        compared = lambda a, b: subprocess.run([PROGRAM, "compare", around / a, around / b, "--min-psnr", "30"],
                                                capture_output=True).returncode
        self.assertEqual(compared("000.png", "009.png"), 3, "a quarter turn shows")

    def test_stored_views_have_pictures_and_are_renamed_and_forgotten(self):
        editor = self.open_ficus()
        editor.command("store view")
        editor.drag([editor.in_viewport(0.4, 0.8), editor.in_viewport(0.6, 0.6)], button=2)
        editor.click("status/Views")
        editor.click("tabs/views/Store view")
        editor.until_ops("import", "view", "view")
        before = editor.viewport()
        x, y, width, height = (round(v) for v in editor.state()["items"]["tabs/views/view 1/picture"])
        picture = editor.picture()[y:y + height, x:x + width]
        self.assertGreater(green(picture).sum(), 200, "leaves are in it")
        editor.click("tabs/views/view 1/picture")
        self.assertGreater((abs(editor.viewport() - before).max(axis=2) > 30).sum(), 5000)
        editor.double_click(*editor.where("tabs/views/view 1/picture"))
        editor.key("ctrl+a")
        editor.type("front")
        editor.key("Return")
        editor.until_ops("import", "view", "view", "rename_view")
        editor.click("tabs/views/view 2/Delete")
        editor.until_ops("import", "view", "view", "rename_view", "remove_view")
        self.assertIn("tabs/views/front/picture", editor.state()["items"])
        self.assertNotIn("tabs/views/view 2/picture", editor.state()["items"])

    def test_axis_knobs_and_menus(self):
        editor = self.open_ficus()
        editor.click("axes/+Y")
        editor.command("store view")
        editor.until_ops("import", "view")
        camera = editor.last_edit()["camera"]
        self.assertGreater(camera["eye"][1] - camera["target"][1], 1)
        self.assertEqual(camera["eye"][0], camera["target"][0], "exactly from above")
        self.assertEqual(camera["eye"][2], camera["target"][2])
        # Escape closes a menu; keys work again then.
        editor.click("menu/Select")
        editor.key("Escape")
        editor.key("ctrl+a")
        editor.until_ops("import", "view", "select")

    def test_graphics_made_anew_lose_nothing(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        editor.key("shift+t")
        before = editor.viewport()
        old = editor.window
        editor.key("ctrl+p")
        editor.type("restart graphics")
        editor.tool("key", "Return")
        until(lambda: editor.tool("search", "--onlyvisible", "--name", "Rebake").split() not in ([], [old]), "another window")
        editor.settle()
        self.assertLess((abs(editor.viewport() - before).max(axis=2) > 30)[:, :480].sum(), 500)
        editor.window = editor.tool("search", "--onlyvisible", "--name", "Rebake").split()[0]
        editor.tool("windowfocus", "--sync", editor.window)
        editor.key("ctrl+i")
        editor.until_ops("import", "select", "select")

    def test_windows_of_any_size(self):
        editor = self.open_ficus()
        for width, height in ((700, 500), (1000, 790), (640, 400)):
            editor.resize(width, height)
            self.assertGreater(self.leaves(), 300, f"the plant is seen at {width} x {height}")
        # What leaves the window while the button is held goes on where the pointer is.
        editor.resize(900, 600)
        editor.key("r")
        x, y, _, _ = editor.state()["items"]["viewport"]
        editor.drag([(200, 150), (1100, 700)])
        corner = editor.last_edit()["polygon"][2]
        self.assertAlmostEqual(corner[0], 1100 - x, delta=3)
        self.assertAlmostEqual(corner[1], 700 - y, delta=3)

    def test_a_cut_shows_and_selects_what_lies_behind_it(self):
        editor = self.open_ficus()
        everything = [editor.in_viewport(0.02, 0.02), editor.in_viewport(0.98, 0.98)]
        editor.key("r", "t")
        editor.drag(everything)
        whole = editor.state()["selected"]
        before = editor.viewport()
        editor.key("shift+t", "shift+x")
        self.assertGreater((abs(editor.viewport() - before).max(axis=2) > 30).sum(), 5000)
        editor.drag(everything)
        behind = editor.state()["selected"]
        self.assertLess(behind, 0.9 * whole)
        self.assertGreater(behind, 0.1 * whole)
        editor.key("shift+x")
        editor.drag(everything)
        self.assertEqual(editor.state()["selected"], whole)

    def test_the_picture_can_have_the_whole_window(self):
        editor = self.open_ficus()
        editor.key("ctrl+space")
        self.assertEqual(editor.state()["items"]["viewport"], [0, 0, 1280, 800])
        editor.key("ctrl+space")
        self.assertGreater(editor.state()["items"]["viewport"][0], 30)

    # Files

    def test_save_quit_and_open_again(self):
        editor = self.open_ficus()
        editor.key("ctrl+a")
        editor.until_ops("import", "select")
        project = self.folder / "plant.rebake"
        editor.key("ctrl+q")
        self.assertIsNone(editor.process.poll(), "there are unsaved changes")
        # Save quits once it is saved; where it cannot be, it is asked for again, and nothing follows a later save.
        editor.click("dialog/Save...")
        editor.answer("/nowhere/plant.rebake")
        self.assertTrue(editor.state()["asks"], "there is no such folder: it stays open")
        editor.key("Escape", "ctrl+s")
        editor.answer(str(self.folder / "first.rebake"))
        until((self.folder / "first.rebake").is_file, "the project")
        editor.settle()
        self.assertIsNone(editor.process.poll(), "only what was asked for")
        editor.key("ctrl+i", "ctrl+q")
        x, y = editor.where("dialog/Save")
        editor.move(x, y)
        editor.tool("click", 1)
        self.assertEqual(editor.process.wait(20), 0)
        editor = self.open(FICUS)
        editor.until_ops("import")
        editor.key("ctrl+a", "ctrl+q")
        editor.click("dialog/Save...")
        editor.key("ctrl+a")
        editor.type(str(project))
        editor.tool("key", "Return")
        self.assertEqual(editor.process.wait(20), 0)
        self.assertTrue(project.is_file())
        self.assertEqual(list((self.screen.home / "state/rebake/journals").iterdir()), [], "the work is safe in the project")
        editor = self.open(project)
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "select"])
        # Another edit in place of an undone one is a change too.
        editor.key("ctrl+z", "ctrl+i")
        editor.until_ops("import", "select", "undo", "select")
        editor.key("ctrl+q")
        editor.click("dialog/Cancel")
        self.assertIsNone(editor.process.poll())
        editor.key("ctrl+q")
        x, y = editor.where("dialog/Don't save")
        editor.move(x, y)
        editor.tool("click", 1)
        self.assertEqual(editor.process.wait(20), 0)

    def test_an_empty_window_leads_on(self):
        editor = self.open()
        editor.click("start/samples/ficus")
        editor.until_ops("import")
        self.assertGreater(self.leaves(), 1000)
        editor.command("open")
        editor.click("dialog/Samples")
        editor.double_click(*editor.where("dialog/entries/kettle"))
        editor.until_ops("import", "import")

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

    def program(self, name, script):
        """A program of that name that the editor finds before any other."""
        folder = self.folder / "programs"
        folder.mkdir(exist_ok=True)
        (folder / name).write_text("#!/bin/sh\n" + script)
        (folder / name).chmod(0o755)
        self.screen.environment["PATH"] = f"{folder}:{self.screen.environment['PATH']}"

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
        # The arrows walk through the list.
        editor.key("ctrl+o", "Down", "Down", "Down", "Return")
        editor.until_ops("import", "import")
        self.assertTrue(editor.last_edit()["path"].endswith("scenes/pot"))
        # Several, with Ctrl.
        editor.key("ctrl+o")
        editor.click("dialog/entries/plant")
        editor.click("dialog/entries/mug", held="ctrl")
        # Ctrl on one that is chosen leaves it out again.
        editor.click("dialog/entries/pot", held="ctrl")
        editor.click("dialog/entries/pot", held="ctrl")
        editor.click("dialog/Open 2")
        editor.until_ops("import", "import", "import", "import")
        self.assertEqual([edit["edit"]["path"].rsplit("/", 1)[1] for edit in editor.journal()],
                         ["plant", "pot", "mug", "plant"])

    def test_the_desktops_own_dialog(self):
        self.program("zenity", f"echo \"$@\" > '{self.folder}/asked'; sleep 0.3; echo '{FICUS}'; echo '{KETTLE}'")
        editor = self.open()
        editor.key("ctrl+o")
        editor.click("dialog/Folders...")
        editor.until_ops("import", "import")
        self.assertIn("--directory --multiple", (self.folder / "asked").read_text())
        # What it proposes to write is still asked for here.
        out = self.folder / "chosen"
        self.program("zenity", f"echo '{out}'")
        editor.key("ctrl+e")
        editor.click("dialog/Browse...")
        self.assertFalse(out.exists())
        editor.click("dialog/Export")
        until(out.is_dir, "the export")

    def test_a_video_on_a_way_through_stored_views(self):
        # Counts the pictures in place of encoding them.
        self.program("ffmpeg", 'for last; do :; done; ls "$(dirname "$last")" > "$last.txt"; mv "$last.txt" "$last"')
        editor = self.open_ficus()
        editor.command("store view")
        editor.drag([editor.in_viewport(0.4, 0.8), editor.in_viewport(0.6, 0.6)], button=2)
        editor.command("store view")
        video = self.folder / "way.mp4"
        editor.command("camera path")
        editor.click("dialog/Video")
        editor.click("dialog/pictures")
        editor.key("ctrl+a")
        editor.type("5")
        editor.click("dialog/path")
        editor.answer(str(video)[:-4])
        until(video.exists, "the video")
        self.assertEqual(len([name for name in video.read_text().split() if name.endswith(".png")]), 5)
        editor.settle()
        self.assertEqual(list((self.screen.home / "cache" / "rebake").glob("film*")), [], "nothing is left behind")
        # A program that fails is said, and there is nothing then.
        self.program("ffmpeg", "exit 7")
        editor.command("turntable")
        editor.click("dialog/Video")
        editor.click("dialog/path")
        editor.answer(str(self.folder / "none.mp4"))
        editor.until(lambda state: any("ffmpeg ended with 7" in text for text in state["messages"]), "it is said")
        self.assertFalse((self.folder / "none.mp4").exists())

    def test_only_what_is_picked_is_exported(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        self.assertEqual(editor.state()["picked"], ["kettle"])
        out = self.folder / "kettle alone"
        editor.key("ctrl+e")
        editor.click("dialog/Only the picked nodes")
        editor.click("dialog/path")
        editor.answer(str(out))
        until(lambda: out.is_dir(), "the export")
        editor.settle()
        told = subprocess.run([PROGRAM, "info", out], capture_output=True, text=True).stdout
        alone = subprocess.run([PROGRAM, "info", KETTLE], capture_output=True, text=True).stdout
        geometry = lambda text: [line for line in text.splitlines() if "geometry  " in line]
        self.assertEqual(geometry(told), geometry(alone), told)
        self.assertEqual(len(geometry(told)), 1)
        # Pictures too: no leaves are in one of the kettle alone.
        both, one = self.folder / "both.png", self.folder / "one.png"
        for picture in (both, one):
            editor.key("F12")
            if picture == one:
                editor.click("dialog/Only the picked nodes")
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
        # What cannot be kept safe is not done.
        editor.key("ctrl+i")
        self.assertEqual(editor.ops(), ["import", "select"])
        editor.key("Escape")
        editor.fill_disk(False)
        save()
        until(project.is_file, "the project")
        editor.key("ctrl+i")
        editor.until_ops("import", "select", "select")

    def test_costs_are_a_chart_to_choose_from(self):
        editor = self.open_ficus()
        editor.command("cost")
        editor.click("tabs/cost/Measure this view")
        x, y = editor.where("tabs/cost/chart/16 samples")
        editor.move(x, y)
        ring = until(lambda: editor.state()["items"].get("largest error"), "a ring where the error is")
        left, top, width, height = editor.state()["items"]["viewport"]
        self.assertTrue(left <= ring[0] <= left + width and top <= ring[1] <= top + height, ring)
        editor.click(x, y)
        editor.key("ctrl+p")
        editor.key("Escape")
        editor.move(*editor.in_viewport(0.5, 0.5))
        editor.until(lambda state: "largest error" not in state["items"], "no ring")

    def test_the_sheet_of_keys_holds_keys_back(self):
        editor = self.open_ficus()
        self.select_branch()
        editor.key("F1", "Delete")
        self.assertEqual(editor.last_edit()["op"], "select_picture")
        editor.key("F1", "Delete")
        self.assertEqual(editor.last_edit()["op"], "delete")

    def test_menus_open_in_the_smallest_window(self):
        editor = self.open_ficus()
        editor.resize(640, 400)
        editor.key("1")
        editor.click("menu/Tool")
        self.assertEqual(editor.state()["tool"], "Move", "it opens, and nothing in it is taken")
        self.assertIn("menu/Rectangle", editor.state()["items"])

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
        editor = self.open(FICUS)  # the question waits while something is read
        editor.click("dialog/Recover")
        editor.key("shift+t")  # the tint of what is selected
        self.assertGreater(self.leaves(), 1000, "the scene is back")
        editor.key("ctrl+i")
        until(lambda: editor.ops() == ["import", "select", "select"], "the recovered work, going on")

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

    # Input

    def test_what_comes_while_the_window_is_stopped_is_taken_in_its_order(self):
        editor = self.open_ficus()
        editor.key("l")
        keys, text, buttons = (editor.seen(kind) for kind in ("keys", "text", "buttons"))
        editor.process.send_signal(signal.SIGSTOP)
        editor.tool("key", "ctrl+p")
        editor.tool("type", "--delay", "5", "select: all")
        editor.tool("key", "Return")
        # Motion before a press is no part of the drag.
        corners = [editor.in_viewport(*corner) for corner in BRANCH]
        editor.tool("mousemove", *editor.in_viewport(0.1, 0.9))
        editor.tool("mousemove", *corners[0])
        editor.tool("mousedown", 1)
        for corner in corners[1:] + corners[:1]:
            editor.tool("mousemove", *corner)
        editor.tool("mouseup", 1)
        editor.process.send_signal(signal.SIGCONT)
        until(lambda: editor.seen("keys") >= keys + 6 and editor.seen("text") >= text + 11 and
              editor.seen("buttons") >= buttons + 2, "all of it")
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "select", "select_picture"])
        polygon = editor.last_edit()["polygon"]
        x, y, _, _ = editor.state()["items"]["viewport"]
        self.assertEqual([polygon[0][0] + x, polygon[0][1] + y], list(corners[0]))
        self.assertEqual(len(polygon), 6)


class NoWindowTest(unittest.TestCase):
    def test_without_a_display_the_headless_commands_are_named(self):
        result = subprocess.run([PROGRAM, "edit"], env={"PATH": "/usr/bin:/bin", "HOME": tempfile.mkdtemp()},
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("rebake run", result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
