"""The cases of tests/frameworks/promises.json."""

import os
import subprocess
import unittest


class Promises(unittest.TestCase):
    def test_1_first(self):
        pass

    def test_2_second(self):
        subprocess.run(["sh", "-c", os.environ["PROMISE"]], check=True)

    def test_3_third(self):
        pass
