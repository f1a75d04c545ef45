"""The command ``python3 -m rtf``: the runner, with this interpreter for Python plug-ins."""

from __future__ import annotations

import os
import shutil
import signal
import sys
from pathlib import Path

_TESTRUNNER = "robottestingframework-testrunner"


def _runner() -> str:
    """Find the program ``rtf`` of this installation, or one in ``PATH``."""
    package = Path(__file__).resolve().parent
    # PREFIX/share/rtf/python/rtf or PREFIX/lib/python3.N/site-packages/rtf; pip install
    # --target puts `bin` next to the package.
    for prefix in (package.parents[3], package.parent):
        program = prefix / "bin" / "rtf"
        if os.access(program, os.X_OK):
            return str(program)
    found = shutil.which("rtf")
    if found is None:
        sys.exit(
            f"error: the program `rtf` is neither in the installation of {package} nor in PATH\n"
            "hint: pip install robot-testing-framework"
        )
    return found


def _execute(name: str) -> None:
    """Replace this process with the runner, called by ``name``."""
    # Python ignores these, and a program inherits that.
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    program = _runner()
    os.execv(program, [name, *sys.argv[1:]])  # noqa: S606 # no shell


def main() -> None:
    """Run ``rtf`` with the arguments of this process."""
    if not os.environ.get("RTF_PYTHON"):
        os.environ["RTF_PYTHON"] = sys.executable
    _execute("rtf")


def testrunner() -> None:
    """Run ``robottestingframework-testrunner``, the command line of 2.x."""
    _execute(_TESTRUNNER)


if __name__ == "__main__":
    main()
