"""The tests in a suite of unittest, which may contain suites."""

from __future__ import annotations

import inspect
import unittest

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any, Callable


def leaves(suite: Any) -> Iterator[Any]:
    """Return all tests in a suite, in order."""
    if _is_test(suite):
        yield suite
        return
    for test in suite:
        yield from leaves(test)


def retain(suite: Any, is_retained: Callable[[Any], bool]) -> None:
    """Remove tests from a suite; its own class and those of inner suites stay."""
    if not isinstance(suite, unittest.BaseTestSuite):
        return
    tests: list[Any] = list(suite)
    for test in tests:
        retain(test, is_retained)
    suite._tests = [test for test in tests if not _is_test(test) or is_retained(test)]


def _is_test(thing: Any) -> bool:
    try:
        iter(thing)
    except TypeError:
        return True
    return False


def start(test: Any) -> dict[str, object]:
    """Return what is known about a test before it runs."""
    params: dict[str, object] = {"name": test.id()}
    method = getattr(test, getattr(test, "_testMethodName", ""), None)
    # A `FunctionTestCase` has no method of the user.
    function = inspect.unwrap(getattr(test, "_testFunc", method) or start)
    code = getattr(function, "__code__", None)
    is_ours = function is start or "__unittest" in getattr(function, "__globals__", {})
    if code is not None and not is_ours:
        params["location"] = {"file": code.co_filename, "line": code.co_firstlineno}
    return params


def class_name(test: Any) -> str:
    """Return the name of a test's class, as unittest reports it for `setUpClass`."""
    return f"{type(test).__module__}.{type(test).__qualname__}"


def import_problem(text: str) -> tuple[str, str]:
    """Return the short and the long text of a module that cannot be imported."""
    long = text.strip()
    first, last = long.partition("\n")[0], long.rpartition("\n")[2]
    return (first if first == last else f"{first}: {last}"), long
