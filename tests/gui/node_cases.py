"""Nodes: move, rotate, copy, group, pick."""

import math

from window_case import WindowCase, FICUS, KETTLE


class NodeTest(WindowCase):
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
        # A number typed during a drag replaces the distance of the pointer.
        x, y = editor.where("gizmo/x")
        editor.drag([(x, y), (x - 30, y)], meanwhile=lambda: editor.key("minus", "0", "period", "2", "5"))
        editor.until_ops("import", "transform", "transform")
        self.assertEqual(editor.last_edit()["translate"], [-0.25, 0, 0])
        # Escape cancels a drag.
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
        # Scale is along the node's own axes, so it never shears.
        self.assertEqual(type_into("Scale/X", "2")["scale"], [2, 1, 1])
        self.assertEqual(type_into("Rotation/Y", "0")["rotation"], [1, 0, 0, 0])
        # Tab moves to the next field; dragging changes a number.
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
        # Escape cancels a drag and typed text; the node stays picked, and shortcuts work again.
        x, y = editor.where("properties/Position/Z")
        editor.drag([(x, y), (x + 40, y)], meanwhile=lambda: editor.key("Escape"))
        editor.click("properties/Position/X")
        editor.type("5")
        editor.key("Escape")
        self.assertEqual(editor.state()["picked"], ["ficus"])
        self.assertEqual(editor.state()["steps"], steps + 1)
        editor.key("l")
        self.assertEqual(editor.state()["tool"], "Lasso")

    def test_numbers_that_are_dragged_end_with_their_step_or_node(self):
        editor = self.open_ficus()
        editor.key("1")
        for _ in range(2):
            x, y = editor.where("gizmo/x")
            editor.drag([(x, y), (x + 60, y + 5)])
        editor.until_ops("import", "transform", "transform")
        # The step under drag is undone: its values must not go to the step before.
        x, y = editor.where("adjust/translate/Y")
        editor.drag([(x, y), (x + 40, y)], meanwhile=lambda: editor.key("ctrl+z"))
        editor.until_ops("import", "transform", "transform", "undo")
        self.assertEqual(editor.state()["steps"], 2)
        editor.key("ctrl+shift+z")
        editor.until_ops("import", "transform", "transform", "undo", "redo")
        # Beyond 90 degrees an angle has other names, which must not change it during a drag.
        x, y = editor.where("adjust/rotate/Y")
        editor.drag([(x, y), (x + 120, y), (x + 121, y), (x + 120, y)])
        w, _, turn, _ = editor.last_edit()["rotate"]
        self.assertAlmostEqual(math.degrees(2 * math.atan2(turn, w)), 120, delta=2)
        # The node under drag disappears: the next one must not take its number.
        editor.key("ctrl+d")
        self.assertEqual(editor.state()["picked"], ["ficus.2"])
        x, y = editor.where("properties/Position/X")
        editor.drag([(x, y), (x + 40, y)], meanwhile=lambda: editor.key("ctrl+z"))
        steps = editor.state()["steps"]
        editor.click("outline/ficus/name")
        self.assertEqual(editor.state()["steps"], steps)
        self.assertEqual(editor.ops()[-1], "undo")

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
        # Rotates about the view direction, confirmed by a click.
        editor.key("r")
        editor.move(300, 150)
        editor.press()
        editor.press(down=False)
        editor.until_ops("import", "transform", "transform")
        self.assertLess(editor.last_edit()["rotate"][0], 0.999)
        # Also while another tool is active, and for this drag only.
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
        # Leaving a name field in any way commits the name.
        editor.double_click(*editor.where("outline/ficus.2/name"))
        editor.key("ctrl+a")
        editor.type("branch")
        editor.click("outline/ficus.2.2/name")
        self.assertEqual(editor.last_edit(), {"op": "rename", "node": 2, "name": "branch"})
        # A drop in the outline is one step.
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
