"""Base of all window tests: an open editor, and measurements of its picture."""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

from screen import Editor, Screen

PROGRAM = sys.argv.pop(1)
HERE = pathlib.Path(__file__).resolve().parent
FICUS = HERE.parents[1] / "samples" / "scenes" / "ficus"
KETTLE = FICUS.parent / "kettle"
# A polygon around the branch on the right, in shares of the viewport.
BRANCH = [(0.57, 0.22), (0.78, 0.22), (0.78, 0.46), (0.62, 0.46), (0.57, 0.38)]


def green(picture):
    """Mask of the pixels that show leaves: green, but not the green of an axis."""
    return (picture[..., 1] > picture[..., 0] + 20) & (picture[..., 1] > picture[..., 2] + 20) & (picture[..., 1] < 190)


def write_png(path, rows):
    """Writes an RGBA PNG; rows of (red, green, blue, alpha)."""
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 6, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def write_square(folder, sign):
    """Writes a MobileNeRF folder of two triangles with 17 x 17 opaque texels, which is fitted quickly. Decoders of
    different signs have nothing in common."""
    folder.mkdir()
    unit = lambda rows, columns, value=1: [[value if j == k else 0 for k in range(columns)] for j in range(rows)]
    (folder / "mlp.json").write_text(json.dumps({
        "0_weights": unit(11, 16), "1_weights": unit(16, 16), "2_weights": unit(16, 3, sign),
        "0_bias": [0] * 16, "1_bias": [0] * 16, "2_bias": [0] * 3, "obj_num": 1}))
    texels = [[(100, 150, 200, 200) if x < 17 and y < 17 else (0, 0, 0, 128) for x in range(64)] for y in range(64)]
    for k in range(2):
        write_png(folder / f"shape0.pngfeat{k}.png", texels)
    low, high = 0.0078125, 0.2578125
    (folder / "shape0.obj").write_text(
        "v -1 1 0\nv -1 -1 0\nv 1 1 0\nv 1 -1 0\n"
        f"vt {low} {1 - low}\nvt {low} {1 - high}\nvt {high} {1 - low}\nvt {high} {1 - high}\n"
        "f 1/1 2/2 4/4\nf 1/1 4/4 3/3\n")
    return folder


class WindowCase(unittest.TestCase):
    def setUp(self):
        self.screen = Screen()
        self.editor = None
        self.folder = pathlib.Path(tempfile.mkdtemp())

    def tearDown(self):
        if self.editor and self.editor.process.poll() is None:
            self.editor.kill()
        self.screen.close()

    def open(self, *paths):
        self.editor = Editor(PROGRAM, self.screen, *paths)
        return self.editor

    def open_ficus(self):
        editor = self.open(FICUS)
        editor.until_ops("import")
        return editor

    def leaves(self):
        return int(green(self.editor.viewport()).sum())

    def select_branch(self):
        """Selects the branch with the lasso; returns the number of triangles."""
        editor = self.editor
        editor.key("l")
        corners = [editor.in_viewport(*corner) for corner in BRANCH]
        editor.drag(corners + corners[:1])
        return editor.state()["selected"]

    def expect_like(self, name, decibels):
        """Compares the whole window with a reference picture. Without the tint or the grid it has 30 dB, without the
        leaves 23 dB; 40 dB allows for rounding on other processors."""
        kept, seen = HERE / "pictures" / (name + ".png"), self.folder / (name + ".png")
        self.editor.settle()
        self.editor.save_picture(seen)
        result = subprocess.run([PROGRAM, "compare", kept, seen, "--min-psnr", str(decibels)], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, f"{result.stdout}{result.stderr} (seen: {seen})")

    def program(self, name, script):
        """Installs a shell script under this name at the start of the editor's PATH."""
        folder = self.folder / "programs"
        folder.mkdir(exist_ok=True)
        (folder / name).write_text("#!/bin/sh\n" + script)
        (folder / name).chmod(0o755)
        self.screen.environment["PATH"] = f"{folder}:{self.screen.environment['PATH']}"
