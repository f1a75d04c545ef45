"""Measures the works of a group by turns, so that what else the machine does
in the meantime hits all of them alike.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from measuring.model import Group, Line, Samples, Work

Rounds = dict[str, list[Samples]]
"""What each work gave, by its name: one entry for each round."""


def measure(
    group: Group, lines: Sequence[Line], rounds: int, tell: Callable[[str], None]
) -> Rounds:
    """Measures what the lines need. Every second round goes backwards, so that
    no work always comes after the same one.
    """
    works = needed(group, lines)
    if group.warm_up:
        tell("warming up")
        for work in works:
            work.run()
    found: Rounds = {work.name: [] for work in works}
    for number in range(1, rounds + 1):
        for work in works if number % 2 else works[::-1]:
            tell(f"round {number} of {rounds}: {work.name}")
            found[work.name].append(work.run())
    return found


def needed(group: Group, lines: Sequence[Line]) -> list[Work]:
    """The works behind these lines that this machine can do."""
    names = {line.work for line in lines} | {line.peer for line in lines}
    return [work for work in group.works if work.name in names and not work.missing]
