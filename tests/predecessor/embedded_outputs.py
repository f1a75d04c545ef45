"""Differences in the output of a program that runs tests in its own process, with reasons.

The lines are those of a unified diff without context, from the predecessor's output to ours. A
scenario without a reason must print the same with both.
"""

from __future__ import annotations

SAME: list[str] = [
    "test/",
    "test/param",
    "test/setup-error",
    "test/check",
    "test/error",
    "test/fail",
    "test/standard",
    "test/teardown",
    "suite/",
    "suite/fail",
    "fixture/teardown-throws",
    "fixture/check-once",
]

NOT_RUN = "the suite says which tests it did not run"

DIFFERENT: dict[str, tuple[str, str]] = {
    "test/blank": (
        "8: a space in the name created another argument",
        """
-first test setup 2 first
-argument <test>
+first test setup 1 first test
""",
    ),
    "test/repetition": (
        "2: three repetitions ran four times",
        """
-first run
-report first running
-report first order
""",
    ),
    "test/setup-false": (
        "a test whose set-up returned false is torn down too",
        """
+first tearDown
""",
    ),
    "test/integer": (
        "3: an exception of another type ended the program",
        """
-died
+error first
+first tearDown
+end test first failed
+end runner
+tests 1 passed 0 failed 1
+suites 0 passed 0 failed 0
+ended
""",
    ),
    "suite/collapse": (
        "4: the test passed during which a fixture collapsed",
        """
-end test first passed
+error first
+error first during the run: the rig fell
+end test first failed
-one check
-two check
-tests 3 passed 3 failed 0
+tests 3 passed 2 failed 1
""",
    ),
    "last/collapse": (
        "4: a collapse during the last test was not reported",
        """
-end test second passed
+error second
+error second during the run: the rig fell
+end test second failed
+error suite the rig fell
-end suite suite passed
+end suite suite failed
-tests 3 passed 3 failed 0
-suites 2 passed 2 failed 0
+tests 3 passed 2 failed 1
+suites 2 passed 1 failed 1
""",
    ),
    "suite/interrupt": (
        "6: a test that was interrupted passed; " + NOT_RUN,
        """
-report first An interrupt signal received
-end test first passed
-failure suite
+error first
+end test first failed
+error suite
+failure suite
-tests 2 passed 2 failed 0
+tests 2 passed 1 failed 1
""",
    ),
    "last/interrupt": (
        "6: an interrupted suite passed",
        """
-report second An interrupt signal received
-end test second passed
+error second
+end test second failed
-end suite suite passed
+failure suite
+end suite suite failed
-tests 3 passed 3 failed 0
-suites 2 passed 2 failed 0
+tests 3 passed 2 failed 1
+suites 2 passed 1 failed 1
""",
    ),
    "fixture/setup-false": (
        "5: the fixture was left as it was; " + NOT_RUN,
        """
+error suite
+one tearDown
""",
    ),
    "fixture/setup-throws": (
        "5: a fixture that was never set up was torn down; " + NOT_RUN,
        """
-two tearDown
+error suite
""",
    ),
    "fixture/check-false": (NOT_RUN, "\n+error suite\n"),
    "fixture2/setup-false": (
        "5: the first fixture was never torn down; " + NOT_RUN,
        """
+error suite
+two tearDown
+one tearDown
""",
    ),
    "fixture2/setup-throws": (NOT_RUN, "\n+error suite\n"),
}
