"""Runs rtf and checks the exit code, the journal and the output."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

Event = dict[str, Any]

RUN_SECS = 600
"""A run takes some ten seconds; a busy machine needs more."""


class Run:
    """A run of rtf and its journal."""

    def __init__(self, rtf: str, suite: str, directory: Path, *options: str) -> None:
        directory.mkdir()
        self.journal = directory / "latest" / "events.jsonl"
        self.output = directory / "output"
        with self.output.open("wb") as output:
            self.process = subprocess.Popen(
                [rtf, "run", "--results", str(directory), *options, suite],
                cwd=directory,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )

    def wait(self) -> int:
        """Waits for the exit code and prints rtf's output."""
        try:
            return self.process.wait(RUN_SECS)
        finally:
            self.stop()
            print(self.output.read_text(errors="replace"), flush=True)

    def stop(self) -> None:
        """Terminates the run if it is still active."""
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait()

    def disturb(
        self, disturbance: Callable[[], None], test: str = "", *, once: str = "test-phase"
    ) -> None:
        """Waits until a test runs, or for an event of the kind `once`, and calls `disturbance`.

        `test` is the test's name; by default, any test. The run is terminated on an error.
        """
        try:
            self.wait_for(
                lambda event: (
                    is_a(event, once)
                    and (once != "test-phase" or event["phase"] == "run")
                    and (not test or self.name(event) == test)
                )
            )
            disturbance()
        except BaseException:
            self.stop()
            raise

    def collapses(self, disturbance: Callable[[], None], test: str = "") -> float:
        """The same, then waits for a collapse; returns the seconds until then."""
        disturbed = 0.0

        def disturb() -> None:
            nonlocal disturbed
            disturbance()
            disturbed = time.monotonic()
            self.wait_for(lambda event: is_a(event, "fixture-collapsed"))

        self.disturb(disturb, test)
        return time.monotonic() - disturbed

    def wait_for(self, condition: Callable[[Event], bool]) -> None:
        """Waits for an event that meets the condition."""
        deadline = time.monotonic() + RUN_SECS
        while not any(condition(event) for event in self.events()):
            if self.process.poll() is not None or time.monotonic() > deadline:
                self.wait()
                raise AssertionError("the run ended or hangs before the expected event")
            time.sleep(0.02)

    def events(self, kind: str = "") -> Iterator[Event]:
        """The events in the journal, or those of a kind, without an incomplete last line."""
        if self.journal.exists():
            # `splitlines` would also split at other separators, which a name may contain.
            for line in self.journal.read_text(encoding="utf-8").split("\n")[:-1]:
                event = json.loads(line)
                if not kind or is_a(event, kind):
                    yield event

    def name(self, event: Event) -> str:
        """The name of an event's test."""
        names = {each["test"]: each["name"] for each in self.events("test-planned")}
        return str(names[event["test"]])

    def verdicts(self) -> dict[str, str]:
        """The last verdict of each test."""
        return {self.name(event): event["verdict"] for event in self.events("test-finished")}

    def attempts(self) -> list[str]:
        """The verdicts of all attempts, in order."""
        return [event["verdict"] for event in self.events("test-finished")]

    def reasons(self, kind: str = "fixture-collapsed") -> list[str]:
        """The reasons of collapses or of other events."""
        return [str(event["reason"]) for event in self.events(kind)]

    def problems(self) -> list[str]:
        """The problems of fixtures in set-up or tear-down."""
        return [each["problem"] for each in self.events("fixture-stopped") if "problem" in each]

    def reason(self, kind: str = "fixture-collapsed") -> str:
        """The reason of the only event of this kind."""
        (reason,) = self.reasons(kind)
        return reason


def is_a(event: Event, kind: str) -> bool:
    """Whether the event is of this kind."""
    return bool(event["type"] == kind)


def expect(what: str, got: object, expected: object) -> None:
    """Fails with a message if a value is not as expected."""
    if got != expected:
        raise AssertionError(f"{what}: got {got}, expected {expected}")
    print(f"ok: {what}: {got}", flush=True)


def expect_in(text: str, message: str) -> None:
    """Fails with a message if a text is not part of another."""
    expect(f"`{text}` in {message!r}", text in message, True)
