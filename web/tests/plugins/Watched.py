"""Samples a signal that violates a monitor, leaves its trajectory, and attaches a recording."""

from __future__ import annotations

import pathlib
import struct
import zlib

import rtf


def picture(path: str, box: int) -> None:
    """Write a PNG file of 64 by 48 pixels with a dark box at this column."""
    row = b"\0" + b"".join(
        b"\x20\x20\x20" if box <= x < box + 12 else b"\xd0\xd8\xe0" for x in range(64)
    )

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", 64, 48, 8, 2, 0, 0, 0))
    data = chunk(b"IDAT", zlib.compress(row * 48))
    whole = b"\x89PNG\r\n\x1a\n" + header + data + chunk(b"IEND", b"")
    pathlib.Path(path).write_bytes(whole)


class Watched(rtf.TestCase):
    """The level is above its limit from 4 s to 6 s."""

    def run(self) -> None:
        for step in range(101):
            at = step * 0.1
            self.sample("level", 3 if 4 <= at < 6 else 1, "m", time=at)
        self.check_trajectory("level", "golden/level.csv", tolerance=0.5)
        picture("golden-scene.png", 10)
        picture("scene.png", 30)
        self.check_picture("scene", "scene.png", "golden-scene.png", tolerance=0.01)
        pathlib.Path("data.mcap").write_text("data", encoding="utf-8")
        self.attach("data.mcap")
