"""The base class of tests that run many episodes of a campaign."""

from __future__ import annotations

from rtf import _session
from rtf._test import TestCase

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Generator
    from typing import Union

    from rtf._episode import Episode
    from rtf._episodes import Episodes

    Result = Union[bool, str, None]
    """`None` or `True`: passed, `False`: failed, a text: the reason of a failure."""


class EpisodeTest(TestCase):
    """A test with `slots` in its suite, which runs up to so many episodes at the same time.

    Write `episode`, or for full control `run` with `take`. `setup` and `tearDown` are called once
    for all episodes.
    """

    @property
    def slots(self) -> int:
        """How many episodes it may run at the same time, from 1."""
        return current().settings.slots

    @property
    def max_steps(self) -> int | None:
        """The limit of an episode in steps, from 1; `None` without one."""
        return current().settings.max_steps

    @property
    def max_time(self) -> float | None:
        """The limit of an episode in simulated time, in s; `None` without one."""
        return current().settings.max_time

    def take(
        self,
        most: int | None = None,
        wait: bool = True,  # noqa: FBT001, FBT002 - as in all languages
    ) -> list[Episode]:
        """Start up to `most` episodes that have arrived, by default as many as slots are free.

        Waits for at least one, unless `wait` is false; an empty list after that means that none
        follows. Without a free slot, waiting is a `ValueError`. A stop request ends it like
        `sleep`.
        """
        return current().take(most, wait=wait)

    def episode(self, episode: Episode) -> Generator[float | None, None, Result] | Result:
        """Run one episode, as a generator or, if it has no steps, as a function.

        Each `yield` is one step, after which other episodes run; a yielded number is the simulated
        time that passed in it, in s. It returns `None` or `True` if the episode passed, `False` or
        the reason as text if it failed. What it reports belongs to the episode.
        """
        raise NotImplementedError(f"{type(self).__name__} has neither `episode` nor `run`")

    def run(self) -> None:
        """Run all episodes, up to `slots` of them interleaved."""
        from rtf import _interleaving  # noqa: PLC0415 - not needed by another `run`

        _interleaving.run(self, current())


def current() -> Episodes:
    """Return the episodes of the test that runs."""
    session = _session.current()
    if session.episodes is None:
        session.end_with_error(
            'this is an episode test, which needs `slots` in its suite: `<test slots="1">`'
        )
    return session.episodes
