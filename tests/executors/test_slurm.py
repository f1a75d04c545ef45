"""`rtf run --executor slurm` with a real cluster of two nodes, see tools/slurm.sh.

RTF_TEST_EPISODES is the number of episodes of a campaign, 40 by default.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess

import pytest
from cluster_project import TESTS, Project, stored
from slurm_cluster import jobs, scontrol, start_waiting_tasks
from waiting import commands, equal, expect, finish, parent, until

pytestmark = pytest.mark.first


def test_verdicts_are_those_of_a_local_run(project: Project) -> None:
    """The same verdicts and exit code as a local run, in one merged run."""
    local = subprocess.run(
        project.command("arm.xml"), check=False, cwd=project.dir, capture_output=True
    )
    expected = stored(project)
    errors = finish(project.start("arm.xml"), local.returncode)
    equal(stored(project), expected)
    equal(len(expected), TESTS)
    expect("4 of 4 tasks ended, 0 running, 0 waiting; 12 of 12 tests finished" in errors, errors)


def test_reports_have_the_merged_run_only(project: Project) -> None:
    """Reports and the history have the merged run only."""
    process = project.start("arm.xml", "--report", "junit=junit.xml", "--symlink", "newest")
    finish(process, 1)
    equal((project.dir / "junit.xml").read_text().count("<testcase"), TESTS)
    expect((project.dir / "newest/events.jsonl").exists(), "no link")
    expect(not (project.dir / "rtf-results/history.db").exists(), "there is a history")


def test_tasks_that_need_the_only_licence_run_one_by_one(project: Project) -> None:
    """Tasks that need the only licence never run at the same time."""
    process = project.start("robot.xml", "--executor-licenses")
    until("a test has started", lambda: bool(project.started()))
    until("the others wait", lambda: list(jobs().values()).count("Licenses") == 3)
    equal(len(project.started()), 1)
    project.go()
    finish(process, 0)


def test_tasks_of_a_node_that_fails_run_again(project: Project) -> None:
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


def test_a_task_that_was_killed_is_reported(project: Project) -> None:
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


def test_ctrl_c_leaves_no_job_and_no_process(project: Project) -> None:
    """Ctrl-C leaves no job and no process, and the results of what ran."""
    process = project.start("slow.xml")
    until("all tests have started", lambda: len(project.started()) == 4)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    equal(jobs(), {})
    equal(set(stored(project).values()), {"interrupted"})
    equal(commands(lambda command: str(project.dir) in command), {})


def test_another_process_merges_the_submission_of_a_killed_one(project: Project) -> None:
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
