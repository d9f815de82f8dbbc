"""Derivation of a page's camera from the matrices that it gives to WebGL."""

import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "samples"))
from measure_viewer import camera_of


def column_major(rows):
    return [rows[r][c] for c in range(4) for r in range(4)]


class CameraOf(unittest.TestCase):
    def test_inverts_a_viewer_that_scales_objects(self):
        # Eye (3, 4, 0) that looks at the origin with z up, and objects scaled by 0.1.
        forward, up = (-0.6, -0.8, 0), (0, 0, 1)
        right = (-0.8, 0.6, 0)
        scale, eye = 0.1, (0.3, 0.4, 0)
        rows = [[*right], [*up], [-x for x in forward]]
        view = [[scale * x for x in row] + [-sum(a * b for a, b in zip(row, eye))] for row in rows] + [[0, 0, 0, 1]]
        near, far, fov, aspect = 0.2, 0.6, math.radians(39), 1.25
        s = 1 / math.tan(fov / 2)
        projection = [[s / aspect, 0, 0, 0], [0, s, 0, 0],
                      [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)], [0, 0, -1, 0]]
        words = camera_of({"camera": {"modelView": column_major(view), "projection": column_major(projection)}})
        options = {name: [float(x) for x in value.split(",")] for name, value in zip(words[::2], words[1::2])}
        for name, wanted in {"--eye": (3, 4, 0), "--target": (2.4, 3.2, 0), "--up": up, "--fov": (39,), "--near": (2,),
                             "--far": (6,)}.items():
            for a, b in zip(options[name], wanted, strict=True):
                self.assertAlmostEqual(a, b, places=6, msg=name)

    def test_is_unknown_without_matrices(self):
        self.assertIsNone(camera_of({"camera": None}))


if __name__ == "__main__":
    unittest.main()
