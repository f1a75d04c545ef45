"""Runs in the workers of pytest-xdist, which have no connection to the host."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import pytest

from rtf import session as rtf_session
from rtf.frameworks import pytest_details
from rtf.frameworks.pytest_failures import DETAILS, FailureDetails
from rtf.frameworks.pytest_options import VALUES
from rtf.frameworks.stop import Stop

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

# The file with the selection, a JSON object. Without it, all items run.
SELECTION_VARIABLE = "RTF_SELECTED_CASES"


class Selection:
    """The selected items that have not finished."""

    def __init__(self, selection: dict[str, Any]) -> None:
        """Use the selectors of the runner: `equals` and `contains`."""
        wanted: list[dict[str, str]] = selection["wanted"]
        self._finished = frozenset(selection["finished"])
        self._paths = frozenset(each["equals"] for each in wanted if "equals" in each)
        self._outer = frozenset(outer for path in self._paths for outer in _outer_paths(path))
        self._texts = [each["contains"] for each in wanted if "contains" in each]
        self._is_all = not wanted

    def includes(self, name: str) -> bool:
        """Whether an item runs. A path also selects the cases in it and around it."""
        if name in self._finished:
            return False
        return (
            self._is_all
            or name in self._paths
            or name in self._outer
            or any(outer in self._paths for outer in _outer_paths(name))
            or any(text in name for text in self._texts)
        )


def _outer_paths(path: str) -> Iterator[str]:
    return (path[:at] for at, character in enumerate(path) if character == "/")


class WorkerDetails(FailureDetails):
    """Adds everything that the controller does not know to the reports."""

    def __init__(self, config: pytest.Config) -> None:
        """Collect the results of the fixture `rtf` for the report."""
        super().__init__()
        self._starts = pytest_details.Starts(str(config.rootpath))
        self._results: list[tuple[str, dict[str, object]]] = []
        values = getattr(config, "workerinput", {}).get(VALUES, "[]").encode()
        self._session = rtf_session.Session(
            lambda *result: self._results.append(result), lambda: values
        )
        rtf_session.enter(self._session)
        # The signal reaches all processes of the group.
        Stop(KeyboardInterrupt)

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> Generator[None, None, None]:
        """Deselect items: the controller learns their names too late."""
        yield
        file = os.environ.get(SELECTION_VARIABLE)
        if file:
            with open(file, encoding="utf-8") as stream:
                selection = Selection(json.load(stream))
            dropped = [item for item in items if not selection.includes(item.nodeid)]
            items[:] = [item for item in items if selection.includes(item.nodeid)]
            config.hook.pytest_deselected(items=dropped)

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[Any]
    ) -> Generator[None, Any, None]:
        """Add details to a report, after other plug-ins have changed it.

        The first report also gets tags and parameters, and the last one results.
        """
        outcome = yield
        details = self.details_of(item, call)
        if call.when == "setup":
            details["start"] = self._starts.of(item)
        elif call.when == "teardown":
            self._session.send_samples()
            details["results"], self._results[:] = list(self._results), []
        setattr(outcome.get_result(), DETAILS, details)
