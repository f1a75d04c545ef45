"""Copies of files that tests attach."""

from __future__ import annotations

import os

_CHUNK_BYTES = 1 << 20


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
