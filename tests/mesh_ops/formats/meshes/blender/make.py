"""Makes the files of this folder with Blender 3.4: a textured cube below a red cone.

    OUT=FOLDER blender --background --factory-startup --python make.py
"""
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
out = os.environ["OUT"]
image = bpy.data.images.new("checker", 8, 8)
image.pixels = [value for y in range(8) for x in range(8) for value in (x / 7, y / 7, 0.5, 1.0)]
image.filepath_raw = out + "/checker.png"
image.file_format = "PNG"
image.save()


def material(name):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    return made, made.node_tree.nodes["Principled BSDF"].inputs["Base Color"]


painted, color = material("painted wood")
texture = painted.node_tree.nodes.new("ShaderNodeTexImage")
texture.image = bpy.data.images.load(out + "/checker.png")
painted.node_tree.links.new(texture.outputs["Color"], color)
bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1))
bpy.context.object.data.materials.append(painted)
red, color = material("red")
color.default_value = (1, 0, 0, 1)
bpy.ops.mesh.primitive_cone_add(vertices=5, radius1=1, depth=2, location=(0, 0, 3))
bpy.context.object.data.materials.append(red)
bpy.context.object.rotation_euler = (0, 0, 0.5)
bpy.ops.export_scene.gltf(filepath=out + "/blender.glb", export_format="GLB")
bpy.ops.export_scene.obj(filepath=out + "/blender.obj", path_mode="COPY")
bpy.ops.export_mesh.ply(filepath=out + "/blender.ply", use_ascii=False)
