"""Rebake's mean value cages beside Blender's Mesh Deform, on the same points and cage, one after the other.

    apt-get install blender
    PYTHONPATH=build python3 samples/python/compare_with_blender.py [POINTS [PRECISION...]]

The cage is sheared and scaled. That is an affine motion, which cages should carry over exactly: what the points differ
from it by is the error. Blender binds on a grid of 2^precision cells and is given one thread, as Rebake is.
"""
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

IN_BLENDER = r"""
import json, sys, time
import bpy
import numpy as np
folder, precision = sys.argv[-2], int(sys.argv[-1])
points, vertices, moved = (np.load(f"{folder}/{name}.npy") for name in ("points", "vertices", "moved"))
faces = np.load(f"{folder}/faces.npy")
for old in list(bpy.data.objects):
    bpy.data.objects.remove(old)
def add(name, coordinates, triangles):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(coordinates.tolist(), [], triangles.tolist())
    made = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(made)
    return made
cage, soup = add("cage", vertices, faces), add("soup", points, np.zeros((0, 3), int))
modifier = soup.modifiers.new("deform", "MESH_DEFORM")
modifier.object, modifier.precision = cage, precision
bpy.context.view_layer.objects.active = soup
bpy.context.view_layer.update()
start = time.perf_counter()
bpy.ops.object.meshdeform_bind(modifier="deform")
seconds = time.perf_counter() - start
assert modifier.is_bound
cage.data.vertices.foreach_set("co", moved.astype(np.float32).ravel())
cage.data.update()
bpy.context.view_layer.update()
result = soup.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
where = np.empty(3 * len(points), np.float32)
result.vertices.foreach_get("co", where)
np.save(f"{folder}/result.npy", where.reshape(-1, 3))
json.dump({"seconds": seconds}, open(f"{folder}/result.json", "w"))
"""


def sphere(count):
    """Points on a ball's surface and a closed mesh of them: an octahedron divided `count` times, bulging."""
    vertices = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    for _ in range(count):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(vertices)
                vertices.append([(x + y) / 2 for x, y in zip(vertices[a], vertices[b])])
            return middles[key]

        faces = [
            triangle
            for a, b, c in faces
            for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
            for triangle in ([a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca])
        ]
    vertices = np.array(vertices, float)
    vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    return vertices * (1 + 0.2 * np.sin(3 * vertices[:, :1])), np.array(faces)


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200000
    precisions = [int(p) for p in sys.argv[2:]] or [4, 5]
    vertices, faces = sphere(3)
    random = np.random.default_rng(1)
    points = random.normal(size=(count, 3))
    points *= 0.7 * random.random((count, 1)) ** (1 / 3) / np.linalg.norm(points, axis=1, keepdims=True)
    linear = np.array([[1.1, 0.2, 0], [0, 0.9, 0.3], [0.1, 0, 1.2]])
    moved, wanted = vertices @ linear.T, points @ linear.T
    diagonal = np.linalg.norm(np.ptp(vertices, axis=0))

    def report(name, seconds, result):
        error = np.linalg.norm(result - wanted, axis=1).max() / diagonal
        print(f"{name:<24} {seconds:8.2f} s   largest error {error:.1e} of the cage's diagonal", flush=True)

    print(f"{count} points, a cage of {len(vertices)} points and {len(faces)} faces, one thread")
    program = "import sys, time, numpy as np, rebake\nf = sys.argv[1]\na = [np.load(f'{f}/{n}.npy') for n in ('points', 'vertices', 'faces', 'moved')]\nt = time.perf_counter()\nr = rebake.move_by_cage(*a)\nprint(time.perf_counter() - t)\nnp.save(f'{f}/result.npy', r)"
    with tempfile.TemporaryDirectory() as folder:
        for name, array in (("points", points), ("vertices", vertices), ("faces", faces), ("moved", moved)):
            np.save(f"{folder}/{name}.npy", array)
        one_core = ["taskset", "-c", "0"]
        run = subprocess.run([*one_core, sys.executable, "-c", program, folder], check=True, capture_output=True, text=True)
        report("Rebake, mean value", float(run.stdout), np.load(f"{folder}/result.npy"))
        script = Path(folder) / "bind.py"
        script.write_text(IN_BLENDER)
        for precision in precisions:
            try:
                subprocess.run(
                    [*one_core, "blender", "--background", "--factory-startup", "--threads", "1", "--python", script, "--", folder, str(precision)],
                    check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                )
            except FileNotFoundError:
                sys.exit("Blender is not installed: apt-get install blender")
            except subprocess.CalledProcessError as error:
                sys.exit(f"Blender ended with code {error.returncode}")
            seconds = json.loads((Path(folder) / "result.json").read_text())["seconds"]
            report(f"Blender, precision {precision}", seconds, np.load(f"{folder}/result.npy"))


if __name__ == "__main__":
    main()
