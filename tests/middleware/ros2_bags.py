"""Prints the content of a bag of ROS 2 as JSON, which the library `rosbags` has read.

    ros2_bags.py BAG

BAG is a directory, or only its MCAP file. Messages are decoded with the definitions in the bag.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from rosbags.interfaces import MessageDefinitionFormat
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore


def content(path: Path) -> dict[str, Any]:
    """The topics of a bag, with the times and values of their messages."""
    topics: dict[str, Any] = {}
    store = get_typestore(Stores.EMPTY)
    with Reader(path) as reader:
        for connection in reader.connections:
            definition = connection.msgdef
            assert definition.format == MessageDefinitionFormat.MSG, connection.topic
            store.register(get_types_from_msg(definition.data, connection.msgtype))
            (profile, *_) = connection.ext.offered_qos_profiles
            topics[connection.topic] = {
                "type": connection.msgtype,
                "hash": connection.digest,
                "definition": definition.data,
                "count": connection.msgcount,
                "reliability": profile.reliability.name,
                "durability": profile.durability.name,
                "times": [],
                "values": [],
            }
        for connection, at, data in reader.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            topics[connection.topic]["times"].append(at)
            topics[connection.topic]["values"].append(value(message))
        return {"start": reader.start_time, "count": reader.message_count, "topics": topics}


def value(message: Any) -> Any:
    """The part of a message that is compared."""
    if hasattr(message, "clock"):
        return message.clock.sec * 10**9 + message.clock.nanosec
    for name in ("label", "r"):
        if hasattr(message, name):
            return getattr(message, name)
    data: Any = getattr(message, "data", None)
    return data.tolist() if hasattr(data, "tolist") else data


if __name__ == "__main__":
    print(json.dumps(content(Path(sys.argv[1]))))
