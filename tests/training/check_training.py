#!/usr/bin/python3
"""Trains scenes of each kind from photographs of the procedural samples, and checks what the reports say (8 minutes on two cores).

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
    ("shelf", "forward", 64, 12, ["--steps", "2500", "--near", "1.7", "--far", "4"], 20, True),
    ("courtyard", "unbounded", 64, 60, ["--steps", "2500", "--side", "48"], 20, True),
]


def main():
    program = os.path.abspath(sys.argv[1])
    photograph = os.path.join(os.path.dirname(program), "rebake_photograph")
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        for model, kind, side, views, options, least, beats_nearest in CAPTURES:
            capture, out = os.path.join(folder, model), os.path.join(folder, model + "-trained")
            subprocess.run([photograph, model, "-o", capture, "--views", str(views), "--held-out", "12", "--side", str(side)],
                           check=True, stdout=subprocess.DEVNULL)
            subprocess.run([program, "train", capture, "-o", out, "--kind", kind, *options], check=True)
            with open(os.path.join(out, "training.json")) as file:
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
