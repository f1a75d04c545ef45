"""200 programs that follow the events of one run."""

from __future__ import annotations

import re
import selectors
import socket
import time
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

from measuring import suite
from measuring.bench import Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work

from lines import page

CLIENTS = 200
ADDRESSES = 10
TESTS = 100
IDLE_SECS = 5
END_SECS = 60
EVENTS = "/api/v1/runs/current/events?from=0"
FINISHED = b'"type":"test-finished"'
MEMORY = "MB"
IDLE = "% of one core"

FOLLOWED = "followed"


def group(bench: Bench) -> Group:
    """The tests, of 20 ms each, start when all clients are connected."""
    gate = bench.directory / "clients-gate"
    first = f'<test type="python" param="{gate}">Gate</test>'
    file = suite.write(bench, "clients", [first, *suite.tests("python", "Steps", TESTS)])
    works = (Work(FOLLOWED, lambda: followed(bench, file, gate)),)
    name = f"{CLIENTS} clients of the event stream"
    lines = (
        Line(f"{name}, memory of rtf", FOLLOWED, MEMORY, limit=Limit(60, required=False)),
        Line(f"{name}, no events", FOLLOWED, IDLE, limit=Limit(2, required=False)),
    )
    return Group("clients", works, lines, rounds=3, warm_up=False)


def followed(bench: Bench, file: Path, gate: Path) -> Samples:
    """Connects, waits without events, then lets the tests run."""
    gate.unlink(missing_ok=True)
    with page.started(bench, "run", str(file)) as (process, url), ExitStack() as connections:
        address = urlsplit(url)
        clients = [
            connections.enter_context(connect(number, address.hostname or "", address.port or 0))
            for number in range(CLIENTS)
        ]
        runner = child_of(process.pid)
        time.sleep(1)
        before = cpu_seconds(runner)
        time.sleep(IDLE_SECS)
        idle = cpu_seconds(runner) - before
        gate.touch()
        counts, memory = follow(clients, runner)
    if set(counts) != {TESTS + 1}:
        raise MeasuringError(f"the clients saw {sorted(set(counts))} tests finish")
    return {MEMORY: [memory], IDLE: [idle / IDLE_SECS * 100]}


def connect(number: int, host: str, port: int) -> socket.socket:
    """Requests the stream. No address may have all connections, so there are several."""
    own = f"127.0.0.{1 + number % ADDRESSES}"
    connection = socket.create_connection((host, port), source_address=(own, 0))
    request = f"GET {EVENTS} HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n"
    connection.sendall(request.encode("ascii"))
    return connection


def follow(clients: list[socket.socket], runner: int) -> tuple[list[int], float]:
    """Reads all streams to their ends: how many tests finished, and the runner's memory."""
    counts = dict.fromkeys(clients, 0)
    rests = dict.fromkeys(clients, b"")
    memory = 0.0
    with selectors.DefaultSelector() as selector:
        for connection in clients:
            selector.register(connection, selectors.EVENT_READ, connection)
        while selector.get_map():
            ready = selector.select(END_SECS)
            if not ready:
                raise MeasuringError("the streams do not end")
            for key, _ in ready:
                connection = key.data
                received = read(connection)
                text = rests[connection] + received
                counts[connection] += text.count(FINISHED)
                # The beginning of a mark may be at the end.
                rests[connection] = text[-len(FINISHED) + 1 :]
                if not received:
                    selector.unregister(connection)
            if all(count < TESTS for count in counts.values()):
                memory = page.peak_mb(runner)
    return list(counts.values()), memory


def read(connection: socket.socket) -> bytes:
    """The next bytes; nothing at the end of the stream."""
    try:
        return connection.recv(1 << 16)
    except ConnectionResetError:
        return b""


def child_of(pid: int) -> int:
    """The runner, which is the child of its guard."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()
    if not children:
        raise MeasuringError("rtf has no child: is the guard off?")
    return int(children[0])


def cpu_seconds(pid: int) -> float:
    """The processor time of a process so far, from the scheduler's clock."""
    tasks = Path(f"/proc/{pid}/task").iterdir()
    texts = [(task / "schedstat").read_text(encoding="ascii") for task in tasks]
    return sum(int(re.split(r"\s+", text)[0]) for text in texts) / 1e9
