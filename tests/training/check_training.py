#!/usr/bin/python3
"""Trains scenes of each kind from photographs of the procedural samples, and checks what the reports say (12 minutes on two cores).

    tests/training/check_training.py build/rebake
"""
import json
import os
import subprocess
import sys
import tempfile

# Model, kind, side of the photographs, training photographs, options, least PSNR in dB, whether the nearest photograph is beaten by 3 dB.
CAPTURES = [
    ("ficus", "object", 128, 100, ["--steps", "3500"], 24, True),
    ("kettle", "object", 128, 100, ["--steps", "3500"], 24, True),
    ("shelf", "forward", 128, 16, ["--steps", "7000", "--side", "48", "--near", "1.7", "--far", "4"], 24, True),
    ("blend", "object", 64, 48, ["--steps", "3000"], 24, False),
    ("courtyard", "unbounded", 64, 60, ["--steps", "2500", "--side", "48"], 20, True),
]


# A scene for Blender: a head on a disk.
BLEND = """
import bpy
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
bpy.ops.mesh.primitive_monkey_add(size=1.6)
bpy.ops.mesh.primitive_cylinder_add(radius=0.9, depth=0.15, location=(0, 0, -0.95))
for k, color in enumerate([(0.7, 0.25, 0.1, 1), (0.15, 0.3, 0.6, 1)]):
    material = bpy.data.materials.new(str(k))
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
    bpy.data.objects[("Suzanne", "Cylinder")[k]].data.materials.append(material)
bpy.ops.object.light_add(type="SUN", rotation=(0.7, 0.3, 0))
bpy.ops.wm.save_as_mainfile(filepath="OUT")
"""


def photograph(program, model, side, views, out):
    """Photographs of a procedural sample, or of the scene above by Blender."""
    words = ["-o", out, "--views", str(views), "--held-out", "12", "--side", str(side)]
    if model != "blend":
        return subprocess.run([os.path.join(os.path.dirname(program), "rebake_photograph"), model, *words], check=True,
                              stdout=subprocess.DEVNULL)
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../samples/photograph_blend.py")
    subprocess.run(["blender", "--background", "--python-exit-code", "1", "--python-expr", BLEND.replace("OUT", out + ".blend")],
                   check=True, stdout=subprocess.DEVNULL)
    return subprocess.run(["blender", "--background", out + ".blend", "--python-exit-code", "1", "--python", script, "--", *words],
                          check=True, stdout=subprocess.DEVNULL)


def main():
    program = os.path.abspath(sys.argv[1])
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        for model, kind, side, views, options, least, beats_nearest in CAPTURES:
            capture, out = os.path.join(folder, model), os.path.join(folder, model + "-trained")
            photograph(program, model, side, views, capture)
            subprocess.run([program, "train", capture, "-o", out, "--kind", kind, *options], check=True)
            with open(os.path.join(out, "rebake_training.json")) as file:
                report = json.load(file)
            judged = report["held out"]
            psnr = judged["PSNR dB"]
            print(f"{model}: {json.dumps(judged)} in {report['minutes']:.1f} minutes", flush=True)

            def expect(holds, what):
                if not holds:
                    failures.append(f"{model}: {what}")

            expect(psnr >= least, f"{psnr} dB is less than {least} dB")
            expect(abs(psnr - judged["before baking PSNR dB"]) <= 0.5, "baking changes the PSNR by more than 0.5 dB")
            expect(psnr >= judged["mean colour PSNR dB"] + 3, "does not beat the mean colour by 3 dB")
            expect(not beats_nearest or psnr >= judged["nearest photograph PSNR dB"] + 3, "does not beat the nearest photograph by 3 dB")
            boxes = any(line.startswith("nested boxes: none") for line in report["plan"])
            expect(boxes == (kind != "unbounded"), "nested boxes are for unbounded scenes only")
    for failure in failures:
        print("FAILED", failure)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
