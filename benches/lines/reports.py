"""A test that reports or samples a million times, and one with 100 000 cases."""

from __future__ import annotations

from collections.abc import Callable

from measuring import suite
from measuring.bench import PREDECESSOR, Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work

COUNT = 1_000_000
CASES = 100_000
RATE = "events/s"
SAMPLE_RATE = "samples/s"
CASE_RATE = "cases/s"
MEMORY = "MB"

# The import into the history has separate lines.
WITHOUT_HISTORY = ("--no-history",)

RTF = "rtf"
OLD = "predecessor"
WITH_SAMPLES = "samples"
WITH_CASES = "cases"


def group(bench: Bench) -> Group:
    """The predecessor keeps them in memory and writes them at the end."""
    missing = "" if bench.predecessor else f"{PREDECESSOR} is missing"
    works = (
        Work(RTF, rtf(bench)),
        Work(OLD, predecessor(bench), missing),
        Work(WITH_SAMPLES, samples(bench)),
        Work(WITH_CASES, cases(bench)),
    )
    rate = Limit(300_000, at_least=True, required=False)
    at_par = Limit(1.0, of_ratio=True, at_least=True, required=False)
    sample_rate = Limit(1_000_000, at_least=True, required=False)
    memory = Limit(100, required=False)
    cases_rate = Limit(150_000, at_least=True)
    lines = (
        Line("1 M reports, journal and console", RTF, RATE, OLD, rate),
        Line("1 M reports, compared with the predecessor", RTF, RATE, OLD, at_par),
        Line("1 M reports, memory", RTF, MEMORY, OLD, memory),
        Line("1 M samples, journal and console", WITH_SAMPLES, SAMPLE_RATE, limit=sample_rate),
        Line("100 000 cases, journal and console", WITH_CASES, CASE_RATE, limit=cases_rate),
    )
    return Group("reports", works, lines, rounds=3)


def rtf(bench: Bench) -> Callable[[], Samples]:
    """The journal must have all of them."""
    file = suite.write(bench, "reports", [f'<test type="dll" param="{COUNT}">Reports</test>'])

    def work() -> Samples:
        with suite.Run(bench, file, options=WITHOUT_HISTORY) as run:
            run.expect("message", COUNT)
            launched = run.launched
        return {RATE: [COUNT / launched.seconds], MEMORY: [launched.children[0].rss_mb]}

    return work


def samples(bench: Bench) -> Callable[[], Samples]:
    """The journal must have all values of the signal."""
    file = suite.write(bench, "samples", [f'<test type="dll" param="{COUNT}">Samples</test>'])

    def work() -> Samples:
        with suite.Run(bench, file, options=WITHOUT_HISTORY) as run:
            batches = [event["samples"] for event in run.events() if "samples" in event]
            found = sum(len(batch["points"]) for batch in batches if isinstance(batch, dict))
            if found != COUNT:
                raise MeasuringError(f"{found} samples in the journal, not {COUNT}")
            return {SAMPLE_RATE: [COUNT / run.launched.seconds]}

    return work


def cases(bench: Bench) -> Callable[[], Samples]:
    """The journal must have each of them from its start to its verdict."""
    file = suite.write(bench, "cases", [f'<test type="dll" param="{CASES}">Cases</test>'])

    def work() -> Samples:
        with suite.Run(bench, file, options=WITHOUT_HISTORY) as run:
            run.expect("case-started", CASES)
            run.expect("case-finished", CASES, '"verdict":"passed"')
            return {CASE_RATE: [CASES / run.launched.seconds]}

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
