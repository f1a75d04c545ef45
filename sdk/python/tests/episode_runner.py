"""Plays the runner of an episode test: hands episodes out as slots become free."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from driver import Host, plugin

if TYPE_CHECKING:
    from pathlib import Path


@dataclass
class Result:
    """What was reported about an episode."""

    outcome: str | None = None
    reason: str | None = None
    end: dict[str, Any] = field(default_factory=dict)
    messages: list[tuple[str, str]] = field(default_factory=list)
    inner: list[str] = field(default_factory=list)

    def verdict(self) -> str:
        """Return the verdict as the runner decides it: the first problem, or the outcome."""
        problems = [kind for kind, _ in self.messages if kind in ("failure", "error")]
        words = {"failure": "failed", "error": "error"}
        return words[problems[0]] if problems else self.outcome or "passed"


class EpisodeRunner:
    """The runner's side of the test of a plug-in, whose rules it checks."""

    def __init__(self, directory: Path, body: str, slots: int = 2, **limits: int) -> None:
        """Start the test."""
        self.host = Host(directory)
        self.slots = slots
        self.results: dict[int, Result] = {}
        self.events: list[tuple[str, int]] = []
        self.outside: list[tuple[str, str]] = []
        self.ids: dict[int, int] = {}
        self.most_open = 0
        self.answer: dict[str, Any] | None = None
        self._open: dict[int, int] = {}
        self._inner: dict[int, int] = {}
        self._cases = 0
        settings = {"slots": slots, **limits}
        self.host.send("run-test", {**plugin(directory, body), "episodes": settings}, number=2)

    def give(self, *episodes: int | dict[str, Any]) -> None:
        """Send episodes; a number is one with this id, and ten times it as seed."""
        given = [
            {"id": one, "seed": 10 * one, "parameters": {}} if isinstance(one, int) else one
            for one in episodes
        ]
        self.host.send("episodes", {"episodes": given})

    def end(self) -> None:
        """Say that no further episode follows."""
        self.host.send("end-of-episodes", {})

    def read(self) -> bool:
        """Handle the next line; whether there was one."""
        message = self.host.read()
        if message is None:
            return False
        params = message.get("params", {})
        if message.get("id") == 2:
            self.answer = message["result"]
        elif message.get("method") == "case-started":
            self._start(params)
        elif message.get("method") == "case-finished":
            self._finish(params)
        elif message.get("method") == "message":
            kind_and_text = (params["kind"], params["text"].partition("\n")[0])
            episode = self.episode_of(params)
            messages = self.outside if episode is None else self.results[episode].messages
            messages.append(kind_and_text)
        return True

    def episode_of(self, params: dict[str, Any]) -> int | None:
        """Return the id of the episode to which a notification belongs."""
        case = params.get("case", 0)
        return self._open.get(self._inner.get(case, case))

    def _start(self, params: dict[str, Any]) -> None:
        self._cases += 1
        assert params["case"] == self._cases
        if "parent" in params:
            top = self._inner.get(params["parent"], params["parent"])
            assert top in self._open
            self._inner[params["case"]] = top
            self.results[self._open[top]].inner.append(params["name"])
            return
        episode = params["episode"]["id"]
        assert episode not in self.results
        assert params == {"case": self._cases, "name": str(episode), "episode": {"id": episode}}
        self.results[episode] = Result()
        self._open[params["case"]] = self.ids[params["case"]] = episode
        self.most_open = max(self.most_open, len(self._open))
        assert len(self._open) <= self.slots
        self.events.append(("start", episode))

    def _finish(self, params: dict[str, Any]) -> None:
        if self._inner.pop(params["case"], None) is not None:
            return
        assert params["case"] not in self._inner.values()
        episode = self._open.pop(params["case"])
        result = self.results[episode]
        result.outcome, result.reason = params.get("outcome"), params.get("reason")
        result.end = params.get("episode", {})
        self.events.append(("end", episode))

    def finish(self) -> EpisodeRunner:
        """Handle all lines until the end of the process."""
        while self.read():
            pass
        self.code, self.output, self.errors = self.host.end()
        return self

    def verdicts(self) -> list[str]:
        """Return the verdicts of the episodes in the order of their ids."""
        return [self.results[one].verdict() for one in sorted(self.results)]


def run_episodes(
    directory: Path, body: str, episodes: list[Any], slots: int = 2, **limits: int
) -> EpisodeRunner:
    """Run a test whose episodes arrive at once."""
    runner = EpisodeRunner(directory, body, slots, **limits)
    if episodes:
        runner.give(*episodes)
    runner.end()
    return runner.finish()


def episode_test(functions: str, base: str = "rtf.EpisodeTest") -> str:
    """Return the source of a test with these functions."""
    lines = "".join(f"    {line}\n" for line in functions.splitlines())
    return f"class Arm({base}):\n{lines}"
