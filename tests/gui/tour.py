"""Plays a new user's first minutes with real events: tour.py PROGRAM FOLDER prints the number of clicks and keys, and
writes the README's window.png and window.gif to the folder."""

import os
import pathlib
import subprocess
import sys
import tempfile

from screen import Editor, Screen

PROGRAM, OUT = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
MOST_ACTIONS = 40
# Polygons around the branch on the right and the one on the left, in shares of the viewport.
RIGHT = [(0.57, 0.22), (0.78, 0.22), (0.78, 0.46), (0.62, 0.46), (0.57, 0.38)]
LEFT = [(0.23, 0.16), (0.40, 0.16), (0.43, 0.27), (0.43, 0.38), (0.23, 0.38)]
RIM = (0.37, 0.60)

frames = pathlib.Path(tempfile.mkdtemp())
count = 0


def frame(times=1):
    global count
    for _ in range(times):
        editor.save_picture(frames / f"{count:04}.png")
        count += 1


class Filmed(Editor):
    """An editor that takes a picture at every third move of the pointer."""

    moves = 0

    def move(self, x, y):
        super().move(x, y)
        self.moves += 1
        if self.moves % 3 == 0:
            frame()


def lasso(corners):
    points = [editor.in_viewport(*corner) for corner in corners]
    editor.drag(points + points[:1])
    editor.settle()
    frame(4)


OUT.mkdir(parents=True, exist_ok=True)
work = tempfile.mkdtemp()
os.chdir(work)  # working folder for exports
screen = Screen()
editor = Filmed(PROGRAM, screen)
frame(6)

# Open a sample.
editor.click("start/samples/ficus")
editor.until_ops("import")
frame(5)
# Select a branch through the whole depth, and bend it twice.
editor.key("l", "t")
lasso(RIGHT)
editor.key("n")
for dx, dy in ((-10, -70), (-60, -60)):
    x, y = editor.where("bend/tip")
    editor.drag([(x, y), (x + dx // 2, y + dy // 2), (x + dx, y + dy)])
    frame(4)
editor.save_picture(OUT / "window.png")
# Delete another branch.
editor.key("l")
lasso(LEFT)
editor.key("Delete")
frame(5)
# Place the kettle on the pot's rim.
editor.key("ctrl+o")
editor.click("dialog/Samples")
frame(3)
editor.double_click(*editor.where("dialog/entries/kettle"))
editor.until(lambda state: state["picked"] == ["kettle"], "the kettle")
frame(4)
editor.key("3")
x, y = editor.where("gizmo/middle")
editor.drag([(x, y), (x - 20, y)], meanwhile=lambda: editor.key("0", "period", "2", "5"))
editor.key("1", "m")
x, y = editor.where("gizmo/middle")
editor.drag([(x, y), editor.in_viewport(*RIM)])
frame(6)
# Compare before and after with the wipe.
editor.key("y")
x, y = editor.where("wipe")
editor.drag([(x, y), (x - 200, y), (x + 150, y)])
editor.key("y")
# Export under the proposed name, and open the export.
editor.key("ctrl+e")
frame(3)
editor.key("Return")
exported = pathlib.Path(work) / "ficus-edited"
editor.until(lambda state: exported.is_dir(), "the export")
frame(4)
actions = editor.clicks + editor.strokes
editor.kill()
screen.close()
screen = Screen()
editor = Filmed(PROGRAM, screen, exported)
editor.until_ops("import")
frame(6)
editor.kill()
screen.close()
subprocess.run(["convert", "-delay", "12", "-loop", "0", *sorted(map(str, frames.glob("*.png"))), "-resize", "600x",
                "-colors", "64", "+dither", "-layers", "OptimizeTransparency", str(OUT / "window.gif")], check=True)
print(f"{actions} clicks and keys")
sys.exit(actions > MOST_ACTIONS)
