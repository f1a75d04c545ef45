"""The results of the tests of a launch."""

from __future__ import annotations

import unittest
from typing import Any


class TestResult(unittest.TextTestResult):
    """Results that also know all tests."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.cases: list[Any] = []

    def startTest(self, test: Any) -> None:
        """Remembers the test."""
        self.cases.append(test)
        super().startTest(test)


class FailResult(unittest.TestResult):
    """All tests of a launch have failed, because it ended early."""

    def __init__(self, test_run: Any, message: str) -> None:
        super().__init__()
        self.cases = list(test_run.all_cases())
        for case in self.cases:
            self.addFailure(case, (Exception, Exception(message), None))


class SkipResult(unittest.TestResult):
    """All tests of a launch are skipped."""

    def __init__(self, test_run: Any, skip_reason: str) -> None:
        super().__init__()
        self.cases = list(test_run.all_cases())
        for case in self.cases:
            self.addSkip(case, skip_reason)
