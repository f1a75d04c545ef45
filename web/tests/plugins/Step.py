"""Reports, measures and prints; continues when the test permits it."""

from __future__ import annotations

import math
import os
import struct
import zlib
from pathlib import Path

import rtf

DIR = Path(os.environ["PAGE_TEST_DIR"])


class Step(rtf.TestCase):
    """Its parameter is the word that it waits for; with `through` it does not wait."""

    def run(self) -> None:
        word = self.args[0]
        print(f"\x1b[32mwaiting\x1b[0m for \x1b[1m{word}\x1b[0m", flush=True)
        self.report(f"the arm is ready for {word}")
        self.check(True, "the arm is at home")
        for step in range(30):
            self.measure("lag", 0.3 + 0.1 * math.sin(step / 4), "rad", high=0.5)
        self.measure("rate", 99.5, "Hz", low=95, high=105)
        picture = DIR / f"picture-{os.getpid()}.png"
        picture.write_bytes(png())
        self.attach(picture, "camera", "image/png")
        if word != "through":
            self.await_word(f"{word}-more")
            print("one more line", flush=True)
            self.report("one more message")
            self.await_word(word)

    def setup(self, args: list[str]) -> None:
        self.args = args

    def await_word(self, word: str) -> None:
        """Waits until the test permits it to continue."""
        while not (DIR / f"{word}.go").exists():
            self.sleep(0.02)


def png(size: int = 48) -> bytes:
    """A small picture: a gradient."""
    rows = b"".join(
        b"\0" + b"".join(bytes((40 + 3 * x, 80 + 2 * y, 160)) for x in range(size))
        for y in range(size)
    )
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(kind, data) for kind, data in parts)


def chunk(kind: bytes, data: bytes) -> bytes:
    """A part of a PNG file."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
