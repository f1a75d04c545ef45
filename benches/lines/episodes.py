"""Episodes of campaigns: what each costs with slots, in a shared host, and in its own process.

The cost of a further episode is a slope between two sizes. Campaigns of a two-link arm are compared
with loops that run the same episodes without rtf; their times include everything.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

from measuring.bench import Bench
from measuring.build import SOURCES
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work
from measuring.suite import expect_in

SLOTS = 64
ARM_EPISODES = 1000
REPEATS = 3
"""Each time is the least of so many: other programs only make it longer."""

FURTHER = "ms a further episode"
START = "ms a campaign of one"
TOTAL = "s"
PER_ARM = "ms an episode"
PROCESS_COUNTS = (10, 40)
SHARED_COUNTS = (200, 2000)
SLOTS_COUNTS = (1000, 20_000)

CPP_PROCESS = "rtf, C++, own process"
CPP_SHARED = "rtf, C++, shared"
LUA_PROCESS = "rtf, Lua, own process"
LUA_SHARED = "rtf, Lua, shared"
PYTHON_PROCESS = "rtf, Python, own process"
PYTHON_SHARED = "rtf, Python, shared"
PYTHON_SLOTS = f"rtf, Python, {SLOTS} slots"
ARMS = ("rollout", "vector")
ARM_TESTS = {"rollout": "ArmRollouts", "vector": "ArmVector"}
ARM_NAMES = {"rollout": "mujoco.rollout", "vector": "a vector environment of Gymnasium"}

FILES = (
    "Trivial.lua",
    "Trivial.py",
    "EmptyEpisodes.py",
    "two_link_arm.py",
    "ArmRollouts.py",
    "ArmVector.py",
    "ArmProcess.py",
)
CAMPAIGN = """<campaign suite="{suite}.xml" episodes="{episodes}">
  <claim require="rate >= 0.5" confidence="0.6"/>
</campaign>
"""


def group(bench: Bench) -> Group:
    """Empty episodes, and those of the arm."""
    directory = bench.directory / "episodes"
    directory.mkdir(exist_ok=True)
    for file in FILES:
        shutil.copy(SOURCES / file, directory)
    shutil.copy(bench.directory / "Trivial.so", directory)
    works = [
        slope(bench, directory, CPP_PROCESS, "<test>Trivial.so</test>", SHARED_COUNTS),
        slope(bench, directory, CPP_SHARED, shared("Trivial.so"), SHARED_COUNTS),
        slope(bench, directory, LUA_PROCESS, "<test>Trivial.lua</test>", SHARED_COUNTS),
        slope(bench, directory, LUA_SHARED, shared("Trivial.lua"), SHARED_COUNTS),
        slope(bench, directory, PYTHON_PROCESS, "<test>Trivial.py</test>", PROCESS_COUNTS),
        slope(bench, directory, PYTHON_SHARED, shared("Trivial.py"), SHARED_COUNTS),
        slope(bench, directory, PYTHON_SLOTS, slots("EmptyEpisodes.py"), SLOTS_COUNTS),
    ]
    lines = [
        Line("episode, C++, shared", CPP_SHARED, FURTHER, CPP_PROCESS),
        Line("episodes, C++, shared: start", CPP_SHARED, START, CPP_PROCESS),
        Line("episode, Lua, shared", LUA_SHARED, FURTHER, LUA_PROCESS),
        Line("episodes, Lua, shared: start", LUA_SHARED, START, LUA_PROCESS),
        Line("episode, Python, shared", PYTHON_SHARED, FURTHER, PYTHON_PROCESS),
        Line("episodes, Python, shared: start", PYTHON_SHARED, START, PYTHON_PROCESS),
        Line(f"episode, Python, {SLOTS} slots", PYTHON_SLOTS, FURTHER, PYTHON_PROCESS),
        Line(f"episodes, Python, {SLOTS} slots: start", PYTHON_SLOTS, START, PYTHON_PROCESS),
    ]
    for kind in ARMS:
        works += arm_works(bench, directory, kind)
        lines += arm_lines(kind)
    return Group("episodes", tuple(works), tuple(lines), rounds=1, warm_up=False)


def shared(plugin: str) -> str:
    """The element of a test that keeps its process."""
    return f'<test isolation="shared">{plugin}</test>'


def slots(plugin: str) -> str:
    """The element of an episode test."""
    return f'<test slots="{SLOTS}">{plugin}</test>'


def arm_lines(kind: str) -> list[Line]:
    """The goals: near the bare loop, and far from a process for each episode."""
    name, own = f"{ARM_EPISODES} episodes of an arm with {ARM_NAMES[kind]}", f"rtf, arm, {kind}"
    near = Limit(1.15, of_ratio=True, required=False)
    far = Limit(0.05, of_ratio=True, required=False)
    return [
        Line(name, own, TOTAL, bare_name(kind), near),
        Line(f"{name}, a process for each", own, PER_ARM, f"rtf, arm, {kind}, own process", far),
    ]


def bare_name(kind: str) -> str:
    """The loop without rtf."""
    return f"the loop without rtf, {kind}"


def arm_works(bench: Bench, directory: Path, kind: str) -> list[Work]:
    """The campaign, the loop, and a process for each episode."""
    element = slots(f"{ARM_TESTS[kind]}.py")
    program = str(directory / "two_link_arm.py")

    def campaign() -> Samples:
        seconds = campaign_seconds(bench, directory, (f"arm-{kind}", element), ARM_EPISODES)
        return {TOTAL: [seconds], PER_ARM: [seconds * 1e3 / ARM_EPISODES]}

    def bare() -> Samples:
        command = [python(), program, kind, str(ARM_EPISODES), str(SLOTS)]
        return {TOTAL: [least(lambda: bare_seconds(bench, command))]}

    own = f'<test param="{kind}">ArmProcess.py</test>'
    process = slope(bench, directory, f"rtf, arm, {kind}, own process", own, PROCESS_COUNTS)

    def processes() -> Samples:
        return {PER_ARM: process.run()[FURTHER]}

    return [
        Work(f"rtf, arm, {kind}", campaign, missing()),
        Work(bare_name(kind), bare, missing()),
        Work(process.name, processes, missing()),
    ]


def bare_seconds(bench: Bench, command: list[str]) -> float:
    """The time of a loop whose episodes must all pass."""
    launched = bench.launch(command)
    if f"{ARM_EPISODES} passed" not in launched.output:
        raise MeasuringError(f"the loop printed `{launched.output}`")
    return launched.seconds


def slope(bench: Bench, directory: Path, name: str, element: str, counts: tuple[int, int]) -> Work:
    """A work with the cost of a further episode, and the time of a campaign with one."""

    def run() -> Samples:
        file = name.replace(", ", "-").replace(" ", "-")
        one, few, many = (
            campaign_seconds(bench, directory, (file, element), count) for count in (1, *counts)
        )
        further = (many - few) / (counts[1] - counts[0])
        return {FURTHER: [further * 1e3], START: [(one - further) * 1e3]}

    return Work(name, run, missing())


def campaign_seconds(bench: Bench, directory: Path, suite: tuple[str, str], episodes: int) -> float:
    """The least time of a campaign, all of whose episodes must pass."""
    name, element = suite
    (directory / f"{name}.xml").write_text(f"<suite>{element}</suite>\n", encoding="utf-8")
    file = directory / f"{name}-{episodes}.campaign.xml"
    file.write_text(CAMPAIGN.format(suite=name, episodes=episodes), encoding="utf-8")
    results = directory / "results"
    command = [str(bench.rtf), "campaign", "run", str(file), "--no-history", "--results"]

    def seconds() -> float:
        shutil.rmtree(results, ignore_errors=True)
        # With one episode, the claim is not decided.
        launched = bench.launch([*command, str(results)], codes=(0, 6), settings=environment())
        found = results / "campaigns/latest/results.jsonl"
        expect_in(found, episodes, '"outcome":"passed"')
        return launched.seconds

    return least(seconds)


def least(seconds: Callable[[], float]) -> float:
    """The least of several times."""
    return min(seconds() for _ in range(REPEATS))


def environment() -> dict[str, str]:
    """The Python with the packages."""
    return {"RTF_PYTHON": python()}


def python() -> str:
    """The interpreter of tools/requirements-episodes.txt."""
    return str(Path(os.environ.get("RTF_BENCH_EPISODES", "")) / "python")


def missing() -> str:
    """Why nothing can be measured."""
    return "" if Path(python()).exists() else "Gymnasium and MuJoCo are not installed"
