"""Deforming: cages, handles, bends along a spine; ground and drop."""

from window_case import WindowCase, FICUS, KETTLE


class BendTest(WindowCase):
    def test_a_cage_keeps_every_release(self):
        editor = self.open_ficus()
        editor.key("c")
        editor.click("options/make-cage")
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
        self.assertEqual(editor.ops(), ["import", "cage", "revise", "cage"], "a step of its own")
        self.assertEqual(editor.state()["steps"], 3)
        self.assertEqual(editor.state()["status"], "Moved 1 cage point of ficus")
        second = editor.items("cage")
        self.assertNotEqual(first, second)
        # Undo and redo go through the individual drags.
        editor.key("ctrl+z")
        self.assertEqual(editor.items("cage"), first)
        self.assertEqual(editor.state()["steps"], 2)
        editor.key("ctrl+z")
        self.assertEqual(editor.items("cage"), points)
        self.assertEqual(editor.state()["steps"], 1)
        # Undoing further, even the import, loses nothing: redo restores every drag and the cage.
        editor.key("ctrl+z")
        self.assertEqual(editor.state()["steps"], 0)
        editor.key("ctrl+y", "ctrl+y", "ctrl+y")
        self.assertEqual(editor.state()["steps"], 3)
        self.assertEqual(editor.items("cage"), second)
        # The soft border can still be adjusted, and the cage stays.
        editor.click("adjust/falloff/value")
        editor.type("0.1")
        editor.key("Return")
        self.assertEqual(editor.last_edit()["falloff"], 0.1)
        self.assertEqual(editor.items("cage"), second)
        # Leaving the tool keeps all steps; Escape cancels the current drag only.
        x, y, _, _ = min(editor.items("cage").values(), key=lambda box: box[1])
        editor.drag([(round(x), round(y)), (round(x) + 60, round(y))], meanwhile=lambda: editor.key("Escape"))
        self.assertEqual(editor.items("cage"), second)
        editor.key("v")
        self.assertEqual(editor.state()["steps"], 3, "leaving the tool folds no steps")
        self.assertEqual(editor.last_edit()["op"], "cage")
        editor.key("ctrl+z")
        self.assertEqual(editor.state()["steps"], 2, "the first release, outside of the tool too")

    def test_cage_points_turn_together_and_on_both_sides(self):
        editor = self.open_ficus()
        editor.key("KP_1", "c")
        editor.click("options/make-cage")
        rest = editor.items("cage")

        def moves():
            """Translation of each moved cage point, by its number."""
            found = {}
            for move in editor.last_edit()["moves"]:
                for part in move["points"]:
                    first, last = part if isinstance(part, list) else (part, part)
                    for number in range(first, last + 1):
                        found[number] = move["translate"]
            return found

        # A lasso around the top row of points in the front view, then a rotation by dragging one of them.
        top = min(box[1] for box in rest.values())
        row = [box for box in rest.values() if box[1] < top + 40]
        left, right = min(box[0] for box in row) - 25, max(box[0] for box in row) + 25
        low, high = max(box[1] for box in row) + 25, top - 25
        corners = [(round(x), round(y)) for x, y in ((left, high), (right, high), (right, low), (left, low))]
        editor.drag(corners, held="ctrl")
        editor.click("options/rotate")
        x, y = max((round(box[0]), round(box[1])) for box in row)
        editor.drag([(x, y), (x, y + 60)])
        turned = moves()
        self.assertGreater(len(turned), 5, "all of the row")
        middle = [sum(move[axis] for move in turned.values()) / len(turned) for axis in range(3)]
        self.assertLess(max(map(abs, middle)), 1e-9, "they turn about their own middle")
        editor.key("ctrl+z")
        # One point with symmetry in X moves both sides.
        editor.click("options/move")
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
        editor.click("options/drag")
        editor.click(*editor.in_viewport(0.70, 0.33))  # the tip of the branch
        self.assertEqual(len(editor.items("handle")), 2)
        before = self.leaves()
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x, y - 60)])
        editor.until_ops("import", "handles")
        edit = editor.last_edit()
        self.assertEqual([len(edit["moves"]), len(edit["fixed"])], [1, 1])
        self.assertGreater(edit["moves"][0]["translate"][1], 0.1)
        # Another drag revises the deformation.
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x, y - 20)])
        self.assertEqual(editor.state()["steps"], 3)
        self.assertGreater(editor.last_edit()["moves"][0]["translate"][1], edit["moves"][0]["translate"][1])
        # Escape cancels the current drag only.
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x + 50, y)], meanwhile=lambda: editor.key("Escape"))
        self.assertEqual(editor.where("handle/1"), (x, y))
        # A point added to the deformed surface holds it where it is.
        editor.click("options/fix")
        editor.click(*editor.in_viewport(0.37, 0.28))
        self.assertEqual(len(editor.items("handle")), 3)
        x, y = editor.where("handle/1")
        editor.drag([(x, y), (x, y + 10)])
        self.assertEqual(len(editor.last_edit()["moves"]) + len(editor.last_edit()["fixed"]), 3)
        # Undo reverts the drags one by one; redo restores the points.
        third = editor.items("handle")
        editor.key("ctrl+z", "ctrl+z", "ctrl+z")
        self.assertEqual(editor.state()["steps"], 1)
        self.assertAlmostEqual(self.leaves(), before, delta=0.02 * before)
        editor.key("ctrl+y", "ctrl+y", "ctrl+y")
        self.assertEqual(editor.items("handle"), third)
        editor.key("v")
        self.assertEqual(editor.state()["steps"], 4, "leaving the tool keeps every step")

    def test_a_kettle_is_put_onto_the_pot(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        editor.key("1", "m")
        x, y = editor.where("gizmo/middle")
        editor.drag([(x, y), editor.in_viewport(0.8, 0.8)])
        moved = editor.last_edit()
        self.assertEqual(moved["op"], "transform")
        x, y = editor.where("gizmo/y")
        editor.drag([(x, y), (x, y - 60)])
        editor.key("End")
        self.assertEqual(editor.last_edit()["op"], "drop")
        self.assertEqual(editor.state()["status"], "Dropped kettle")
        # The kettle is supported already: nothing moves or is recorded, and the status says why.
        steps, ops = editor.state()["steps"], editor.ops()
        editor.key("End")
        self.assertEqual((editor.state()["steps"], editor.ops()), (steps, ops))
        self.assertIn("already stands on a surface or on the ground;", editor.state()["status"])

    def test_the_ground_is_where_the_grid_is(self):
        """The first object stands on the ground; an object dropped beside it stands at the same height."""
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        self.assertTrue(editor.journal()[0]["edit"]["ground"])
        foot = editor.state()["ground"]
        self.assertLess(foot, -0.5)
        editor.click("outline/kettle/name")
        editor.key("1")
        editor.key("m")
        x, y = editor.where("gizmo/middle")
        editor.drag([(x, y), editor.in_viewport(0.85, 0.75)])
        editor.settle()
        self.assertAlmostEqual(editor.state()["picked_foot"], foot, places=5, msg="snapped onto the ground")
        x, y = editor.where("gizmo/y")
        editor.drag([(x, y), (x, y - 60)])
        editor.settle()
        self.assertGreater(editor.state()["picked_foot"], foot + 0.05)
        editor.key("End")
        editor.settle()
        self.assertAlmostEqual(editor.state()["picked_foot"], foot, places=5)
        # The ground can be set: by a height, and by three points.
        editor.click("tool/Ground")
        editor.click("options/height")
        editor.type("0-2.5")
        editor.key("Return")
        self.assertAlmostEqual(editor.state()["ground"], -2.5, places=6)
        editor.key("End")
        editor.settle()
        self.assertAlmostEqual(editor.state()["picked_foot"], -2.5, places=5)
        for share in ((0.43, 0.70), (0.47, 0.70), (0.45, 0.74)):
            editor.click(*editor.in_viewport(*share))
        self.assertEqual(len(editor.last_edit().get("points", [])), 3)
        editor.click("options/lowest-point")
        self.assertTrue(editor.last_edit()["foot"])

    def test_a_known_length_scales_the_scene(self):
        editor = self.open_ficus()
        editor.click("tool/Measure")
        for share in ((0.43, 0.70), (0.47, 0.72)):
            editor.click(*editor.in_viewport(*share))
        self.assertGreater(abs(editor.where("measure/1")[0] - editor.where("measure/0")[0]), 10)
        editor.click("options/length")
        editor.type("0.82")
        editor.key("Return")
        editor.settle()
        edit = editor.last_edit()
        self.assertEqual((edit["op"], edit["length"], len(edit["points"])), ("set_length", 0.82, 2))
        # The points scale with the scene: the length stays without another edit.
        editor.click("options/length")
        editor.type("0.82")
        editor.key("Return")
        self.assertEqual(editor.ops(), ["import", "set_length"])

    def test_a_capture_is_registered_by_clicked_pairs(self):
        editor = self.open(FICUS, KETTLE)
        editor.until_ops("import", "import")
        pairs = (((0.35, 0.42), (0.42, 0.74)), ((0.50, 0.42), (0.49, 0.73)), ((0.43, 0.55), (0.45, 0.69)))
        editor.click("outline/kettle/name")
        editor.click("tool/Register")
        editor.click(*editor.in_viewport(*pairs[0][1]))
        editor.until(lambda state: any('Click a point of "kettle" first' in text for text in state["messages"]), "said")
        for kettle, pot in pairs:
            editor.click(*editor.in_viewport(*kettle))
            editor.click(*editor.in_viewport(*pot))
        editor.settle()
        editor.key("BackSpace")  # removes the last point, and one more click sets it again
        editor.settle()
        self.assertNotIn("register-onto/2", editor.state()["items"])
        editor.click(*editor.in_viewport(*pairs[2][1]))
        editor.settle()
        places = [editor.where(f"register-onto/{k}") for k in range(3)]
        editor.click("options/refine")
        editor.click("options/register")
        editor.settle()
        edit = editor.last_edit()
        self.assertEqual((edit["op"], len(edit["points"]), len(edit["onto"]), edit["refine"]), ("register", 3, 3, False))
        for (x, y), (_, share) in zip(places, pairs):
            seen = editor.in_viewport(*share)
            self.assertLess(abs(x - seen[0]) + abs(y - seen[1]), 3, "counterparts are where they were clicked")
        self.assertNotIn("register-from/0", editor.state()["items"], "the pairs are used up")

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
        held[:, :150] = held[:, -150:] = False  # the axis gizmo
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
        # The last step can be adjusted without adding a step.
        editor.click("adjust/degrees/value")
        editor.type("30")
        editor.key("Return")
        editor.until_ops("import", "select_picture", "bend", "adjust", "bend")
        self.assertEqual(editor.last_edit()["degrees"], 30)
        self.assertEqual(editor.state()["steps"], 3)
        # A second bend keeps the axis of the first.
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
        editor.click("options/curved")
        x, y = editor.where("bend/tip")
        editor.drag([(x, y), (x - 20, y - 60)], meanwhile=lambda: editor.key("5", "0"))
        edit = editor.last_edit()
        self.assertEqual(edit["degrees"], 50)
        self.assertGreaterEqual(len(edit["spine"]), 5)
        self.assertNotIn("origin", {name for name, value in edit.items() if value is not None})
        tip = editor.where("bend/tip")
        self.assertLess(tip[1], y - 20, "the handle went with it")
        # A second bend uses the same curve and starts where the first ended.
        editor.drag([tip, (tip[0] - 10, tip[1] - 30)])
        self.assertEqual(editor.ops()[-2:], ["bend", "bend"])
        self.assertEqual(editor.last_edit()["spine"], edit["spine"])

    def test_a_bend_of_what_is_seen_offers_the_rest(self):
        editor = self.open_ficus()
        seen = self.select_branch()
        editor.key("n")
        editor.click("options/select-occluded")
        self.assertGreater(editor.state()["selected"], 1.3 * seen)
        self.assertNotIn("options/select-occluded", editor.state()["items"])
        # The handles follow the bent branch.
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
        editor.click("form/apply")
        editor.until_ops("import", "bend")
        self.assertEqual(editor.last_edit()["degrees"], 60)
