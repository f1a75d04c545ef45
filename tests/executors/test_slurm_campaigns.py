"""`rtf campaign run --executor slurm` with a real cluster of two nodes, see tools/slurm.sh."""

from __future__ import annotations

import os
import signal

import pytest
from cluster_campaigns import SLOTS, Campaigns
from slurm_cluster import jobs, scontrol, start_waiting_tasks
from waiting import EPISODES, commands, equal, expect, finish, finish_with_output, until

pytestmark = pytest.mark.first


def test_results_are_the_same_on_local_workers_and_in_the_cluster(campaigns: Campaigns) -> None:
    """The results of all episodes are the same on 1, 2 and 4 workers and in the cluster."""
    results = []
    for workers in "124":
        finish(campaigns.start("--workers", workers), 0)
        results.append(campaigns.results())
    equal(len(results[0]), EPISODES)
    equal({outcome for outcome, _ in results[0].values()}, {"passed", "failed"})
    (campaigns.dir / "ran").unlink()
    errors = finish(campaigns.start_in_cluster(), 0)
    results.append(campaigns.results())
    for others in results:
        equal(others, results[0])
    equal({node for _, node in campaigns.ran()}, {"n1", "n2"})
    expect("4 of 4 tasks ended, 0 running, 0 waiting" in errors, errors)


def test_a_failed_node_and_a_killed_process(campaigns: Campaigns) -> None:
    """A node fails, and the submitting process is killed: each episode has one final result."""
    process = campaigns.start_and_hold(EPISODES // 2)
    process.kill()
    process.communicate()
    before = campaigns.recorded()
    # The node returns when its `slurmd` registers again.
    scontrol("update", "NodeName=n2", "State=DOWN", "Reason=test")
    until("two tasks wait", lambda: list(jobs().values()).count("BeginTime") == 2)
    failed = {episode for episode, node in campaigns.ran() if node == "n2"}
    campaigns.add_late_results(failed & set(before))
    follower = campaigns.resume()
    start_waiting_tasks()
    campaigns.release()
    output, _ = finish_with_output(follower, 0)
    expect("errors and collapses" not in output, output)
    campaigns.two_tasks_ran_again(before)


def test_the_episode_of_a_killed_worker_is_repeated(campaigns: Campaigns) -> None:
    """The episode of a task that was killed is the bench's, and repeated in a further array."""
    campaigns.hold()
    process = campaigns.start_in_cluster()
    until("all tasks wait", lambda: len(campaigns.ran()) == 4)
    array = campaigns.newest() / "arrays/1"
    (task,) = commands(lambda command: f"--array-task=1:0:{array}" in command)
    os.kill(task, signal.SIGKILL)
    until("the task has ended", lambda: len(jobs()) == 3)
    campaigns.release()
    output, _ = finish_with_output(process, 0)
    expect("errors and collapses of the bench: 1" in output, output)
    expect("worker 1 was killed" in output, output)
    equal(sorted(campaigns.results()), list(range(1, EPISODES + 1)))
    equal(len(list((campaigns.newest() / "arrays").iterdir())), 2)
    equal(set(campaigns.recorded().values()), {1})


def test_batches_on_a_failed_node_and_in_a_killed_worker(campaigns: Campaigns) -> None:
    """The episodes that they had at a time are repeated: each has one final result."""
    finish(campaigns.start("--workers", "1", suite="batch"), 0)
    expected = campaigns.results()
    equal({outcome for outcome, _ in expected.values()}, {"passed", "failed"})
    (campaigns.dir / "ran").unlink()
    process = campaigns.start_in_cluster(suite="batch")
    until("some episodes have results", lambda: campaigns.recorded().total() >= SLOTS)
    campaigns.hold()

    def open_on(node: str) -> int:
        started = {episode for episode, place in campaigns.ran() if place == node}
        return len(started - set(campaigns.recorded()))

    until("all wait", lambda: all(open_on(node) == 2 * SLOTS for node in ("n1", "n2")))
    scontrol("update", "NodeName=n2", "State=DOWN", "Reason=test")
    until("two tasks wait", lambda: list(jobs().values()).count("BeginTime") == 2)
    worker = next(iter(commands(lambda command: f":{campaigns.newest()}/arrays/1" in command)))
    os.kill(worker, signal.SIGKILL)
    start_waiting_tasks()
    campaigns.release()
    output, _ = finish_with_output(process, 0)
    expect(f"a process that ended, and repeated: {SLOTS}" in output, output)
    equal(campaigns.results(), expected)


def test_a_decided_claim_ends_the_array(campaigns: Campaigns) -> None:
    """A decided claim ends the array."""
    stop = '<stop rule="sprt" low="0.8" high="0.95" alpha="0.01" beta="0.01"/>'
    process = campaigns.start_in_cluster(episodes=5000, rate="0.9", stop=stop)
    output, _ = finish_with_output(process, 1)
    expect("decided after" in output, output)
    equal(jobs(), {})
    expect(len(campaigns.results()) < 1000, output)


def test_a_cancelled_campaign_is_continued(campaigns: Campaigns) -> None:
    """Ctrl-C leaves no job and no process, and the rest runs later."""
    process = campaigns.start_and_hold(4)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    equal(jobs(), {})
    equal(commands(lambda command: str(campaigns.dir) in command), {})
    campaigns.release()
    finish(campaigns.resume(), 0)
    campaigns.ran_once()


def test_a_campaign_that_was_killed_while_it_stops_is_continued(campaigns: Campaigns) -> None:
    """A process that was killed after Ctrl-C is continued: the stopped array first ends."""
    campaigns.hold()
    process = campaigns.start_in_cluster()
    until("all tasks wait", lambda: len(campaigns.ran()) == 4)
    process.send_signal(signal.SIGINT)
    until("it is cancelled", (campaigns.newest() / "arrays/1/cancelled").exists)
    process.kill()
    process.communicate()
    campaigns.release()
    finish(campaigns.resume(), 0)
    equal(sorted(campaigns.results()), list(range(1, EPISODES + 1)))


def test_workers_that_need_the_only_licence_run_one_by_one(campaigns: Campaigns) -> None:
    """Tasks that need the only licence never run at the same time."""
    campaigns.hold()
    process = campaigns.start_in_cluster(
        "--executor-licenses", suite="robot", episodes=8, rate="0.01"
    )
    until("an episode has started", lambda: bool(campaigns.ran()))
    until("the others wait", lambda: list(jobs().values()).count("Licenses") == 3)
    equal(len(campaigns.ran()), 1)
    campaigns.release()
    finish(process, 0)
    equal(len(campaigns.results()), 8)
