"""Published pages in a real browser: the pictures are Rebake's, and the page behaves.

Usage: web_page_test.py REBAKE [unittest arguments]
"""
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from devtools import Browser, Server

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples/scenes"
REBAKE = sys.argv.pop(1)
CAMERA = {"eye": [0.9, 1.2, 3.2], "target": [0.1, -0.1, 0], "up": [0, 1, 0], "fov": 39, "near": 1, "far": 8}
BEND = {"op": "bend", "node": "ficus", "degrees": 70, "axis": [1, 0.3, 0], "direction": [0, -1, 0], "frame": "bounds",
        "box": {"min": [0.52, 0.5, 0], "max": [1, 1, 1]}, "falloff": 0.15}
FICUS = {"op": "import", "path": str(SAMPLES / "ficus"), "as": "ficus"}
KETTLE = {"op": "import", "path": str(SAMPLES / "kettle"), "as": "kettle"}
MOVED = {"op": "transform", "node": "kettle", "translate": [0.6, -0.45, 0.7], "scale": 0.6,
         "rotate": {"axis": [0, 1, 0], "degrees": 150}}


def rebake(*words):
    done = subprocess.run([REBAKE, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout


class WebPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.at = Path(self.folder.name)
        self.browser.size(400, 400)
        self.browser.messages.clear()

    def tearDown(self):
        self.folder.cleanup()

    def scene(self, *edits):
        """A Rebake scene made by edits."""
        script, out = self.at / "script.jsonl", self.at / "scene"
        lines = [*edits, {"op": "save", "out": str(out)}]
        script.write_text("".join(json.dumps(line) + "\n" for line in lines))
        code, text = rebake("run", script)
        self.assertEqual(code, 0, text)
        return out

    def publish(self, scene, *options):
        page = self.at / "page"
        code, text = rebake("publish", scene, "-o", page, *options)
        self.assertEqual(code, 0, text)
        return page

    def show(self, page):
        server = Server(page)
        self.addCleanup(server.close)
        self.browser.open(server.url)
        self.browser.evaluate("viewer.ready.then(() => true)")
        return server

    def capture(self, camera, size=400):
        self.browser.evaluate(f"viewer.setView({json.dumps(camera)})")
        url = self.browser.evaluate(f"viewer.captureFrame({size}, {size})")
        picture = self.at / "browser.png"
        picture.write_bytes(base64.b64decode(url.split(",")[1]))
        return picture

    def expect_picture_of(self, scene, camera=CAMERA, psnr=55):
        """The picture of the page that is open against Rebake's own."""
        own = self.at / "own.png"
        listed = [",".join(map(repr, camera[key])) if isinstance(camera[key], list) else camera[key] for key in camera]
        code, text = rebake("render", scene, "-o", own, "--size", "400x400",
                            *(word for key, value in zip(camera, listed) for word in ("--" + key, value)))
        self.assertEqual(code, 0, text)
        code, text = rebake("compare", self.capture(camera), own, "--min-psnr", psnr)
        self.assertEqual(code, 0, text)
        self.assertEqual(self.browser.messages, [])
        return text

    def expect_page_of(self, scene, **options):
        server = self.show(self.publish(scene))
        self.expect_picture_of(scene, **options)
        self.assertTrue(all(path == "/" or path.startswith(("/data/", "/viewer/", "/scene.json")) for path in server.requests),
                        server.requests)

    def test_unedited_scenes(self):
        for name in ("ficus", "kettle"):
            self.expect_page_of(SAMPLES / name)

    def test_several_decoders_and_orientations(self):
        self.expect_page_of(self.scene(FICUS, KETTLE, MOVED))

    def test_trained_scenes(self):
        photographs, trained = self.at / "photographs", self.at / "trained"
        photograph = Path(REBAKE).with_name("rebake_photograph")
        subprocess.run([photograph, "kettle", "-o", photographs, "--views", "24", "--held-out", "4", "--side", "48"], check=True,
                       stdout=subprocess.DEVNULL)
        code, text = rebake("train", photographs, "-o", trained, "--side", "24", "--steps", "800")
        self.assertEqual(code, 0, text)
        self.expect_page_of(trained)
        self.expect_page_of(self.scene({"op": "import", "path": str(trained), "as": "trained"}, FICUS,
                                       {"op": "transform", "node": "trained", "translate": [0.9, 0, 0]},
                                       {"op": "bend", "node": "trained", "axis": [0, 1, 0], "degrees": 30}), psnr=45)

    def test_five_decoders(self):
        copies = []
        for k in range(4):
            # Another scale of the colours: a decoder of its own.
            folder = self.at / f"kettle{k}"
            shutil.copytree(SAMPLES / "kettle", folder)
            decoder = json.loads((folder / "mlp.json").read_text())
            decoder["2_bias"] = [b + 0.5 * (k - 2) for b in decoder["2_bias"]]
            (folder / "mlp.json").write_text(json.dumps(decoder))
            copies += [{"op": "import", "path": str(folder), "as": f"k{k}"},
                       {"op": "transform", "node": f"k{k}", "translate": [0.7 * (k - 1.5), -0.5, 0.8], "scale": 0.3}]
        self.expect_page_of(self.scene(FICUS, *copies))

    def test_instances_of_all_sizes(self):
        # The page's grid of positions suits the nearest instance.
        scene = self.scene(FICUS, {"op": "duplicate", "node": "ficus", "as": "near"},
                           {"op": "transform", "node": "ficus", "translate": [0, 0, -4000]},
                           {"op": "view", "name": "near", "camera": {k: CAMERA[k] for k in ("eye", "target")}})
        page = self.publish(scene, "--view", "near")
        self.show(page)
        self.expect_picture_of(scene)
        self.assertEqual(self.browser.evaluate("viewer.stats().triangles"), 2 * 2328)

    def test_a_hundred_orientations(self):
        copies = []
        for k in range(120):
            copies.append({"op": "duplicate", "node": "ficus", "as": f"c{k}"})
            copies.append({"op": "transform", "node": f"c{k}", "scale": 0.1, "translate": [0.3 * (k % 12) - 1.6, 0.25 * (k // 12) - 1, 0.5],
                           "rotate": {"axis": [0.3, 1, 0.1], "degrees": 3 * k + 1}})
        self.expect_page_of(self.scene(FICUS, *copies))

    def test_keyframes_play(self):
        turn = {"axis": [0, 1, 0], "degrees": 120}
        scene = self.scene(FICUS, KETTLE, {**MOVED, "node": "kettle"},
                           {"op": "key", "node": "kettle", "time": 0, "interpolation": "linear"},
                           {"op": "key", "node": "kettle", "time": 2, "position": [-0.6, -0.2, 0.7], "rotation": turn})
        self.show(self.publish(scene))
        self.expect_picture_of(scene)  # as it stands
        # 53 dB: positions have the grid of the resting scene.
        for seconds in (0.5, 2):
            self.browser.evaluate(f"viewer.seek({seconds})")
            own = self.at / "own.png"
            words = [w for key, value in CAMERA.items() for w in ("--" + key, ",".join(map(repr, value)) if isinstance(value, list) else value)]
            code, text = rebake("render", scene, "--at", seconds, "-o", own, "--size", "400x400", *words)
            self.assertEqual(code, 0, text)
            code, text = rebake("compare", self.capture(CAMERA), own, "--min-psnr", 53)
            self.assertEqual(code, 0, text)
        self.browser.evaluate("viewer.seek(0)")
        self.browser.evaluate("viewer.setPlaying(true)")
        self.assertEqual(self.browser.evaluate("document.getElementById('play').textContent"), "Pause")
        self.browser.evaluate("new Promise((done) => { const id = setInterval(() => { if (!viewer.playing) { clearInterval(id); done(true); } }, 50); })")
        self.assertEqual(self.browser.evaluate("viewer.seconds"), 2)
        self.assertEqual(self.browser.messages, [])

    def test_bends_play(self):
        scene = self.scene(FICUS, {"op": "key", "node": "ficus", "time": 0, "degrees": 0, "interpolation": "linear"},
                           {"op": "key", "node": "ficus", "time": 2, "degrees": 50},
                           {"op": "key", "node": "ficus", "time": 0, "interpolation": "linear"},
                           {"op": "key", "node": "ficus", "time": 2, "position": [0.4, 0, 0]})
        page = self.publish(scene)
        self.show(page)
        self.expect_picture_of(scene)
        bend, = json.loads((page / "scene.json").read_text())["motion"]["bends"]
        self.assertGreater(len(bend["seconds"]), 3)
        words = [w for key, value in CAMERA.items() for w in ("--" + key, ",".join(map(repr, value)) if isinstance(value, list) else value)]
        # A pose itself, and the worst place between two.
        between = (bend["seconds"][1] + bend["seconds"][2]) / 2
        for seconds, least in ((2, 53), (bend["seconds"][1], 53), (between, 30)):
            self.browser.evaluate(f"viewer.seek({seconds})")
            own = self.at / "own.png"
            code, text = rebake("render", scene, "--at", seconds, "-o", own, "--size", "400x400", *words)
            self.assertEqual(code, 0, text)
            code, text = rebake("compare", self.capture(CAMERA), own, "--min-psnr", least)
            self.assertEqual(code, 0, f"{seconds} s: {text}")
        before = self.capture(CAMERA).read_bytes()
        self.browser.evaluate("viewer.lose = viewer.renderer.gl.getExtension('WEBGL_lose_context'), viewer.lose.loseContext()")
        self.browser.evaluate("new Promise((done) => { viewer.addEventListener('restored', () => done(true)); setTimeout(() => viewer.lose.restoreContext(), 50); })")
        self.assertEqual(self.capture(CAMERA).read_bytes(), before)

    def test_the_camera_follows_its_keyframes_until_somebody_moves_it(self):
        scene = self.scene(FICUS, *({"op": "key", "time": t, "camera": {"eye": eye, "target": [0, 0, 0]}}
                                    for t, eye in ((0, [0, 1, 4]), (1, [4, 1, 0]))))
        self.show(self.publish(scene))
        self.browser.evaluate("viewer.seek(1)")
        self.assertAlmostEqual(self.camera()["eye"][0], 4, 6)
        self.browser.evaluate("document.getElementById('picture').dispatchEvent(new PointerEvent('wheel'))")
        before = self.camera()
        self.browser.evaluate("viewer.seek(0.2)")
        self.assertEqual(self.camera(), before)

    def test_before_and_after(self):
        edited = self.scene(FICUS, BEND)
        page = self.publish(edited, "--before", SAMPLES / "ficus")
        names = sorted(path.name for path in (page / "data").iterdir())
        self.assertNotIn("before.feat0.0.webp", names, "equal textures are carried once")
        self.show(page)
        self.expect_picture_of(edited)
        self.browser.evaluate("viewer.showBefore(true)")
        self.expect_picture_of(SAMPLES / "ficus")
        self.browser.evaluate("viewer.showBefore(false)")
        self.expect_picture_of(edited)

    def test_transparent_pages(self):
        self.show(self.publish(SAMPLES / "ficus", "--transparent"))
        own = self.at / "own.png"
        words = [w for key, value in CAMERA.items() for w in ("--" + key, ",".join(map(repr, value)) if isinstance(value, list) else value)]
        code, text = rebake("render", SAMPLES / "ficus", "-o", own, "--size", "400x400", "--background", "0,0,0", *words)
        self.assertEqual(code, 0, text)
        code, text = rebake("render", SAMPLES / "ficus", "-o", self.at / "clear.png", "--size", "400x400", "--transparent", *words)
        self.assertEqual(code, 0, text)
        code, text = rebake("compare", self.capture(CAMERA), self.at / "clear.png", "--min-psnr", 40)
        self.assertEqual(code, 0, text)
        alpha = self.browser.evaluate(f"viewer.setView({json.dumps(CAMERA)}), viewer.renderer.pixels(viewer.camera, 400, 400).filter((_, k) => k % 4 === 3).reduce((sum, a) => sum + (a > 0 && a < 255 ? 1 : 0), 0)")
        self.assertGreater(alpha, 100, "edges are partly transparent")
        self.assertEqual(self.browser.evaluate("viewer.renderer.pixels(viewer.camera, 40, 40)[3]"), 0)

    def test_views_have_thumbnails_and_the_page_a_poster(self):
        scene = self.scene(FICUS, {"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}})
        page = self.publish(scene, "--poster")
        self.assertIn("og:image", (page / "index.html").read_text())
        self.browser.size(900, 700)
        self.show(page)
        self.assertIsNone(self.browser.evaluate("document.getElementById('poster')"), "it goes when the scene is there")
        image = "document.querySelector('#gallery img')"
        self.assertEqual(self.browser.evaluate(f"new Promise((done) => setTimeout(() => done([{image}.alt, {image}.naturalWidth]), 300))"), ["front", 96])
        self.browser.evaluate(f"{image}.parentElement.click()")
        self.assertAlmostEqual(self.camera()["eye"][2], 4, 6)
        self.assertEqual(self.browser.messages, [])

    def test_cameras_that_show_nothing_are_refused(self):
        self.show(self.publish(SAMPLES / "ficus"))
        before = self.camera()
        for bad in ({"eye": [0, 0, None]}, {"fov": 0}, {"fov": 200}, {"eye": before["target"]}, {"near": 5, "far": 1}, {"up": [0, 0, 0]}):
            said = self.browser.evaluate(f"(() => {{ try {{ viewer.setView({json.dumps(bad)}); return ''; }} catch (e) {{ return e.message; }} }})()")
            self.assertIn("shows nothing", said, bad)
        self.assertEqual(self.camera(), before)
        said = self.browser.evaluate("viewer.captureFrame(100000, 4).then(() => '', e => e.message)")
        self.assertIn("pixels per side", said)

    def covered(self):
        """Pixels of the canvas that are not white."""
        return self.browser.evaluate("(() => { const p = viewer.renderer.pixels(viewer.camera, 200, 200); let n = 0;"
                                     " for (let k = 0; k < p.length; k += 4) if (p[k] + p[k + 1] + p[k + 2] < 760) ++n; return n; })()")

    def test_nothing_is_cut_off_by_moving(self):
        row = [line for k in range(3) for line in (
            {**FICUS, "as": f"f{k}"}, {"op": "transform", "node": f"f{k}", "translate": [3 * k - 3, 0, 0]})]
        camera = {"eye": [0, 1, 12], "target": [0, 0, 0]}
        scene = self.scene(*row, {"op": "view", "name": "side", "camera": camera},
                           {"op": "view", "name": "flat", "camera": {**camera, "ortho_height": 9}},
                           {"op": "view", "name": "top", "camera": {"eye": [0, 12, 0], "target": [0, 0, 0]}})
        self.show(self.publish(scene, "--view", "side"))
        self.browser.evaluate("viewer.controls.orbit(200, 0)")  # by 90°
        self.assertAlmostEqual(self.camera()["eye"][2], 0, 6)
        end_on = self.covered()
        self.browser.evaluate("viewer.setView({near: 0.01, far: 1000})")
        self.assertEqual(self.covered(), end_on, "the planes follow the scene")
        choose = "(() => { const s = document.getElementById('views'); s.value = '%d'; s.onchange(); return s.value; })()"
        # Views are sorted by name: flat, side, top.
        self.assertEqual(self.browser.evaluate(choose % 0), "", "a view can be chosen again")
        before = self.covered()
        for _ in range(8):
            self.browser.evaluate("viewer.controls.zoom(1.1, 200, 200)")
        self.assertGreater(self.covered(), 0.1 * before, "an orthographic camera zooms out")
        for _ in range(16):
            self.browser.evaluate("viewer.controls.zoom(1 / 1.1, 200, 200)")
        self.assertGreater(self.covered(), before, "and in, without cutting the scene")
        self.browser.evaluate(choose % 2)
        self.browser.evaluate("viewer.controls.orbit(0, -60)")
        self.assertLess(self.camera()["eye"][1], 11.9, "the view from above can be left")
        for factor in (0.01, 100):
            for _ in range(20):
                self.browser.evaluate(f"viewer.controls.zoom({factor}, 200, 200)")
        self.assertTrue(all(abs(x) < 1e4 for x in self.camera()["eye"]), "zoom has limits")

    def test_damaged_files_are_named(self):
        page = self.publish(SAMPLES / "ficus")
        for name, text in (("data/mesh0.gz", "no mesh"), ("data/feat0.0.webp", "no picture"), ("scene.json", "{")):
            before = (page / name).read_bytes()
            (page / name).write_text(text)
            server = Server(page)
            self.addCleanup(server.close)
            self.browser.open(server.url)
            said = self.browser.evaluate("viewer.ready.then(() => '', e => e.message)")
            self.assertIn(name + " is damaged", said)
            self.assertEqual(self.browser.evaluate("document.getElementById('message').textContent"), said)
            (page / name).write_bytes(before)

    def test_a_folder_without_a_server_says_so(self):
        self.browser.open((self.publish(SAMPLES / "ficus") / "index.html").as_uri())
        time.sleep(3.3)
        self.assertEqual(self.browser.evaluate("getComputedStyle(document.getElementById('message')).visibility"), "visible")
        self.assertIn("web server", self.browser.evaluate("document.getElementById('message').textContent"))

    def test_camera_and_views_on_the_command_line(self):
        scene = self.scene(FICUS, *({"op": "view", "name": name, "camera": {k: CAMERA[k] for k in ("eye", "target")}} for name in "ab"))
        page = self.publish(scene, "--views", "b", "--camera", json.dumps({"eye": [0, 0, 9], "target": [0, 0, 0]}))
        manifest = json.loads((page / "scene.json").read_text())
        self.assertEqual([view["name"] for view in manifest["views"]], ["b"])
        self.assertEqual(manifest["home"]["eye"], [0, 0, 9])

    def test_mirrored_objects(self):
        self.expect_page_of(self.scene(FICUS, KETTLE, MOVED, {"op": "transform", "node": "kettle", "scale": [-1, 1, 1]}))

    def test_bent_objects(self):
        self.expect_page_of(self.scene(FICUS, BEND))

    def test_light_that_follows_edits(self):
        scene = self.scene(FICUS, KETTLE, MOVED, BEND, {"op": "light"})
        page = self.publish(scene)
        self.assertTrue(list((page / "data").glob("light*.gz")), "the scene has light maps")
        self.show(page)
        self.expect_picture_of(scene)

    def test_moving_highlights(self):
        scene = self.scene(KETTLE, {"op": "bend", "node": "kettle", "degrees": 60}, {"op": "light"})
        page = self.publish(scene)
        manifest = json.loads((page / "scene.json").read_text())
        self.assertIn("carried moving highlights: specular surfaces were rotated", manifest["decisions"])
        self.show(page)
        self.expect_picture_of(scene)

    def test_far_from_the_origin(self):
        far = {**CAMERA, "eye": [1e6 + 0.9, 1.2, 3.2], "target": [1e6 + 0.1, -0.1, 0]}
        self.expect_page_of(self.scene(FICUS, {"op": "transform", "node": "ficus", "translate": [1e6, 0, 0]}), camera=far)

    def test_nothing_is_drawn_at_rest(self):
        self.show(self.publish(SAMPLES / "ficus"))
        frames = self.browser.evaluate("viewer.stats().frames")
        time.sleep(0.7)
        self.assertEqual(self.browser.evaluate("viewer.stats().frames"), frames)
        self.assertTrue(self.browser.evaluate("viewer.stats().atRest"))

    def rest(self):
        self.browser.evaluate("new Promise(done => { const ask = () => viewer.stats().atRest ? done() : setTimeout(ask, 20);"
                              " ask(); })")

    def camera(self):
        return self.browser.evaluate("viewer.camera")

    def mouse(self, kind, x, y, **more):
        self.browser.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def test_mouse_and_keys_move_the_camera(self):
        self.show(self.publish(SAMPLES / "ficus"))
        home = self.camera()
        distance = lambda c: sum((a - b) ** 2 for a, b in zip(c["eye"], c["target"])) ** 0.5
        self.mouse("mousePressed", 200, 200, button="left", clickCount=1, buttons=1)
        self.mouse("mouseMoved", 260, 200, button="left", buttons=1)
        self.mouse("mouseReleased", 260, 200, button="left", clickCount=1)
        orbited = self.camera()
        self.assertEqual(orbited["target"], home["target"])
        self.assertNotEqual(orbited["eye"], home["eye"])
        self.assertAlmostEqual(distance(orbited), distance(home), 9)
        self.mouse("mouseWheel", 100, 200, deltaX=0, deltaY=-300)
        zoomed = self.camera()
        self.assertLess(distance(zoomed), 0.7 * distance(home))
        self.assertNotEqual(zoomed["target"], home["target"], "the zoom goes to the cursor")
        for clicks in (1, 2):
            self.mouse("mousePressed", 200, 250, button="left", clickCount=clicks, buttons=1)
            self.mouse("mouseReleased", 200, 250, button="left", clickCount=clicks)
        self.assertNotEqual(self.camera()["target"], zoomed["target"], "a double click on the pot sets the pivot")
        for key in ("ArrowLeft", "h"):
            before = self.camera()
            self.browser.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=key if len(key) == 1 else "")
            self.assertNotEqual(self.camera(), before, key)
        self.assertEqual(self.camera(), home)
        self.rest()
        self.assertEqual(self.browser.messages, [])

    def test_the_canvas_shows_the_picture_while_moving_and_at_rest(self):
        self.show(self.publish(SAMPLES / "ficus"))
        colors = ("(() => { const gl = viewer.renderer.gl, p = new Uint8Array(4); gl.bindFramebuffer(gl.FRAMEBUFFER, null);"
                  " gl.readPixels(200, 140, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, p); return [...p]; })()")
        moving = "drawMoving(viewer.camera, 400, 400, {})".format
        self.browser.evaluate(f"viewer.renderer.{moving(1)}, viewer.renderer.{moving(0.8)}")
        for draw in (moving(1), moving(0.5), "drawAtRest(viewer.camera, 400, 400, null)"):
            red, green, blue, alpha = self.browser.evaluate(f"viewer.renderer.{draw}, {colors}")
            self.assertEqual(alpha, 255)
            self.assertTrue(red > green > blue > 20, f"the pot is brown: {draw}: {(red, green, blue)}")

    def test_a_lost_context_comes_back(self):
        scene = SAMPLES / "ficus"
        self.show(self.publish(scene))
        self.browser.evaluate(
            "new Promise(done => { const lose = viewer.renderer.gl.getExtension('WEBGL_lose_context');"
            " viewer.addEventListener('restored', done, {once: true}); lose.loseContext();"
            " setTimeout(() => lose.restoreContext(), 100); })")
        self.browser.messages[:] = [m for m in self.browser.messages if "CONTEXT_LOST" not in m]
        self.expect_picture_of(scene)

    def test_a_single_file_works_without_a_server(self):
        page = self.at / "ficus.html"
        code, text = rebake("publish", SAMPLES / "ficus", "-o", page, "--single-file")
        self.assertEqual(code, 0, text)
        self.browser.open(page.as_uri())
        self.browser.evaluate("viewer.ready.then(() => true)")
        self.assertEqual(self.browser.evaluate("performance.getEntriesByType('resource').filter(e => !/^(data|blob):/.test(e.name)).length"), 0)
        self.expect_picture_of(SAMPLES / "ficus")

    def test_titles_and_names_are_text(self):
        evil = "<img src=x onerror=alert(1)> \"&'</script><script>alert(2)</script>"
        scene = self.scene(FICUS, {"op": "view", "name": evil, "camera": {**{k: CAMERA[k] for k in ("eye", "target")}}})
        for options in ((), ("--single-file",)):
            page = self.at / "evil.html" if options else self.at / "evil"
            code, text = rebake("publish", scene, "-o", page, "--title", evil, *options)
            self.assertEqual(code, 0, text)
            if options:
                self.browser.open(page.as_uri())
                self.browser.evaluate("viewer.ready.then(() => true)")
            else:
                self.show(page)
            self.assertEqual(self.browser.evaluate("document.title"), evil)
            self.assertEqual(self.browser.evaluate("document.getElementById('views').options[1].textContent"), evil)
            self.assertEqual(self.browser.evaluate("document.querySelectorAll('img:not(#gallery img)').length"), 0)
            self.assertEqual(self.browser.messages, [])

    def test_phones(self):
        self.browser.size(360, 640, 2, mobile=True)
        scene = self.scene(FICUS, {"op": "view", "name": "a view with a rather long name for a phone",
                                   "camera": {"eye": CAMERA["eye"], "target": CAMERA["target"]}})
        self.show(self.publish(scene))
        boxes = self.browser.evaluate("[...document.querySelectorAll('button, select')].filter(e => !e.hidden)"
                                      ".map(e => { const b = e.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; })")
        self.assertGreaterEqual(len(boxes), 4)
        for left, top, right, bottom in boxes:
            self.assertTrue(left >= 0 and top >= 0 and right <= 360 and bottom <= 640, (left, top, right, bottom))
        self.assertEqual(self.browser.evaluate("document.documentElement.scrollWidth"), 360)

    def test_a_missing_webgl_is_said(self):
        browser = Browser(["--disable-3d-apis"])
        self.addCleanup(browser.close)
        server = Server(self.publish(SAMPLES / "ficus"))
        self.addCleanup(server.close)
        browser.open(server.url)
        browser.evaluate("viewer.ready.catch(() => true)")
        self.assertIn("needs WebGL 2", browser.evaluate("document.getElementById('message').textContent"))
        self.assertFalse(browser.evaluate("document.getElementById('message').hidden"))

    def test_types(self):
        if shutil.which("tsc") is None:
            self.fail("tsc is not installed (tests/run installs node-typescript)")
        done = subprocess.run(["tsc", "-p", ROOT / "render/web_page/viewer"], stdout=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    if shutil.which("chromium") is None:
        print("skipped: chromium is not installed (tests/run installs it)")
        sys.exit(77)
    unittest.main(verbosity=2)
