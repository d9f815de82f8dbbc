"""glTF files of Rebake in other programs: check_gltf.py REBAKE

Exports a scene with two objects, views and keyframes, plain and compressed. Checks the files with the Khronos validator
(npm: gltf-validator; meshopt compression in decompressed form), and compares the pictures of Blender and three.js with
Rebake's of the same file: all take one sample in the middle of each pixel. In .ci/deep.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/browser"))
from devtools import Browser, Server  # noqa: E402

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
# The file with its buffer views decompressed, for the validator, which does not read EXT_meshopt_compression.
DECOMPRESS = """
import {MeshoptDecoder} from 'meshoptimizer';
import fs from 'fs';
await MeshoptDecoder.ready;
const file = fs.readFileSync(process.argv[2]), length = file.readUInt32LE(12);
const root = JSON.parse(file.subarray(20, 20 + length).toString()), binary = file.subarray(28 + length);
const parts = [];
let size = 0;
for (const view of root.bufferViews) {
  const packed = view.extensions?.EXT_meshopt_compression;
  const from = (packed ?? view).byteOffset ?? 0;
  let bytes = binary.subarray(from, from + (packed ?? view).byteLength);
  if (packed) {
    const target = new Uint8Array(packed.count * packed.byteStride);
    MeshoptDecoder.decodeGltfBuffer(target, packed.count, packed.byteStride, bytes, packed.mode, packed.filter ?? 'NONE');
    bytes = target;
    delete view.extensions;
  }
  Object.assign(view, {buffer: 0, byteOffset: size, byteLength: bytes.length});
  parts.push(bytes, Buffer.alloc((4 - bytes.length % 4) % 4));
  size += Math.ceil(bytes.length / 4) * 4;
}
root.buffers = [{byteLength: size}];
for (const list of ['extensionsUsed', 'extensionsRequired'])
  if (root[list]) root[list] = root[list].filter((name) => name != 'EXT_meshopt_compression');
if (root.extensionsRequired?.length === 0) delete root.extensionsRequired;
let text = Buffer.from(JSON.stringify(root));
text = Buffer.concat([text, Buffer.alloc((4 - text.length % 4) % 4, 32)]);
const head = Buffer.alloc(20), body = Buffer.alloc(8);
head.write('glTF');
head.writeUInt32LE(2, 4);
head.writeUInt32LE(28 + text.length + size, 8);
head.writeUInt32LE(text.length, 12);
head.write('JSON', 16);
body.writeUInt32LE(size);
body.write('BIN\\0', 4);
fs.writeFileSync(process.argv[3], Buffer.concat([head, text, body, ...parts]));
"""
IN_THREE = """<!doctype html><body><canvas></canvas><script type="importmap">
{"imports": {"three": "./node_modules/three/build/three.module.js", "three/addons/": "./node_modules/three/examples/jsm/"}}
</script><script type="module">
import * as THREE from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {MeshoptDecoder} from 'three/addons/libs/meshopt_decoder.module.js';
window.draw = async (file, side, camera) => {
  const renderer = new THREE.WebGLRenderer({canvas: document.querySelector('canvas'), alpha: true, preserveDrawingBuffer: true});
  renderer.setPixelRatio(1);
  renderer.setSize(side, side);
  renderer.setClearColor(0, 0);
  const loader = new GLTFLoader();
  loader.setMeshoptDecoder(MeshoptDecoder);
  const {scene, animations} = await loader.loadAsync(file);
  const eye = new THREE.PerspectiveCamera(camera.fov, 1, 0.05, 100);
  eye.position.set(...camera.eye);
  eye.lookAt(...camera.target);
  renderer.render(scene, eye);
  const gl = renderer.getContext(), pixels = new Uint8Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return {pixels: Array.from(pixels), tracks: animations[0].tracks.length, morphs: Math.max(...(() => {
    const counts = [0];
    scene.traverse((node) => counts.push(node.morphTargetInfluences?.length ?? 0));
    return counts;
  })())};
};
</script>"""
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


def check(name, own, other):
    """Compares pictures, each with its coverage, with those of Rebake."""
    (own, own_alpha), (other, other_alpha) = own, other
    covered, there = own_alpha > 127, other_alpha > 127
    coverage = (covered & there).sum() / (covered | there).sum()
    inside = eroded(covered & there)
    db = -10 * np.log10(np.mean(((own - other)[inside] / 255) ** 2))
    print(f"{name}: {db:.1f} dB over {inside.sum()} pixels inside, {100 * coverage:.2f} % of the covered pixels agree")
    if db < LEAST_DB or coverage < LEAST_COVERAGE:
        sys.exit(f"expected {LEAST_DB} dB and {LEAST_COVERAGE:.0%}")


def validate(at):
    for file in ("scene.glb", "full.glb", "webp.glb", "small.glb"):
        checked = at / file
        if file == "small.glb":
            checked = at / "decompressed.glb"
            (at / "decompress.mjs").write_text(DECOMPRESS)
            run("node", at / "decompress.mjs", at / file, checked, cwd=at)
        issues = json.loads(run("node", "-e", VALIDATE, checked, cwd=at))
        print(f"Khronos validator, {file}: {issues['numErrors']} errors, {issues['numWarnings']} warnings, "
              f"{(at / file).stat().st_size / 1e6:.2f} MB")
        if issues["numErrors"] or issues["numWarnings"]:
            sys.exit(json.dumps(issues["messages"][:5], indent=1))


def check_in_blender(at, own):
    (at / "b.py").write_text(IN_BLENDER)
    # Blender takes modules from the first python3 of PATH; Debian's has NumPy.
    debian = {**os.environ, "PATH": f"/usr/bin:{os.environ['PATH']}"}
    said = run("blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", at / "b.py", "--", at / "scene.glb",
               at / "blender.png", SIDE, env=debian)
    end = next(line for line in said.splitlines() if line.startswith("END"))
    poses = int(next(line for line in said.splitlines() if line.startswith("KEYS")).split()[1]) - 1
    print(f"Blender: {end[4:]} after a second, {poses} poses of the bend")
    # Blender's z points up: (x, y, z) is (x, −z, y) there.
    if end != "END [-0.6, -0.7, 0.3] [3.0, -1.0, 1.0]" or poses < 3:
        sys.exit("the keyframes are not those of the scene")
    check("Blender's picture", own, pixels(at / "blender.png"))


def check_in_three(at, own):
    (at / "index.html").write_text(IN_THREE)
    browser, server = Browser(), Server(at)
    try:
        for file in ("scene.glb", "small.glb"):
            browser.open(server.url)
            browser.evaluate("new Promise((done) => { const wait = () => window.draw ? done(true) : setTimeout(wait, 20); wait(); })")
            drawn = browser.evaluate(f"draw({json.dumps(file)}, {SIDE}, {json.dumps(CAMERA)})")
            rows = np.array(drawn["pixels"], float).reshape(SIDE, SIDE, 4)[::-1]
            if drawn["tracks"] < 5 or drawn["morphs"] < 3:
                sys.exit(f"three.js found {drawn['tracks']} tracks and {drawn['morphs']} poses")
            check(f"three.js' picture of {file}", own, (rows[..., :3], rows[..., 3]))
    finally:
        browser.close()
        server.close()


def main():
    rebake = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        at = Path(name)
        exports = [{"op": "export", "format": "gltf", "out": str(at / out), **more} for out, more in (
            ("scene.glb", {}), ("webp.glb", {"compress": ["webp"]}), ("small.glb", {"compress": ["quantized", "meshopt"]}))]
        (at / "s.jsonl").write_text("".join(json.dumps(line) + "\n" for line in [
            *EDITS, *exports, {"op": "save", "out": str(at / "scene")}]))
        run(rebake, "run", at / "s.jsonl")
        run(rebake, "export", at / "scene", "--format", "gltf_features", "-o", at / "full.glb")
        run("npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", at, "gltf-validator", "meshoptimizer", "three")
        validate(at)
        words = [word for key, value in CAMERA.items() for word in ("--" + key, ",".join(map(str, value)) if isinstance(value, list) else value)]
        run(rebake, "render", at / "scene.glb", "--samples", 1, "--transparent", "--size", f"{SIDE}x{SIDE}", "-o", at / "own.png", *words)
        own = pixels(at / "own.png")
        check_in_three(at, own)
        check_in_blender(at, own)


main()
