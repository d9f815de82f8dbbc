"""A window of the editor on a display of its own, its pointer and keys, and what it shows.

The editor announces what is true of each frame (REBAKE_ANNOUNCE, see README.md here): where things can be clicked, what
is selected, and whether it has settled. So nothing here knows where a button is, or how long something takes."""

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
PATIENCE = 180  # seconds, of a machine that does much else


class Screen:
    """A display. Everything the editor keeps for a person lies in `home`."""

    def __init__(self, width=WIDTH, height=HEIGHT):
        self.width, self.height = width, height
        self.editors = []  # processes that were started on it
        self.home = pathlib.Path(tempfile.mkdtemp())
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp",
             "-noreset", "+extension", "GLX"],  # else it begins anew when its last client ends, and may miss the next
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            self.display = ":" + pipe.readline().strip()
        self.environment = dict(os.environ, DISPLAY=self.display, HOME=str(self.home),
                                XDG_CONFIG_HOME=str(self.home / "config"), XDG_CACHE_HOME=str(self.home / "cache"), XDG_STATE_HOME=str(self.home / "state"),
                                REBAKE_ANNOUNCE=str(self.home / "announced"))

    def settings(self, **values):
        """What the editor remembers, before it starts."""
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
    """Waits for what() to be something, and returns that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := what():
            return found
        time.sleep(0.02)
    raise AssertionError("in vain: " + says)


def read_picture(file):
    """Rows of pixels, red, green and blue."""
    size = subprocess.run(["identify", "-format", "%w %h", file], capture_output=True, text=True, check=True).stdout
    width, height = map(int, size.split())
    raw = subprocess.run(["convert", file, "-depth", "8", "rgb:-"], capture_output=True, check=True).stdout
    return numpy.frombuffer(raw, numpy.uint8).reshape(height, width, 3).astype(int)


class Editor:
    """The program with its window."""

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
        # Python ignores SIGXFSZ, and so does the editor then: a limit of file size is an error of writing, like a full
        # disk.
        self.process = subprocess.Popen([program, "edit", *map(str, paths)], env=screen.environment, restore_signals=False)
        screen.editors.append(self.process)
        self.clicks = self.strokes = 0
        self.window = until(lambda: self.tool("search", "--onlyvisible", "--name", "Rebake").split(), "a window")[0]
        self.tool("windowfocus", "--sync", self.window)
        self.settle()

    def tool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.screen.environment, capture_output=True,
                              text=True).stdout

    # What is announced

    def listen(self, pipe):
        with open(pipe) as lines:
            for line in lines:
                self.latest = json.loads(line)

    def state(self):
        """Of the last frame; nothing before the first."""
        return self.latest

    def settle(self):
        """Until all input is seen and nothing is being done."""
        return until(lambda: (state := self.state()).get("settled") and state, "settled")

    def until(self, what, says):
        """Until what(state) of a settled frame is something."""
        return until(lambda: (state := self.state()).get("settled") and what(state) and state, says)

    def where(self, item):
        """The middle of what is announced under that name."""
        x, y, width, height = until(lambda: self.state().get("items", {}).get(item), item)
        return round(x + width / 2), round(y + height / 2)

    def items(self, part):
        return {name[len(part) + 1:]: box for name, box in self.state()["items"].items() if name.startswith(part + "/")}

    def seen(self, kind):
        return self.state()["input"][kind]

    def counted(self, kind, more, act):
        """Does it, and waits until the editor has seen so many more of that kind of input."""
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
        """A point, or the name of an item; with a key held."""
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
        """One notch."""
        self.move(x, y)
        self.counted("wheel", 1, lambda: self.tool("click", 4 if away else 5))
        self.settle()

    def drag(self, points, button=1, meanwhile=lambda: None, held=None):
        """Along points, with steps between them as a hand makes; with a key held."""
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
        """In place of what a file dialog proposes."""
        self.key("ctrl+a")
        self.type(text)
        self.key("Return")

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
        until(lambda: abs(self.state()["items"]["viewport"][0] + self.state()["items"]["viewport"][2] - width) < width / 2
              and self.state()["window"] == [width, height], f"{width} x {height}")
        self.settle()

    # What is there

    def picture(self):
        """Rows of pixels, red, green and blue."""
        raw = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], env=self.screen.environment,
                             capture_output=True, check=True).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(self.screen.height, self.screen.width, 3).astype(int)

    def viewport(self):
        """The pixels of the scene's picture."""
        x, y, width, height = (round(v) for v in self.state()["items"]["viewport"])
        return self.picture()[y:y + height, x:x + width]

    def in_viewport(self, across, down):
        """A point of the picture, by shares of its size."""
        x, y, width, height = self.state()["items"]["viewport"]
        return round(x + across * width), round(y + down * height)

    def save_picture(self, path):
        subprocess.run(["import", "-window", "root", str(path)], env=self.screen.environment, check=True)

    def journal(self):
        """What the document did, from its journal."""
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
