"""The C++ plug-ins of an example, built against the SDK of this checkout."""

from __future__ import annotations

import fcntl
import functools
from pathlib import Path

from checkout import BUILD, call


@functools.cache
def plugins(example: str) -> Path:
    """Builds the plug-ins of an example, and returns their directory."""
    BUILD.mkdir(exist_ok=True)
    with (BUILD / f"{example}.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        call("tools/plugins.sh", f"examples/{example}")
    return BUILD / "examples" / example
