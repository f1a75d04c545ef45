"""Recordings for checks: read, and cut off as by a killed recorder.

Needs a Python with the library `mcap`, and for bags ROS 1.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Series = dict[str, list[tuple[float, float]]]


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


def as_mcap(bag: Path, path: Path) -> Path:
    """Write the messages of a bag into an MCAP file as ROS's converters do."""
    from mcap.writer import Writer  # noqa: PLC0415

    rosbag: Any = importlib.import_module("rosbag")
    channels: dict[str, int] = {}
    with path.open("wb") as stream, rosbag.Bag(str(bag)) as source:
        writer = Writer(stream)
        writer.start(profile="ros1")
        for topic, (kind, data, md5sum, *_, found), at in source.read_messages(raw=True):
            if topic not in channels:
                text = found._full_text.encode()
                schema = writer.register_schema(kind, "ros1msg", text)
                channels[topic] = writer.register_channel(topic, "ros1", schema, {"md5sum": md5sum})
            writer.add_message(channels[topic], at.to_nsec(), data, at.to_nsec())
        writer.finish()
    return path


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


def cut_bag(file: Path, torn: Path) -> tuple[Path, int]:
    """Write a bag with many chunks and cut it off; the number of messages ROS can restore."""
    # Only with ROS; the fixture `rosbag` has the same name.
    rosbag: Any = importlib.import_module("rosbag")
    with rosbag.Bag(str(file)) as bag, rosbag.Bag(str(torn), "w", chunk_threshold=512) as copy:
        for topic, message, at in bag.read_messages(topics=["/level"]):
            copy.write(topic, message, at)
    os.truncate(torn, torn.stat().st_size // 2)
    restored = torn.with_name("restored.bag")
    restored.write_bytes(torn.read_bytes())
    subprocess.run(["rosbag", "reindex", "-q", str(restored)], check=True)
    with rosbag.Bag(str(restored)) as bag:
        return torn, int(bag.get_message_count())
