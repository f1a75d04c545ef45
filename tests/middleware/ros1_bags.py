"""Bags of ROS 1 for checks: converted, and cut off as by a killed recorder.

    ros1_bags.py as_mcap|cut_bag BAG RESULT

Needs Debian's Python with rosbag, and the library `mcap`.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from mcap.writer import Writer

# The fixture `rosbag` has the same name.
rosbag: Any = importlib.import_module("rosbag")


def as_mcap(bag: Path, path: Path) -> None:
    """Write the messages of a bag into an MCAP file as ROS's converters do."""
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


def cut_bag(file: Path, torn: Path) -> None:
    """Write a bag with many chunks and cut it off; prints how many messages ROS can restore."""
    with rosbag.Bag(str(file)) as bag, rosbag.Bag(str(torn), "w", chunk_threshold=512) as copy:
        for topic, message, at in bag.read_messages(topics=["/level"]):
            copy.write(topic, message, at)
    os.truncate(torn, torn.stat().st_size // 2)
    restored = torn.with_name("restored.bag")
    restored.write_bytes(torn.read_bytes())
    subprocess.run(["rosbag", "reindex", "-q", str(restored)], check=True)
    with rosbag.Bag(str(restored)) as bag:
        print(bag.get_message_count())


if __name__ == "__main__":
    {"as_mcap": as_mcap, "cut_bag": cut_bag}[sys.argv[1]](*map(Path, sys.argv[2:]))
