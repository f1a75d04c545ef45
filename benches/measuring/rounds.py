"""Measures the works of a group alternately, so that other load affects all of them equally."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from measuring.model import Group, Line, Samples, Work

Rounds = dict[str, list[Samples]]
"""The samples of each work, by name: one entry per round."""


def measure(
    group: Group, lines: Sequence[Line], rounds: int, report: Callable[[str], None]
) -> Rounds:
    """Measures the works of the lines. Every second round is in reverse order, so that
    no work always follows the same one.
    """
    works = needed(group, lines)
    if group.warm_up:
        report("warming up")
        for work in works:
            work.run()
    found: Rounds = {work.name: [] for work in works}
    for number in range(1, rounds + 1):
        for work in works if number % 2 else works[::-1]:
            report(f"round {number} of {rounds}: {work.name}")
            found[work.name].append(work.run())
    return found


def needed(group: Group, lines: Sequence[Line]) -> list[Work]:
    """The works of these lines that are available on this machine."""
    names = {line.work for line in lines} | {line.peer for line in lines}
    return [work for work in group.works if work.name in names and not work.missing]
