"""The shared memory of Fast DDS, which all processes of a machine otherwise have in common."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from checkout import ROOT, call
from run import expect

SCRIPT = """#!/bin/sh
exec unshare {options} sh -c 'mount --bind "$0" /dev/shm && exec "$@"' '{memory}' '{program}' "$@"
"""
CLEAN_UP = """
import sys
from pathlib import Path
from rtf_fixtures.fastdds import clean_up
print("removed:", *clean_up(5.0, Path(sys.argv[1])))
"""


@contextmanager
def private_memory(program: str, directory: Path) -> Iterator[str]:
    """A program whose shared memory is in a directory; the next run of rtf could clean it up."""
    memory = directory / "shared-memory"
    memory.mkdir(parents=True)
    options = "--mount" if os.geteuid() == 0 else "--mount --map-root-user"
    script = directory / Path(program).name
    script.write_text(SCRIPT.format(options=options, memory=memory, program=program))
    script.chmod(0o755)
    yield str(script)
    call("python3", "-c", CLEAN_UP, memory, PYTHONPATH=str(ROOT / "fixtures"))
    expect("shared memory after the next run", left(str(script)), [])


def left(program: str) -> list[str]:
    """The files in the shared memory of such a program."""
    memory = Path(program).with_name("shared-memory")
    return [file.name for file in memory.glob("*fastdds_*")]
