"""glTF files of Rebake in other programs: check_gltf.py REBAKE

Exports a scene with two objects, views and keyframes. Checks the file with the Khronos validator (npm: gltf-validator),
and compares Blender's picture of it with Rebake's: both take one sample in the middle of each pixel. In .ci/deep.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SIDE = 300
LEAST_DB, LEAST_COVERAGE = 40, 0.99
CAMERA = {"eye": [0.9, 1.2, 3.6], "target": [0.1, 0, 0], "fov": 39}
EDITS = [
    {"op": "import", "path": str(ROOT / "samples/scenes/ficus"), "as": "ficus"},
    {"op": "import", "path": str(ROOT / "samples/scenes/kettle"), "as": "kettle"},
    {"op": "transform", "node": "kettle", "translate": [0.6, -0.3, 0.7], "scale": 0.6},
    {"op": "view", "name": "front", "camera": CAMERA},
    {"op": "key", "node": "kettle", "time": 0},
    {"op": "key", "node": "kettle", "time": 1, "position": [-0.6, 0.3, 0.7], "rotation": {"axis": [0, 1, 0], "degrees": 90}},
    {"op": "key", "node": "ficus", "time": 0, "degrees": 0},
    {"op": "key", "node": "ficus", "time": 1, "degrees": 40},
    {"op": "key", "time": 0, "view": "front"},
    {"op": "key", "time": 1, "camera": {"eye": [3, 1, 1], "target": [0, 0, 0]}},
]
VALIDATE = """
const validator = require('gltf-validator'), fs = require('fs');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1]))).then((r) => console.log(JSON.stringify(r.issues)));
"""
# Debian's add-on for glTF uses a name that its NumPy no longer has.
IN_BLENDER = r"""
import sys
import numpy
numpy.bool = bool
import bpy
glb, out, side = sys.argv[-3], sys.argv[-2], int(sys.argv[-1])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=glb)
kettle, camera = bpy.data.objects["kettle"], bpy.data.objects["film camera"]
fps = bpy.context.scene.render.fps
bpy.context.scene.frame_set(fps)
print("END", [round(x, 4) for x in kettle.matrix_world.translation], [round(x, 4) for x in camera.matrix_world.translation])
print("KEYS", max(len(m.shape_keys.key_blocks) for m in bpy.data.meshes if m.shape_keys))
bpy.context.scene.frame_set(0)
scene = bpy.context.scene
scene.camera = bpy.data.objects["front"]
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.cycles.use_denoising = False
scene.cycles.pixel_filter_type = "BOX"
scene.cycles.filter_width = 0.01
scene.cycles.transparent_max_bounces = 64
scene.view_settings.view_transform = "Standard"
scene.render.film_transparent = True
scene.render.resolution_x = scene.render.resolution_y = side
scene.render.dither_intensity = 0
scene.render.image_settings.color_mode = "RGBA"
scene.render.filepath = out
bpy.ops.render.render(write_still=True)
"""


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{words[0]} failed:\n{done.stdout}")
    return done.stdout


def pixels(picture):
    """RGBA of a PNG, through OpenImageIO."""
    raw = picture.with_suffix(".raw.pnm")
    alpha = picture.with_suffix(".alpha.pnm")
    run("oiiotool", picture, "--ch", "R,G,B", "-o", raw)
    run("oiiotool", picture, "--ch", "A,A,A", "-o", alpha)

    def read(file):
        data = file.read_bytes()
        return np.frombuffer(data[-3 * SIDE * SIDE:], np.uint8).reshape(SIDE, SIDE, 3).astype(float)

    return read(raw), read(alpha)[..., 0]


def eroded(mask):
    inner = mask.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(mask, step, axis)
    return inner


def main():
    rebake = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        at = Path(name)
        (at / "s.jsonl").write_text("".join(json.dumps(line) + "\n" for line in [
            *EDITS, {"op": "export", "format": "gltf", "out": str(at / "scene.glb")},
            {"op": "save", "out": str(at / "scene")}]))
        run(rebake, "run", at / "s.jsonl")
        run(rebake, "export", at / "scene", "--format", "gltf_features", "-o", at / "full.glb")
        run("npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", at, "gltf-validator")
        for file in ("scene.glb", "full.glb"):
            issues = json.loads(run("node", "-e", VALIDATE, at / file, cwd=at))
            print(f"Khronos validator, {file}: {issues['numErrors']} errors, {issues['numWarnings']} warnings")
            if issues["numErrors"] or issues["numWarnings"]:
                sys.exit(json.dumps(issues["messages"][:5], indent=1))
        (at / "b.py").write_text(IN_BLENDER)
        said = run("blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", at / "b.py", "--", at / "scene.glb",
                   at / "blender.png", SIDE)
        end = next(line for line in said.splitlines() if line.startswith("END"))
        poses = int(next(line for line in said.splitlines() if line.startswith("KEYS")).split()[1]) - 1
        print(f"Blender: {end[4:]} after a second, {poses} poses of the bend")
        # Blender's z points up: (x, y, z) is (x, −z, y) there.
        if end != "END [-0.6, -0.7, 0.3] [3.0, -1.0, 1.0]" or poses < 3:
            sys.exit("the keyframes are not those of the scene")
        words = [word for key, value in CAMERA.items() for word in ("--" + key, ",".join(map(str, value)) if isinstance(value, list) else value)]
        run(rebake, "render", at / "scene.glb", "--samples", 1, "--transparent", "--size", f"{SIDE}x{SIDE}", "-o", at / "own.png", *words)
        (own, own_alpha), (other, other_alpha) = pixels(at / "own.png"), pixels(at / "blender.png")
        covered, there = own_alpha > 127, other_alpha > 127
        coverage = (covered & there).sum() / (covered | there).sum()
        inside = eroded(covered & there)
        db = -10 * np.log10(np.mean(((own - other)[inside] / 255) ** 2))
        print(f"Blender's picture: {db:.1f} dB over {inside.sum()} pixels inside, {100 * coverage:.2f} % of the covered pixels agree")
        if db < LEAST_DB or coverage < LEAST_COVERAGE:
            sys.exit(f"expected {LEAST_DB} dB and {LEAST_COVERAGE:.0%}")


main()
