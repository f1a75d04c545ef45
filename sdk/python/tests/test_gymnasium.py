"""Episode tests in vector environments, with the real Gymnasium and MuJoCo."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import pytest
from episode_runner import EpisodeRunner, run_episodes

if TYPE_CHECKING:
    from pathlib import Path

pytest.importorskip("gymnasium", reason="tools/requirements-episodes.txt is not installed")

# It moves to the goal, which the seed chooses. The parameter `fault` breaks an episode.
LINE = """import os, signal
import gymnasium, numpy as np, rtf.gymnasium
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, SyncVectorEnv

class Line(gymnasium.Env):
    observation_space = spaces.Box(-100, 100, (2,), np.float64)
    action_space = spaces.Box(-1, 1, (1,), np.float64)
    def __init__(self):
        self.parameters = {}
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.fault = self.parameters.get("fault")
        if self.fault == "reset": raise ValueError("it is stuck")
        self.count, self.at, self.goal = 0, 0.0, int(self.np_random.integers(2, 90))
        if self.fault == "nan at once": return np.array([np.nan, 0]), {}
        return self.observe(), {}
    def observe(self):
        return np.array([self.at, self.goal], np.float64)
    def step(self, action):
        self.count, self.at = self.count + 1, self.at + float(action[0])
        fault = self.fault if self.count == 2 else None
        if fault == "step": raise ValueError("a gear is broken")
        if fault == "crash": os.kill(os.getpid(), signal.SIGSEGV)
        if fault == "four": return self.observe(), 0.0, False, {}
        if fault == "shape": return np.zeros(3), 0.0, False, False, {}
        observation = np.array([np.nan, 0]) if fault == "nan" else self.observe()
        info = {"is_success": self.goal < 80, "energy": {"sum": self.at}}
        return observation, np.nan if fault == "reward" else -0.5, self.at >= self.goal, False, info
"""

TEST = '''
class Arm(rtf.gymnasium.VectorTest):
    def make_env(self):
        return Line()
    def act(self, observations):
        return np.ones((self.slots, 1))
'''  # fmt: skip

VECTOR = TEST.replace("def make_env(self)", "def unused(self)")


def seeded(count: int, **parameters: str) -> list[dict[str, Any]]:
    """Return episodes with seeds."""
    return [{"id": n, "seed": 7 * n, "parameters": parameters} for n in range(1, count + 1)]


def with_faults(*faults: str) -> list[dict[str, Any]]:
    """Return an episode for each fault; an empty one is none."""
    return [
        {"id": n, "seed": n, "parameters": {"fault": fault}} for n, fault in enumerate(faults, 1)
    ]


def vector_envs(body: str, more: str = "") -> str:
    """Return the source of a test whose `make_envs` has this body."""
    return f"{LINE}{more}{VECTOR}    def make_envs(self, slots):\n        {body}\n"


def of_lines(slots: str = "slots", mode: str = "DISABLED", kind: str = "SyncVectorEnv") -> str:
    """Return the source of a vector environment that nothing guards."""
    return f"{kind}([Line] * {slots}, autoreset_mode=AutoresetMode.{mode})"


@pytest.mark.parametrize("asynchronous", [False, True])
def test_results_do_not_depend_on_slots_and_order(tmp_path: Path, *, asynchronous: bool) -> None:
    judge = (
        f"    asynchronous = {asynchronous}\n"
        "    def judge(self, end):\n"
        "        assert end.terminated and not end.truncated\n"
        "        self.measure('reward', end.reward)\n"
        "        self.measure('energy', end.info['energy']['sum'])\n"
        "        return super().judge(end)\n"
    )
    found = []
    for slots, order in ((1, 1), (3, -1), (16, 1)):
        runner = run_episodes(tmp_path, LINE + TEST + judge, seeded(12)[::order], slots=slots)
        assert (runner.outside, runner.answer) == ([], {"outcome": "passed"}), runner.errors
        assert runner.most_open == min(slots, 12)
        measured = {(it["name"], it["case"]): it["value"] for it in runner.host.of("measured")}
        values = {
            runner.ids[case]: value for (name, case), value in measured.items() if name == "reward"
        }
        results = sorted(runner.results.items())
        found.append([(n, it.outcome, it.end, values[n]) for n, it in results])
    assert found[0] == found[1] == found[2]
    assert {outcome for _, outcome, _, _ in found[0]} == {"passed", "failed"}
    assert all(2 * -reward == end["steps"] for _, _, end, reward in found[0])
    assert len({end["first_observation"] for _, _, end, _ in found[0]}) > 6


@pytest.mark.parametrize("asynchronous", [False, True])
def test_the_other_mode_is_the_other_vector_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, asynchronous: bool
) -> None:
    body = (
        f"{LINE}{TEST}    asynchronous = {asynchronous}\n"
        "    def configure(self, envs, slot, episode):\n        self.report(type(envs).__name__)\n"
    )
    kinds = ["GuardedVectorEnv", "AsyncVectorEnv"]
    for variable, expected in (("", asynchronous), ("other", not asynchronous)):
        monkeypatch.setenv("RTF_VECTOR_MODE", variable)
        runner = run_episodes(tmp_path, body, seeded(1), slots=1)
        assert {text for _, text in runner.results[1].messages} == {kinds[expected]}


@pytest.mark.parametrize("asynchronous", [False, True])
def test_a_task_of_mujoco(tmp_path: Path, *, asynchronous: bool) -> None:
    pytest.importorskip("mujoco")
    body = f"""import gymnasium, rtf.gymnasium
class Reach(rtf.gymnasium.VectorTest):
    timestep = 0.02
    asynchronous = {asynchronous}
    def make_env(self):
        return gymnasium.make("Reacher-v5")
    def act(self, observations):
        return 0 * observations[:, :2]
    def judge(self, end):
        assert end.truncated and "reward_dist" in end.info
        return end.reward > -10 or f"the reward is {{end.reward:.1f}}"
"""
    runner = run_episodes(tmp_path, body, list(range(1, 8)), slots=3)
    assert (runner.outside, runner.code) == ([], 0), runner.errors
    assert [result.end["steps"] for result in runner.results.values()] == [50] * 7
    assert [result.end["time_us"] for result in runner.results.values()] == [1_000_000] * 7
    assert {"passed", "failed"} == set(runner.verdicts())
    assert all(it.reason for it in runner.results.values() if it.outcome == "failed")


def test_slots_without_an_episode_repeat_one_that_runs(tmp_path: Path) -> None:
    log = (
        "    def configure(self, envs, slot, episode):\n"
        "        super().configure(envs, slot, episode)\n"
        "        self.report(f'{slot}: {episode.parameter(\"mass\")}')\n"
    )
    runner = EpisodeRunner(tmp_path, LINE + TEST + log, slots=3)
    # The goal of the first one is far: the slot of the second one is done several times before.
    runner.give(
        {"id": 1, "seed": 4, "parameters": {"mass": "1"}},
        {"id": 2, "seed": 11, "parameters": {"mass": "2"}},
    )
    while ("end", 2) not in runner.events or ("end", 1) not in runner.events:
        assert runner.read()
    runner.give({"id": 3, "seed": 5, "parameters": {"mass": "3"}})
    runner.end()
    runner.finish()
    assert (runner.code, runner.answer) == (0, {"outcome": "passed"})
    assert [it.end["steps"] for _, it in sorted(runner.results.items())] == [65, 13, 61]
    assert ("report", "1: 1") in runner.outside
    assert all(text.endswith((": 1", ": 3")) for _, text in runner.outside)


FAULTS = {
    "step": "ValueError: a gear is broken",
    "reset": "ValueError: it is stuck",
    "nan at once": "the first observation contains NaN",
    "nan": "the observation after step 2 contains NaN",
    "reward": "the reward of step 2 is NaN",
    "four": "ValueError: `step` returned 4 results, expected 5: observation, reward, terminated,"
    " truncated, info",
    "shape": "ValueError: `step` returned an observation of the shape (3,), expected (2,)",
}


@pytest.mark.parametrize("asynchronous", [False, True])
@pytest.mark.parametrize("first", ["", "step", "reset", "nan at once"])
def test_what_breaks_in_one_environment_is_an_error_of_its_episode(
    tmp_path: Path, first: str, *, asynchronous: bool
) -> None:
    body = f"{LINE}{TEST}    asynchronous = {asynchronous}\n"
    faults = [first, "", *(one for fault in FAULTS for one in (fault, ""))]
    runner = run_episodes(tmp_path, body, with_faults(*faults), slots=3)
    assert runner.verdicts() == ["error" if fault else "passed" for fault in faults]
    for number, fault in enumerate(faults, 1):
        expected = [("error", FAULTS[fault])] if fault else []
        assert runner.results[number].messages == expected
    assert runner.outside == []
    (broken, *_) = (it for it in runner.host.of("message") if "a gear is broken" in it["text"])
    assert broken["location"]["file"] == str(tmp_path / "plugin.py")
    assert 'raise ValueError("a gear is broken")' in broken["text"]


def test_the_end_of_an_environments_process(tmp_path: Path) -> None:
    body = f"{LINE}{TEST}    asynchronous = True\n"
    runner = run_episodes(tmp_path, body, with_faults("crash", "", "", ""), slots=3)
    assert runner.results[1].outcome == "crashed"
    assert runner.results[1].reason == "the process of its environment ended with SIGSEGV"
    for other in (2, 3):
        assert runner.results[other].outcome == "error"
        assert runner.results[other].reason == "`step` raised EOFError, in one of 3 slots"
    assert runner.outside == [("error", "EOFError")]
    # No process of an environment is left: the output of the host has ended.
    assert runner.code == 0


def test_an_exception_of_a_vector_environment_is_one_of_all_episodes(tmp_path: Path) -> None:
    for slots, where in ((3, ", in one of 3 slots"), (1, "")):
        body = vector_envs(f"return {of_lines()}")
        runner = run_episodes(tmp_path, body, with_faults("step", "", "", ""), slots=slots)
        assert runner.verdicts() == ["error"] * slots
        reason = f"`step` raised ValueError: a gear is broken{where}"
        assert {it.reason for it in runner.results.values()} == {reason}
        assert runner.outside == [("error", "ValueError: a gear is broken")]


@pytest.mark.parametrize(
    ("envs", "text"),
    [
        (of_lines("2"),
         "`SyncVectorEnv` has 2 slots, expected 3, the argument of `make_envs`"),
        ("Line()", "`make_envs` returned Line, expected a `gymnasium.vector.VectorEnv`"),
        (of_lines(mode="NEXT_STEP"),
         ("`SyncVectorEnv` must not reset its slots by itself: a slot that starts whenever the"
         " last episode is over runs more of the short episodes. Its `autoreset_mode` is"
         " NEXT_STEP, expected `gymnasium.vector.AutoresetMode.DISABLED`")),
        ("gymnasium.make_vec('CartPole-v1', slots, vectorization_mode='vector_entry_point')",
         ("`CartPoleVectorEnv` must not reset its slots by itself: a slot that starts whenever the"
         " last episode is over runs more of the short episodes. Its `autoreset_mode` is"
         " NEXT_STEP, expected `gymnasium.vector.AutoresetMode.DISABLED`")),
    ],
)  # fmt: skip
def test_vector_environments_that_are_refused(tmp_path: Path, envs: str, text: str) -> None:
    runner = run_episodes(tmp_path, vector_envs(f"return {envs}"), seeded(2), slots=3)
    assert runner.outside == [("error", text)]
    assert (runner.results, runner.answer) == ({}, {"outcome": "error"})


BROKEN = """
SEEDS = iter(range(100))

class Broken(SyncVectorEnv):
    def __init__(self, slots):
        super().__init__([Line] * slots, autoreset_mode=AutoresetMode.DISABLED)
    def reset(self, *, seed=None, options=None):
        {reset}
        return super().reset(seed=seed, options=options)
    def step(self, actions):
        observations, rewards, terminated, truncated, infos = super().step(actions)
        {step}
        return observations, rewards, terminated, truncated, infos
"""


@pytest.mark.parametrize(
    ("reset", "step", "text"),
    [
        ("return super().reset(seed=seed)[0]", "pass",
         "`reset` of `Broken` returned ndarray, expected 2: observations, infos"),
        ("pass", "return observations, rewards, terminated, infos",
         ("`step` of `Broken` returned 4 results, expected 5: observations, rewards, terminated,"
         " truncated, infos")),
        ("pass", "rewards = rewards[1:]",
         "`step` of `Broken` returned rewards of the shape (2,), expected (3,)"),
        ("pass", "observations = observations[1:]",
         ("`step` of `Broken` returned observations of the shape (2, 2), expected (3, 2): a row"
         " for each slot")),
        ("options['reset_mask'] = np.ones(3, np.bool_)", "pass",
         ("`reset` of `Broken` must reset the slots in `options['reset_mask']` only, but it"
         " changed the observation of slot 0, whose episode runs")),
        ("seed[1] = 5", "pass",
         ("slot 1 ignores the seed: after a reset with 7, the observation is not that of the"
         " other slots")),
        ("seed[0] = seed[2] = next(SEEDS)", "pass",
         ("the slots 0, 2 ignore the seed: two resets with the same seed had different"
         " observations")),
    ],
)  # fmt: skip
def test_vector_environments_with_mistakes(
    tmp_path: Path, reset: str, step: str, text: str
) -> None:
    body = vector_envs("return Broken(slots)", BROKEN.format(reset=reset, step=step))
    # The second one ends first, and another one takes its slot.
    episodes = [{"id": n, "seed": seed, "parameters": {}} for n, seed in ((1, 7), (2, 11), (3, 4))]
    runner = EpisodeRunner(tmp_path, body, slots=3)
    runner.give(*episodes, {"id": 4, "seed": 3, "parameters": {}})
    runner.end()
    runner.finish()
    assert runner.outside == [("error", text)]
    reasons = {it.reason for it in runner.results.values() if it.outcome == "error"}
    assert reasons == {text}
    assert set(runner.verdicts()) <= {"error", "passed"}


def test_the_seeds_are_verified_with_three_resets(tmp_path: Path) -> None:
    count = "print('reset', seed)\n        print(*options['reset_mask'].tolist())"
    body = vector_envs("return Broken(slots)", BROKEN.format(reset=count, step="pass"))
    runner = run_episodes(tmp_path, body, seeded(3), slots=3)
    assert (runner.outside, len(runner.results)) == ([], 3)
    resets = [line for line in runner.output.splitlines() if line.startswith("reset")]
    assert resets[:4] == [
        "reset [7, 7, 7]", "reset [8, 8, 8]", "reset [7, 7, 7]", "reset [7, 14, 21]"
    ]  # fmt: skip


def test_a_constant_first_observation_is_reported(tmp_path: Path) -> None:
    body = (LINE + TEST).replace("int(self.np_random.integers(2, 90))", "5")
    runner = run_episodes(tmp_path, body, seeded(2), slots=2)
    text = "the first observation does not depend on the seed: two seeds had the same one"
    assert runner.outside == [("report", text)]
    assert runner.verdicts() == ["passed"] * 2


SPACES = """
class Nested(Line):
    observation_space = spaces.Dict({
        "arm": spaces.Tuple((Line.observation_space, spaces.Discrete(100))),
        "text": spaces.Text(4, min_length=4), "image": spaces.Box(0, 255, (4, 4, 3), np.uint8)})
    action_space = spaces.Dict({"move": Line.action_space, "grip": spaces.Discrete(2)})
    def observe(self):
        value = np.array([np.nan, 0]) if self.count == 3 and self.fault else super().observe()
        image = np.full((4, 4, 3), self.count, np.uint8)
        return {"arm": (value, self.goal), "text": f"{self.count:04}", "image": image}
    def step(self, action):
        return super().step(action["move"])
"""


def test_nested_spaces(tmp_path: Path) -> None:
    test = TEST.replace("Line()", "Nested()").replace(
        "np.ones((self.slots, 1))",
        "{'move': np.ones((self.slots, 1)), 'grip': np.zeros(self.slots, np.int64)}",
    )
    episodes = with_faults("", "", "", "late", "", "")
    runner = run_episodes(tmp_path, LINE + SPACES + test, episodes, slots=3)
    assert runner.verdicts() == ["passed"] * 3 + ["error"] + ["passed"] * 2
    text = "the observation after step 3 contains NaN"
    assert runner.results[4].messages == [("error", text)]
    assert len({it.end["first_observation"] for it in runner.results.values()}) > 3
    # One of two parts is not seeded.
    unseeded = SPACES.replace("(value, self.goal)", "(value, np.random.randint(100))")
    runner = run_episodes(tmp_path, LINE + unseeded + test, seeded(3), slots=3)
    ((kind, text),) = runner.outside
    assert (kind, text.split(" the seed")[0]) == ("error", "the slots 0, 1, 2 ignore")


@pytest.mark.parametrize(
    ("space", "actions", "text"),
    [
        ("Line.action_space", "np.ones((2, 1))",
         "actions of the shape (2, 1), expected (3, 1): a row for each slot"),
        ("Line.action_space", "None",
         "actions of the shape (), expected (3, 1): a row for each slot"),
        ("spaces.Discrete(4)", "np.zeros((3, 1))",
         "actions of the shape (3, 1), expected (3,): a row for each slot"),
        ("spaces.Dict(grip=spaces.Discrete(2))", "{'grip': [1]}",
         "actions['grip'] of the shape (1,), expected (3,): a row for each slot"),
        ("spaces.Dict(grip=spaces.Discrete(2))", "{'move': [1]}",
         "actions that are not a dictionary with 'grip'"),
        ("spaces.Tuple((spaces.Discrete(2), spaces.Discrete(2)))", "([1, 1, 1],)",
         "actions that are not a tuple of 2"),
    ],
)  # fmt: skip
def test_actions_of_a_wrong_shape(tmp_path: Path, space: str, actions: str, text: str) -> None:
    body = (LINE + TEST).replace("np.ones((self.slots, 1))", actions)
    body = body.replace("    def __init__", f"    action_space = {space}\n    def __init__", 1)
    if space == "Line.action_space":
        body = body.replace("    action_space = Line.action_space\n", "")
    runner = run_episodes(tmp_path, body, seeded(2), slots=3)
    assert runner.outside == [("error", f"`act` returned {text}")]
    reasons = {it.reason for it in runner.results.values()}
    assert reasons == {f"`run` ended with `{runner.outside[0][1]}`"}


def test_an_exception_of_the_policy(tmp_path: Path) -> None:
    body = (LINE + TEST).replace("np.ones((self.slots, 1))", "observations['image']")
    runner = run_episodes(tmp_path, body, seeded(2), slots=2)
    assert runner.verdicts() == ["error"] * 2
    assert {it.reason.split(":")[0] for it in runner.results.values() if it.reason} == {
        "`run` ended with IndexError"
    }


JUDGES = [
    ("return end.steps > 0", "passed", None),
    ("return np.bool_(end.steps == 0)", "failed", None),
    ("return 'too slow'", "failed", "too slow"),
    ("return self.check(False, 'it stands')", "failed", "it stands"),
    ("self.skip('no target')", "skipped", "no target"),
    ("raise ValueError('42')", "error", "ValueError: 42"),
    ("pass", "error", "TypeError: `judge` returned None, expected a truth or a text"),
    (
        "return end.reward",
        "error",
        "TypeError: `judge` returned -6.5, expected a truth or a text",
    ),
    (
        "end.info.pop('is_success'); return super().judge(end)",
        "error",
        (
            "the environment reports neither `is_success` nor `success` in the `info` of the last"
            " step, but `energy`: write `judge(self, end)`"
        ),
    ),
    (
        "end.info['success'] = end.info.pop('is_success'); return super().judge(end)",
        "passed",
        None,
    ),
]


def test_judgements(tmp_path: Path) -> None:
    judges = "".join(
        f"    def judge_{n}(self, end):\n        {judge}\n"
        for n, (judge, _, _) in enumerate(JUDGES, 1)
    )
    choice = "        return getattr(self, f'judge_{end.episode.id}')(end)\n"
    body = f"{LINE}{TEST}{judges}    def judge(self, end):\n{choice}"
    body = body.replace("super().judge", "super(Arm, self).judge")
    episodes: list[Any] = [
        {"id": n, "seed": 11, "parameters": {}} for n in range(1, len(JUDGES) + 1)
    ]
    runner = run_episodes(tmp_path, body, episodes, slots=4)
    assert runner.verdicts() == [verdict for _, verdict, _ in JUDGES]
    for number, (_, _, problem) in enumerate(JUDGES, 1):
        result = runner.results[number]
        assert problem in [*(text for _, text in result.messages), result.reason]
        assert result.end["steps"] == 13
    assert runner.outside == []


def test_parameters_reach_their_slots(tmp_path: Path) -> None:
    """A setter that would disturb an episode that runs is called only before its reset."""
    more = """
class Loaded(Line):
    @property
    def parameters(self):
        return self.values
    @parameters.setter
    def parameters(self, values):
        self.values = values
        self.at = 0.0
    def step(self, action):
        return super().step(action * float(self.values["speed"]))
"""
    speeds = ["1", "2", "4", "1", "0.5"]
    episodes: list[Any] = [
        {"id": n, "seed": 11, "parameters": {"speed": speed}} for n, speed in enumerate(speeds, 1)
    ]
    for asynchronous in (False, True):
        body = LINE + more + TEST.replace("Line()", "Loaded()")
        runner = run_episodes(
            tmp_path, f"{body}    asynchronous = {asynchronous}\n", episodes, slots=2
        )
        assert runner.verdicts() == ["passed"] * 5
        steps = [it.end["steps"] for _, it in sorted(runner.results.items())]
        assert steps == [13, 7, 4, 13, 26]


@pytest.mark.parametrize("kind", ["SyncVectorEnv", "gymnasium.vector.AsyncVectorEnv"])
def test_parameters_of_a_vector_environment(tmp_path: Path, kind: str) -> None:
    more = """
class Loaded(Line):
    def step(self, action):
        return super().step(action * float(self.parameters["speed"]))
"""
    envs = of_lines(kind=kind).replace("Line", "Loaded")
    body = vector_envs(f"return {envs}", more)
    episodes = [
        {"id": n, "seed": 11, "parameters": {"speed": speed}} for n, speed in ((1, "1"), (2, "2"))
    ]
    runner = run_episodes(tmp_path, body, episodes, slots=3)
    assert [it.end["steps"] for _, it in sorted(runner.results.items())] == [13, 7]


def test_parameters_that_nobody_takes_are_an_error(tmp_path: Path) -> None:
    body = (
        (LINE + TEST)
        .replace("self.parameters = {}", "pass")
        .replace('self.parameters.get("fault")', "None")
    )
    text = (
        "the campaign has the parameters `mass`, but the environments have no attribute"
        " `parameters`: add it to them, or write `configure(self, envs, slot, episode)`"
    )
    runner = run_episodes(tmp_path, body, seeded(2, mass="1"), slots=2)
    assert runner.outside == [("error", text)]
    configure = (
        "    def configure(self, envs, slot, episode):\n        float(episode.parameter('m'))\n"
    )
    episodes = [{"id": n, "seed": 11, "parameters": {"m": m}} for n, m in ((1, "x"), (2, "1"))]
    runner = run_episodes(tmp_path, body + configure, episodes, slots=2)
    assert runner.verdicts() == ["error", "passed"]
    text = "ValueError: could not convert string to float: 'x'"
    assert (runner.results[1].messages, runner.outside) == ([("error", text)], [])


def test_limits(tmp_path: Path) -> None:
    episodes = [{"id": 1, "seed": 11, "parameters": {}}, {"id": 2, "seed": 4, "parameters": {}}]
    runner = run_episodes(tmp_path, LINE + TEST, episodes, slots=2, max_steps=13)
    assert [it.outcome for it in runner.results.values()] == ["passed", "timed-out"]
    assert runner.results[2].reason == "not done after 13 steps"
    assert runner.results[2].end["steps"] == 13
    timed = f"{LINE}{TEST}    timestep = 0.1\n"
    runner = run_episodes(tmp_path, timed, episodes, slots=2, max_time_us=1_300_000)
    assert [it.outcome for it in runner.results.values()] == ["passed", "timed-out"]
    assert runner.results[2].reason == "not done after 1.3 s of simulated time"
    assert runner.results[2].end["time_us"] == 1_300_000


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("pass", "the suite has `max-time`, but `Arm` has no `timestep`, in s"),
        ("timestep = -1", "`timestep` is -1 s, expected a number above 0"),
        ("timestep = 2.5", "`timestep` is 2.5 s, longer than `max-time` of the suite"),
    ],
)
def test_timesteps_that_are_refused(tmp_path: Path, line: str, text: str) -> None:
    body = f"{LINE}{TEST}    {line}\n"
    runner = run_episodes(tmp_path, body, seeded(1), max_time_us=2_000_000)
    assert runner.outside == [("error", text)]


@pytest.mark.parametrize("asynchronous", [False, True])
def test_a_stop_request_closes_the_environments(tmp_path: Path, *, asynchronous: bool) -> None:
    body = (
        f"{LINE}{TEST}    asynchronous = {asynchronous}\n"
        "    def act(self, observations):\n"
        "        if not hasattr(self, 'runs'):\n"
        "            self.runs = True\n            self.report('acts')\n"
        "        return np.zeros((self.slots, 1))\n"
    )
    runner = EpisodeRunner(tmp_path, body)
    runner.give(*seeded(3))
    while not runner.outside:
        assert runner.read()
    runner.host.send("interrupt", {"reason": "enough"})
    runner.finish()
    assert runner.answer == {"outcome": "interrupted", "reason": "enough"}
    assert (runner.events, runner.code) == ([("start", 1), ("start", 2)], 0)


def test_neither_environment_nor_policy(tmp_path: Path) -> None:
    empty = "import rtf.gymnasium\nclass Arm(rtf.gymnasium.VectorTest):\n    pass\n"
    runner = run_episodes(tmp_path, empty, seeded(1))
    text = "Arm has neither `make_env(self)` nor `make_envs(self, slots)`"
    assert runner.outside == [("error", text)]
    wrong = TEST.replace("Line()", "None")
    runner = run_episodes(tmp_path, LINE + wrong, seeded(1))
    text = "`make_env` returned NoneType, expected a `gymnasium.Env`"
    assert runner.outside == [("error", text)]


def test_a_result_is_sent_before_the_policy_continues(tmp_path: Path) -> None:
    """The policy waits until the result of the first episode has been received."""
    body = (
        f"{LINE}{TEST}"
        "    def act(self, observations):\n"
        "        if observations[1, 0] == 14:\n            open('fifo').read()\n"
        "        return np.ones((self.slots, 1))\n"
    )
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    runner = EpisodeRunner(tmp_path, body, slots=2)
    runner.give({"id": 1, "seed": 11, "parameters": {}}, {"id": 2, "seed": 5, "parameters": {}})
    runner.end()
    while ("end", 1) not in runner.events:
        assert runner.read()
    fifo.write_text("")
    assert runner.finish().verdicts() == ["passed"] * 2


def test_a_slow_judge_does_not_hold_other_results(tmp_path: Path) -> None:
    body = (
        (
            f"{LINE}{TEST}"
            "    def judge(self, end):\n"
            "        if end.episode.id == 2:\n            rtf.gymnasium.time.sleep(0.1)\n"
            "        if end.episode.id == 3:\n            open('fifo').read()\n"
            "        return True\n"
        )
        .replace("import os, signal", "import os, signal, time")
        .replace("rtf.gymnasium.time", "time")
    )
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    runner = EpisodeRunner(tmp_path, body, slots=3)
    runner.give(*({"id": n, "seed": 11, "parameters": {}} for n in (1, 2, 3)))
    runner.end()
    while ("end", 2) not in runner.events:
        assert runner.read()
    fifo.write_text("")
    assert runner.finish().verdicts() == ["passed"] * 3


def test_a_judge_that_forks_sends_no_result_twice(tmp_path: Path) -> None:
    body = (
        f"{LINE}{TEST}"
        "    def judge(self, end):\n"
        "        if end.episode.id == 2:\n"
        "            if os.fork() == 0:\n"
        "                self.report('child')\n                os._exit(0)\n"
        "            os.wait()\n"
        "        return True\n"
    )
    episodes: list[Any] = [{"id": n, "seed": 11, "parameters": {}} for n in (1, 2)]
    runner = run_episodes(tmp_path, body, episodes, slots=2)
    assert runner.verdicts() == ["passed"] * 2
    assert runner.results[2].messages == [("report", "child")]


def test_memory_does_not_grow(tmp_path: Path) -> None:
    body = (
        f"import gc, json\n{LINE}{TEST}"
        "    def tearDown(self):\n"
        "        gc.collect()\n"
        "        kinds = [type(one).__name__ for one in gc.get_objects()]\n"
        "        self.report(json.dumps({k: kinds.count(k) for k in ('Episode', 'OpenCase')}))\n"
    )
    episodes = [{"id": n, "seed": 11, "parameters": {}} for n in range(1, 201)]
    runner = run_episodes(tmp_path, body, episodes, slots=8)
    assert runner.verdicts() == ["passed"] * 200
    assert sum(json.loads(runner.outside[-1][1]).values()) < 10


def test_the_vector_environment_returns_what_that_of_gymnasium_does() -> None:
    import gymnasium
    import numpy as np
    from gymnasium import spaces
    from gymnasium.vector import AutoresetMode, SyncVectorEnv

    from rtf.gymnasium.guarded_vector_env import GuardedVectorEnv

    class Nested(gymnasium.Env):  # type: ignore[misc, type-arg, unused-ignore]
        observation_space = spaces.Dict(
            at=spaces.Box(-9, 9, (2,), np.float32),
            parts=spaces.Tuple([spaces.Discrete(9), spaces.Box(0, 1, (), np.float64)]),
        )
        action_space = spaces.Box(-1, 1, (2,), np.float64)

        def observe(self) -> Any:
            self.observation_space.seed(int(self.np_random.integers(99)))
            return self.observation_space.sample()

        def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
            super().reset(seed=seed)
            self.steps = 0
            return self.observe(), {"start": seed}

        def step(self, action: Any) -> Any:
            self.steps += 1
            reward = float(self.np_random.normal())
            info = {"late": {"reward": reward}, "text": "t"} if reward > 0 else {}
            return self.observe(), reward + float(action[0]), self.steps == 4, reward > 1, info

    def trace(kind: type[SyncVectorEnv]) -> list[Any]:
        envs = kind([Nested] * 3, autoreset_mode=AutoresetMode.DISABLED)
        found: list[Any] = [envs.reset(seed=[1, 2, 3])]
        for _ in range(12):
            found.append(envs.step(np.full((3, 2), 0.5)))
            done = found[-1][2] | found[-1][3]
            if done.any():
                found.append(envs.reset(seed=[7, 8, 9], options={"reset_mask": done}))
        return found

    ours, theirs = trace(GuardedVectorEnv), trace(SyncVectorEnv)
    assert repr(ours) == repr(theirs)
