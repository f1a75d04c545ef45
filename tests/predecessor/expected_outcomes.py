"""The outcome of each case with the predecessor and with rtf, and the reason of a difference.

An outcome is `colour | verdicts | log of the plug-ins`. If the predecessor is right, both are the
same, and there is no reason. A number is that of the defect in docs/how-to/migrating-rtf2.md.
"""

from __future__ import annotations

from typing import NamedTuple


class Row(NamedTuple):
    """One case. `old` is None if its outcome is not deterministic."""

    what: str
    old: str | None
    new: str
    why: str = ""


def same(what: str, outcome: str) -> Row:
    """A case in which the predecessor is right."""
    return Row(what, outcome, outcome)


RAN = "ran, torn down"

TESTS = [
    same("pass", f"green | passed | {RAN}"),
    same("setup-error", "red | error | torn down"),
    same("assert-error", f"red | error | {RAN}"),
    same("assert-error-if-false", f"red | error | {RAN}"),
    same("assert-error-if-true", f"red | error | {RAN}"),
    same("assert-fail", f"red | failed | {RAN}"),
    same("assert-fail-if-false", f"red | failed | {RAN}"),
    same("assert-fail-if-true", f"red | failed | {RAN}"),
    same("fail-if-false", f"red | failed | {RAN}"),
    same("fail-if-false-holds", f"green | passed | {RAN}"),
    same("fail-if-true", f"red | failed | {RAN}"),
    same("check", f"red | failed | {RAN}"),
    same("fail-then-error", f"red | failed | {RAN}"),
    same("failed", f"red | failed | {RAN}"),
    same("teardown-error", f"red | error | {RAN}"),
    same("teardown-fail", f"red | error | {RAN}"),
    same("standard", f"red | error | {RAN}"),
    same("fixture-exception", f"red | error | {RAN}"),
    same("rename", f"green | passed | {RAN}"),
    same('args-param --x "1 2"', f"green | passed | {RAN}"),
    same("args-environment", f"green | passed | {RAN}"),
    Row(
        "setup-false",
        "red | error | ",
        "red | error | torn down",
        "a test whose set-up returned false is torn down too",
    ),
    Row(
        "setup-fail",
        "red | failed | torn down",
        "red | error | torn down",
        "when the set-up fails, the bench is wrong, not the robot",
    ),
    Row(
        "fail-if-true-comparison",
        f"red | failed | {RAN}",
        f"green | passed | {RAN}",
        "…_IF_TRUE negated only the first operand of a comparison",
    ),
    Row(
        "result",
        f"green | passed | {RAN}",
        f"red | failed | {RAN}",
        "a failure that was added to the result directly did not count",
    ),
    Row(
        "integer",
        "red | the runner died | ran",
        f"red | error | {RAN}",
        "3: an exception of another type ended the runner",
    ),
    Row("exit", "green |  | ran", "red | crashed | ran", "3: exit(0) in a test was green"),
    Row(
        "abort", "red | the runner died | ran", "red | crashed | ran", "3: abort() ended the runner"
    ),
    Row(
        "crash", "red | the runner died | ran", "red | crashed | ran", "3: a crash ended the runner"
    ),
    Row(
        "long",
        f"red | failed | {RAN}",
        f"green | passed | {RAN}",
        "8: Asserter::format cut after 254 characters",
    ),
    Row(
        "repetition-three",
        "green | passed | ran, ran, ran, ran, torn down",
        "green | passed | ran, ran, ran, torn down",
        "2: three repetitions ran four times",
    ),
    Row(
        'args --name "a b" "" c',
        "red | error | torn down",
        f"green | passed | {RAN}",
        "8: an empty argument was dropped",
    ),
    Row(
        "args-many" + " x" * 200,
        None,
        f"green | passed | {RAN}",
        "8: more than 128 arguments wrote past an array",
    ),
]


def rig(param: str) -> str:
    """A fixture with additional arguments."""
    return f"<fixture param='rig {param}'>Rig</fixture>"


def test(param: str, attributes: str = "type='dll'") -> str:
    """A test that ends in the way of its parameter."""
    return f"<test {attributes} param='{param}'>Endings</test>"


SUITES = [
    same(
        rig("a") + rig("b") + test("pass"),
        f"green | passed | a up, b up, {RAN}, b down, a down",
    ),
    same(test("pass") + rig("a"), f"green | passed | a up, {RAN}, a down"),
    same("<test type='dll'>libplain</test>", "green | passed | "),
    same(
        "<test type='dll'>Whole</test>",
        "green | passed | before, set up, ran, torn down, after",
    ),
    Row(
        "<test type='dll' param='x'>Whole</test>" + test("pass"),
        f"red | error, passed | before, set up, after, {RAN}",
        f"red | error, passed | before, set up, torn down, after, {RAN}",
        "a test whose set-up returned false is torn down too",
    ),
    same("<!-- -->" + test("pass", attributes=""), f"green | passed | {RAN}"),
    same("<!-- two -- dashes -->" + test("pass"), f"green | passed | {RAN}"),
    same(
        test("pass") + test("assert-fail") + test("assert-error") + test("pass"),
        f"red | passed, failed, error, passed | {RAN}, {RAN}, {RAN}, {RAN}",
    ),
    Row(
        rig("a false") + rig("b") + test("pass"),
        "red |  | a up",
        "red | skipped | a up, a down",
        "5: the fixture whose set-up failed was left as it was",
    ),
    Row(
        rig("a") + rig("b false") + test("pass"),
        "red |  | a up, b up",
        "red | skipped | a up, b up, b down, a down",
        "5: when the second set-up failed, the first fixture was never torn down",
    ),
    Row(
        rig("a throw") + rig("b") + test("pass"),
        "red |  | a up,  down, a down",
        "red | skipped | a up, a down",
        "5: a fixture that was never set up was torn down",
    ),
    Row(
        rig("a") + rig("b throw") + test("pass"),
        "red |  | a up, b up, b down, a down",
        "red | skipped | a up, b up, b down, a down",
        "the tests that did not run are shown",
    ),
    Row(
        rig("a collapse") + test("collapse"),
        f"green | passed | a up, {RAN}, a down",
        f"red | collapsed | a up, {RAN}, a down",
        "4: a collapse during the last or only test was not reported",
    ),
    Row(
        rig("a collapse") + test("collapse") + test("pass"),
        f"red | passed, passed | a up, {RAN}, a down, a up, {RAN}, a down",
        f"red | collapsed, passed | a up, {RAN}, a down, a up, {RAN}, a down",
        "4: the test during which the fixture collapsed passed",
    ),
    Row(
        "<test type='dll'>nowhere</test>" + test("pass"),
        f"green | passed | {RAN}",
        "red | exit code 2 | ",
        "1: a plug-in that was not found was skipped",
    ),
    Row("", "green |  | ", "red | exit code 2 | ", "1: a suite without tests was green"),
    Row(
        "<fixture>nowhere</fixture>" + test("pass"),
        "red |  | ",
        "red | exit code 2 | ",
        "1: nothing is started, and the exit code says so",
    ),
    Row(
        test("assert-fail", "type='dll' repetition='2'") + test("pass"),
        f"green | passed | {RAN}",
        f"red | failed, failed, passed | {RAN}, {RAN}, {RAN}",
        "2: a repetition dropped the test",
    ),
    Row(
        test("assert-fail") + test("exit"),
        f"green | failed | {RAN}, ran",
        f"red | failed, crashed | {RAN}, ran",
        "3: exit(0) hid the failure before it",
    ),
    Row(
        test("crash") + test("pass"),
        "red | the runner died | ran",
        f"red | crashed, passed | ran, {RAN}",
        "3: a crash ended the run",
    ),
    Row(
        test("pass") + test("crash"),
        f"red | the runner died | {RAN}, ran",
        f"red | passed, crashed | {RAN}, ran",
        "3: a crash ended the run",
    ),
]
