"""Episode tests in Python in vector environments of Gymnasium."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest
from checkout import ROOT, call, venv

SDK = ROOT / "sdk/python"
POLICY = "def policy(observations):\n    return 0 * observations[:, :2]\n\n"
SUITE = '<suite name="reach"><test slots="{slots}" {more}>ReachTest.py</test></suite>'
CAMPAIGN = (
    '<campaign suite="reach.xml" episodes="12" seed="4">{parameter}'
    '<claim require="rate &gt;= 0.1" confidence="0.6"/></campaign>'
)
# An environment with a parameter. One of its payloads is too heavy for the process.
LIFT = '''import os
import gymnasium
import numpy as np
import rtf.gymnasium


class Lift(gymnasium.Env):
    """Lifts a payload to a height, which the seed chooses."""

    observation_space = gymnasium.spaces.Box(0, 100, (2,), np.float64)
    action_space = gymnasium.spaces.Box(0, 1, (1,), np.float64)

    def __init__(self):
        self.parameters = {}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.at, self.goal = 0.0, float(self.np_random.integers(3, 30))
        self.payload = float(self.parameters["payload"])
        return np.array([self.at, self.goal]), {}

    def step(self, action):
        self.at += float(action[0])
        if self.payload == 9 and self.at == 2:
            os.abort()
        if self.payload == 8 and self.at == 2:
            raise ValueError("the gripper is open")
        done = self.at >= self.goal
        return np.array([self.at, self.goal]), -1.0, done, False, {"success": self.payload < 5}


class LiftTest(rtf.gymnasium.VectorTest):
    asynchronous = ASYNCHRONOUS

    def make_env(self):
        return Lift()

    def act(self, observations):
        return np.ones((self.slots, 1))
'''


def documented() -> str:
    """The test of the documentation."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "spec/sdk.md").read_text(), re.DOTALL)
    (block,) = (block for block in blocks if "VectorTest" in block)
    return str(block)


def results(directory: Path) -> list[dict[str, object]]:
    """The results of the newest campaign, without what differs each time."""
    text = (directory / "rtf-results/campaigns/latest/results.jsonl").read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    for line in lines:
        for name in ("duration_us", "problem", "shown"):
            line.pop(name, None)
    return lines


def run(rtf: str, directory: Path, *more: str) -> subprocess.CompletedProcess[str]:
    """Runs a command of campaigns."""
    command = [rtf, "campaign", *more]
    return subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)


def test_the_sdk_with_gymnasium() -> None:
    call(venv("episodes") / "python", "-m", "pytest", "tests/test_gymnasium.py", cwd=SDK)


def test_the_documented_test_is_short() -> None:
    assert len([line for line in documented().splitlines() if line]) <= 15


@pytest.mark.venv("episodes")
def test_a_campaign_with_mujoco(debug_rtf: str, tmp_path: Path) -> None:
    (tmp_path / "ReachTest.py").write_text(POLICY + documented())
    (tmp_path / "reach.xml").write_text(SUITE.format(slots=5, more='max-time="1s"'))
    (tmp_path / "campaign.xml").write_text(CAMPAIGN.format(parameter=""))
    found = []
    for options in (["--slots", "1"], [], ["--slots", "16", "--workers", "2"]):
        ran = run(debug_rtf, tmp_path, "run", "campaign.xml", *options)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        found.append(results(tmp_path))
    assert found[0] == found[1] == found[2]
    assert {line["outcome"] for line in found[0]} == {"passed", "failed"}
    assert len({line["first_observation"] for line in found[0]}) == 12
    # The same without the SDK: the reward of one episode.
    (tmp_path / "alone.py").write_text(ALONE)
    for line in (found[0][0], found[0][7]):
        seed = next(
            one["seed"]
            for one in map(json.loads, episodes(tmp_path).splitlines())
            if one["id"] == line["episode"]
        )
        python = venv("episodes") / "python"
        output = subprocess.run(
            [python, "alone.py", str(seed)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        assert (float(output) > -12) == (line["outcome"] == "passed")
        if line["outcome"] == "failed":
            assert f"the reward is {float(output):.1f}" in str(line["reason"])


ALONE = """import sys
import gymnasium
env = gymnasium.make("Reacher-v5")
observation, _ = env.reset(seed=int(sys.argv[1]))
total, done = 0.0, False
while not done:
    observation, reward, terminated, truncated, _ = env.step(0 * observation[:2])
    total, done = total + reward, terminated or truncated
print(total)
"""


def episodes(directory: Path) -> str:
    """The list of episodes of the newest campaign."""
    return (directory / "rtf-results/campaigns/latest/episodes.jsonl").read_text()


@pytest.mark.venv("episodes")
@pytest.mark.parametrize("asynchronous", [False, True])
def test_what_breaks_costs_its_episode(debug_rtf: str, tmp_path: Path, asynchronous: bool) -> None:
    (tmp_path / "ReachTest.py").write_text(LIFT.replace("ASYNCHRONOUS", str(asynchronous)))
    (tmp_path / "reach.xml").write_text(SUITE.format(slots=3, more=""))
    parameter = '<parameter name="payload" distribution="grid" values="1 2 9 6 8 3 4"/>'
    campaign = CAMPAIGN.format(parameter=parameter).replace('episodes="12" ', "")
    (tmp_path / "campaign.xml").write_text(campaign)
    ran = run(debug_rtf, tmp_path, "run", "campaign.xml")
    outcomes = {str(line["episode"]): line["outcome"] for line in results(tmp_path)}
    payloads = {
        one["parameters"]["payload"]: outcomes[str(one["id"])]
        for one in map(json.loads, episodes(tmp_path).splitlines())
    }
    assert payloads == {
        **dict.fromkeys(("1", "2", "3", "4"), "passed"),
        **dict.fromkeys(("6", "9"), "failed"),
        "8": "error",
    }, ran.stdout + ran.stderr
