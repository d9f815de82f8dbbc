"""What all tests of the window share: an editor that is open, and ways to say what is seen of it."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

from screen import Editor, Screen

PROGRAM = sys.argv.pop(1)
HERE = pathlib.Path(__file__).resolve().parent
FICUS = HERE.parents[1] / "samples" / "scenes" / "ficus"
KETTLE = FICUS.parent / "kettle"
# Shares of the viewport: around the branch that goes to the right.
BRANCH = [(0.57, 0.22), (0.78, 0.22), (0.78, 0.46), (0.62, 0.46), (0.57, 0.38)]


def green(picture):
    """Which pixels are leaves: green, and not the green of an axis."""
    return (picture[..., 1] > picture[..., 0] + 20) & (picture[..., 1] > picture[..., 2] + 20) & (picture[..., 1] < 190)


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
        """With the lasso; how many triangles."""
        editor = self.editor
        editor.key("l")
        corners = [editor.in_viewport(*corner) for corner in BRANCH]
        editor.drag(corners + corners[:1])
        return editor.state()["selected"]

    def expect_like(self, name, decibels):
        """The whole window against a kept picture. Without the tint, or without the grid, it is at 30 dB, without the
        leaves at 23; 40 leaves room for rounding of another processor."""
        kept, seen = HERE / "pictures" / (name + ".png"), self.folder / (name + ".png")
        self.editor.settle()
        self.editor.save_picture(seen)
        result = subprocess.run([PROGRAM, "compare", kept, seen, "--min-psnr", str(decibels)], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, f"{result.stdout}{result.stderr} (seen: {seen})")

    def program(self, name, script):
        """A program of that name that the editor finds before any other."""
        folder = self.folder / "programs"
        folder.mkdir(exist_ok=True)
        (folder / name).write_text("#!/bin/sh\n" + script)
        (folder / name).chmod(0o755)
        self.screen.environment["PATH"] = f"{folder}:{self.screen.environment['PATH']}"
