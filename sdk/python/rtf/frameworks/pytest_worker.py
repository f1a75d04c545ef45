"""Runs in the workers of pytest-xdist, which have no connection to the host."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import pytest

from rtf import session as rtf_session
from rtf.frameworks import pytest_details
from rtf.frameworks.pytest_failures import DETAILS, FailureDetails
from rtf.frameworks.stop import Stop

if TYPE_CHECKING:
    from collections.abc import Generator

# The file with the names of the selected items, a JSON list. Without it, all run.
SELECTION_VARIABLE = "RTF_SELECTED_CASES"

# The values of fixtures in the controller's input for a worker.
VALUES = "rtf_fixture_values"


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
                selected = frozenset(json.load(stream))
            dropped = [item for item in items if item.nodeid not in selected]
            items[:] = [item for item in items if item.nodeid in selected]
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
