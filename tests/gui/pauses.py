"""Measures how long the window does not draw during jobs on a scene: pauses.py PROGRAM SCENE. Prints the longest pause
of each job in milliseconds, and the job's duration in seconds, until the picture is at rest."""

import sys
import time

from screen import Editor, Screen

PROGRAM, SCENE = sys.argv[1:3]
REGION = [(0.30, 0.30), (0.50, 0.30), (0.50, 0.50), (0.30, 0.50)]


def job(name, do):
    editor.key("shift+F11")  # unassigned key: pauses are measured from here
    begun = time.monotonic()
    do()
    state = editor.settle()
    print(f"{name:24} {state['longest_pause_ms']:6} ms {time.monotonic() - begun:6.1f} s", flush=True)


def lasso():
    corners = [editor.in_viewport(*corner) for corner in REGION]
    editor.drag(corners + corners[:1])


def bend():
    x, y = editor.where("bend/tip")
    editor.drag([(x, y), (x + 30, y + 30)])


screen = Screen()
begun = time.monotonic()
editor = Editor(PROGRAM, screen, SCENE)
editor.until_ops("import")
print(f"{'load':24} {editor.settle()['longest_pause_ms']:6} ms {time.monotonic() - begun:6.1f} s", flush=True)
job("turn the view", lambda: editor.drag([editor.in_viewport(0.3, 0.7), editor.in_viewport(0.6, 0.5)], button=2))
editor.key("l")
job("lasso", lasso)
job("find the spine", lambda: editor.key("n"))
job("bend", bend)
job("delete", lambda: editor.key("Delete"))
job("undo", lambda: editor.key("ctrl+z"))
job("redo", lambda: editor.key("ctrl+y"))
editor.kill()
screen.close()
