"""Photographs a Blender scene from known cameras: transforms_train.json and transforms_test.json with rendered pictures
(Cycles, transparent background), as NeRF's synthetic scenes have them. Try: rebake train FOLDER -o TRAINED.

    blender --background SCENE.blend --python samples/photograph_blend.py -- -o FOLDER [--views 100] [--held-out 20]
        [--side 128] [--samples 32]
"""
import argparse
import json
import math
import os
import sys

import bpy
from mathutils import Matrix, Vector

GOLDEN = 0.6180339887498949


def bounds():
    """Middle and radius of all visible meshes."""
    corners = [each.matrix_world @ Vector(corner) for each in bpy.context.scene.objects
               if each.type == "MESH" and not each.hide_render for corner in each.bound_box]
    if not corners:
        sys.exit("error: the scene has no visible mesh")
    low = Vector([min(c[k] for c in corners) for k in range(3)])
    high = Vector([max(c[k] for c in corners) for k in range(3)])
    return (low + high) / 2, max((high - low).length / 2, 1e-6)


def pose(middle, distance, k, count, phase):
    """A camera on the upper hemisphere; those of another phase lie between."""
    angle, up = 2 * math.pi * (k + phase) * GOLDEN, 0.05 + 0.85 * (k + 0.5) / count
    out = Vector((math.cos(angle) * math.sqrt(1 - up * up), math.sin(angle) * math.sqrt(1 - up * up), up))
    return Matrix.Translation(middle + distance * out) @ out.to_track_quat("Z", "Y").to_matrix().to_4x4()


def main():
    parser = argparse.ArgumentParser(prog="photograph_blend.py")
    parser.add_argument("-o", "--out", required=True)
    parser.add_argument("--views", type=int, default=100)
    parser.add_argument("--held-out", type=int, default=20)
    parser.add_argument("--side", type=int, default=128)
    parser.add_argument("--samples", type=int, default=32)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    if min(options.views, options.held_out, options.side, options.samples) < 1:
        sys.exit("error: numbers must be at least 1")
    if os.path.exists(options.out) and os.listdir(options.out):
        sys.exit(f"error: {options.out} exists and is not empty; choose another folder")
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = options.samples
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = options.side
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    camera = bpy.data.objects.new("photograph", bpy.data.cameras.new("photograph"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    middle, radius = bounds()
    camera.data.angle = math.radians(39)
    distance = 1.05 * radius / math.sin(camera.data.angle / 2)
    camera.data.clip_start, camera.data.clip_end = distance / 1000, 100 * distance
    for part, count, phase in (("train", options.views, 0), ("test", options.held_out, 0.5)):
        frames = []
        for k in range(count):
            camera.matrix_world = pose(middle, distance, k, count, phase)
            name = f"{part}/{k:04}"
            scene.render.filepath = os.path.join(os.path.abspath(options.out), name + ".png")
            bpy.ops.render.render(write_still=True)
            frames.append({"file_path": name, "transform_matrix": [list(row) for row in camera.matrix_world]})
        with open(os.path.join(options.out, f"transforms_{part}.json"), "w") as file:
            json.dump({"camera_angle_x": camera.data.angle, "w": options.side, "h": options.side, "frames": frames}, file, indent=1)


main()
