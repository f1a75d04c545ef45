"""Starts what took longest in earlier runs first, so that no processor idles at the end.

The process that distributes the tests records how long they take, and gives the same record to all
workers, which would otherwise collect the tests in different orders.
"""

from __future__ import annotations

import json
import os
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

FILE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rtf/durations.json"

Durations = dict[str, float]
RECORDED = pytest.StashKey[Durations]()


class Recorder:
    """Records how long tests took, without their set-up, which often waits for a build."""

    def __init__(self, durations: Durations) -> None:
        self.durations = durations

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Replaces the duration of a test."""
        if report.when == "call" and report.passed:
            self.durations[without_group(report.nodeid)] = round(report.duration, 2)

    def pytest_sessionfinish(self) -> None:
        """Writes the file, at once, as others may read it."""
        FILE.parent.mkdir(parents=True, exist_ok=True)
        new = FILE.with_suffix(f".{os.getpid()}")
        new.write_text(json.dumps(self.durations, indent=0, sort_keys=True) + "\n")
        new.replace(FILE)


def pytest_configure(config: pytest.Config) -> None:
    """Reads the record, or takes that of the distributing process."""
    worker: dict[str, Any] | None = getattr(config, "workerinput", None)
    durations: Durations = worker["durations"] if worker else recorded()
    config.stash[RECORDED] = durations
    if worker is None and not config.option.collectonly:
        config.pluginmanager.register(Recorder(dict(durations)))


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Gives the record to a worker."""
    node.workerinput["durations"] = node.config.stash[RECORDED]


def recorded() -> Durations:
    """The durations of earlier runs in seconds, none at first."""
    try:
        found: Durations = json.loads(FILE.read_text())
    except (OSError, ValueError):
        return {}
    return found


def longest_first(items: list[pytest.Item], config: pytest.Config) -> None:
    """Sorts tests by the sums of their groups.

    Without a record, a test takes what its mark `first` declares. While a worker runs a test, it
    already has the next one: the shortest ones follow those that the workers start with.
    """
    durations = config.stash[RECORDED]
    sums: defaultdict[str, float] = defaultdict(float)
    for item in items:
        sums[group(item)] += durations.get(item.nodeid, declared(item))
    groups = sorted(sums, key=lambda each: -sums[each])
    workers = getattr(config, "workerinput", {}).get("workercount", 0)
    shortest = groups[max(workers, len(groups) - workers) :]
    places: dict[str, float] = {each: place for place, each in enumerate(groups)}
    places |= dict.fromkeys(shortest, workers - 0.5)
    items.sort(key=lambda item: places[group(item)])


def declared(item: pytest.Item) -> float:
    """The seconds that the mark `first` declares."""
    marker = item.get_closest_marker("first")
    return 60.0 * (marker.args[0] if marker.args else 1) if marker else 0.0


def group(item: pytest.Item) -> str:
    """What runs in one process."""
    marker = item.get_closest_marker("xdist_group")
    return "@" + str(marker.args[0]) if marker else item.nodeid


def without_group(name: str) -> str:
    """The name of a test, to which xdist appends its group."""
    return name if name.rfind("@") < name.rfind("]") else name.partition("@")[0]
