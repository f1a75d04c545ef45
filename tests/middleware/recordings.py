"""Recordings for checks: read, and cut off as by a killed recorder.

Needs the library `mcap`, see `packages`.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Series = dict[str, list[tuple[float, float]]]


def packages(programs: Path) -> Path:
    """The directory of the packages of a virtual environment."""
    (found,) = programs.parent.glob("lib/python3*/site-packages")
    return found


def messages(file: Path) -> Iterator[Any]:
    """The schemas, channels and messages of a recording."""
    from mcap.reader import make_reader  # noqa: PLC0415 - the linters run without it

    with file.open("rb") as stream:
        yield from make_reader(stream).iter_messages()


def series(file: Path) -> Series:
    """The times since the first message of a channel, and the values."""
    found: Series = {}
    for _, channel, message in messages(file):
        if channel.topic != "/log":
            value = json.loads(message.data)["value"]
            found.setdefault(channel.topic, []).append((message.log_time * 1e-9, value))
    return {
        name: [(at - points[0][0], value) for at, value in points] for name, points in found.items()
    }


def cut(file: Path, torn: Path) -> tuple[Path, int]:
    """Write a recording with many chunks and cut it off; the number of complete messages."""
    from mcap.reader import NonSeekingReader  # noqa: PLC0415
    from mcap.writer import Writer  # noqa: PLC0415

    with torn.open("wb") as stream:
        writer = Writer(stream, chunk_size=1024)
        writer.start()
        schema = writer.register_schema("measurement", "jsonschema", b"{}")
        level = writer.register_channel("/level", "json", schema)
        for _, channel, message in messages(file):
            if channel.topic == "/level":
                writer.add_message(level, message.log_time, message.data, message.log_time)
        writer.finish()
    os.truncate(torn, torn.stat().st_size // 2)
    complete = 0
    with torn.open("rb") as stream, contextlib.suppress(Exception):
        for _ in NonSeekingReader(stream).iter_messages(log_time_order=False):
            complete += 1
    return torn, complete
