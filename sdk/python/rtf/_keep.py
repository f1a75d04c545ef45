"""Copies of files that tests attach."""

from __future__ import annotations

import os
import stat

_CHUNK_BYTES = 1 << 20


def check(path: str) -> None:
    """Raise an error that says why something cannot be attached: only files can."""
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        raise FileNotFoundError(f"there is no file `{path}` to attach") from None
    if stat.S_ISREG(mode):
        return
    kinds = {stat.S_IFDIR: "a directory", stat.S_IFIFO: "a FIFO"}
    kind = kinds.get(stat.S_IFMT(mode), "a device or a socket")
    raise OSError(f"`{path}` cannot be attached: it is {kind}, not a file")


def copy(path: str, name: str, folder: str) -> str:
    """Copy a file into `folder`, under a name that no other has; return where."""
    os.makedirs(folder, exist_ok=True)
    safe = "".join(c if c.isalnum() or c in ".-_" else "_" for c in name)
    number = 1
    while True:
        target = os.path.join(folder, f"{number}-{safe}")
        try:
            kept = open(target, "xb")  # noqa: SIM115 - closed below, in any case
        except FileExistsError:
            number += 1
            continue
        with kept, open(path, "rb") as source:
            while chunk := source.read(_CHUNK_BYTES):
                kept.write(chunk)
        return target
