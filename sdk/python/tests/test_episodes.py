"""Episode tests: many episodes of a campaign in one process."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from driver import Host, arm, plugin, run
from episode_runner import EpisodeRunner, episode_test, run_episodes

STEPS = "def episode(self, episode):\n    for _ in range(episode.seed):\n        yield\n"


def parameters(**values: str) -> dict[str, Any]:
    """Return an episode with these parameters."""
    return {"id": 7, "seed": 5, "parameters": values}


def test_an_episode_has_an_id_a_seed_and_parameters(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n"
        "    for episode in self.take():\n"
        "        with episode:\n"
        "            self.report((episode.id, episode.seed, episode.parameters))\n"
        "            self.report(episode.parameter('payload') + episode.parameter('speed', '9'))\n"
        "            self.report((self.slots, self.max_steps, self.max_time))\n"
        "            self.measure('distance', 0.5)\n"
        "        episode.finish(steps=4, time=0.25, first_observation='x')\n"
        "    assert self.take() == []\n"
    )
    runner = run_episodes(
        tmp_path, body, [parameters(payload="1.2")], slots=3, max_steps=4, max_time_us=2_500_000
    )
    assert runner.results[7].messages == [
        ("report", "(7, 5, {'payload': '1.2'})"),
        ("report", "1.29"),
        ("report", "(3, 4, 2.5)"),
    ]
    (measured,) = runner.host.of("measured")
    assert measured["case"] == 1
    end = runner.results[7].end
    assert (end["steps"], end["time_us"], len(end["first_observation"])) == (4, 250_000, 16)
    assert (runner.verdicts(), runner.outside) == (["passed"], [])
    assert (runner.answer, runner.code) == ({"outcome": "passed"}, 0)


def test_the_host_says_that_it_runs_episodes(tmp_path: Path) -> None:
    assert Host(tmp_path).initialized["result"]["runs_episodes"] is True


def test_generators_are_interleaved_and_keep_their_cases(tmp_path: Path) -> None:
    body = episode_test(
        "def episode(self, episode):\n"
        "    with self.case('lift'):\n"
        "        self.report(f'one {episode.id}')\n"
        "        yield\n"
        "        self.report(f'two {episode.id}')\n"
        "        self.sample('height', episode.id, time=0.5)\n"
        "        yield\n"
        "        self.sample('height', episode.id, time=1.0)\n"
        "    self.check(episode.id != 2, 'it holds')\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2, 3])
    assert runner.verdicts() == ["passed", "failed", "passed"]
    assert runner.most_open == 2
    texts = [message["text"] for message in runner.host.of("message")]
    assert texts[:4] == ["one 1", "one 2", "two 1", "two 2"]
    for episode, result in runner.results.items():
        assert [text for _, text in result.messages][:2] == [f"one {episode}", f"two {episode}"]
        assert result.inner == ["lift"]
        assert result.end == {"steps": 2}
    # Each episode has its own batches, so that their times do not mix.
    points = [(one["case"], one["points"]) for one in runner.host.of("sampled")]
    assert sorted(value for _, batch in points for _, value in batch) == [1, 1, 2, 2, 3, 3]
    assert all(len({value for _, value in batch}) == 1 for _, batch in points)


def test_samples_of_interleaved_episodes_are_sent_in_batches(tmp_path: Path) -> None:
    body = episode_test(
        "def episode(self, episode):\n"
        "    for count in range(100):\n"
        "        self.sample('height', episode.id, time=count)\n        yield\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2, 3], slots=3)
    batches = runner.host.of("sampled")
    assert sum(len(batch["points"]) for batch in batches) == 300
    assert len(batches) < 150


@pytest.mark.parametrize(
    ("end", "verdict", "reason"),
    [
        ("return None", "passed", None),
        ("return True", "passed", None),
        ("return False", "failed", None),
        ("return 'too far'", "failed", "too far"),
        ("self.check(False, 'it moves')", "failed", None),
        ("self.check(False, 'it moves')\nreturn True", "failed", None),
        ("self.require(False, 'it moves')", "failed", None),
        ("self.error('no bench')", "error", None),
        ("raise ValueError('42')", "error", None),
        ("self.skip('no gripper')", "skipped", "no gripper"),
        ("return 3", "error", None),
        ("episode.finish(False, 'far')\nreturn True", "failed", "far"),
        ("episode.finish(True)\nreturn True", "passed", None),
    ],
)  # fmt: skip
@pytest.mark.parametrize("steps", [0, 1])
def test_the_result_of_an_episode(
    tmp_path: Path, end: str, verdict: str, reason: str | None, steps: int
) -> None:
    lines = "".join(f"        {line}\n" for line in end.splitlines())
    body = episode_test(
        "def episode(self, episode):\n"
        + "    yield\n" * steps
        + f"    if episode.id == 2:\n{lines}"
        + "    return True\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2, 3], slots=2)
    assert runner.verdicts() == ["passed", verdict, "passed"]
    assert runner.results[2].reason == reason
    # Finished twice: the exception is the test's, which continues.
    text = "RuntimeError: episode 2 is finished already"
    assert runner.outside == [("error", text)] * ("finish(" in end)


def test_an_exception_is_reported_in_its_episode(tmp_path: Path) -> None:
    body = episode_test("def episode(self, episode):\n    yield\n    raise ValueError('42')\n")
    runner = run_episodes(tmp_path, body, [1])
    (message,) = runner.host.of("message")
    assert message["text"].startswith("ValueError: 42\nTraceback")
    assert message["location"] == {"file": str(tmp_path / "plugin.py"), "line": 5}
    assert "_interleaving" not in message["text"]
    assert message["case"] == 1


def test_limits_in_steps_and_simulated_time(tmp_path: Path) -> None:
    body = episode_test(
        "def episode(self, episode):\n"
        "    try:\n"
        "        for _ in range(episode.seed):\n            yield 0.1\n"
        "    finally:\n        self.report('closed')\n"
    )
    episodes: list[Any] = [{"id": n, "seed": n, "parameters": {}} for n in (3, 4, 5, 6)]
    runner = run_episodes(tmp_path, body, episodes, max_steps=5, max_time_us=400_000)
    assert [runner.results[n].verdict() for n in (3, 4)] == ["passed", "passed"]
    for late in (5, 6):
        result = runner.results[late]
        assert result.outcome == "timed-out"
        assert result.reason == "not done after 0.4 s of simulated time"
        assert result.end == {"steps": 4, "time_us": 400_000}
        assert result.messages == [("report", "closed")]
    runner = run_episodes(tmp_path, body, [{"id": 1, "seed": 6, "parameters": {}}], max_steps=5)
    assert runner.results[1].reason == "not done after 5 steps"
    assert runner.results[1].end == {"steps": 5, "time_us": 500_000}


@pytest.mark.parametrize(
    ("step", "text"),
    [
        ("yield", "TypeError: the suite has `max-time`, so `yield` needs the seconds that passed"),
        ("yield -1", "ValueError: a step of -1 s: expected seconds from 0"),
        ("yield float('nan')", "ValueError: a step of nan s: expected seconds from 0"),
        ("return", "ValueError: the suite has `max-time`, so `finish` needs `time`"),
    ],
)
def test_a_limit_that_cannot_be_checked_is_an_error(tmp_path: Path, step: str, text: str) -> None:
    body = episode_test(f"def episode(self, episode):\n    {step}\n")
    runner = run_episodes(tmp_path, body, [1], max_time_us=1)
    assert runner.results[1].messages == [("error", text)]


def test_a_limit_of_a_finished_episode(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n"
        "    while episodes := self.take(1):\n"
        "        with episodes[0] as episode:\n"
        "            if episode.id < 4:\n"
        "                episode.finish(episode.id > 1 or None, 'far', steps=10 + episode.id)\n"
        "            if episode.id == 4:\n                episode.finish(False, 'far')\n"
        "            if episode.id == 5:\n                episode.finish(True)\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2, 3, 4, 5], slots=1, max_steps=11)
    assert runner.verdicts() == ["passed", "timed-out", "timed-out", "failed", "error"]
    assert runner.results[2].reason == "not done after 11 steps"
    assert runner.results[5].messages == [
        ("error", "ValueError: the suite has `max-steps`, so `finish` needs `steps`")
    ]


@pytest.mark.parametrize(
    ("call", "problem"),
    [
        ("one.finish(True); one.finish(True)", "RuntimeError: episode 1 is finished already"),
        ("one.finish('far')", "TypeError: `passed` is 'far', expected True, False or None"),
        ("one.finish(True, steps=-1)", "ValueError: `steps` is -1, expected a number from 0"),
        ("one.finish(True, time=-1)", "ValueError: `time` is -1 s, expected a number from 0"),
        ("one.finish(True, first_observation=object())",
         "TypeError: an observation is bytes, a text or an array, not object"),
        ("one.parameter('mass')",
         "LookupError: there is no parameter `mass`; this episode has: payload, speed"),
        ("with one, self.case('lift'): one.finish(True)",
         "RuntimeError: episode 1 has a case that is open: finish it first"),
        ("self.take()", "ValueError: `take` would wait without an end: none of 1 slots is free"),
        ("one.finish(True); self.take(0)",
         "ValueError: `take` would wait without an end: `most` is 0"),
        ("self.plan_cases(['lift'])",
         "the cases of an episode test are its episodes, which cannot be planned"),
    ],
)  # fmt: skip
def test_mistakes_of_a_test(tmp_path: Path, call: str, problem: str) -> None:
    body = episode_test(f"def run(self):\n    one, = self.take()\n    {call}\n")
    episode = {"id": 1, "seed": 0, "parameters": {"payload": "1", "speed": "2"}}
    runner = run_episodes(tmp_path, body, [episode], slots=1)
    texts = [*runner.outside, *runner.results[1].messages]
    assert ("error", problem) in texts
    assert runner.answer == {"outcome": "error"}
    # It has a result in any case.
    assert ("end", 1) in runner.events


def test_after_run_an_episode_cannot_be_finished(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n    self.one, = self.take()\n    self.one.finish()\n    self.take()\n"
        "def tearDown(self):\n    self.one.finish()\n"
    )
    runner = run_episodes(tmp_path, body, [1])
    assert runner.outside == [("error", "RuntimeError: episode 1 cannot be finished after `run`")]


def test_a_case_belongs_to_an_episode(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n"
        "    with self.case('outside'):\n        self.report('never')\n"
        "    while self.take():\n        pass\n"
    )
    runner = run_episodes(tmp_path, body, [])
    text = "a case of an episode test belongs to an episode: `with episode:`"
    assert runner.outside == [("error", text)]


def test_what_is_reported_elsewhere_belongs_to_the_test(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n"
        "    first, second = self.take()\n"
        "    with second:\n"
        "        with first:\n            self.report('in first')\n"
        "        self.report('in second')\n"
        "    self.report('outside')\n"
        "    second.finish()\n    first.finish(False)\n"
        "    self.take()\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2])
    assert runner.results[1].messages == [("report", "in first")]
    assert runner.results[2].messages == [("report", "in second")]
    assert runner.outside == [("report", "outside")]
    assert runner.events[2:] == [("end", 2), ("end", 1)]


def test_threads_enter_different_episodes(tmp_path: Path) -> None:
    body = "import threading\n" + episode_test(
        "def work(self, episode, barrier):\n"
        "    with episode:\n"
        "        barrier.wait(60)\n"
        "        self.report(f'in {episode.id}')\n"
        "        with self.case('inner'):\n            barrier.wait(60)\n"
        "        barrier.wait(60)\n"
        "    episode.finish()\n"
        "def run(self):\n"
        "    episodes = self.take()\n"
        "    barrier = threading.Barrier(len(episodes))\n"
        "    threads = [threading.Thread(target=self.work, args=(e, barrier)) for e in episodes]\n"
        "    for thread in threads:\n        thread.start()\n"
        "    for thread in threads:\n        thread.join()\n"
        "    self.take()\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2, 3], slots=3)
    assert runner.verdicts() == ["passed"] * 3
    for episode, result in runner.results.items():
        assert result.messages == [("report", f"in {episode}")]
        assert result.inner == ["inner"]
    assert runner.outside == []


def test_threads_take_episodes(tmp_path: Path) -> None:
    body = "import threading\n" + episode_test(
        "def work(self):\n"
        "    while episodes := self.take(1):\n"
        "        with episodes[0] as episode:\n            self.report(episode.id)\n"
        "        episode.finish()\n"
        "def run(self):\n"
        "    threads = [threading.Thread(target=self.work) for _ in range(self.slots)]\n"
        "    for thread in threads:\n        thread.start()\n"
        "    self.report('all wait or work')\n"
        "    for thread in threads:\n        thread.join()\n"
    )
    runner = EpisodeRunner(tmp_path, body, slots=4)
    while not runner.outside:
        assert runner.read()
    runner.give(*range(1, 61))
    while len(runner.events) < 120:
        assert runner.read()
    # All threads wait, and are woken.
    runner.end()
    runner.finish()
    assert runner.verdicts() == ["passed"] * 60
    assert all(it.messages == [("report", str(n))] for n, it in runner.results.items())
    runner = EpisodeRunner(tmp_path, body, slots=4)
    while not runner.outside:
        assert runner.read()
    runner.host.send("interrupt", {"reason": "enough"})
    runner.finish()
    assert runner.answer == {"outcome": "interrupted", "reason": "enough"}


def test_episodes_arrive_while_others_run(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n"
        "    first, = self.take()\n"
        "    assert self.take(wait=False) == []\n"
        "    self.report('ready')\n"
        "    while not (second := self.take(wait=False)):\n        pass\n"
        "    first.finish()\n    second[0].finish()\n"
        "    self.report(self.take())\n"
    )
    runner = EpisodeRunner(tmp_path, body)
    runner.give(1)
    while not runner.outside:
        assert runner.read()
    runner.give(2)
    while len(runner.events) < 4:
        assert runner.read()
    runner.end()
    runner.finish()
    assert runner.outside == [("report", "ready"), ("report", "[]")]


def test_a_result_is_sent_before_the_next_step(tmp_path: Path) -> None:
    """The second episode starts to hang only after the first result has been received."""
    body = "import os\n" + episode_test(
        "def episode(self, episode):\n"
        "    if episode.id == 2:\n        os.read(os.open('fifo', os.O_RDONLY), 1)\n"
        "    yield\n"
    )
    fifo = tmp_path / "fifo"
    import os

    os.mkfifo(fifo)
    runner = EpisodeRunner(tmp_path, body, slots=3)
    runner.give(1, 2)
    runner.end()
    while ("start", 2) not in runner.events:
        assert runner.read()
    fifo.write_bytes(b"x")
    runner.finish()
    assert runner.verdicts() == ["passed", "passed"]
    runner = EpisodeRunner(tmp_path, body.replace("    yield\n", ""), slots=1)
    runner.give(1, 2)
    while ("start", 2) not in runner.events:
        assert runner.read()
    # Its process waits for the file now or soon, and the result of the first one is here.
    assert ("end", 1) in runner.events
    fifo.write_bytes(b"x")
    runner.end()
    assert runner.finish().verdicts() == ["passed", "passed"]


def test_a_stop_request_wakes_a_test_that_waits(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n    self.report('waits')\n    self.take()\n"
        "def tearDown(self):\n    self.report('torn down')\n"
    )
    runner = EpisodeRunner(tmp_path, body)
    while not runner.outside:
        assert runner.read()
    runner.host.send("interrupt", {"reason": "enough"})
    runner.finish()
    assert runner.answer == {"outcome": "interrupted", "reason": "enough"}
    assert runner.outside == [("report", "waits"), ("report", "torn down")]


def test_after_a_stop_request_open_episodes_are_the_runners(tmp_path: Path) -> None:
    body = episode_test(
        "def episode(self, episode):\n"
        "    try:\n        self.report('runs')\n        while True:\n            yield\n"
        "    finally:\n        self.report('closed')\n"
    )
    runner = EpisodeRunner(tmp_path, body)
    runner.give(1, 2, 3)
    while 2 not in runner.results or not runner.results[2].messages:
        assert runner.read()
    runner.host.send("interrupt", {"reason": "enough"})
    runner.finish()
    assert runner.answer == {"outcome": "interrupted", "reason": "enough"}
    assert runner.events == [("start", 1), ("start", 2)]
    for episode in (1, 2):
        assert runner.results[episode].messages == [("report", "runs"), ("report", "closed")]


def test_a_result_after_a_stop_request_is_not_sent(tmp_path: Path) -> None:
    body = episode_test(
        "def run(self):\n"
        "    one, = self.take()\n"
        "    self.report('runs')\n"
        "    while not self.interrupted():\n        pass\n"
        "    one.finish(True)\n"
    )
    runner = EpisodeRunner(tmp_path, body)
    runner.give(1)
    while not runner.outside:
        assert runner.read()
    runner.host.send("interrupt", {"reason": "enough"})
    runner.finish()
    assert runner.answer == {"outcome": "interrupted", "reason": "enough"}
    assert runner.events == [("start", 1)]


def test_a_run_that_ends_with_open_episodes_is_an_error(tmp_path: Path) -> None:
    body = episode_test("def run(self):\n    self.take()\n")
    runner = run_episodes(tmp_path, body, [1, 2])
    assert runner.verdicts() == ["error", "error"]
    assert runner.results[1].reason == "`run` ended while the episode was open"
    assert runner.outside == [("error", "`run` ended while 2 episodes were open: 1, 2")]


@pytest.mark.parametrize("arrived", [True, False])
def test_a_run_that_ends_before_the_last_episode_is_an_error(
    tmp_path: Path, *, arrived: bool
) -> None:
    body = episode_test("def run(self):\n    self.take()[0].finish()\n    self.report('ends')\n")
    runner = EpisodeRunner(tmp_path, body, slots=1)
    runner.give(1, *([2] if arrived else []))
    while not runner.outside:
        assert runner.read()
    if not arrived:
        runner.give(2)
    runner.finish()
    text = "`run` ended, but more episodes follow until `take` returns an empty list"
    assert runner.outside == [("report", "ends"), ("error", text)]


def test_a_run_that_does_not_wait_for_the_end_passes(tmp_path: Path) -> None:
    body = episode_test("def run(self):\n    self.take()[0].finish()\n    self.report('ends')\n")
    runner = EpisodeRunner(tmp_path, body, slots=1)
    runner.give(1)
    while not runner.outside:
        assert runner.read()
    runner.end()
    runner.finish()
    assert (runner.answer, runner.verdicts()) == ({"outcome": "passed"}, ["passed"])


def test_an_exception_of_run_is_the_reason_of_open_episodes(tmp_path: Path) -> None:
    body = episode_test("def run(self):\n    self.take()\n    raise ValueError('42')\n")
    runner = run_episodes(tmp_path, body, [1, 2, 3])
    assert runner.verdicts() == ["error", "error"]
    assert runner.results[2].reason == "`run` ended with ValueError: 42"
    assert runner.outside == [("error", "ValueError: 42")]


def test_a_critical_assertion_ends_the_test(tmp_path: Path) -> None:
    body = episode_test(
        "def episode(self, episode):\n"
        "    yield\n    self.require_critical(episode.id == 2, 'it is safe')\n"
    )
    runner = run_episodes(tmp_path, body, [1, 2, 3])
    assert runner.verdicts() == ["failed", "error"]
    assert runner.results[2].reason == "`run` ended with `it is safe`"
    (critical,) = (one for one in runner.host.of("message") if one["kind"] == "failure")
    assert critical["critical"] is True


def test_a_test_without_episode_or_run(tmp_path: Path) -> None:
    runner = run_episodes(tmp_path, "class Arm(rtf.EpisodeTest):\n    pass\n", [1])
    text = "NotImplementedError: Arm has neither `episode` nor `run`"
    assert runner.results[1].messages == [("error", text)]


def test_a_coroutine_is_an_error(tmp_path: Path) -> None:
    body = "class Arm(rtf.EpisodeTest):\n    async def episode(self, episode):\n        pass\n"
    runner = run_episodes(tmp_path, body, [1])
    text = "TypeError: `episode` is a coroutine, expected a generator"
    assert runner.results[1].messages == [("error", text)]
    assert runner.errors == ""


def test_a_suite_that_does_not_fit_the_class_is_an_error(tmp_path: Path) -> None:
    ran = run(tmp_path, episode_test(STEPS))
    text = '`Arm` is an episode test, which needs `slots`: `<test slots="1">`'
    assert (ran.problem, ran.phases) == (("error", text), [])
    ran = run(tmp_path, arm("pass"), episodes={"slots": 2})
    text = "the test has `slots`, but `Arm` is not derived from `rtf.EpisodeTest`"
    assert (ran.problem, ran.phases) == (("error", text), [])


@pytest.mark.parametrize("slots", ["many", {"slots": 0}, {"slots": 1, "max_steps": "5"}])
def test_settings_that_are_no_numbers_are_refused(tmp_path: Path, slots: Any) -> None:
    host = Host(tmp_path)
    answer = host.ask("run-test", {**plugin(tmp_path, episode_test(STEPS)), "episodes": slots})
    assert answer["error"]["code"] == -32602


def test_a_forked_child_neither_takes_nor_finishes(tmp_path: Path) -> None:
    body = "import os\n" + episode_test(
        "def run(self):\n"
        "    one, = self.take()\n"
        "    if os.fork() == 0:\n"
        "        with one:\n            self.report('from the child')\n"
        "        one.finish(False)\n"
        "        try:\n            self.take()\n"
        "        except RuntimeError as problem:\n            self.report(problem)\n"
        "        os._exit(0)\n"
        "    os.wait()\n"
        "    one.finish(True)\n    self.take()\n"
    )
    runner = run_episodes(tmp_path, body, [1])
    assert runner.verdicts() == ["passed"]
    assert runner.results[1].messages == [("report", "from the child")]
    text = "episodes can be taken in `run` of the test only"
    assert runner.outside == [("report", text)]


def test_the_check_finds_a_test(tmp_path: Path) -> None:
    import subprocess
    import sys

    from driver import PACKAGE

    file = Path(plugin(tmp_path, episode_test(STEPS))["file"])
    command = [sys.executable, "-m", "rtf_start", "rtf.host", "--check", str(file)]
    environment = {"PYTHONPATH": str(PACKAGE)}
    output = subprocess.run(command, env=environment, capture_output=True, check=True).stdout
    assert json.loads(output)["kinds"] == ["test"]


def test_finished_episodes_are_forgotten(tmp_path: Path) -> None:
    body = "import gc\n" + episode_test(
        "def episode(self, episode):\n"
        "    with self.case('inner'):\n        self.sample('x', 1)\n        yield\n"
        "def tearDown(self):\n"
        "    gc.collect()\n"
        "    kinds = [type(one).__name__ for one in gc.get_objects()]\n"
        "    names = ('Episode', 'OpenCase', 'Running', 'generator', 'Batch')\n"
        "    self.report({name: kinds.count(name) for name in names})\n"
    )
    runner = run_episodes(tmp_path, body, list(range(1, 201)), slots=8)
    assert runner.verdicts() == ["passed"] * 200
    ((_, text),) = runner.outside
    assert sum(json.loads(text.replace("'", '"')).values()) < 10
