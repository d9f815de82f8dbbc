"""Screenshots of the window for review: shots.py PROGRAM FOLDER [LOOKS] [SCALE] writes a picture of each panel and
dialog, light and dark, at scale 1 and 2, and overviews of all of them (overview-LOOKS-SCALE.png)."""

import pathlib
import subprocess
import sys

from screen import Editor, Screen, until

PROGRAM, OUT = sys.argv[1], pathlib.Path(sys.argv[2])
SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples" / "scenes"
BRANCH = [(0.57, 0.22), (0.78, 0.22), (0.78, 0.46), (0.62, 0.46), (0.57, 0.38)]


def shots(looks, scale):
    screen = Screen(1280 * scale, 800 * scale)
    try:
        take(screen, looks, scale)
    finally:
        screen.close()


def take(screen, looks, scale):
    screen.settings(looks=looks, text_scale=scale, window_width=1280 * scale, window_height=800 * scale)
    taken = []

    def shot(name, over="viewport"):
        editor.move(*editor.where(over))
        editor.settle()
        file = OUT / f"{looks}-{scale}x-{len(taken):02}-{name}.png"
        editor.save_picture(file)
        taken.append(file)

    editor = Editor(PROGRAM, screen)
    shot("empty")
    editor.key("ctrl+o")
    editor.click("dialog/Samples")
    shot("open")
    editor.double_click(*editor.where("dialog/entries/ficus"))
    editor.until_ops("import")
    shot("opened")
    shot("tooltip", over="tool/Lasso")
    for menu in ("File", "Edit", "View", "Window"):
        editor.click("menu/" + menu)
        shot("menu-" + menu.lower())
        editor.key("Escape")
    editor.key("l", "t")
    corners = [editor.in_viewport(*corner) for corner in BRANCH]
    editor.drag(corners + corners[:1])
    shot("selected")
    editor.key("n")
    shot("bend")
    x, y = editor.where("bend/tip")
    editor.drag([(x, y), (x, y - 60 * scale)])
    shot("bent")
    editor.key("c")
    editor.click("options/make-cage")
    shot("cage")
    editor.key("Escape", "Escape", "ctrl+shift+a", "k")
    editor.click(*editor.in_viewport(0.45, 0.72))
    editor.click("options/drag")
    editor.click(*editor.in_viewport(0.38, 0.3))
    x, y = editor.where("handle/1")
    editor.drag([(x, y), (x, y - 50 * scale)])
    shot("handles")
    editor.key("Escape", "2")
    editor.key("ctrl+shift+a")
    shot("turn")
    editor.key("1")
    shot("move")
    editor.key("u")
    shot("volume")
    editor.key("v")
    editor.command("store view")
    editor.click("status/Views")
    shot("views")
    editor.click("tabs/light")
    editor.click("tabs/light/follows-edits")
    shot("light")
    editor.click("tabs/Close")
    editor.click("status/History")
    shot("history")
    editor.click("tabs/script")
    shot("script")
    editor.click("tabs/cost")
    editor.click("tabs/cost/measure")
    shot("cost")
    shot("error", over="tabs/cost/chart/4 samples")
    editor.click("tabs/messages")
    shot("messages")
    editor.click("tabs/Close")
    editor.key("ctrl+p")
    editor.type("select")
    shot("palette")
    editor.key("Escape")
    editor.command("bend by")
    shot("form")
    editor.key("Escape", "F1")
    shot("keys")
    editor.key("Escape", "ctrl+e")
    shot("export")
    editor.click("dialog/plain")
    editor.click("dialog/compare")
    until(lambda: "dialog/plain/wipe" in editor.state()["items"], "the comparison", 60)
    until(lambda: editor.state()["settled"], "its picture", 60)
    shot("plain")
    editor.key("Escape", "Escape")
    editor.command("turntable")
    shot("turntable")
    editor.key("Escape")
    editor.click(*editor.where("outline/ficus/name"), button=3)
    shot("context")
    editor.key("Escape", "ctrl+q")
    shot("quit")
    editor.key("Escape")
    editor.command("run script")
    editor.answer("/nowhere/script.jsonl")
    shot("failure")
    editor.key("Escape", "y")
    shot("wipe")
    editor.key("y", "ctrl+space")
    shot("alone")
    editor.kill()
    subprocess.run(["montage", *taken, "-geometry", "640x400+6+6", "-tile", "4x", "-background", "#808080",
                    str(OUT / f"overview-{looks}-{scale}x.png")], check=True)


OUT.mkdir(parents=True, exist_ok=True)
for looks in sys.argv[3:4] or ("dark", "light"):
    for scale in map(int, sys.argv[4:5] or ("1", "2")):
        shots(looks, scale)
