"""Runs example 12 as a user does: two policies, a comparison that finds which is worse and where,
a failed episode again with its samples, and that results do not depend on how episodes run. The
commands of the guide's page about policies, which has the same requirements, run, too.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from checkout import ROOT
from pages import commands, write_files
from run import Run, expect, expect_in

pytestmark = pytest.mark.venv("episodes")
EXAMPLE = ROOT / "examples/12-policies"
EPISODES = 200
LATEST = "rtf-results/learned/campaigns/latest"
LEARNED = ["--set", "controller=learned"]
HEAVIEST_SEEN = 1.0
"""The payload in kg up to which the learned policy has demonstrations."""


@pytest.fixture(name="example")
def copied_example(tmp_path: Path) -> Path:
    """A copy of the example, without results."""
    ignored = shutil.ignore_patterns("__pycache__", "rtf-results")
    return Path(shutil.copytree(EXAMPLE, tmp_path / "example", ignore=ignored))


def call(rtf: str, example: Path, *args: str, code: int) -> str:
    """What a command prints."""
    ran = subprocess.run([rtf, *args], cwd=example, stdout=subprocess.PIPE, text=True, check=False)
    print(ran.stdout, flush=True)
    expect(" ".join(args), ran.returncode, code)
    return ran.stdout


def document(rtf: str, example: Path, *args: str, code: int) -> dict[str, Any]:
    """What a command prints as JSON."""
    found: dict[str, Any] = json.loads(call(rtf, example, *args, "--format", "json", code=code))
    return found


def results(example: Path, version: str) -> list[dict[str, Any]]:
    """The results of the newest campaign of a version."""
    file = example / "rtf-results" / version / "campaigns/latest/results.jsonl"
    return [json.loads(line) for line in file.read_text().splitlines()]


def parameters(example: Path, version: str) -> dict[int, dict[str, str]]:
    """The parameters of the episodes, by their ids."""
    file = example / "rtf-results" / version / "campaigns/latest/episodes.jsonl"
    lines = map(json.loads, file.read_text().splitlines())
    return {line["id"]: line["parameters"] for line in lines}


@pytest.mark.first
def test_the_comparison_finds_which_policy_is_worse_and_where(rtf: str, example: Path) -> None:
    call(rtf, example, "run", "reach.xml", code=0)
    run = ["campaign", "run", "campaign.xml"]
    call(rtf, example, *run, "--results", "rtf-results/pd", code=0)
    output = call(rtf, example, *run, "--results", "rtf-results/learned", *LEARNED, code=1)
    expect_in("claim rate >= 0.9: failed", output)
    expect("all have a result", len(results(example, "learned")), EPISODES)
    versions = ["rtf-results/pd/campaigns/latest", LATEST]
    compare = ["campaign", "compare", *versions, "--by", "payload"]
    text = call(rtf, example, *compare, code=1)
    expect_in(f"{EPISODES} episodes with a result in both", text)
    expect_in("2 is worse than 1 (p <= 0.05)", text)
    fails_where_it_has_seen_nothing(example)
    shows_the_reason(rtf, example)
    repeats_an_episode(rtf, example)


def fails_where_it_has_seen_nothing(example: Path) -> None:
    """All failed episodes have payloads without demonstrations, and most of the heaviest fail."""
    payloads = {id_: float(of["payload"]) for id_, of in parameters(example, "learned").items()}
    outcomes = {line["episode"]: line["outcome"] for line in results(example, "learned")}
    failed = [payloads[id_] for id_, outcome in outcomes.items() if outcome == "failed"]
    expect("the lightest that fails", min(failed) > HEAVIEST_SEEN * 0.95, True)
    heaviest = [outcomes[id_] for id_, payload in payloads.items() if payload > HEAVIEST_SEEN + 0.3]
    expect("the heaviest fail", heaviest.count("failed") > len(heaviest) * 0.8, True)


def shows_the_reason(rtf: str, example: Path) -> None:
    """The payload is the parameter with the largest effect, and the map is drawn."""
    options = ["campaign", "show", LATEST, "--map", "payload,target"]
    found = document(rtf, example, *options, code=0)
    expect("the reason", found["parameters"][0]["name"], "payload")
    expect(
        "the rows of the map",
        sorted(row[0] for row in found["map"]["rows"]),
        ["high", "level", "low"],
    )


def repeats_an_episode(rtf: str, example: Path) -> None:
    """A failed episode fails in the same way, and has the samples of both joints."""
    first = next(line for line in results(example, "learned") if line["outcome"] == "failed")
    options = ["--episode", str(first["episode"]), *LEARNED, "--report", "html=episode.html"]
    run = Run(rtf, str(example / "campaign.xml"), example / "episode", *options)
    expect("exit code", run.wait(), 1)
    [case] = run.events("case-finished")
    expect_in(case["reason"], first["reason"])
    expect("the steps", case["episode"]["steps"], measured(first, "steps"))
    batches = [event["samples"] for event in run.events("sampled")]
    expect("signals", {batch["name"] for batch in batches}, {"shoulder", "elbow"})
    expect("of the episode", {batch["case"] for batch in batches}, {case["case"]})
    times = sorted(time for batch in batches for time, _ in batch["points"])
    expect("the whole episode", (times[0], times[-1]), (0.0, 2.0))


def measured(result: dict[str, Any], name: str) -> float:
    """A measurement of an episode."""
    [value] = [each["value"] for each in result["measurements"] if each["name"] == name]
    return float(value)


def test_the_plan_finds_fewer_episodes_than_the_campaign_has(rtf: str, example: Path) -> None:
    options = ["campaign", "plan", "--detect", "15%", "--rate", "0.9"]
    text = call(rtf, example, *options, code=0)
    expect_in("112 (80.2 %)  in pairs, if the results of an episode are independent", text)


def test_results_do_not_depend_on_how_episodes_run(rtf: str, example: Path) -> None:
    options = ["campaign", "invariance", "campaign.xml", "--episodes", "50", *LEARNED]
    expect_in("no variation changes results", call(rtf, example, *options, code=0))


def test_an_ignored_seed_is_an_error_that_names_the_slots(rtf: str, example: Path) -> None:
    environment = example / "arm_env.py"
    source = environment.read_text()
    expect_in("super().reset(seed=seed, options=options)", source)
    environment.write_text(source.replace("reset(seed=seed, ", "reset("))
    output = call(rtf, example, "run", "reach.xml", code=1)
    expect_in("ignore the seed", output)


def test_an_exception_ends_only_its_own_episodes(rtf: str, example: Path) -> None:
    environment = example / "arm_env.py"
    source = environment.read_text()
    expect_in("        self.data.ctrl[:] = action\n", source)
    raising = (
        "        assert self.payload < 1.495, 'too heavy'\n        self.data.ctrl[:] = action\n"
    )
    environment.write_text(source.replace("        self.data.ctrl[:] = action\n", raising))
    output = call(
        rtf, example, "campaign", "run", "campaign.xml", "--results", "rtf-results/heavy", code=0
    )
    expect_in("claim rate >= 0.9: passed", output)
    heavy = {i for i, of in parameters(example, "heavy").items() if float(of["payload"]) >= 1.495}
    outcomes = {line["episode"]: line["outcome"] for line in results(example, "heavy")}
    errors = {id_ for id_, outcome in outcomes.items() if outcome == "error"}
    expect("the errors", errors, heavy)
    expect("the others", {outcomes[id_] for id_ in outcomes if id_ not in heavy}, {"passed"})


def test_page_about_policies(rtf: str, tmp_path: Path) -> None:
    """In the order of the page, with the outputs that it shows."""
    page = ROOT / "docs/how-to/evaluate-a-policy.md"
    write_files(page, tmp_path)
    for block in commands(page):
        ran = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", block.text],
            cwd=tmp_path,
            env=os.environ | {"PATH": f"{Path(rtf).parent}:{os.environ['PATH']}"},
            stdout=subprocess.PIPE,
            text=True,
            check=False,
        )
        print(block.text, ran.stdout, sep="\n", flush=True)
        expect("exit code", ran.returncode, block.exit_code)
        expect("the output is that of the page", block.matches(ran.stdout), True)
