"""Checks `rtf campaign run --executor kubernetes`: part of kubernetes_checks.py."""

from __future__ import annotations

import os
import signal

from cluster_campaigns import Campaigns
from kubernetes_cluster import NAMESPACE, Cluster
from waiting import EPISODES, commands, equal, expect, finish, finish_with_output, until

HOOKED = """<suite name="hooked">
  <hook on="end"><command>false</command></hook>
  <test>Grasp.lua</test>
</suite>"""


def campaign_results(_: Cluster, campaigns: Campaigns) -> None:
    """The results of all episodes are the same on 2 local workers and in the cluster."""
    finish(campaigns.start("--workers", "2"), 0)
    expected = campaigns.results()
    equal(len(expected), EPISODES)
    equal({outcome for outcome, _ in expected.values()}, {"passed", "failed"})
    (campaigns.dir / "ran").unlink()
    errors = finish(campaigns.start_in_cluster(), 0)
    equal(campaigns.results(), expected)
    equal({node for _, node in campaigns.ran()}, {"n1", "n2"})
    expect("4 of 4 tasks ended, 0 running, 0 waiting" in errors, errors)
    # Failed episodes are no failure of a pod that another one would repeat.
    expect("failed" not in errors, errors)


def campaign_by_hand(cluster: Cluster, campaigns: Campaigns) -> None:
    """A printed job that the user submits is followed."""
    output, _ = finish_with_output(campaigns.start_in_cluster("--executor-print"), 0)
    (campaigns.dir / "job.json").write_text(output)
    job = str(campaigns.dir / "job.json")
    cluster.kubectl("create", "--namespace", NAMESPACE, "--filename", job)
    finish(campaigns.resume(), 0)
    equal(sorted(campaigns.results()), list(range(1, EPISODES + 1)))
    equal([path.name for path in (campaigns.newest() / "arrays").iterdir()], ["1"])


def campaign_lost_node_and_killed_process(cluster: Cluster, campaigns: Campaigns) -> None:
    """A node fails, and the submitting process is killed: each episode has one final result."""
    process = campaigns.start_and_hold(EPISODES // 2)
    process.kill()
    process.communicate()
    before = campaigns.recorded()
    cluster.kill_node("n2")
    failed = {episode for episode, node in campaigns.ran() if node == "n2"}
    campaigns.add_late_results(failed & set(before))
    follower = campaigns.resume()
    # The controller that removes the pods of lost nodes waits for a minute.
    until("two tasks wait", lambda: len(cluster.pods("Pending")) == 2)
    campaigns.release()
    output, errors = finish_with_output(follower, 0)
    expect("errors and collapses" not in output, output)
    expect("was ended: DeletionByPodGC" in errors, errors)
    campaigns.two_tasks_ran_again(before)


def campaign_killed_pod(cluster: Cluster, campaigns: Campaigns) -> None:
    """The pod of a task that was killed runs again, with the episodes that have no result."""
    campaigns.hold()
    process = campaigns.start_in_cluster()
    until("all tasks wait", lambda: len(campaigns.ran()) == 4)
    array = campaigns.newest() / "arrays/1"
    for task in commands(lambda command: f"--array-task=1:0:{array}" in command):
        os.kill(task, signal.SIGKILL)
    until("the pod has failed", lambda: len(cluster.pods("Failed")) == 1)
    campaigns.release()
    output, errors = finish_with_output(process, 0)
    expect("task 1: pod " in errors and "failed with exit code 137" in errors, errors)
    equal(sorted(campaigns.results()), list(range(1, EPISODES + 1)))
    equal(set(campaigns.recorded().values()), {1})
    equal(sorted(path.name for path in (array / "parts/1").iterdir()), ["0", "1"])
    expect("errors and collapses" not in output, output)


def campaign_failed_hook(cluster: Cluster, campaigns: Campaigns) -> None:
    """A failed hook ends the campaign."""
    (campaigns.dir / "hooked.xml").write_text(HOOKED)
    output, _ = finish_with_output(campaigns.start_in_cluster(suite="hooked"), 4)
    expect("hook" in output, output)
    equal(cluster.pods("Running"), [])


def campaign_decided_early(cluster: Cluster, campaigns: Campaigns) -> None:
    """A decided claim ends the job."""
    stop = '<stop rule="sprt" low="0.8" high="0.95" alpha="0.01" beta="0.01"/>'
    process = campaigns.start_in_cluster(episodes=5000, rate="0.9", stop=stop)
    output, _ = finish_with_output(process, 1)
    expect("decided after" in output, output)
    equal((cluster.objects("jobs"), cluster.objects("pods")), ([], []))
    expect(len(campaigns.results()) < 1000, output)


def campaign_cancelled_and_continued(cluster: Cluster, campaigns: Campaigns) -> None:
    """Ctrl-C leaves no job and no process, and the rest runs later."""
    process = campaigns.start_and_hold(4)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    equal((cluster.objects("jobs"), cluster.objects("pods")), ([], []))
    equal(commands(lambda command: str(campaigns.dir) in command), {})
    campaigns.release()
    finish(campaigns.resume(), 0)
    campaigns.ran_once()


CHECKS = [
    campaign_results,
    campaign_by_hand,
    campaign_lost_node_and_killed_process,
    campaign_killed_pod,
    campaign_failed_hook,
    campaign_decided_early,
    campaign_cancelled_and_continued,
]
