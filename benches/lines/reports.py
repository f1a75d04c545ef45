"""A test that reports a million times."""

from __future__ import annotations

from collections.abc import Callable

from measuring import suite
from measuring.bench import PREDECESSOR, Bench
from measuring.model import Group, Limit, Line, Samples, Work

COUNT = 1_000_000
RATE = "events/s"
MEMORY = "MB"

RTF = "rtf"
OLD = "predecessor"


def group(bench: Bench) -> Group:
    """The predecessor keeps them in memory and writes them at the end."""
    missing = "" if bench.predecessor else f"{PREDECESSOR} is missing"
    works = (Work(RTF, rtf(bench)), Work(OLD, predecessor(bench), missing))
    rate = Limit(300_000, at_least=True, required=False)
    memory = Limit(100, required=False)
    lines = (
        Line("1 M reports, journal and console", RTF, RATE, OLD, rate),
        Line("1 M reports, memory", RTF, MEMORY, OLD, memory),
    )
    return Group("reports", works, lines, rounds=3)


def rtf(bench: Bench) -> Callable[[], Samples]:
    """The journal must have all of them."""
    file = suite.write(bench, "reports", [f'<test type="dll" param="{COUNT}">Reports</test>'])

    def work() -> Samples:
        with suite.Run(bench, file) as run:
            run.expect("message", COUNT)
            launched = run.launched
        return {RATE: [COUNT / launched.seconds], MEMORY: [launched.children[0].rss_mb]}

    return work


def predecessor(bench: Bench) -> Callable[[], Samples]:
    """The result file must have all of them."""
    elements = [f'<test type="dll" param="{COUNT}">./Predecessor.so</test>']
    file = suite.write(bench, "predecessor-reports", elements)

    def work() -> Samples:
        launched = suite.run_predecessor(bench, file, 1)
        suite.expect_in(bench.directory / suite.PREDECESSOR_RESULT, COUNT, "joint 3 moved")
        return {RATE: [COUNT / launched.seconds], MEMORY: [launched.children[0].rss_mb]}

    return work
