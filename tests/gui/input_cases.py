"""Order of input events, and the error without a display."""

import signal
import subprocess
import tempfile
import unittest

from screen import until
from window_case import WindowCase, BRANCH, PROGRAM


class InputTest(WindowCase):
    def test_what_comes_while_the_window_is_stopped_is_taken_in_its_order(self):
        editor = self.open_ficus()
        editor.key("l")
        keys, text, buttons = (editor.seen(kind) for kind in ("keys", "text", "buttons"))
        editor.process.send_signal(signal.SIGSTOP)
        editor.tool("key", "ctrl+p")
        editor.tool("type", "--delay", "5", "select: all")
        editor.tool("key", "Return")
        # Pointer motion before the press is not part of the drag.
        corners = [editor.in_viewport(*corner) for corner in BRANCH]
        editor.tool("mousemove", *editor.in_viewport(0.1, 0.9))
        editor.tool("mousemove", *corners[0])
        editor.tool("mousedown", 1)
        for corner in corners[1:] + corners[:1]:
            editor.tool("mousemove", *corner)
        editor.tool("mouseup", 1)
        editor.process.send_signal(signal.SIGCONT)
        until(lambda: editor.seen("keys") >= keys + 6 and editor.seen("text") >= text + 11 and
              editor.seen("buttons") >= buttons + 2, "all of it")
        editor.settle()
        self.assertEqual(editor.ops(), ["import", "select", "select_picture"])
        polygon = editor.last_edit()["polygon"]
        x, y, _, _ = editor.state()["items"]["viewport"]
        self.assertEqual([polygon[0][0] + x, polygon[0][1] + y], list(corners[0]))
        self.assertEqual(len(polygon), 6)


class NoWindowTest(unittest.TestCase):
    def test_without_a_display_the_headless_commands_are_named(self):
        result = subprocess.run([PROGRAM, "edit"], env={"PATH": "/usr/bin:/bin", "HOME": tempfile.mkdtemp()},
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("rebake run", result.stderr)
