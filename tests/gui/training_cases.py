"""Training a scene from photographs."""

import json
import pathlib
import subprocess

from screen import until
from window_case import PROGRAM, WindowCase


class TrainingTest(WindowCase):
    def photograph(self):
        """A capture of the kettle at 48 x 48 pixels."""
        photographs = self.folder / "kettle"
        program = pathlib.Path(PROGRAM).with_name("rebake_photograph")
        subprocess.run([program, "kettle", "-o", photographs, "--views", "16", "--held-out", "4", "--side", "48"], check=True,
                       capture_output=True)
        return photographs

    def fill(self, field, text):
        self.editor.click("training/" + field)
        self.editor.key("ctrl+a")
        self.editor.type(text)
        self.editor.key("Tab")

    def training(self):
        return self.editor.state()["training"]

    def progress(self):
        return next((item for item in self.editor.state()["items"] if item.startswith("training/progress: ")), "")

    def test_a_scene_appears_while_it_trains_pauses_goes_on_and_is_kept(self):
        photographs = self.photograph()
        editor = self.open()
        editor.command("train from")
        editor.click("training/choose")
        editor.answer(str(self.folder))
        self.assertIn("dialog/problem", editor.state()["items"], "no cameras are there")
        editor.answer(str(photographs))
        editor.settle()
        # The suggested folder follows the photographs.
        other = self.folder / "other"
        photographs.rename(other)
        editor.click("training/choose")
        editor.answer(str(other))
        photographs = other
        editor.settle()
        out = self.folder / "other-trained"
        self.fill("side", "16")
        empty = editor.viewport().std()
        editor.click("training/train")
        until(lambda: self.training()["triangles"] > 100, "the scene", 60)
        until(lambda: editor.viewport().std() > empty + 5, "its picture")
        self.assertEqual(editor.ops(), [], "it is no part of the document")
        editor.key("f")
        self.assertNotIn("not available", " ".join(editor.state()["messages"]))
        # Without room for a checkpoint it runs on, and nothing is lost.
        editor.fill_disk()
        editor.click("training/pause")
        until(lambda: "runs on" in " ".join(editor.state()["messages"]), "the warning", 30)
        self.assertTrue(self.training()["runs"])
        editor.fill_disk(False)
        editor.click("training/pause")
        until(lambda: not self.training()["runs"], "the pause", 30)
        self.assertTrue((self.folder / "other-trained.training/rebake-checkpoint").is_file())
        self.assertGreater(self.training()["triangles"], 100, "it stays in view")
        editor.click("training/continue")
        until(lambda: "step" in self.progress(), "more steps", 30)
        step = int(self.progress().split("step ")[1].split()[0])
        self.assertGreater(step, 50, "it continues from the checkpoint")
        editor.click("training/keep")
        editor.until_ops("import")
        self.assertEqual(editor.last_edit()["path"], str(out))
        report = json.loads((out / "rebake_training.json").read_text())
        self.assertLess(report["steps done"], report["steps"])
        self.assertFalse((self.folder / "other-trained.training").exists())
        until(lambda: self.training() == {"runs": False, "triangles": 0}, "the end")
        # Closing the window in the midst of another training keeps its checkpoint.
        editor.command("train from")
        self.fill("out", str(self.folder / "second"))
        editor.click("training/train")
        until(lambda: "step" in self.progress(), "steps", 30)
        editor.tool("key", "ctrl+q")
        self.assertEqual(editor.process.wait(20), 0)
        self.assertTrue((self.folder / "second.training/rebake-checkpoint").is_file())
