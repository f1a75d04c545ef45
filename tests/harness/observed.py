"""The tests and cases of a run, from its journal."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Event = dict[str, Any]
PROBLEMS = ("failure", "error")


@dataclass
class CaseResult:
    """A case."""

    path: str
    parent: int | None
    location: str
    tags: list[str]
    parameters: dict[str, str]
    verdict: str = "open"
    reason: str = ""
    messages: list[str] = field(default_factory=list)
    measured: dict[str, float | None] = field(default_factory=dict)
    problem_location: str = ""
    started: int = 0
    seconds: float = 0.0


@dataclass
class TestResult:
    """A test: the last attempt of its last repetition."""

    __test__ = False  # pytest would take it for a class of tests

    verdict: str = "open"
    reason: str = ""
    stacks: str = ""
    messages: list[str] = field(default_factory=list)
    measured: dict[str, float | None] = field(default_factory=dict)
    output: dict[str, str] = field(default_factory=lambda: {"stdout": "", "stderr": ""})
    by_id: dict[int, CaseResult] = field(default_factory=dict)

    @property
    def cases(self) -> dict[str, CaseResult]:
        """The cases by path."""
        return {case.path: case for case in self.by_id.values()}

    def start_case(self, event: Event) -> None:
        """Adds a case."""
        parent = event.get("parent")
        prefix = f"{self.by_id[parent].path}/" if parent else ""
        parameters = event.get("parameters", [])
        self.by_id[event["case"]] = CaseResult(
            path=prefix + event["name"],
            parent=parent,
            location=located(event),
            tags=event.get("tags", []),
            parameters={each["name"]: each["value"] for each in parameters},
            started=event["at"],
        )

    def add_message(self, message: Event) -> None:
        """Adds a message to its case, or to the test."""
        case = self.by_id.get(message.get("case", 0))
        (case or self).messages.append(message["text"])
        if case and message["kind"] in PROBLEMS and not case.problem_location:
            case.problem_location = located(message)


def located(event: Event) -> str:
    """`FILE:LINE` without directories."""
    location = event.get("location")
    return f"{Path(location['file']).name}:{location['line']}" if location else ""


def observe(events: Iterable[Event]) -> dict[str, TestResult]:
    """The tests of a run by name."""
    names: dict[int, str] = {}
    tests: dict[str, TestResult] = {}
    for event in events:
        if event["type"] == "test-planned":
            names[event["test"]] = event["name"]
        elif event["type"] == "test-started":
            tests[names[event["test"]]] = TestResult()
        elif event["type"] == "test-skipped":
            skipped = tests.setdefault(names[event["test"]], TestResult())
            skipped.verdict, skipped.reason = "skipped", event.get("reason", "")
        else:
            source = event.get("source") or {}
            number = event.get("test", source.get("test"))
            if number is not None and names[number] in tests:
                add(tests[names[number]], event)
    return tests


def add(test: TestResult, event: Event) -> None:
    """Adds an event to its test."""
    match event["type"]:
        case "case-started":
            test.start_case(event)
        case "case-finished":
            case = test.by_id[event["case"]]
            case.verdict, case.reason = event["verdict"], event.get("reason", "")
            case.seconds = event.get("duration_us", event["at"] - case.started) / 1e6
        case "message":
            test.add_message(event["message"])
        case "measured":
            measurement = event["measurement"]
            owner = test.by_id.get(measurement.get("case", 0)) or test
            owner.measured[measurement["name"]] = measurement["value"]
        case "output":
            test.output[event["stream"]] += event["text"]
        case "stack-dumped":
            test.stacks += event["text"]
        case "test-finished":
            test.verdict, test.reason = event["verdict"], event.get("reason", "")
