"""Selecting, deleting and erasing."""

from screen import until
from window_case import WindowCase, FICUS, KETTLE, green


class SelectTest(WindowCase):
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
        # A click on a line of the history goes back to that step.
        editor.click("status/History")
        editor.click("tabs/history/1")
        self.assertEqual(editor.state()["steps"], 1)

    def test_the_eraser_shows_what_a_whole_picture_would(self):
        """For a stroke only changed pixels are drawn, at full quality; the picture equals a complete one."""
        editor = self.open_ficus()
        editor.key("e")
        away = editor.in_viewport(0.02, 0.98)  # so that the eraser's ring is out of the way
        editor.move(*away)
        whole = editor.viewport()
        for down in (0.2, 0.3, 0.4):
            editor.drag([editor.in_viewport(0.45, down), editor.in_viewport(0.6, down + 0.05)])
            self.assertEqual(editor.last_edit()["op"], "erase")
        editor.move(*away)
        erased = editor.viewport()
        self.assertLess(int(green(erased).sum()), 0.95 * int(green(whole).sum()))
        editor.key("g")
        self.assertGreater(int((editor.viewport() != erased).sum()), 100, "without the grid")
        editor.key("g")
        editor.settle()
        self.assertEqual(int((editor.viewport() != erased).sum()), 0)
        editor.key("ctrl+z", "ctrl+z", "ctrl+z")
        editor.settle()
        self.assertEqual(int((editor.viewport() != whole).sum()), 0)

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
        # With nothing picked, both nodes are selected in.
        editor.key("Escape", "Escape")
        self.assertEqual(editor.state()["scope"], "in the scene")
        editor.key("r")
        editor.drag(everything)
        self.assertNotIn("node", editor.last_edit())
        both = editor.state()["selected"]
        # Delete and invert affect picked nodes only.
        editor.click("outline/kettle/name")
        editor.key("ctrl+i")
        self.assertEqual(editor.last_edit()["node"], kettle)
        self.assertLess(editor.state()["selected"], both)
        editor.click("outline/ficus/name")
        editor.key("Delete")
        self.assertEqual(editor.last_edit()["op"], "delete")
        self.assertNotEqual(editor.last_edit()["node"], kettle)

    def test_counts_are_of_what_the_command_changes(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.key("Escape", "Escape", "ctrl+a")
        both = editor.state()["selected"]
        bright = self.orange()
        editor.click("outline/kettle/name")
        kettle = editor.state()["selected"]
        self.assertLess(kettle, both)
        self.assertEqual(editor.state()["selected_words"], f"{kettle} selected in kettle, {both - kettle} elsewhere")
        # Selected triangles outside of the scope are drawn faintly.
        self.assertLess(self.orange(), 0.7 * bright)
        editor.key("Delete")
        self.assertEqual(editor.state()["status"], f"Deleted {kettle} triangles of kettle")
        self.assertEqual(editor.state()["selected_words"], f"{both - kettle} selected")

    def orange(self):
        """Number of pixels with the full tint of a selection."""
        self.editor.settle()
        picture = self.editor.viewport()
        return int(((picture[..., 0] > picture[..., 2] + 90) & (picture[..., 0] > picture[..., 1] + 20)).sum())

    def test_forms_of_selections_show_what_they_take(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        before = editor.viewport()
        editor.command("select floaters")
        count = lambda: next((item for item in editor.state()["items"] if item.startswith("form/count: ")), "")
        until(lambda: "Would select" in count(), "a count")
        first = count()
        editor.click("form/at_most")
        editor.type("100000")
        until(lambda: "Would select" in count() and count() != first, "the count follows")
        editor.settle()
        self.assertGreater(int((editor.viewport()[:, :300] != before[:, :300]).sum()) + self.orange(), 1000)
        self.assertEqual(editor.ops(), ["import", "import"], "nothing is done yet")
        # The form follows the picked node: counts of kettle and plant differ.
        of_kettle = count()
        editor.click("outline/ficus/name")
        until(lambda: "Would select" in count() and count() != of_kettle, "the scope's count")
        shown = int(count().split()[3])
        editor.click("form/apply")
        editor.settle()
        self.assertEqual(editor.last_edit()["op"], "select_floaters")
        self.assertEqual(editor.state()["selected"], shown)

    def test_an_emptied_scene_offers_to_open_another(self):
        editor = self.open_ficus()
        editor.key("ctrl+a", "Delete")
        until(lambda: "start/Open..." in editor.state()["items"], "the start card")
        editor.key("ctrl+z")
        until(lambda: "start/Open..." not in editor.state()["items"], "the scene is back")
        self.assertGreater(self.orange(), 1000, "with its selection")

    def test_visible_only_is_remembered_for_each_tool(self):
        editor = self.open_ficus()
        editor.key("l")
        editor.click("options/visible-only")
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
        editor.click("options/everywhere")
        editor.click(*leaf)
        self.assertFalse(editor.last_edit()["contiguous"])
        self.assertGreater(editor.state()["selected"], 2 * touching)

    def test_flood_replaces_the_selection_of_the_whole_scope(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.key("Escape", "Escape", "ctrl+a", "o")
        both = editor.state()["selected"]
        editor.click(*editor.in_viewport(0.45, 0.5))
        taken = editor.state()["selected"]
        self.assertLess(taken, both / 2)
        node = editor.last_edit()["node"]
        editor.key("Delete")
        self.assertIn(f"Deleted {taken} triangles of ", editor.state()["status"])
        self.assertNotIn(" and ", editor.state()["status"], "one node")
        # It was one step, and the keys add.
        editor.key("ctrl+z", "ctrl+z")
        self.assertEqual(editor.state()["selected"], both)
        editor.click(*editor.in_viewport(0.45, 0.5), held="shift")
        self.assertEqual((editor.state()["selected"], editor.last_edit()["node"]), (both, node))

    def test_flood_with_both_keys_leaves_nothing_elsewhere(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.key("Escape", "Escape", "ctrl+a", "o")
        # xdotool's helper holds one key, so Control is held around the click.
        editor.counted("keys", 1, lambda: editor.tool("keydown", "ctrl"))
        editor.click(*editor.in_viewport(0.45, 0.5), held="shift")
        editor.counted("keys", 1, lambda: editor.tool("keyup", "ctrl"))
        editor.settle()
        taken, words = editor.state()["selected"], editor.state()["selected_words"]
        self.assertEqual(editor.last_edit()["mode"], "intersect")
        self.assertEqual(words, f"{taken} selected")
        editor.key("Delete")
        self.assertNotIn(" and ", editor.state()["status"], "one node")

    def test_the_count_of_a_form_survives_the_preview_of_a_drag(self):
        editor = self.open_ficus()
        editor.key("1")
        editor.command("select floaters")
        counts = lambda: [item for item in editor.state()["items"] if item.startswith("form/count: Would")]
        until(counts, "a count")
        before = counts()
        x, y = editor.where("properties/Position/X")
        editor.drag([(x, y), (x + 40, y)], meanwhile=lambda: editor.key("Escape"))
        until(lambda: counts() == before, "the count again")
        editor.click("form/Preview")
        editor.click("form/Preview")
        until(lambda: counts() == before, "the count after the preview was off")

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
        editor.click("options/sphere")
        x, y = editor.where("volume/middle")
        editor.drag([(x, y), (x + 60, y - 120)])
        editor.click("options/add")
        edit = editor.last_edit()
        self.assertEqual(edit["mode"], "add")
        self.assertIn("radius", edit["sphere"])
        self.assertGreater(editor.state()["selected"], inside)
        editor.click("options/remove")
        self.assertEqual(editor.last_edit()["mode"], "remove")
        # Escape cancels the drag of a side.
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

    def three_kettles(self):
        """Three kettles, of which all triangles are selected; nothing is picked."""
        editor = self.open(KETTLE, KETTLE, KETTLE)
        editor.until_ops("import", "import", "import")
        editor.key("Escape", "Escape", "ctrl+a")
        names = sorted(item.split("/")[1] for item in editor.state()["items"]
                       if item.startswith("outline/") and item.endswith("/name"))
        for name in names:
            editor.click(f"outline/{name}/name")
            self.assertGreater(editor.state()["selected"], 0, name)
        editor.key("Escape", "Escape")
        return editor, names

    def test_a_locked_picked_node_does_not_stand_for_the_scene(self):
        editor, names = self.three_kettles()
        editor.click(f"outline/{names[1]}/name")
        editor.click(f"outline/{names[1]}/Locked")
        editor.click(f"outline/{names[1]}/name")
        steps = editor.state()["steps"]
        self.assertEqual(editor.state()["selected"], 0)
        editor.key("1")
        self.assertNotIn("gizmo/middle", editor.state()["items"])
        editor.drag([editor.in_viewport(0.5, 0.5), editor.in_viewport(0.6, 0.5)])
        editor.key("r")
        editor.drag([editor.in_viewport(0.2, 0.2), editor.in_viewport(0.8, 0.8)])
        self.assertIn("no visible, unlocked object", " ".join(editor.state()["messages"]))
        editor.key("o")
        editor.click(*editor.in_viewport(0.5, 0.5))
        self.assertEqual(editor.state()["steps"], steps)

    def test_a_cage_of_two_picked_nodes_is_refused_if_a_third_has_a_selection(self):
        editor, names = self.three_kettles()
        editor.click(f"outline/{names[0]}/name")
        editor.click(f"outline/{names[1]}/name", held="ctrl")
        steps = editor.state()["steps"]
        editor.key("c")
        editor.click("options/make-cage")
        self.assertIn("Pick one node, or none", " ".join(editor.state()["messages"]))
        self.assertEqual(editor.state()["steps"], steps)

    def test_separate_without_a_picked_node_takes_all_that_is_selected(self):
        editor = self.open(KETTLE, KETTLE, KETTLE)
        editor.until_ops("import", "import", "import")
        editor.key("Escape", "Escape", "r")
        editor.drag([editor.in_viewport(0.2, 0.2), editor.in_viewport(0.8, 0.5)])
        editor.key("ctrl+j")
        self.assertEqual(editor.ops()[-1], "separate")
        self.assertEqual(editor.state()["steps"], 5)

    def test_forms_count_the_scope(self):
        editor, names = self.three_kettles()
        editor.click(f"outline/{names[0]}/name")
        here = editor.state()["selected"]
        editor.command("select floaters")
        counts = lambda: [item for item in editor.state()["items"] if item.startswith("form/count: Would")]
        until(counts, "a count")
        self.assertIn(f"(currently {here})", counts()[0])
