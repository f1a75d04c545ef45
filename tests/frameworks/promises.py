#!/usr/bin/env python3
"""Checks the promises about every test on the tests of a framework.

    promises.py RTF TYPE

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
import json
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools")]

from observed import TestResult, observe  # noqa: E402
from run import Run, is_a  # noqa: E402

Table = dict[str, Any]
POLL_SECS = 0.02
CASES = {"first": "first", "second": "second", "third": "third"}


def main() -> int:
    """Prints all broken promises; the exit code is 1 if there is any."""
    rtf, framework = str(Path(sys.argv[1]).resolve()), sys.argv[2]
    table: Table = json.loads((Path(__file__).parent / "promises.json").read_text())
    if framework not in table["types"]:
        raise SystemExit(f"promises.json has no type `{framework}`")
    with tempfile.TemporaryDirectory() as name:
        promises = Promises(rtf, framework, table, Path(name))
        promises.check()
    print(f"\n{promises.checked} promises kept, {len(promises.broken)} broken")
    for broken in promises.broken:
        print(f"broken: {broken}")
    return 1 if promises.broken else 0


class Promises:
    """The promises to one framework."""

    def __init__(self, rtf: str, framework: str, table: Table, directory: Path) -> None:
        self.rtf, self.framework, self.directory = rtf, framework, directory
        self.type: Table = table["types"][framework]
        self.promises: dict[str, Table] = table["promises"]
        self.cases: dict[str, str] = self.type.get("cases", CASES)
        self.broken: list[str] = []
        self.checked = 0

    def check(self) -> None:
        """Runs all tests that nothing disturbs in one suite, and each other test alone."""
        together: dict[str, tuple[Table, str]] = {}
        for name, promise in self.promises.items():
            if "refused" in self.exception(name):
                self.check_refused(name, promise)
                continue
            for mode in self.type["modes"]:
                title = f"{name} ({mode})"
                if "when" in promise:
                    self.check_disturbed(title, promise, mode)
                else:
                    together[title] = (promise, mode)
        run = self.start(
            "all", {title: self.test(title, *each) for title, each in together.items()}
        )
        run.wait()
        events = list(run.events())
        results = observe(events)
        processes = processes_of(self.directory_of("all"))
        self.expect("processes after the run of all", processes, [])
        for title, (_, mode) in together.items():
            self.compare(title, mode, results.get(title, TestResult()), left_of(events, title))

    def exception(self, name: str) -> Table:
        """What the type does not keep of a promise."""
        exceptions: Table = self.type.get("except", {})
        found: Table = exceptions.get(name, {})
        return found

    def test(self, title: str, promise: Table, mode: str) -> str:
        """The test of a promise."""
        attributes = {"name": title, "type": self.framework, "param": self.type.get("param", "")}
        attributes |= promise.get("attributes", {})
        if mode == "case":
            attributes["isolation"] = "case"
        words = " ".join(f"{key}={quoteattr(value)}" for key, value in attributes.items())
        variables = {"PROMISE": promise["does"], "MEASURES": promise.get("measures")}
        return f"<test {words}>{self.file()}{environment(variables)}</test>"

    def file(self) -> str:
        """The file of all tests."""
        source = ROOT / "tests/frameworks" / self.framework
        out = ROOT / "build/frameworks" / self.framework
        text: str = self.type["file"]
        return text.format(source=source, out=out)

    def directory_of(self, title: str) -> Path:
        """A directory whose name needs no quotes."""
        return self.directory / "".join(filter(str.isalnum, title))

    def suite(self, title: str, tests: dict[str, str], fixture: str = "") -> Path:
        """Writes a suite; returns its directory."""
        directory = self.directory_of(title)
        directory.mkdir()
        variables = environment({"MARK": "a b", "PROMISE_DIR": str(directory)})
        text = "\n".join([variables, self.type.get("fixture", ""), fixture, *tests.values()])
        parallel = self.type.get("parallel", 3)
        (directory / "suite.xml").write_text(
            f"<suite name='promises' parallel='{parallel}'>\n{text}\n</suite>\n"
        )
        return directory

    def start(self, title: str, tests: dict[str, str], fixture: str = "") -> Run:
        """Starts a run of tests."""
        directory = self.suite(title, tests, fixture)
        return Run(self.rtf, str(directory / "suite.xml"), directory / "results")

    def check_refused(self, name: str, promise: Table) -> None:
        """`rtf check` reports a promise that the type does not keep."""
        directory = self.suite(name, {name: self.test(name, promise, self.type["modes"][0])})
        command = [self.rtf, "check", str(directory / "suite.xml")]
        done = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
        text = self.exception(name)["refused"]
        self.expect(f"{name}: `{text}` in {done.stdout!r}", text in done.stdout, True)

    def check_disturbed(self, title: str, promise: Table, mode: str) -> None:
        """Interrupts a run while its command runs, or lets its fixture collapse."""
        directory = self.directory_of(title)
        wait = f"while ! test -e {directory}/collapse; do sleep 0.05; done"
        command = f"<command>sh -c {quoteattr(wait)}</command>"
        arm = f"<fixture name='arm' type='process'>{command}</fixture>"
        fixture = arm if promise["when"] == "collapse" else ""
        run = self.start(title, {title: self.test(title, promise, mode)}, fixture)
        try:
            while not (directory / "runs").exists() and run.process.poll() is None:
                time.sleep(POLL_SECS)
            case = self.cases.get("second")
            if case and self.verdicts(title, mode)["second"]:
                run.wait_for(lambda event: is_a(event, "case-started") and event["name"] == case)
            if promise["when"] == "collapse":
                (directory / "collapse").touch()
            else:
                run.process.send_signal(signal.SIGINT)
        finally:
            run.wait()
        events = list(run.events())
        self.compare(title, mode, observe(events).get(title, TestResult()), left_of(events, title))
        self.expect(f"{title}: processes after the run", processes_of(directory), [])
        if file := self.expected(title, mode).get("file"):
            self.expect(f"{title}: {file} exists", (directory / file).exists(), True)

    def expected(self, title: str, mode: str) -> Table:
        """What the table expects of a test."""
        name = title.removesuffix(f" ({mode})")
        promise = self.promises[name]
        separate = promise.get("separate", {}) if mode != "process" else {}
        return {**promise["expected"], **self.exception(name), **separate}

    def verdicts(self, title: str, mode: str) -> dict[str, str | None]:
        """The verdicts that the table expects of the cases."""
        verdicts: dict[str, str | None] = dict.fromkeys(self.cases, "passed")
        verdicts |= self.expected(title, mode).get("cases", {})
        return verdicts

    def compare(self, title: str, mode: str, got: TestResult, left: int) -> None:
        """Compares a result with the table."""
        expected = self.expected(title, mode)
        self.expect(f"{title}: verdict ({got.reason})", got.verdict, expected["verdict"])
        reason = expected.get("reason", "")
        self.expect(f"{title}: `{reason}` in {got.reason!r}", reason in got.reason, True)
        self.expect(f"{title}: processes left", left, expected.get("left", 0))
        for stream in ("stdout", "stderr"):
            text = expected.get(stream, "")
            self.expect(f"{title}: `{text}` in {stream}", text in got.output[stream], True)
        verdicts = self.verdicts(title, mode)
        wanted = {self.cases[case]: verdicts[case] for case in self.cases if verdicts[case]}
        found = {case.path: case.verdict for case in got.by_id.values() if case.parent is None}
        for case in {case for case, verdict in wanted.items() if verdict == "any"}:
            wanted[case] = found.setdefault(case, "any")
        self.expect(f"{title}: cases", found, wanted)
        owners = {"": got.measured, **{case.path: case.measured for case in got.by_id.values()}}
        measured = {owner: values for owner, values in owners.items() if values}
        third = {self.cases.get("third", ""): expected.get("measured")}
        wanted_values = {owner: values for owner, values in third.items() if values}
        self.expect(f"{title}: measured", measured, wanted_values)

    def expect(self, what: str, got: object, expected: object) -> None:
        """Remembers a broken promise."""
        self.checked += got == expected
        if got != expected:
            self.broken.append(f"{what}: got {got!r}, expected {expected!r}")


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


if __name__ == "__main__":
    sys.exit(main())
