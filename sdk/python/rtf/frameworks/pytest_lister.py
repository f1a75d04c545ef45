"""Lists the items of pytest for the host."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtf.frameworks import pytest_details
from rtf.frameworks.pytest_texts import collection_problem

if TYPE_CHECKING:
    import pytest

    from rtf.frameworks.listing import Listing


class Lister:
    """Lists items after all plug-ins have changed them."""

    def __init__(self, config: pytest.Config, listing: Listing) -> None:
        """List to this file."""
        self._listing = listing
        self._starts = pytest_details.Starts(str(config.rootpath))

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """List modules that skip themselves, and report problems."""
        if report.failed:
            short, long = collection_problem(report)
            self._listing.problem(f"{short}\n{long}")
        elif report.skipped:
            self._listing.case({"name": report.nodeid})

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """List all items."""
        self._starts.names(session.items)
        for item in session.items:
            self._listing.case(self._starts.of(item))

    def pytest_internalerror(self, excrepr: object) -> None:
        """Report an error of pytest or a plug-in."""
        self._listing.problem(f"internal error of pytest or a plug-in\n{excrepr}")

    def pytest_unconfigure(self) -> None:
        """Complete the list."""
        self._listing.finish()
