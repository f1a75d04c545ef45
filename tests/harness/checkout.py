"""The checkout, and what its scripts install: virtual environments, middleware, packages."""

from __future__ import annotations

import functools
import os
import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
"""The files that tests build, which later runs use again."""
TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")

# Python's readline, which pytest imports, sets the size of a terminal for all processes, also for
# those whose output is compared.
for size in ("COLUMNS", "LINES"):
    os.environ.pop(size, None)
    os.unsetenv(size)

STARTED_WITH = dict(os.environ)
"""The environment before a test has changed it."""


def call(*command: str | Path, cwd: Path = ROOT, **variables: str) -> None:
    """Runs a command, whose output belongs to the test; fails unless it exits with 0."""
    print("$", *command, flush=True)
    words = list(map(str, command))
    code = subprocess.run(words, cwd=cwd, env={**os.environ, **variables}, check=False).returncode
    assert code == 0, f"exit code {code}: {shlex.join(words)[:200]}"


def output_of(*command: str | Path, **variables: str) -> str:
    """The standard output of a command of this checkout, without the last line break."""
    ran = subprocess.run(
        list(map(str, command)),
        cwd=ROOT,
        env={**STARTED_WITH, **variables},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return ran.stdout.rstrip("\n")


@functools.cache
def venv(name: str, **variables: str) -> Path:
    """The directory with the programs of tools/requirements-NAME.txt, installed if necessary."""
    return Path(output_of("tools/venv.sh", name, **variables))


@functools.cache
def exports(*command: str) -> Mapping[str, str]:
    """The variables that a script like tools/middleware.sh exports.

    `PATH` has only the directories that the script puts first, each with a colon.
    """
    script = 'set -e; settings=$("$@"); eval "$settings"; env -0'
    listed = output_of("bash", "-c", script, "bash", *command)
    pairs = (entry.partition("=") for entry in listed.split("\0") if entry)
    found = {
        name: value
        for name, _, value in pairs
        if STARTED_WITH.get(name) != value and name not in {"_", "SHLVL", "PWD", "OLDPWD"}
    }
    if "PATH" in found:
        found["PATH"] = found["PATH"].removesuffix(STARTED_WITH["PATH"])
    return found


def need_packages(*packages: str) -> None:
    """Installs the Debian packages that are missing."""
    script = '. tools/env.sh; . tools/packages.sh; need_packages "$@"'
    output_of("bash", "-c", script, "bash", *packages)
