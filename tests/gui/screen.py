"""A window of the editor on a display of its own, its pointer and keys, and what it shows."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time

import numpy

WIDTH, HEIGHT = 1280, 800


class Screen:
    """A display. Everything the editor keeps for a person lies in `home`."""

    def __init__(self):
        self.home = pathlib.Path(tempfile.mkdtemp())
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-nolisten", "tcp",
             "-noreset", "+extension", "GLX"],  # else it begins anew when its last client ends, and may miss the next
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            self.display = ":" + pipe.readline().strip()
        self.environment = dict(os.environ, DISPLAY=self.display, HOME=str(self.home),
                                XDG_CONFIG_HOME=str(self.home / "config"), XDG_STATE_HOME=str(self.home / "state"))

    def close(self):
        self.server.terminate()
        self.server.wait()
        shutil.rmtree(self.home)


def until(what, says, seconds=20):
    """Waits for what() to be something, and returns that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := what():
            return found
        time.sleep(0.05)
    raise AssertionError("in vain: " + says)


class Editor:
    """The program with its window."""

    def __init__(self, program, screen, *paths):
        self.screen = screen
        # Python ignores SIGXFSZ, and so does the editor then: a limit of file size is an error of writing, like a full
        # disk.
        self.process = subprocess.Popen([program, "edit", *map(str, paths)], env=screen.environment, restore_signals=False)
        self.window = until(lambda: self.tool("search", "--onlyvisible", "--name", "Rebake").split(), "a window")[0]
        self.tool("windowfocus", "--sync", self.window)
        self.settle()

    def tool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.screen.environment, capture_output=True,
                              text=True).stdout

    # Pointer and keys

    def move(self, x, y):
        self.tool("mousemove", x, y)
        time.sleep(0.05)

    def click(self, x, y):
        self.drag(1, [(x, y)])

    def click_wheel(self, x, y, button):
        """4 turns it away from people, 5 towards them."""
        self.move(x, y)
        self.tool("click", button)
        time.sleep(0.05)

    def drag(self, button, points, meanwhile=lambda: None):
        """Along points, with steps between them as a hand makes."""
        self.move(*points[0])
        time.sleep(0.1)
        self.tool("mousedown", button)
        time.sleep(0.15)
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            for k in range(1, 7):
                self.move(round(x0 + (x1 - x0) * k / 6), round(y0 + (y1 - y0) * k / 6))
        meanwhile()
        time.sleep(0.15)
        self.tool("mouseup", button)
        time.sleep(0.2)

    def key(self, *keys):
        for key in keys:
            self.tool("key", key)
            time.sleep(0.15)

    def type(self, text):
        self.tool("type", "--delay", "20", text)
        time.sleep(0.2)

    def command(self, name):
        """By the palette."""
        self.key("ctrl+p")
        self.type(name)
        self.key("Return")

    def fill_disk(self, full=True):
        subprocess.run(["prlimit", f"--pid={self.process.pid}", "--fsize=" + ("16:unlimited" if full else "unlimited")],
                       check=True)

    def resize(self, width, height):
        self.tool("windowsize", "--sync", self.window, width, height)
        self.settle()

    # What is there

    def picture(self):
        """Rows of pixels, red, green and blue."""
        raw = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], env=self.screen.environment,
                             capture_output=True, check=True).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(HEIGHT, WIDTH, 3).astype(int)

    def save_picture(self, path):
        subprocess.run(["import", "-window", "root", str(path)], env=self.screen.environment, check=True)

    def settle(self):
        """Until nothing changes any more."""
        def still():
            before = self.picture()
            time.sleep(0.3)
            return (before == self.picture()).all()
        until(still, "a picture that stays")

    def find_color(self, color, near=12):
        """Middles of the spots of a colour in the viewport, largest first, as (x, y). The pointer goes aside."""
        self.move(100, 550)
        self.settle()
        picture = self.picture()[60:570, 75:950]
        mask = (abs(picture - numpy.array(color)).max(axis=2) <= near)
        spots = []
        while mask.any():
            y, x = numpy.argwhere(mask)[0]
            # What touches, by growing.
            todo, here = [(y, x)], []
            mask[y, x] = False
            while todo:
                y, x = todo.pop()
                here.append((y, x))
                for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0)):
                    j, i = y + dy, x + dx
                    if 0 <= j < mask.shape[0] and 0 <= i < mask.shape[1] and mask[j, i]:
                        mask[j, i] = False
                        todo.append((j, i))
            spots.append(here)
        spots.sort(key=len, reverse=True)
        return [tuple(int(v) for v in numpy.mean(spot, axis=0)[::-1] + [75, 60]) for spot in spots]

    def journal(self):
        """What the document did, from its journal."""
        folder = self.screen.home / "state" / "rebake" / "journals"
        files = sorted(folder.glob("*.journal")) if folder.is_dir() else []
        lines = [json.loads(line[17:]) for file in files for line in file.read_text().splitlines()]
        return [line for line in lines if "rebake_journal" not in line]

    def ops(self):
        names = []
        for line in self.journal():
            edits = line.get("edits", [line["edit"]] if "edit" in line else [])
            names += [edit["op"] for edit in edits] or ["undo" if "undo" in line else "redo"]
        return names

    def until_ops(self, *ops):
        until(lambda: self.ops() == list(ops), f"edits {ops}, not {self.ops()}")
        self.settle()

    # The end

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
