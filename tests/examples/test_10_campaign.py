"""Runs example 10 as a user does: a claim that holds, one that fails, the map that shows why, the
smallest change that fails, and the programs that search.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
from checkout import ROOT, venv
from run import expect, expect_in

pytestmark = pytest.mark.venv("demo")
EXAMPLE = ROOT / "examples/10-campaign"
EPISODES = 500


class Campaigns:
    """The example's campaigns, with results in a directory."""

    def __init__(self, rtf: str, results: Path) -> None:
        self.rtf, self.results = rtf, results

    def call(self, *args: str, code: int) -> str:
        """What a command prints."""
        done = subprocess.run(
            [self.rtf, *args, "--results", str(self.results)],
            cwd=EXAMPLE,
            stdout=subprocess.PIPE,
            text=True,
            check=False,
        )
        print(done.stdout)
        expect(" ".join(args), done.returncode, code)
        return done.stdout

    def show(self) -> dict[str, Any]:
        """The results of the newest campaign."""
        options = ["--format", "json", "--map", "payload,friction"]
        text = self.call("campaign", "show", *options, code=0)
        document: dict[str, Any] = json.loads(text)
        return document


@pytest.fixture
def campaigns(rtf: str, tmp_path: Path) -> Campaigns:
    """A directory without results."""
    return Campaigns(rtf, tmp_path)


def test_an_episode_is_a_suite(campaigns: Campaigns) -> None:
    campaigns.call("run", "carry.xml", code=0)


@pytest.mark.first
def test_the_claim_holds_for_the_payload_of_the_data_sheet(campaigns: Campaigns) -> None:
    campaigns.call("campaign", "run", "campaign.xml", "--workers", "2", code=0)
    found = campaigns.show()
    expect("passed", found["passed"], EPISODES)


@pytest.mark.first
def test_the_claim_fails_for_twice_that_payload(campaigns: Campaigns) -> None:
    """The map shows why, and a failed episode fails again."""
    output = campaigns.call("campaign", "run", "heavy.xml", "--workers", "2", code=1)
    expect_in("claim rate >= 0.95: failed", output)
    found = campaigns.show()
    expect("all have results", found["passed"] + found["failed"], EPISODES)
    first = found["parameters"][0]
    expect("the reason", first["name"], "payload")
    expect("the heaviest payloads", first["cells"][-1]["passed"], 0)
    expect("the lightest payloads", first["cells"][0]["passed"], first["cells"][0]["episodes"])
    expect("columns of the map", len(found["map"]["columns"]), 6)
    newest = campaigns.results / "campaigns" / "latest" / "results.jsonl"
    lines = [json.loads(line) for line in newest.read_text().splitlines()]
    failed = next(line["episode"] for line in lines if line["outcome"] == "failed")
    campaigns.call("run", "--episode", str(failed), "heavy.xml", code=1)
    text = campaigns.call("campaign", "shrink", str(failed), "--format", "json", code=0)
    changes = {change["name"]: change for change in json.loads(text)["changes"]}
    expect("the smallest change", list(changes), ["payload"])
    payload = float(changes["payload"]["value"])
    expect("the payload is at the edge of the map", 0.75 < payload < 0.9, True)


def test_optuna_finds_the_worst_world(campaigns: Campaigns) -> None:
    worst = search(campaigns, "worst_world.py", code=0)
    found = re.search(r"largest error .* is ([0-9.]+) rad", worst)
    expect("the worst error", found is not None and 0.03 < float(found[1]) < 0.05, True)


def test_hypothesis_finds_the_simplest_world_that_fails(campaigns: Campaigns) -> None:
    simplest = search(campaigns, "any_payload.py", code=1)
    found = re.search(r"payload=Decimal\('0\.8[0-9]?'\)", simplest)
    expect("Hypothesis finds the payload", found is not None, True)


def search(campaigns: Campaigns, script: str, *, code: int) -> str:
    """What a program that searches prints."""
    path = f"{Path(campaigns.rtf).parent}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "RTF_RESULTS": str(campaigns.results)}
    done = subprocess.run(
        [venv("search") / "python", script],
        cwd=EXAMPLE,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(done.stdout)
    expect(script, done.returncode, code)
    return done.stdout
