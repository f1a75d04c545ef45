#!/usr/bin/env python3
"""Checks `rtf run --executor slurm` with a real cluster of two nodes: tools/slurm.sh check.py RTF.

A sharded suite has the verdicts of a local run, a task of a node that fails is run again, a
cancelled submission leaves nothing, and a submission whose process was killed is resumed.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

LIMIT = 120.0
"""Seconds in which each expected event must occur."""

TESTS = 12

PASSES = "function TestCase.run() end\n"
FAILS = "function TestCase.run() rtf.fail('it is wrong') end\n"
# Runs until the file `go` exists.
WAITS = """function TestCase.run()
  local started = io.open(os.getenv("RTF_PARAM_DIR") .. "/started", "a")
  started:write(os.getenv("SLURMD_NODENAME"), "\\n")
  started:close()
  while not io.open(os.getenv("RTF_PARAM_DIR") .. "/go") do rtf.sleep(0.05) end
end
"""

Verdicts = dict[str, str]


class Project:
    """A directory with a suite, shared by all nodes."""

    def __init__(self, rtf: str, directory: Path) -> None:
        self.rtf = rtf
        self.dir = directory
        (directory / "passes.lua").write_text(PASSES)
        (directory / "fails.lua").write_text(FAILS)
        (directory / "waits.lua").write_text(WAITS)
        names = [f"T{number}" for number in range(TESTS)]
        kinds = ["fails" if number % 5 == 0 else "passes" for number in range(TESTS)]
        self.suite("arm", dict(zip(names, kinds, strict=True)))
        self.suite("slow", dict.fromkeys("ABCD", "waits"))
        # The licence of the cluster.
        self.suite("robot", dict.fromkeys("ABCD", "waits"), 'requires="robot"')

    def suite(self, name: str, tests: dict[str, str], attributes: str = "") -> None:
        """Writes a suite with tests by name."""
        lines = "".join(f'<test name="{test}">{kind}.lua</test>' for test, kind in tests.items())
        (self.dir / f"{name}.xml").write_text(f'<suite name="{name}" {attributes}>{lines}</suite>')

    def command(self, *args: str) -> list[str]:
        """The command of a run."""
        return [self.rtf, "run", "--no-history", *args]

    def start(self, *args: str) -> subprocess.Popen[str]:
        """Starts a run with four shards in the cluster."""
        command = self.command(*args, "--executor", "slurm", "--shards", "4", "--shard-by", "count")
        command += ["--set", f"dir={self.dir}"]
        return subprocess.Popen(
            command, cwd=self.dir, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )

    def started(self) -> list[str]:
        """The nodes of the tests that have started."""
        path = self.dir / "started"
        return path.read_text().split() if path.exists() else []

    def go(self) -> None:
        """Lets the waiting tests end."""
        (self.dir / "go").touch()

    def submission(self) -> Path:
        """The directory of the only submission."""
        (found,) = (self.dir / "rtf-results/.submissions").iterdir()
        return found


def main() -> int:
    """Runs all checks."""
    rtf = str(Path(sys.argv[1]).resolve())
    checks = [verdicts, merged_reports, licences, failed_node, lost_task, cancelled, resumed]
    for check in checks:
        with tempfile.TemporaryDirectory() as directory:
            started = time.monotonic()
            check(Project(rtf, Path(directory).resolve()))
        print(f"ok  {check.__name__}  {time.monotonic() - started:.1f} s")
        until("the cluster is idle", lambda: not jobs() and nodes() == {"idle"})
    return 0


def verdicts(project: Project) -> None:
    """The same verdicts and exit code as a local run, in one merged run."""
    local = subprocess.run(
        project.command("arm.xml"), check=False, cwd=project.dir, capture_output=True
    )
    expected = stored(project)
    run = finish(project.start("arm.xml"), local.returncode)
    equal(stored(project), expected)
    equal(len(expected), TESTS)
    expect("4 of 4 tasks ended, 0 running, 0 waiting; 12 of 12 tests finished" in run, run)


def merged_reports(project: Project) -> None:
    """Reports and the history have the merged run only."""
    process = project.start("arm.xml", "--report", "junit=junit.xml", "--symlink", "newest")
    finish(process, 1)
    equal((project.dir / "junit.xml").read_text().count("<testcase"), TESTS)
    expect((project.dir / "newest/events.jsonl").exists(), "no link")
    expect(not (project.dir / "rtf-results/history.db").exists(), "there is a history")


def licences(project: Project) -> None:
    """Tasks that need the only licence never run at the same time."""
    process = project.start("robot.xml", "--executor-licenses")
    until("a test has started", lambda: bool(project.started()))
    until("the others wait", lambda: list(jobs().values()).count("Licenses") == 3)
    equal(len(project.started()), 1)
    project.go()
    finish(process, 0)


def failed_node(project: Project) -> None:
    """The tasks of a node that fails are run again."""
    process = project.start("slow.xml")
    until("all tests have started", lambda: len(project.started()) == 4)
    # The node returns when its `slurmd` registers again.
    scontrol("update", "NodeName=n2", "State=DOWN", "Reason=test")
    until("two tasks wait", lambda: list(jobs().values()).count("BeginTime") == 2)
    project.go()
    # By default, they would start after two minutes.
    for task in [task for task, reason in jobs().items() if reason == "BeginTime"]:
        scontrol("update", f"JobId={task}", "StartTime=now")
    finish(process, 0)
    equal(stored(project), dict.fromkeys("ABCD", "passed"))
    attempts = project.submission().glob("parts/*/*")
    equal(sorted(attempt.name for attempt in attempts), ["0", "0", "0", "0", "1", "1"])


def lost_task(project: Project) -> None:
    """A task whose runner and guard were killed is reported, and the run is not green."""
    process = project.start("slow.xml")
    until("all tests have started", lambda: len(project.started()) == 4)
    killed = commands(lambda command: f"--array-task=1:0:{project.submission()}" in command)
    equal(len(killed), 2)
    # The runner first: the end of its stopped guard would continue it.
    runner_first = sorted(killed, key=lambda process_id: parent(process_id) not in killed)
    for number in (signal.SIGSTOP, signal.SIGKILL):
        for process_id in runner_first:
            os.kill(process_id, number)
    until("the task has ended", lambda: len(jobs()) == 3)
    project.go()
    output = finish(process, 5)
    expect(re.search(r"error: task 1 died: its run has no end", output) is not None, output)


def cancelled(project: Project) -> None:
    """Ctrl-C leaves no job and no process, and the results of what ran."""
    process = project.start("slow.xml")
    until("all tests have started", lambda: len(project.started()) == 4)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    equal(jobs(), {})
    equal(set(stored(project).values()), {"interrupted"})
    equal(commands(lambda command: str(project.dir) in command), {})


def resumed(project: Project) -> None:
    """Another process merges the submission of a killed one."""
    process = project.start("slow.xml", "--report", "junit=junit.xml")
    until("all tests have started", lambda: len(project.started()) == 4)
    process.kill()
    process.communicate()
    equal(len(jobs()), 4)
    resume = [project.rtf, "run", "--resume", str(project.submission())]
    follower = subprocess.Popen(
        resume, cwd="/", text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    project.go()
    finish(follower, 0)
    equal(len(stored(project)), 4)
    equal((project.dir / "junit.xml").read_text().count("<testcase"), 4)


def finish(process: subprocess.Popen[str], code: int) -> str:
    """Waits for a run; returns its standard error."""
    stdout, stderr = process.communicate(timeout=LIMIT)
    expect(process.returncode == code, f"exit code {process.returncode}\n{stdout}\n{stderr}")
    return stderr


def stored(project: Project) -> Verdicts:
    """The verdicts of the newest run, by the names of the tests."""
    journal = project.dir / "rtf-results/latest/events.jsonl"
    events = [json.loads(line) for line in journal.read_text().splitlines()]
    names = {event["test"]: event["name"] for event in events if event["type"] == "test-planned"}
    finished = [event for event in events if event["type"] == "test-finished"]
    equal(len(finished), len(names))
    return {names[event["test"]]: event["verdict"] for event in finished}


def jobs() -> dict[str, str]:
    """The tasks that have not ended, with the reason why they wait."""
    lines = output("squeue", "--noheader", "--array", "--format=%i %r").splitlines()
    return dict(line.split(maxsplit=1) for line in lines)


def nodes() -> set[str]:
    """The states of the nodes."""
    return set(output("sinfo", "--noheader", "--Node", "--format=%t").split())


def commands(is_wanted: Callable[[str], bool]) -> dict[int, str]:
    """The processes with such a command, by id."""
    found = {}
    for process in Path("/proc").iterdir():
        if process.name.isdigit():
            try:
                command = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
            if is_wanted(command):
                found[int(process.name)] = command
    return found


def parent(process_id: int) -> int:
    """The parent of a process."""
    status = Path(f"/proc/{process_id}/status").read_text()
    return int(status.split("PPid:")[1].split()[0])


def scontrol(*args: str) -> None:
    """Changes the cluster."""
    subprocess.run(["scontrol", *args], check=True)


def output(*command: str) -> str:
    """The output of a command."""
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def until(what: str, is_true: Callable[[], bool]) -> None:
    """Waits for something."""
    deadline = time.monotonic() + LIMIT
    while not is_true():
        if time.monotonic() > deadline:
            sys.exit(f"after {LIMIT} s: not {what}: {output('squeue')}")
        time.sleep(0.05)


def equal(actual: object, expected: object) -> None:
    """Exits unless the values are equal."""
    expect(actual == expected, f"{actual} is not {expected}")


def expect(is_true: bool, message: str) -> None:
    """Exits with a message unless it is true."""
    if not is_true:
        raise AssertionError(message)


if __name__ == "__main__":
    os.environ.pop("RTF_RESULTS", None)
    sys.exit(main())
