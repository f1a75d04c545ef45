"""10 000 episodes of a trivial simulator: what rtf adds to each, its memory, the merged report."""

from __future__ import annotations

import shutil
from pathlib import Path

from measuring.bench import Bench
from measuring.model import Group, Limit, Line, Samples, Work
from measuring.suite import expect_in

EPISODES = 10_000
WORKERS = 2
PER_EPISODE = "ms/episode"
SECONDS = "s"
MEMORY = "MB"

RUN = "rtf campaign run"
MERGE = "rtf merge of a campaign"

# The simulator stays up, and its reset does nothing.
SUITE = """<suite name="simulated">
  <fixture name="simulator" type="process">
    <command>sleep inf</command>
    <reset command="/bin/true"/>
  </fixture>
  <test>Trivial.lua</test>
</suite>
"""
CAMPAIGN = f"""<campaign suite="simulated.xml" episodes="{EPISODES}">
  <parameter name="load" distribution="uniform" low="0" high="1"/>
  <claim require="rate >= 0.9" confidence="0.95"/>
</campaign>
"""


def group(bench: Bench) -> Group:
    """The campaign, and then the report of its workers."""
    directory = bench.directory / "campaign"
    directory.mkdir(exist_ok=True)
    shutil.copy(Path(__file__).parents[1] / "plugins" / "Trivial.lua", directory)
    (directory / "simulated.xml").write_text(SUITE, encoding="utf-8")
    (directory / "campaign.xml").write_text(CAMPAIGN, encoding="utf-8")
    works = (Work(RUN, lambda: run(bench, directory)), Work(MERGE, lambda: merge(bench, directory)))
    name = f"{EPISODES:,}".replace(",", " ") + " episodes on two workers"
    lines = (
        Line(name, RUN, PER_EPISODE, limit=Limit(5)),
        Line(f"{name}, memory", RUN, MEMORY, limit=Limit(200)),
        Line(f"{name}, merged", MERGE, SECONDS, limit=Limit(5)),
        Line(f"{name}, memory of rtf merge", MERGE, MEMORY, limit=Limit(200)),
    )
    return Group("campaigns", works, lines, rounds=1, warm_up=False)


def run(bench: Bench, directory: Path) -> Samples:
    """The campaign; its memory is that of its largest process."""
    results = directory / "results"
    shutil.rmtree(results, ignore_errors=True)
    command = [str(bench.rtf), "campaign", "run", str(directory / "campaign.xml"), "--no-history"]
    launched = bench.launch([*command, "--results", str(results), "--workers", str(WORKERS)])
    expect_in(results / "campaigns/latest/results.jsonl", EPISODES, '"outcome":"passed"')
    milliseconds = launched.seconds * 1000 / EPISODES
    return {PER_EPISODE: [milliseconds], MEMORY: [launched.children[0].rss_mb]}


def merge(bench: Bench, directory: Path) -> Samples:
    """One run with all episodes."""
    campaign = (directory / "results/campaigns/latest").resolve()
    runs = [str(path.resolve()) for path in sorted(campaign.glob("workers/*/latest"))]
    merged = directory / "merged"
    launched = bench.launch([str(bench.rtf), "merge", *runs, "--results", str(merged)])
    expect_in(merged / "latest/events.jsonl", EPISODES, '"type":"test-finished"')
    shutil.rmtree(merged)
    return {SECONDS: [launched.seconds], MEMORY: [launched.children[0].rss_mb]}
