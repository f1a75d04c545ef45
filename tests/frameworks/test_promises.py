"""Checks the promises about every test on the tests of each framework.

`promises.json` is the table. Each program in it has three cases: `first` and `third` pass, and
`second` runs the shell command in `PROMISE`. With the variable `MEASURES`, `third` also reports
the measurement `force` = 2.5, with `MEASURES` as its upper limit if it can have one. A promise
has

    does          the command
    measures      the variable `MEASURES`, by default none
    attributes    of the test
    when          `interrupt` or `collapse`: what happens while the command runs; it has then
                  written `$PROMISE_DIR/runs`; nothing outlives the run
    expected      `verdict`; `reason`: a part of it; `left`: how many processes were left behind,
                  by default 0; `stdout`, `stderr`: a part of it; `file`: one that the command
                  has written in `$PROMISE_DIR`;
                  `measured`: the measurements of `third`, or of a test without cases, by default
                  none; all others have none;
                  `cases`: those that did not pass, with `null` for one that is not reported, and
                  `any` for one that may be
    separate      replaces parts of it if each case has a process

and a type

    file, param   of its tests
    modes         `process`: one process for all cases; `case`: the same with isolation="case";
                  `always`: each case has a process
    fixture       an element that each suite has. `BLOCKED` are the signals that its programs block
                  in processes that they start, as a number
    parallel      how many tests run at once, by default 3
    cases         the names of the cases, by default the same
    except        for each promise that it cannot keep: replaces parts of `expected`, or `refused`
                  is a part of what `rtf check` prints
"""

from __future__ import annotations

import contextlib
import functools
import json
import signal
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast
from xml.sax.saxutils import quoteattr

import pytest
from corpora import BUILDS, SOURCES, TYPES, build, parameter
from observed import TestResult, observe
from run import Run, is_a

Table = dict[str, Any]
POLL_SECS = 0.02
CASES = {"first": "first", "second": "second", "third": "third"}
TABLE: Table = json.loads((SOURCES / "promises.json").read_text())


@dataclass(frozen=True)
class Promise:
    """A promise to the tests of a type, with an isolation mode."""

    type: str
    name: str
    mode: str

    @property
    def title(self) -> str:
        """The name of its test."""
        return f"{self.name} ({self.mode})"

    @property
    def of_type(self) -> Table:
        """The type in the table."""
        found: Table = TABLE["types"][self.type]
        return found

    @property
    def promised(self) -> Table:
        """The promise in the table."""
        found: Table = TABLE["promises"][self.name]
        return found

    @property
    def exception(self) -> Table:
        """What the type does not keep of it."""
        found: Table = self.of_type.get("except", {}).get(self.name, {})
        return found

    @property
    def kind(self) -> str:
        """How it is checked."""
        if "refused" in self.exception:
            return "refused"
        return "disturbed" if "when" in self.promised else "together"

    @property
    def cases(self) -> dict[str, str]:
        """The names of the cases."""
        found: dict[str, str] = self.of_type.get("cases", CASES)
        return found

    @property
    def expected(self) -> Table:
        """What the table expects of its test."""
        separate = self.promised.get("separate", {}) if self.mode != "process" else {}
        return {**self.promised["expected"], **self.exception, **separate}

    @property
    def verdicts(self) -> dict[str, str | None]:
        """The verdicts that the table expects of the cases."""
        verdicts: dict[str, str | None] = dict.fromkeys(self.cases, "passed")
        verdicts |= self.expected.get("cases", {})
        return verdicts

    def test(self) -> str:
        """Its test, as an element of a suite."""
        attributes = {"name": self.title, "type": self.type}
        attributes["param"] = self.of_type.get("param", "")
        attributes |= self.promised.get("attributes", {})
        if self.mode == "case":
            attributes["isolation"] = "case"
        words = " ".join(f"{key}={quoteattr(value)}" for key, value in attributes.items())
        variables = {"PROMISE": self.promised["does"], "MEASURES": self.promised.get("measures")}
        places = {"source": SOURCES / self.type, "out": BUILDS / self.type}
        file = self.of_type["file"].format(**places)
        return f"<test {words}>{file}{environment(variables)}</test>"

    def compare(self, got: TestResult, left: int) -> None:
        """Compares a result with the table."""
        expected = self.expected
        assert got.verdict == expected["verdict"], got.reason
        assert expected.get("reason", "") in got.reason
        assert left == expected.get("left", 0), "processes left"
        for stream in ("stdout", "stderr"):
            assert expected.get(stream, "") in got.output[stream]
        verdicts = self.verdicts
        wanted = {self.cases[case]: verdicts[case] for case in self.cases if verdicts[case]}
        found = {case.path: case.verdict for case in got.by_id.values() if case.parent is None}
        for case in {case for case, verdict in wanted.items() if verdict == "any"}:
            wanted[case] = found.setdefault(case, "any")
        assert found == wanted
        owners = {"": got.measured, **{case.path: case.measured for case in got.by_id.values()}}
        measured = {owner: values for owner, values in owners.items() if values}
        third = {self.cases.get("third", ""): expected.get("measured")}
        assert measured == {owner: values for owner, values in third.items() if values}


def promises() -> Iterator[Promise]:
    """The promises to all types. A refused one is the same in all modes."""
    for framework, of_type in TABLE["types"].items():
        for name in TABLE["promises"]:
            for mode in of_type["modes"]:
                promise = Promise(framework, name, mode)
                if promise.kind != "refused" or mode == of_type["modes"][0]:
                    yield promise


def of_kind(kind: str) -> pytest.MarkDecorator:
    """Runs a test for each promise of a kind; those of a type that run together are a group."""
    chosen = [each for each in promises() if each.kind == kind]
    group = "promises" if kind == "together" else ""
    cases = [parameter(it.type, it, f"{it.name}-{it.mode}", group) for it in chosen]
    return pytest.mark.parametrize("promise", cases)


def test_each_type_has_promises() -> None:
    assert sorted(TABLE["types"]) == TYPES


@of_kind("together")
def test_a_promise_is_kept(
    rtf: str,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
    promise: Promise,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    build(promise.type, monkeypatch)
    functions = (item for item in request.session.items if isinstance(item, pytest.Function))
    same = (item for item in functions if item.function is request.function)
    selected = (cast("Promise", item.callspec.params["promise"]) for item in same)
    chosen = tuple(each for each in selected if each.type == promise.type)
    directory = tmp_path_factory.getbasetemp() / f"promises-to-{promise.type}"
    run = start_together(rtf, chosen, directory)
    run.wait()
    assert processes_of(directory) == [], "processes after the run of all"
    events = list(run.events())
    result = observe(events).get(promise.title, TestResult())
    promise.compare(result, left_of(events, promise.title))


@of_kind("disturbed")
def test_a_promise_is_kept_if_the_run_is_interrupted_or_a_fixture_collapses(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, promise: Promise
) -> None:
    build(promise.type, monkeypatch)
    wait = f"while ! test -e {tmp_path}/collapse; do sleep 0.05; done"
    command = f"<command>sh -c {quoteattr(wait)}</command>"
    arm = f"<fixture name='arm' type='process'>{command}</fixture>"
    collapses = promise.promised["when"] == "collapse"
    suite = write_suite(tmp_path, (promise,), arm if collapses else "")
    run = Run(rtf, str(suite), tmp_path / "results")
    try:
        while not (tmp_path / "runs").exists() and run.process.poll() is None:
            time.sleep(POLL_SECS)
        case = promise.cases.get("second")
        if case and promise.verdicts["second"]:
            run.wait_for(lambda event: is_a(event, "case-started") and event["name"] == case)
        if collapses:
            (tmp_path / "collapse").touch()
        else:
            run.process.send_signal(signal.SIGINT)
    finally:
        run.wait()
    events = list(run.events())
    result = observe(events).get(promise.title, TestResult())
    promise.compare(result, left_of(events, promise.title))
    assert processes_of(tmp_path) == [], "processes after the run"
    if file := promise.expected.get("file"):
        assert (tmp_path / file).exists()


@of_kind("refused")
def test_a_promise_that_a_type_cannot_keep_is_refused(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, promise: Promise
) -> None:
    build(promise.type, monkeypatch)
    command = [rtf, "check", str(write_suite(tmp_path, (promise,)))]
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    assert promise.exception["refused"] in done.stdout


@functools.cache
def start_together(rtf: str, chosen: tuple[Promise, ...], directory: Path) -> Run:
    """Runs the tests of all chosen promises to a type in one suite, several at once."""
    directory.mkdir()
    return Run(rtf, str(write_suite(directory, chosen)), directory / "results")


def write_suite(directory: Path, chosen: tuple[Promise, ...], fixture: str = "") -> Path:
    """Writes a suite with the tests of promises to one type."""
    of_type = chosen[0].of_type
    variables = environment({"MARK": "a b", "PROMISE_DIR": str(directory)})
    tests = (each.test() for each in chosen)
    text = "\n".join([variables, of_type.get("fixture", ""), fixture, *tests])
    suite = directory / "suite.xml"
    suite.write_text(
        f"<suite name='promises' parallel='{of_type.get('parallel', 3)}'>\n{text}\n</suite>\n"
    )
    return suite


def environment(variables: dict[str, str | None]) -> str:
    """The elements of a suite that set variables."""
    return "".join(
        f"<env name='{name}' value={quoteattr(value)}/>"
        for name, value in variables.items()
        if value is not None
    )


def processes_of(directory: Path) -> list[str]:
    """The commands of all processes that have the directory of a suite in their environment."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        # It may have ended, or be another user's.
        with contextlib.suppress(OSError):
            if f"PROMISE_DIR={directory}\0".encode() in (process / "environ").read_bytes():
                found.append((process / "cmdline").read_text(errors="replace"))
    return found


def left_of(events: list[Table], title: str) -> int:
    """How many processes a test left behind."""
    planned = {event["name"]: event["test"] for event in events if event["type"] == "test-planned"}
    source = {"test": planned.get(title)}
    leaks = [event for event in events if event["type"] == "processes-leaked"]
    return sum(len(event["processes"]) for event in leaks if event["source"] == source)
