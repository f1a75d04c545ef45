"""A network in which a test can count the packets that would leave the machine.

The test runs in a network namespace with a second interface for the default route. No
process listens there, and the kernel counts the packets.
"""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator
from pathlib import Path

from run import expect

OUTSIDE = "out"
"""The interface of the default route."""
INSIDE = "RTF_CHECK_INSIDE"

SETTLE = f"""
set -e
ip link set lo up
ip link add {OUTSIDE} type veth peer name far
# Without IPv6 addresses, which send packets by themselves.
ip link set {OUTSIDE} addrgenmode none
ip link set far addrgenmode none
ip addr add 10.99.0.1/24 dev {OUTSIDE}
ip link set {OUTSIDE} up
ip link set far up
ip route add default dev {OUTSIDE}
exec "$@"
"""


def is_inside() -> bool:
    """Whether this process is in such a network; the first answer also proves that it counts."""
    if INSIDE not in os.environ:
        return False
    if not os.environ[INSIDE]:
        os.environ[INSIDE] = "checked"
        stray_packet_is_seen()
    return True


def command(inner: list[str]) -> list[str]:
    """A command that runs another in such a network."""
    unshare = ["unshare", "--net", *(["--map-root-user"] if os.geteuid() else [])]
    return [*unshare, "env", f"{INSIDE}=", "sh", "-c", SETTLE, "sh", *inner]


def packets() -> int:
    """How many packets were sent to the outside interface."""
    for line in Path("/proc/net/dev").read_text().splitlines():
        interface, _, numbers = line.partition(":")
        if interface.strip() == OUTSIDE:
            return int(numbers.split()[9])
    raise AssertionError(f"there is no interface {OUTSIDE}")


def stray_packet_is_seen() -> None:
    """Proves that packets are counted, with a multicast datagram as discovery sends it."""
    before = packets()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stray:
        stray.sendto(b"discovery", ("239.255.0.1", 7400))
    expect("a stray packet is counted", packets() - before >= 1, True)


@contextlib.contextmanager
def quiet(what: str) -> Iterator[None]:
    """A context in which no packet may leave."""
    before = packets()
    yield
    expect(f"{what}: packets that left", packets() - before, 0)
