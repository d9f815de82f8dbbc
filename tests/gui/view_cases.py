"""Stored views, pictures, videos, panels, light, and the window itself."""

import json
import subprocess

from screen import until
from window_case import FICUS, KETTLE, PROGRAM, WindowCase, green


class ViewTest(WindowCase):
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
        editor.click("tabs/views/store-view")
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

    def test_what_the_camera_turns_to_is_not_compiled_for(self):
        # Two objects far apart, and a stored view of each.
        script = self.folder / "apart.jsonl"
        view = {"fov": 39, "near": 0.1, "far": 500}
        script.write_text("\n".join(map(json.dumps, [
            {"op": "import", "path": str(FICUS), "as": "ficus"},
            {"op": "import", "path": str(KETTLE), "as": "kettle"},
            {"op": "transform", "node": "kettle", "translate": [100, 0, 0]},
            {"op": "view", "name": "at the ficus", "camera": {"eye": [0, 1, 4], "target": [0, 0, 0], **view}},
            {"op": "view", "name": "at the kettle", "camera": {"eye": [100, 1, 4], "target": [100, 0, 0], **view}},
            {"op": "save", "out": str(self.folder / "apart")}])))
        subprocess.run([PROGRAM, "run", script], check=True, capture_output=True)
        editor = self.open(self.folder / "apart")
        editor.command("at the ficus")
        until(lambda: editor.state().get("programs", {}).get("all_made"), "programs made ahead")
        seen, waited = editor.viewport(), editor.state()["programs"]["frames_waited"]
        editor.command("at the kettle")
        self.assertGreater((abs(editor.viewport() - seen).max(axis=2) > 30).sum(), 5000)
        editor.drag([editor.in_viewport(0.4, 0.8), editor.in_viewport(0.6, 0.6)], button=2)
        self.assertEqual(editor.state()["programs"]["frames_waited"], waited)

    def test_axis_knobs_and_menus(self):
        editor = self.open_ficus()
        editor.click("axes/+Y")
        editor.command("store view")
        editor.until_ops("import", "view")
        camera = editor.last_edit()["camera"]
        self.assertGreater(camera["eye"][1] - camera["target"][1], 1)
        self.assertEqual(camera["eye"][0], camera["target"][0], "exactly from above")
        self.assertEqual(camera["eye"][2], camera["target"][2])
        # Escape closes a menu, and shortcuts work again.
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
        # A drag continues outside of the window.
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

    def test_an_empty_window_leads_on(self):
        editor = self.open()
        editor.click("start/samples/ficus")
        editor.until_ops("import")
        self.assertGreater(self.leaves(), 1000)
        editor.command("open")
        editor.click("dialog/Samples")
        editor.double_click(*editor.where("dialog/entries/kettle"))
        editor.until_ops("import", "import")

    def test_text_scale_keeps_the_size_of_the_window(self):
        self.screen.settings(text_scale=1.5)
        editor = self.open_ficus()
        editor.settle()
        size = editor.state()["window"]
        editor.key("shift+a")  # any input: settings are saved with the frame
        editor.settle()
        saved = json.loads((self.screen.home / "config/rebake/settings.json").read_text())
        self.assertEqual([saved["window_width"], saved["window_height"]], size, "the size at the next start")

    def test_costs_are_a_chart_to_choose_from(self):
        editor = self.open_ficus()
        editor.command("performance")
        editor.click("tabs/cost/measure")
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

    def test_light_follows_what_is_bent(self):
        editor = self.open_ficus()
        editor.click("status/Light")
        editor.click("tabs/light/follows-edits")
        editor.until_ops("import", "light")
        self.assertNotIn("tabs/light/decisions", editor.state()["items"])
        editor.command("bend by")
        editor.click("form/degrees")
        editor.type("60")
        editor.click("form/apply")
        editor.until_ops("import", "light", "bend")
        editor.settle()
        lit = editor.viewport()
        editor.click("tabs/light/as-baked")
        different = lambda a: int((abs(editor.viewport() - a).max(axis=2) > 8).sum())
        self.assertGreater(different(lit), 1000, "light changed the bent plant")
        editor.click("tabs/light/as-baked")
        self.assertLess(different(lit), 100)
        editor.click("tabs/light/removed")
        editor.until_ops("import", "light", "bend", "light")
        self.assertEqual(editor.last_edit()["effects"], ["self", "cast", "highlights"])
        # Highlights can be switched off alone, and are off without self-shadows.
        editor.click("tabs/light/highlights")
        editor.until(lambda state: editor.last_edit()["effects"] == ["self", "cast"], "highlights are off")
        editor.click("tabs/light/self")
        editor.until(lambda state: editor.last_edit()["effects"] == ["cast"], "shadows on itself are off")
        self.assertNotIn("tabs/light/highlights", editor.state()["items"])

    def test_a_model_of_light_is_trained_forgotten_and_loaded(self):
        model = self.folder / "branch.light"
        self.screen.environment["REBAKE_RESULTS"] = str(self.folder / "results")  # models are kept there
        editor = self.open_ficus()
        said = lambda text: until(lambda: text in " ".join(editor.state()["messages"]), text, 120)
        editor.click("status/Light")
        editor.click("tabs/light/follows-edits")
        editor.until_ops("import", "light")
        # Nothing was deformed yet: nothing to train on.
        editor.click("tabs/light/model/train")
        said("bend it first")
        editor.command("bend by")
        editor.click("form/degrees")
        editor.type("60")
        editor.click("form/apply")
        editor.until_ops("import", "light", "bend")
        editor.click("tabs/light/model/options")
        for field, value in (("poses", "16"), ("rays", "16"), ("out", str(model))):
            editor.click(f"tabs/light/model/options/{field}")
            editor.key("ctrl+a")
            editor.type(value)
            editor.key("Tab")
        editor.key("Escape")
        editor.until(lambda state: "tabs/light/model/options/out" not in state["items"], "the options are closed")
        editor.click("tabs/light/model/train")
        said("now use the model")
        self.assertGreater(model.stat().st_size, 1000)
        self.assertEqual(editor.ops(), ["import", "light", "bend"], "training is no step of the history")
        editor.click("tabs/light/model/forget")
        said("rotate the transfer again")
        editor.click("tabs/light/model/load")
        editor.answer(str(model))
        until(lambda: "now use the model" in "".join(editor.state()["messages"][-1:]), "the loaded model", 60)

    def test_a_picture_is_taken_as_light(self):
        sky = self.folder / "sky.png"
        subprocess.run(["convert", "-size", "64x32", "gradient:white-#302820", sky], check=True)
        editor = self.open_ficus()
        editor.click("status/Light")
        editor.click("tabs/light/follows-edits")
        editor.click("tabs/light/environment-map")
        editor.answer(str(self.folder))
        editor.until(lambda state: "dialog/problem" in state["items"], "a folder is no picture")
        editor.click("dialog/path")
        editor.answer(str(sky))
        editor.until_ops("import", "light", "light")
        self.assertEqual(editor.last_edit()["source"], "picture")
        editor.settle()
        editor.click("tabs/light/turn")
        editor.key("ctrl+a")
        editor.type("90")
        editor.key("Return")
        editor.until_ops("import", "light", "light", "light")
        self.assertAlmostEqual(editor.last_edit()["picture_degrees"], 90, places=5)
        # Switching the source back to a picture reuses the one chosen before.
        editor.click("tabs/light/sky")
        editor.click("tabs/light/environment-map")
        editor.until_ops("import", "light", "light", "light", "light", "light")
        self.assertEqual(editor.last_edit()["source"], "picture")
        editor.until(lambda state: "tabs/light/another picture" in state["items"], "the picture again")
        self.assertEqual(editor.last_edit()["picture"], "", "the scene has it, so its file is not needed again")

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

    def test_a_video_on_a_way_through_stored_views(self):
        # A stand-in for ffmpeg that lists the pictures instead of encoding them.
        self.program("ffmpeg", 'for last; do :; done; ls "$(dirname "$last")" > "$last.txt"; mv "$last.txt" "$last"')
        editor = self.open_ficus()
        editor.command("store view")
        editor.drag([editor.in_viewport(0.4, 0.8), editor.in_viewport(0.6, 0.6)], button=2)
        editor.command("store view")
        video = self.folder / "way.mp4"
        editor.command("camera path")
        editor.click("dialog/video")
        editor.click("dialog/pictures")
        editor.key("ctrl+a")
        editor.type("5")
        editor.click("dialog/path")
        editor.answer(str(video)[:-4])
        until(video.exists, "the video")
        self.assertEqual(len([name for name in video.read_text().split() if name.endswith(".png")]), 5)
        editor.settle()
        self.assertEqual(list((self.screen.home / "cache" / "rebake").glob("film*")), [], "nothing is left behind")
        # If ffmpeg fails, the window reports it and no file is left.
        self.program("ffmpeg", "exit 7")
        editor.command("turntable")
        editor.click("dialog/video")
        editor.click("dialog/path")
        editor.answer(str(self.folder / "none.mp4"))
        editor.until(lambda state: any("exit status 7" in text for text in state["messages"]), "it is said")
        self.assertFalse((self.folder / "none.mp4").exists())
