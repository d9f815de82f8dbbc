"""Times a published viewer page against Rebake on the same scene, in one run."""
import http.server
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

from measure_page import measure_page, publish

FRAMES = 15   # per round; the median counts
PATIENCE = 300  # seconds until a page must have drawn the scene


def serve(page, scene, expected):
    """A server of the page's folder. Files that it does not hold come from the scene's folder, by name, because pages
    expect scenes at places of their own. Returns the server, a dictionary of what the probe sent, and an event for it."""
    here, folder = os.path.dirname(os.path.abspath(__file__)), os.path.dirname(os.path.abspath(page))
    sent, arrived = {}, threading.Event()

    def content(path):
        name = os.path.basename(path)
        own = os.path.realpath(os.path.join(folder, path.lstrip("/")))
        if name == os.path.basename(page):
            with open(os.path.join(here, "viewer_probe.js")) as probe, open(page) as text:
                return f"<script>const EXPECTED = {json.dumps(expected)};\n{probe.read()}</script>\n{text.read()}".encode()
        candidates = [own] if own.startswith(os.path.realpath(folder) + os.sep) else []
        for place in candidates + [os.path.join(scene, name)]:
            if os.path.isfile(place):
                with open(place, "rb") as file:
                    return file.read()
        return None

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            path = urllib.parse.unquote(urllib.parse.urlparse(self.path).path)
            body = content(path)
            if body is None:
                self.send_error(404)
                return
            kinds = {".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".png": "image/png"}
            self.send_response(200)
            self.send_header("Content-Type", kinds.get(os.path.splitext(path)[1], "application/octet-stream"))
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self):
            name = os.path.basename(self.path)
            sent[name] = self.rfile.read(int(self.headers["Content-Length"]))
            self.send_response(204)
            self.end_headers()
            if name in ("report", "failed"):
                arrived.set()

        def log_message(self, *args):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server, sent, arrived


def view(browser, page, query, scene, expected):
    """Opens the page until it has drawn the scene and timed its frames. Returns the probe's report and its picture."""
    server, sent, arrived = serve(page, scene, expected)
    address = f"http://127.0.0.1:{server.server_port}/{os.path.basename(page)}{'?' + query if query else ''}"
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen(
            [browser, "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--use-angle=gl-egl", "--ignore-gpu-blocklist",
             "--window-size=1600,1200", "--user-data-dir=" + profile, address],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        arrived.wait(PATIENCE)
        process.kill()
        process.wait()
    server.shutdown()
    if "failed" in sent:
        sys.exit(f"{page}: the page failed: {sent['failed'].decode()}")
    if "report" not in sent:
        sys.exit(f"{page}: the page did not draw {expected['triangles']} triangles with {expected['images']} images within "
                 f"{PATIENCE} s. Does it read this layout of the scene, and does it draw in requestAnimationFrame?")
    return json.loads(sent["report"]), sent["picture"]


def camera_of(report):
    """Options of `rebake render` for the camera of the largest draw call, in the scene's own units."""
    if not report["camera"]:
        return None
    m, p = report["camera"]["modelView"], report["camera"]["projection"]  # column-major
    rows = [[m[4 * c + r] for c in range(3)] for r in range(3)]
    shift = m[12:15]
    scale = math.sqrt(sum(x * x for x in rows[0]))
    back = [sum(rows[r][c] * shift[r] for r in range(3)) for c in range(3)]
    eye = [-b / scale**2 for b in back]
    up, forward = [x / scale for x in rows[1]], [-x / scale for x in rows[2]]
    near, far = p[14] / (p[10] - 1) / scale, p[14] / (p[10] + 1) / scale
    fov = 2 * math.degrees(math.atan(1 / p[5]))
    join = lambda v: ",".join(f"{x:.9g}" for x in v)
    return ["--eye", join(eye), "--target", join([e + f for e, f in zip(eye, forward)]), "--up", join(up),
            "--fov", f"{fov:.9g}", "--near", f"{near:.9g}", "--far", f"{far:.9g}"]


def measure_viewer(page, scene, build, rounds=3):
    """Medians in ms by name ("frame", "load") as (Rebake, page), those of the page that Rebake publishes ("first", "load", "rest",
    "turning"; and "data", "code" in bytes), the PSNR between both pictures in dB (None: equal), and the size of the picture in
    pixels."""
    program = os.path.join(build, "rebake")
    browser = shutil.which("chromium")
    if not browser:
        sys.exit("chromium is not installed (tests/run installs it)")
    page, _, query = page.partition("?")
    for path in (page, scene):
        if not os.path.exists(path):
            sys.exit(f"{path} does not exist")
    info = json.loads(subprocess.run([program, "info", scene, "--json"], check=True, stdout=subprocess.PIPE).stdout)
    expected = {"triangles": info["triangles"], "images": 2 * info["texture_sets"], "frames": FRAMES}
    own, other, published = {"frame": [], "load": []}, {"frame": [], "load": []}, {"first": [], "load": [], "rest": [], "turning": []}
    with tempfile.TemporaryDirectory() as out:
        folder = os.path.join(out, "published")
        data, code = publish(program, scene, folder)
        for _ in range(rounds):
            report, picture = view(browser, page, query, scene, expected)
            other["frame"].append(statistics.median(report["frames"]))
            other["load"].append(report["load"])
            camera = camera_of(report)
            if camera is None:
                sys.exit(f"{page}: no matrices named modelViewMatrix and projectionMatrix are set, so its camera is unknown")
            render = [program, "render", scene, "-o", os.path.join(out, "rebake.png"),
                      "--size", f"{report['width']}x{report['height']}", *camera]
            start = time.monotonic()
            subprocess.run(render, check=True)
            own["load"].append(1000 * (time.monotonic() - start))
            times = subprocess.run([*render, "--time", str(FRAMES), "--json"], check=True, stdout=subprocess.PIPE).stdout
            own["frame"].append(json.loads(times)["frame_ms"]["median"])
            for name, value in measure_page(folder, camera, (report["width"], report["height"]), FRAMES).items():
                published[name].append(value)
        with open(os.path.join(out, "page.png"), "wb") as file:
            file.write(picture)
        compared = subprocess.run([program, "compare", os.path.join(out, "rebake.png"), os.path.join(out, "page.png"), "--json"],
                                  check=True, stdout=subprocess.PIPE).stdout
    middle = {name: (statistics.median(own[name]), statistics.median(other[name])) for name in own}
    psnr = json.loads(compared)["psnr_db"]
    pages = {name: statistics.median(values) for name, values in published.items()} | {"data": data, "code": code}
    return middle, pages, psnr, (report["width"], report["height"])
