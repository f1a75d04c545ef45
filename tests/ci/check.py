#!/usr/bin/env python3
"""Executes the shell steps of the CI helpers in packaging/ as their systems do.

    tests/ci/check.py RTF

What the systems themselves do between the steps is replaced: the checkout, artefacts and stashes
are copies of directories. `pip install` is real; the package is a wheel that starts RTF.
"""

import sys
import tempfile
from pathlib import Path

import github
import gitlab
import jenkins
from project import Project, make_wheel


def main() -> None:
    """Check every helper."""
    rtf = Path(sys.argv[1]).resolve()
    root = Path(__file__).resolve().parents[2]
    with tempfile.TemporaryDirectory() as work:
        wheels = make_wheel(Path(work, "wheels"), rtf)
        for helper in (github, gitlab, jenkins):
            name = helper.__name__
            base = Path(work, name)
            base.mkdir()
            helper.check_helper(root / "packaging", Project(base, wheels, rtf))
            print(f"{name}: ok")


if __name__ == "__main__":
    main()
