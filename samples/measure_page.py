"""Times the page that `rebake publish` makes, in headless Chromium."""
import json
import os
import statistics
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "tests/browser"))
from devtools import Browser, Server  # noqa: E402

# Frames that wait for the GPU, as the probe of other viewers does.
TIMED = """(() => {
  const renderer = viewer.renderer, gl = renderer.gl, times = [];
  for (let k = 0; k < %d; ++k) {
    const start = performance.now();
    renderer.%s;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    times.push(performance.now() - start);
  }
  return times;
})()"""


def publish(program, scene, folder):
    """Publishes a scene and returns the bytes of its data and of its code."""
    subprocess.run([program, "publish", scene, "-o", folder, "--poster"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    sizes = {"data": 0, "code": 0}
    for place, _, names in os.walk(folder):
        for name in names:
            sizes["data" if os.path.basename(place) == "data" or name == "poster.png" else "code"] += os.path.getsize(os.path.join(place, name))
    return sizes["data"], sizes["code"]


def measure_page(folder, camera, size, frames):
    """Milliseconds: until the poster is there, until all is drawn, a frame at rest and a frame while turning (medians). `camera`: the options of
    `rebake render`."""
    words = dict(zip(camera[::2], camera[1::2]))
    vector = lambda name: [float(x) for x in words[name].split(",")]
    view = {name: vector("--" + name) for name in ("eye", "target", "up")}
    view |= {name: float(words["--" + name]) for name in ("fov", "near", "far")}
    width, height = size
    browser, server = Browser(), Server(folder)
    try:
        browser.size(width, height)
        browser.open(server.url)
        load = browser.evaluate("viewer.ready.then(() => performance.now())")
        first = browser.evaluate("performance.getEntriesByType('resource').find((e) => e.name.endsWith('poster.png')).responseEnd")
        browser.evaluate(f"viewer.setView({json.dumps(view)})")
        times = [statistics.median(browser.evaluate(TIMED % (frames, call)))
                 for call in (f"drawAtRest(viewer.camera, {width}, {height}, null)",
                              f"drawMoving(viewer.camera, {width}, {height}, 1)")]
        if browser.messages:
            sys.exit(f"the published page failed: {browser.messages}")
    finally:
        browser.close()
        server.close()
    return {"first": first, "load": load, "rest": times[0], "turning": times[1]}
