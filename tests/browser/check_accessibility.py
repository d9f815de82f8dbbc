"""Published pages without violations of axe-core (npm): check_accessibility.py REBAKE. In .ci/deep.

The page has everything that it can show: views, keyframes, the scene before the edits; with the panel open and closed,
dark and light, wide and as on a phone.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from devtools import Browser, Server

ROOT = Path(__file__).resolve().parents[2]
EDITS = [
    {"op": "import", "path": str(ROOT / "samples/scenes/ficus"), "as": "ficus"},
    {"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}},
    {"op": "key", "node": "ficus", "time": 0},
    {"op": "key", "node": "ficus", "time": 1, "position": [0, 0.5, 0]},
]


def run(*words):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{words[0]} failed:\n{done.stdout}")


def main():
    rebake = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        at = Path(name)
        lines = [*EDITS, {"op": "publish", "out": str(at / "page"), "title": "Ficus", "poster": True,
                          "before": str(ROOT / "samples/scenes/ficus")}]
        (at / "s.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
        run(rebake, "run", at / "s.jsonl")
        run("npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", at, "axe-core")
        axe = (at / "node_modules/axe-core/axe.min.js").read_text()
        browser, server = Browser(), Server(at / "page")
        found = {}
        try:
            for scheme in ("light", "dark"):
                browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
                for width, height in ((1000, 700), (360, 640)):
                    browser.size(width, height)
                    browser.open(server.url)
                    browser.evaluate("viewer.ready.then(() => true)")
                    browser.evaluate(axe + "; true")
                    for panel in (False, True):
                        browser.evaluate(f"viewer.openPanel({json.dumps(panel)})")
                        checked = browser.evaluate("axe.run().then((r) => ({passes: r.passes.length, violations: r.violations.map("
                                                   "(v) => v.id + ': ' + v.help + ' ' + v.nodes.map((n) => n.html.slice(0, 120)).join(' | '))}))")
                        if checked["passes"] < 10:
                            sys.exit(f"axe-core checked only {checked['passes']} rules")
                        for violation in checked["violations"]:
                            found.setdefault(violation, f"{scheme}, {width}×{height}, panel {'open' if panel else 'closed'}")
        finally:
            browser.close()
            server.close()
        if found:
            sys.exit("\n".join(f"{violation} ({where})" for violation, where in found.items()))
        print("axe-core: no violations in 8 states of the page")


main()
