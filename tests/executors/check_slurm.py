#!/usr/bin/env python3
"""Checks `rtf run --executor slurm` with a real cluster of two nodes:
tools/slurm.sh check_slurm.py RTF.

A sharded suite has the verdicts of a local run, a task of a node that fails is run again, a
cancelled submission leaves nothing, and a submission whose process was killed is resumed. The
same for campaigns, in slurm_campaigns.py. A further argument selects the checks whose names
contain it. RTF_TEST_EPISODES is the number of episodes of a campaign, 40 by default.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import slurm_campaigns
from campaigns import Campaigns
from project import TESTS, Executor, Project, stored
from slurm import jobs, nodes, scontrol, start_waiting_tasks
from waiting import commands, equal, expect, finish, parent, until

SLURM = Executor(["--executor", "slurm"])


def main() -> int:
    """Runs all checks."""
    rtf = str(Path(sys.argv[1]).resolve())
    word = sys.argv[2] if len(sys.argv) > 2 else ""
    runs = [verdicts, merged_reports, licences, failed_node, lost_task, cancelled, resumed]
    checks = [(check.__name__, partial(run, check)) for check in runs]
    checks += [(check.__name__, partial(run_campaigns, check)) for check in slurm_campaigns.CHECKS]
    for name, check in checks:
        if word not in name:
            continue
        started = time.monotonic()
        with tempfile.TemporaryDirectory() as directory:
            check(rtf, Path(directory).resolve())
        print(f"ok  {name}  {time.monotonic() - started:.1f} s", flush=True)
        until("the cluster is idle", lambda: not jobs() and nodes() == {"idle"})
    return 0


def run(check: Callable[[Project], None], rtf: str, directory: Path) -> None:
    """Runs a check in a new directory."""
    check(Project(rtf, directory, SLURM))


def run_campaigns(check: Callable[[Campaigns], None], rtf: str, directory: Path) -> None:
    """Runs a check of campaigns in a new directory."""
    check(Campaigns(rtf, directory, SLURM))


def verdicts(project: Project) -> None:
    """The same verdicts and exit code as a local run, in one merged run."""
    local = subprocess.run(
        project.command("arm.xml"), check=False, cwd=project.dir, capture_output=True
    )
    expected = stored(project)
    errors = finish(project.start("arm.xml"), local.returncode)
    equal(stored(project), expected)
    equal(len(expected), TESTS)
    expect("4 of 4 tasks ended, 0 running, 0 waiting; 12 of 12 tests finished" in errors, errors)


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
    start_waiting_tasks()
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


if __name__ == "__main__":
    os.environ.pop("RTF_RESULTS", None)
    sys.exit(main())
