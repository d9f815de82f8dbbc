"""Tests of the editor with real events: each asserts the edits in the document, and the picture.

editor_test.py PROGRAM runs all; editor_test.py PROGRAM bend_cases.py one file; editor_test.py PROGRAM BendTest.NAME one.
"""

import pathlib
import sys
import unittest

from bend_cases import BendTest
from file_cases import FileTest
from input_cases import InputTest, NoWindowTest
from node_cases import NodeTest
from select_cases import SelectTest
from training_cases import TrainingTest
from view_cases import ViewTest

if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[-1].endswith("_cases.py"):
        unittest.main(module=pathlib.Path(sys.argv.pop()).stem, verbosity=2)
    unittest.main(verbosity=2)
