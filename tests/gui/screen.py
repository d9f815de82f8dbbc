"""A window of the editor on its own display: pointer and key events, and its picture.

The editor announces the state of each frame (REBAKE_ANNOUNCE, see README.md in this folder): positions of clickable
items, the selection, and whether all work is finished. So tests know neither positions of buttons nor durations."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import numpy

WIDTH, HEIGHT = 1280, 800
PATIENCE = 180  # timeout in seconds, for a busy machine


class Screen:
    """An X display, and `home`, a temporary home folder for the editor's files."""

    def __init__(self, width=WIDTH, height=HEIGHT):
        self.width, self.height = width, height
        self.editors = []  # editor processes on this display
        self.home = pathlib.Path(tempfile.mkdtemp())
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp",
             "-noreset", "+extension", "GLX"],  # otherwise it restarts after its last client, and may miss the next one
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            self.display = ":" + pipe.readline().strip()
        self.environment = dict(os.environ, DISPLAY=self.display, HOME=str(self.home),
                                XDG_CONFIG_HOME=str(self.home / "config"), XDG_CACHE_HOME=str(self.home / "cache"), XDG_STATE_HOME=str(self.home / "state"),
                                REBAKE_ANNOUNCE=str(self.home / "announced"))

    def settings(self, **values):
        """Writes the editor's settings file; call before the editor starts."""
        file = self.home / "config/rebake/settings.json"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps({"window_width": self.width, "window_height": self.height, **values}))

    def close(self):
        for editor in self.editors:
            if editor.poll() is None:
                editor.kill()
                editor.wait()
        self.server.terminate()
        self.server.wait()
        shutil.rmtree(self.home)


def until(what, says, seconds=PATIENCE):
    """Waits until what() is true and returns its value; `says` describes it in the error."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := what():
            return found
        time.sleep(0.02)
    raise AssertionError("in vain: " + says)


def read_picture(file):
    """Pixels of a picture file: [row][column][red, green, blue]."""
    size = subprocess.run(["identify", "-format", "%w %h", file], capture_output=True, text=True, check=True).stdout
    width, height = map(int, size.split())
    raw = subprocess.run(["convert", file, "-depth", "8", "rgb:-"], capture_output=True, check=True).stdout
    return numpy.frombuffer(raw, numpy.uint8).reshape(height, width, 3).astype(int)


class Editor:
    """The program with its window; methods send input and wait until it was processed."""

    def __init__(self, program, screen, *paths):
        self.screen = screen
        pipe = screen.home / "announced"
        if not pipe.exists():
            os.mkfifo(pipe)
        self.latest = {}
        self.listener = threading.Thread(target=self.listen, args=(pipe,), daemon=True)
        self.listener.start()
        if not (screen.home / "config/rebake/settings.json").exists():
            screen.settings()
        # Python ignores SIGXFSZ, and the editor inherits that: beyond a file size limit, writes fail as on a full disk.
        self.process = subprocess.Popen([program, "edit", *map(str, paths)], env=screen.environment, restore_signals=False)
        screen.editors.append(self.process)
        self.clicks = self.strokes = 0
        self.window = until(lambda: self.tool("search", "--onlyvisible", "--name", "Rebake").split(), "a window")[0]
        self.tool("windowfocus", "--sync", self.window)
        self.settle()

    def tool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.screen.environment, capture_output=True,
                              text=True).stdout

    # Announced state

    def listen(self, pipe):
        with open(pipe) as lines:
            for line in lines:
                self.latest = json.loads(line)

    def state(self):
        """State of the last frame; empty before the first."""
        return self.latest

    def settle(self):
        """Waits until all input was processed and no job runs; returns the state."""
        return until(lambda: (state := self.state()).get("settled") and state, "settled")

    def until(self, what, says):
        """Waits until what(state) is true in a settled frame; returns the state."""
        return until(lambda: (state := self.state()).get("settled") and what(state) and state, says)

    def where(self, item):
        """Centre of the item that is announced under this name."""
        x, y, width, height = until(lambda: self.state().get("items", {}).get(item), item)
        return round(x + width / 2), round(y + height / 2)

    def items(self, part):
        return {name[len(part) + 1:]: box for name, box in self.state()["items"].items() if name.startswith(part + "/")}

    def seen(self, kind):
        return self.state()["input"][kind]

    def counted(self, kind, more, act):
        """Calls act() and waits until the editor has processed `more` events of this kind."""
        wanted = self.seen(kind) + more
        act()
        until(lambda: self.seen(kind) >= wanted, f"{more} more {kind}")

    # Pointer and keys

    def move(self, x, y):
        self.tool("mousemove", x, y)
        until(lambda: self.seen("pointer") == [x, y], f"the pointer at {x}, {y}")

    def press(self, button=1, down=True):
        self.counted("buttons", 1, lambda: self.tool("mousedown" if down else "mouseup", button))
        self.clicks += down

    def click(self, where, y=None, button=1, held=None):
        """Clicks a point or a named item, optionally with a key held."""
        x, y = self.where(where) if y is None else (where, y)
        self.move(x, y)
        if held:
            self.counted("keys", 1, lambda: self.tool("keydown", held))
        self.press(button)
        self.press(button, down=False)
        if held:
            self.counted("keys", 1, lambda: self.tool("keyup", held))
        self.settle()

    def double_click(self, x, y):
        self.move(x, y)
        self.counted("buttons", 4, lambda: self.tool("click", "--repeat", 2, "--delay", 60, 1))
        self.clicks += 2
        self.settle()

    def wheel(self, x, y, away):
        """Turns the wheel by one notch."""
        self.move(x, y)
        self.counted("wheel", 1, lambda: self.tool("click", 4 if away else 5))
        self.settle()

    def drag(self, points, button=1, meanwhile=lambda: None, held=None):
        """Drags along points with small steps, optionally with a key held; meanwhile() runs before the release."""
        self.move(*points[0])
        if held:
            self.counted("keys", 1, lambda: self.tool("keydown", held))
        self.press(button)
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            for k in range(1, 7):
                self.move(round(x0 + (x1 - x0) * k / 6), round(y0 + (y1 - y0) * k / 6))
        meanwhile()
        self.press(button, down=False)
        if held:
            self.counted("keys", 1, lambda: self.tool("keyup", held))
        self.settle()

    def key(self, *keys):
        for key in keys:
            self.counted("keys", 2 * (key.count("+") + 1), lambda: self.tool("key", key))
            self.strokes += 1
        if self.process.poll() is None:
            self.settle()

    def type(self, text):
        self.counted("text", len(text), lambda: self.tool("type", "--delay", "5", text))
        self.strokes += len(text)
        self.settle()

    def answer(self, text):
        """Replaces the path that a file dialog proposes, and confirms."""
        self.key("ctrl+a")
        self.type(text)
        self.key("Return")

    def command(self, name):
        """Runs a command by the command palette."""
        self.key("ctrl+p")
        self.type(name)
        self.key("Return")

    def fill_disk(self, full=True):
        subprocess.run(["prlimit", f"--pid={self.process.pid}", "--fsize=" + ("16:unlimited" if full else "unlimited")],
                       check=True)

    def resize(self, width, height):
        self.tool("windowsize", "--sync", self.window, width, height)
        until(lambda: abs(self.state()["items"]["viewport"][0] + self.state()["items"]["viewport"][2] - width) < width / 2
              and self.state()["window"] == [width, height], f"{width} x {height}")
        self.settle()

    # Pictures and files

    def picture(self):
        """Pixels of the whole screen: [row][column][red, green, blue]."""
        raw = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], env=self.screen.environment,
                             capture_output=True, check=True).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(self.screen.height, self.screen.width, 3).astype(int)

    def viewport(self):
        """Pixels of the viewport: [row][column][red, green, blue]."""
        x, y, width, height = (round(v) for v in self.state()["items"]["viewport"])
        return self.picture()[y:y + height, x:x + width]

    def in_viewport(self, across, down):
        """Screen position of a point in the viewport, given by shares of its size."""
        x, y, width, height = self.state()["items"]["viewport"]
        return round(x + across * width), round(y + down * height)

    def save_picture(self, path):
        subprocess.run(["import", "-window", "root", str(path)], env=self.screen.environment, check=True)

    def journal(self):
        """Lines of all journals, without headers, as dictionaries."""
        folder = self.screen.home / "state" / "rebake" / "journals"
        files = sorted(folder.glob("*.journal")) if folder.is_dir() else []
        lines = [json.loads(line[17:]) for file in files for line in file.read_text().splitlines()]
        return [line for line in lines if "rebake_journal" not in line]

    def last_edit(self):
        line = self.journal()[-1]
        line = line.get("adjust", line)
        return line["edits"][-1] if "edits" in line else line["edit"]

    def ops(self):
        names = []
        for line in self.journal():
            if "adjust" in line:
                names.append("adjust")
                line = line["adjust"]
            if "replaces" in line:
                names.append("revise")
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
