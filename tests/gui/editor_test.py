"""The editor as people use it: each test asserts the edits that arrived in the document, and what is seen.

editor_test.py PROGRAM runs all; editor_test.py PROGRAM BendTest.NAME one.
"""

import unittest

from bend_cases import BendTest
from file_cases import FileTest
from input_cases import InputTest, NoWindowTest
from node_cases import NodeTest
from select_cases import SelectTest
from view_cases import ViewTest

if __name__ == "__main__":
    unittest.main(verbosity=2)
