"""Campaigns in a directory that all nodes of a cluster share."""

from __future__ import annotations

import json
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

from cluster_project import Executor
from waiting import EPISODES, equal, expect, finish, until

# Half of the episodes fail. While the file `hold` exists, they wait.
GRASP = """function TestCase.run()
  local dir = os.getenv("RTF_PARAM_DIR")
  local ran = io.open(dir .. "/ran", "a")
  local node = os.getenv("SLURMD_NODENAME") or os.getenv("NODE") or "local"
  ran:write(os.getenv("RTF_EPISODE"), " ", node, "\\n")
  ran:close()
  rtf.sleep(0.1)
  while io.open(dir .. "/hold") do rtf.sleep(0.05) end
  rtf.check(tonumber(os.getenv("RTF_PARAM_LOAD")) < 1, "too heavy")
end
"""
# The same in a test that runs four episodes at a time.
BATCH = """import os
import time
from pathlib import Path

import rtf


class Batch(rtf.EpisodeTest):
    def episode(self, episode):
        folder = Path(os.environ["RTF_PARAM_DIR"])
        node = os.environ.get("SLURMD_NODENAME", "local")
        with (folder / "ran").open("a") as ran:
            ran.write(f"{episode.id} {node}\\n")
        for _ in range(20):
            time.sleep(0.005)
            yield
        while (folder / "hold").exists():
            time.sleep(0.05)
            yield
        return float(episode.parameter("load")) < 1 or "too heavy"
"""
SUITE = '<suite name="grasp" {attributes}><test>Grasp.lua</test></suite>'
CAMPAIGN = """<campaign suite="{suite}.xml" episodes="{episodes}" seed="3">
  <parameter name="load" distribution="uniform" low="0" high="2"/>
  <claim require="rate >= {rate}" confidence="0.9"/>
  {stop}
</campaign>
"""

SLOTS = 4
"""How many episodes a batch has at a time."""

Results = dict[int, tuple[str, str]]


class Campaigns:
    """A directory with campaigns, shared by all nodes."""

    def __init__(self, rtf: str, directory: Path, executor: Executor) -> None:
        self.rtf = rtf
        self.executor = executor
        self.dir = directory
        (directory / "Grasp.lua").write_text(GRASP)
        (directory / "grasp.xml").write_text(SUITE.format(attributes=""))
        (directory / "Batch.py").write_text(BATCH)
        (directory / "batch.xml").write_text(
            f'<suite name="batch"><test slots="{SLOTS}">Batch.py</test></suite>'
        )
        # The only robot of the cluster.
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
        return self.start(*self.executor.options, "--shards", "4", *args, **campaign)

    def start_and_hold(self, results: int) -> subprocess.Popen[str]:
        """Starts a campaign with four tasks, which all wait in an episode after some results."""
        process = self.start_in_cluster()
        until("some episodes have results", lambda: self.recorded().total() >= results)
        self.hold()
        until("all tasks wait", lambda: len(self.ran()) == self.recorded().total() + 4)
        expect(len(self.recorded()) < EPISODES - 4, "most episodes have results")
        return process

    def resume(self) -> subprocess.Popen[str]:
        """Continues the newest campaign."""
        return self.rtf_campaign("--resume", str(self.newest()))

    def rtf_campaign(self, *args: str) -> subprocess.Popen[str]:
        """Starts `rtf campaign run`."""
        command = [self.rtf, "campaign", "run", *args]
        return self.executor.start(command, self.dir)

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

    def ran_once(self) -> None:
        """Each episode has one final result and one result of a worker."""
        equal(self.recorded(), Counter(range(1, EPISODES + 1)))
        equal(sorted(self.results()), list(range(1, EPISODES + 1)))

    def two_tasks_ran_again(self, before: Counter[int]) -> None:
        """After a node failed, its two tasks continued in the same job, without the episodes that
        had results before. Each episode has one final result, which is that of a local run.
        """
        results = self.results()
        equal(sorted(results), list(range(1, EPISODES + 1)))
        equal([path.name for path in (self.newest() / "arrays").iterdir()], ["1"])
        attempts = self.newest().glob("arrays/1/parts/*/*")
        equal(sorted(attempt.name for attempt in attempts), ["0", "0", "0", "0", "1", "1"])
        runs = Counter(episode for episode, _ in self.ran())
        equal({episode for episode in before if runs[episode] > 1}, set())
        equal(len([episode for episode in runs if runs[episode] == 2]), 2)
        finish(self.start("--workers", "2"), 0)
        equal(self.results(), results)
