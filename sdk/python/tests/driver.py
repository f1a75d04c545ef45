"""Plays the runner: starts the real host over a socket pair and records its lines."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).resolve().parent.parent
# Ends a host that hangs, so that the test fails. No test takes nearly as long.
LIMIT_SECONDS = 60


class Host:
    """A host process and the runner's end of its channel."""

    def __init__(self, directory: Path, stack_file: Path | None = None) -> None:
        ours, theirs = socket.socketpair()
        ours.settimeout(LIMIT_SECONDS)
        self.channel = ours
        self._lines = ours.makefile("rb")
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE)}
        # The host must behave the same however the tests are run.
        environment.pop("PYTHONUNBUFFERED", None)
        environment["RTF_CHANNEL"] = f"fd:{theirs.fileno()}"
        self.process = subprocess.Popen(
            [sys.executable, "-m", "rtf_start", "rtf.host"],
            cwd=directory,
            env=environment,
            pass_fds=[theirs.fileno()],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        theirs.close()
        self.seen: list[dict[str, Any]] = []
        params: dict[str, Any] = {"protocol": 1, "rtf": "0.1.0"}
        if stack_file is not None:
            params["stack_file"] = str(stack_file)
        self.initialized = self.ask("initialize", params)

    def send(self, method: str, params: dict[str, Any], number: int | None = None) -> None:
        message: dict[str, Any] = {"jsonrpc": "2.0", "method": method, "params": params}
        if number is not None:
            message["id"] = number
        self.channel.sendall(json.dumps(message).encode() + b"\n")

    def ask(self, method: str, params: dict[str, Any]) -> dict[str, Any]:
        """Send a request and wait for its answer."""
        self.send(method, params, number=1)
        return self.answer()

    def read(self) -> dict[str, Any] | None:
        """Return the next line; `None` when the host has closed the channel."""
        line = self._lines.readline()
        if not line:
            return None
        message: dict[str, Any] = json.loads(line)
        self.seen.append(message)
        return message

    def answer(self) -> dict[str, Any]:
        """Return the next answer."""
        while (message := self.read()) is not None:
            if "id" in message:
                return message
        raise AssertionError(f"no answer; the host wrote {self.process.communicate()}")

    def wait_for(self, method: str) -> dict[str, Any]:
        """Return the parameters of the next notification of this kind."""
        while (message := self.read()) is not None:
            if message.get("method") == method:
                params: dict[str, Any] = message["params"]
                return params
        raise AssertionError(f"no `{method}`; the host wrote {self.process.communicate()}")

    def of(self, method: str) -> list[dict[str, Any]]:
        """Return the parameters of all notifications of this kind so far."""
        return [message["params"] for message in self.seen if message.get("method") == method]

    def texts(self) -> list[tuple[str, str]]:
        """Return kind and text of all messages so far."""
        return [(message["kind"], message["text"]) for message in self.of("message")]

    def problem(self) -> tuple[str, str] | None:
        """Return kind and first line of the first failure or error so far."""
        problems = [one for one in self.texts() if one[0] in {"failure", "error"}]
        return (problems[0][0], problems[0][1].partition("\n")[0]) if problems else None

    def end(self) -> tuple[int, str, str]:
        """Wait for the end of the process: exit code, output, errors."""
        while self.read() is not None:
            pass
        output, errors = self.process.communicate(timeout=LIMIT_SECONDS)
        return self.process.returncode, output, errors


class Ran:
    """The results of a test."""

    def __init__(self, host: Host, answer: dict[str, Any] | None) -> None:
        self.code, self.output, self.errors = host.end()
        self.result = answer["result"] if answer else None
        self.host = host
        self.texts = host.texts()
        self.problem = host.problem()
        self.phases = [phase["phase"] for phase in host.of("phase")]


def plugin(directory: Path, body: str, name: str = "plugin.py") -> dict[str, Any]:
    """Write a plug-in and return the parameters of a request about it."""
    file = directory / name
    file.write_text("import rtf\n" + body, encoding="utf-8")
    return {"file": str(file), "name": "Arm", "args": ["--rate", "100"], "is_last": True}


def run(directory: Path, body: str, **more: Any) -> Ran:
    """Run a test to its end."""
    host = Host(directory)
    host.send("run-test", {**plugin(directory, body), **more}, number=2)
    answer = None
    while (message := host.read()) is not None:
        if message.get("id") == 2:
            answer = message
    return Ran(host, answer)


def arm(run_body: str, more: str = "") -> str:
    """Return the source of a test whose `run` has these lines."""
    lines = "".join(f"        {line}\n" for line in run_body.splitlines())
    return f"class Arm(rtf.TestCase):\n    def run(self):\n{lines}{more}"
