"""The pytest plug-in: `python3 -m pytest -p rtf.frameworks.pytest_plugin`.

It reports items to the host that started pytest, or lists them. Without a host, it only
provides the fixture `rtf`.
"""

from __future__ import annotations

import pytest

from rtf.frameworks import pytest_options, stack_dump
from rtf.frameworks.connection import Connection
from rtf.frameworks.listing import Listing
from rtf.frameworks.pytest_fixture import rtf
from rtf.frameworks.pytest_options import VALUES

__all__ = ["pytest_cmdline_main", "pytest_configure", "pytest_load_initial_conftests", "rtf"]


class _Host:
    """How the host started this process."""

    connection: Connection | None = None
    listing: Listing | None = None


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests() -> None:
    """Connect to the host before the user's modules are loaded, whose children must not."""
    stack_dump.prepare()
    _Host.listing = Listing.from_environment()
    _Host.connection = Connection.from_environment()


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Change options before the plug-ins read them."""
    # A worker of pytest-xdist reads the configuration of the project, too.
    is_worker = VALUES in getattr(config, "workerinput", ())
    if is_worker or _Host.listing is not None or _Host.connection is not None:
        pytest_options.run_all_items(config)


def pytest_configure(config: pytest.Config) -> None:
    """Start to report or to list."""
    plugin: object
    if _Host.listing is not None:
        from rtf.frameworks.pytest_lister import Lister  # noqa: PLC0415 - only what is used

        plugin = Lister(config, _Host.listing)
    elif hasattr(config, "workerinput"):
        from rtf.frameworks.pytest_worker import WorkerDetails  # noqa: PLC0415

        plugin = WorkerDetails(config)
    elif _Host.connection is not None:
        from rtf.frameworks.pytest_reporter import Reporter  # noqa: PLC0415

        plugin = Reporter(config, _Host.connection)
    else:
        return
    config.pluginmanager.register(plugin, "rtf-reporter")
