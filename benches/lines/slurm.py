"""How much faster a campaign is on two nodes of a Slurm cluster than on one."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from measuring.bench import TOP, Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work
from measuring.suite import expect_in

EPISODES = 2000
EPISODE_SECS = 0.1
UNIT = "episodes/s"

ONE = "rtf campaign run on one node"
TWO = "rtf campaign run on two nodes"

TEST = f"function TestCase.run() rtf.sleep({EPISODE_SECS}) end\n"
SUITE = '<suite name="simulated"><test>Simulated.lua</test></suite>'
CAMPAIGN = f"""<campaign suite="simulated.xml" episodes="{EPISODES}">
  <parameter name="load" distribution="uniform" low="0" high="1"/>
  <claim require="rate >= 0.9" confidence="0.95"/>
</campaign>
"""
# The start of the cluster does not count.
MEASURE = """
import subprocess, sys, time
begin = time.monotonic()
subprocess.run(sys.argv[2:], check=True)
open(sys.argv[1], "w").write(str(time.monotonic() - begin))
"""


def group(bench: Bench) -> Group:
    """Episodes that sleep, with one task per processor: each node of the cluster has two."""
    directory = bench.directory / "slurm"
    directory.mkdir(exist_ok=True)
    (directory / "Simulated.lua").write_text(TEST, encoding="utf-8")
    (directory / "simulated.xml").write_text(SUITE, encoding="utf-8")
    (directory / "campaign.xml").write_text(CAMPAIGN, encoding="utf-8")
    one = ("--shards", "2", "--executor-arg=--nodelist=n1")
    two = ("--shards", "4")
    works = (
        Work(ONE, lambda: run(bench, directory, *one), missing()),
        Work(TWO, lambda: run(bench, directory, *two), missing()),
    )
    limit = Limit(1.8, of_ratio=True, at_least=True)
    lines = (Line(f"{EPISODES} episodes of 0.1 s on Slurm", TWO, UNIT, ONE, limit),)
    return Group("slurm", works, lines, rounds=1, warm_up=False)


def missing() -> str:
    """Why there is no cluster on this machine."""
    if os.geteuid() != 0:
        return "a Slurm cluster needs root"
    return "" if shutil.which("apt-get") else "Slurm is unpacked from Debian's packages"


def run(bench: Bench, directory: Path, *options: str) -> Samples:
    """One campaign in a new cluster."""
    seconds = directory / "seconds"
    results = directory / "results"
    measured = [str(bench.rtf), "campaign", "run", str(directory / "campaign.xml")]
    measured += ["--results", str(results), "--executor", "slurm", *options]
    bench.launch(
        [str(TOP / "tools/slurm.sh"), "python3", "-c", MEASURE, str(seconds), *measured], codes=(0,)
    )
    campaign = (results / "campaigns/latest").resolve()
    expect_in(campaign / "results.jsonl", EPISODES, '"outcome":"passed"')
    tasks = len(list(campaign.glob("arrays/1/parts/*")))
    if tasks != int(options[1]):
        raise MeasuringError(f"the job had {tasks} tasks")
    shutil.rmtree(results)
    return {UNIT: [EPISODES / float(seconds.read_text(encoding="utf-8"))]}
