"""Options in the configuration of a project that would keep cases from the runner.

With `addopts` or `PYTEST_ADDOPTS`, a project changes each run of pytest. The runner selects
cases itself, and runs all of them. Options in the suite's `param` count.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest

# The values of fixtures in the controller's input for a worker of pytest-xdist.
VALUES = "rtf_fixture_values"

# Options that leave out items because of other results: how the suite would write them, and
# their value without effect.
_LEAVE_OUT: tuple[tuple[str, re.Pattern[str], object], ...] = (
    ("maxfail", re.compile(r"-[a-zA-Z]*x|--exitfirst|--maxfail"), 0),
    ("lf", re.compile(r"--lf|--last-failed"), False),
    ("stepwise", re.compile(r"--sw|--stepwise"), False),
    ("stepwise_skip", re.compile(r"--sw-skip|--stepwise-skip"), False),
)


def run_all_items(config: pytest.Config) -> None:
    """Undo the options that leave out items because of other results."""
    given = config.invocation_params.args
    for name, option, value in _LEAVE_OUT:
        is_ours = any(isinstance(arg, str) and option.match(arg) for arg in given)
        if getattr(config.option, name, value) != value and not is_ours:
            setattr(config.option, name, value)


def accept_part_of_coverage(config: pytest.Config) -> None:
    """Undo the limit of pytest-cov: only some of the items run."""
    coverage = config.pluginmanager.getplugin("_cov")
    if coverage is not None:
        coverage.options.cov_fail_under = None
