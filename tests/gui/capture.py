"""Makes the README's pictures of the editor: capture.py PROGRAM FOLDER writes window.png and window.gif there."""

import pathlib
import subprocess
import sys
import tempfile

from screen import Editor, Screen

PROGRAM, OUT = sys.argv[1], pathlib.Path(sys.argv[2])
FICUS = pathlib.Path(__file__).resolve().parents[2] / "samples" / "scenes" / "ficus"
LEAVES = [(570, 170), (640, 150), (700, 180), (690, 280), (600, 290), (560, 230)]

screen = Screen()
frames = pathlib.Path(tempfile.mkdtemp())
count = 0


def frame(times=1):
    global count
    for _ in range(times):
        editor.save_picture(frames / f"{count:03}.png")
        count += 1


class Filmed(Editor):
    """Takes a picture at every other move of a drag."""

    moves = 0

    def move(self, x, y):
        super().move(x, y)
        self.moves += 1
        if self.moves % 2 == 0:
            frame()


editor = Filmed(PROGRAM, screen, FICUS)
editor.until_ops("import")
frame(3)
editor.drag(2, [(400, 500), (440, 480)])
editor.key("l")
editor.drag(1, LEAVES + LEAVES[:1])
editor.settle()
frame(4)
editor.key("Delete")
editor.settle()
frame(5)
editor.key("ctrl+z", "c")
editor.click(475, 38)
editor.settle()
frame(3)
points = editor.find_color((120, 190, 255))
top = max(points, key=lambda p: p[0] - p[1])
editor.drag(1, [top, (top[0] + 20, top[1] - 50), (top[0] - 40, top[1] - 90)])
frame(4)
editor.settle()
editor.save_picture(OUT / "window.png")
editor.key("Return")
editor.settle()
frame(6)
editor.kill()
screen.close()
subprocess.run(["convert", "-delay", "14", "-loop", "0", *sorted(map(str, frames.glob("*.png"))), "-resize", "40%",
                "-colors", "64", "+dither", "-layers", "OptimizeTransparency", str(OUT / "window.gif")], check=True)
