"""Checks `rtf campaign run --executor slurm`: part of check.py."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

from cluster import (
    commands,
    equal,
    expect,
    finish,
    finish_with_output,
    jobs,
    scontrol,
    start_waiting_tasks,
    until,
)

# Half of the episodes fail. While the file `hold` exists, they wait.
GRASP = """function TestCase.run()
  local dir = os.getenv("RTF_PARAM_DIR")
  local ran = io.open(dir .. "/ran", "a")
  ran:write(os.getenv("RTF_EPISODE"), " ", os.getenv("SLURMD_NODENAME") or "local", "\\n")
  ran:close()
  rtf.sleep(0.1)
  while io.open(dir .. "/hold") do rtf.sleep(0.05) end
  rtf.check(tonumber(os.getenv("RTF_PARAM_LOAD")) < 1, "too heavy")
end
"""
SUITE = '<suite name="grasp" {attributes}><test>Grasp.lua</test></suite>'
CAMPAIGN = """<campaign suite="{suite}.xml" episodes="{episodes}" seed="3">
  <parameter name="load" distribution="uniform" low="0" high="2"/>
  <claim require="rate >= {rate}" confidence="0.9"/>
  {stop}
</campaign>
"""

EPISODES = 40

Results = dict[int, tuple[str, str]]


class Campaigns:
    """A directory with campaigns, shared by all nodes."""

    def __init__(self, rtf: str, directory: Path) -> None:
        self.rtf = rtf
        self.dir = directory
        (directory / "Grasp.lua").write_text(GRASP)
        (directory / "grasp.xml").write_text(SUITE.format(attributes=""))
        # The licence of the cluster.
        (directory / "robot.xml").write_text(SUITE.format(attributes='requires="robot"'))

    def start(
        self,
        *args: str,
        suite: str = "grasp",
        episodes: int = EPISODES,
        rate: str = "0.1",
        stop: str = "",
    ) -> subprocess.Popen[str]:
        """Starts a campaign."""
        text = CAMPAIGN.format(suite=suite, episodes=episodes, rate=rate, stop=stop)
        if stop:
            text = text.replace(' confidence="0.9"', "")
        (self.dir / "campaign.xml").write_text(text)
        return self.rtf_campaign("campaign.xml", "--set", f"dir={self.dir}", *args)

    def start_in_cluster(self, *args: str, **campaign: Any) -> subprocess.Popen[str]:
        """Starts a campaign with four tasks."""
        return self.start("--executor", "slurm", "--shards", "4", *args, **campaign)

    def resume(self) -> subprocess.Popen[str]:
        """Continues the newest campaign."""
        return self.rtf_campaign("--resume", str(self.newest()))

    def rtf_campaign(self, *args: str) -> subprocess.Popen[str]:
        """Starts `rtf campaign run`."""
        command = [self.rtf, "campaign", "run", *args]
        pipe = subprocess.PIPE
        return subprocess.Popen(command, cwd=self.dir, text=True, stdout=pipe, stderr=pipe)

    def hold(self) -> None:
        """Lets the episodes wait."""
        (self.dir / "hold").touch()

    def release(self) -> None:
        """Lets the episodes continue."""
        (self.dir / "hold").unlink()

    def ran(self) -> list[tuple[int, str]]:
        """The episodes that have started, with their nodes."""
        path = self.dir / "ran"
        lines = path.read_text().splitlines() if path.exists() else []
        return [(int(line.split()[0]), line.split()[1]) for line in lines]

    def newest(self) -> Path:
        """The directory of the newest campaign."""
        return (self.dir / "rtf-results/campaigns/latest").resolve()

    def results(self) -> Results:
        """The final result and the reason of each episode. Fails if an episode has several."""
        lines = (self.newest() / "results.jsonl").read_text().splitlines()
        results = [json.loads(line) for line in lines]
        found = {it["episode"]: (it["outcome"], it.get("reason", "")) for it in results}
        equal(len(found), len(results))
        return found

    def add_late_results(self, episodes: set[int]) -> None:
        """Adds a further result for each of these episodes, as a late attempt might."""
        for file in self.newest().glob("workers/*/*Z-*/episodes.jsonl"):
            lines = [json.loads(line) for line in file.read_text().splitlines()]
            for episode in {line["episode"] for line in lines} & episodes:
                with file.open("a") as more:
                    more.write(json.dumps({"episode": episode, "outcome": "error"}) + "\n")

    def recorded(self) -> Counter[int]:
        """How many results each episode has in the files of the workers."""
        files = self.newest().glob("workers/*/*Z-*/episodes.jsonl")
        lines = [json.loads(line) for file in files for line in file.read_text().splitlines()]
        return Counter(line["episode"] for line in lines if "outcome" in line)


def same_results(campaigns: Campaigns) -> None:
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


def failed_node_and_killed_process(campaigns: Campaigns) -> None:
    """A node fails, and the submitting process is killed: each episode has one final result."""
    process = campaigns.start_in_cluster()
    until("some episodes have results", lambda: campaigns.recorded().total() >= 8)
    campaigns.hold()
    until("all tasks wait", lambda: len(campaigns.ran()) == campaigns.recorded().total() + 4)
    process.kill()
    process.communicate()
    before = campaigns.recorded()
    expect(len(before) < EPISODES - 4, str(before))
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
    results = campaigns.results()
    equal(sorted(results), list(range(1, EPISODES + 1)))
    equal([path.name for path in (campaigns.newest() / "arrays").iterdir()], ["1"])
    attempts = campaigns.newest().glob("arrays/1/parts/*/*")
    equal(sorted(attempt.name for attempt in attempts), ["0", "0", "0", "0", "1", "1"])
    runs = Counter(episode for episode, _ in campaigns.ran())
    equal({episode for episode in before if runs[episode] > 1}, set())
    equal(len([episode for episode in runs if runs[episode] == 2]), 2)
    finish(campaigns.start("--workers", "2"), 0)
    equal(campaigns.results(), results)


def worker_that_dies(campaigns: Campaigns) -> None:
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


def early_end(campaigns: Campaigns) -> None:
    """A decided claim ends the array."""
    stop = '<stop rule="sprt" low="0.8" high="0.95" alpha="0.01" beta="0.01"/>'
    process = campaigns.start_in_cluster(episodes=5000, rate="0.9", stop=stop)
    output, _ = finish_with_output(process, 1)
    expect("decided after" in output, output)
    equal(jobs(), {})
    expect(len(campaigns.results()) < 1000, output)


def cancelled_and_continued(campaigns: Campaigns) -> None:
    """Ctrl-C leaves no job and no process, and the rest runs later."""
    process = campaigns.start_in_cluster()
    until("some episodes have results", lambda: campaigns.recorded().total() >= 4)
    campaigns.hold()
    until("all tasks wait", lambda: len(campaigns.ran()) == campaigns.recorded().total() + 4)
    process.send_signal(signal.SIGINT)
    finish(process, 130)
    equal(jobs(), {})
    equal(commands(lambda command: str(campaigns.dir) in command), {})
    before = campaigns.recorded()
    expect(len(before) < EPISODES - 4, str(before))
    campaigns.release()
    finish(campaigns.resume(), 0)
    equal(campaigns.recorded(), Counter(range(1, EPISODES + 1)))
    equal(sorted(campaigns.results()), list(range(1, EPISODES + 1)))


def killed_while_it_stops(campaigns: Campaigns) -> None:
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


def campaign_licences(campaigns: Campaigns) -> None:
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


CHECKS = [
    same_results,
    failed_node_and_killed_process,
    worker_that_dies,
    early_end,
    cancelled_and_continued,
    killed_while_it_stops,
    campaign_licences,
]
