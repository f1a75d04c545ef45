"""The cases of tests/frameworks/promises.json."""

import os
import subprocess


def test_first():
    pass


def test_second():
    assert subprocess.Popen(["sh", "-c", os.environ["PROMISE"]]).wait() == 0


def test_third(rtf):
    if "MEASURES" in os.environ:
        rtf.measure("force", 2.5, "N", high=float(os.environ["MEASURES"]))
