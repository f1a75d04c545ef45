"""Runs YARP's fixtures while parts hang or do not start, and two of them in parallel.

All programs are YARP's own. The tests of example 03 kill them.
"""

from __future__ import annotations

import signal
import tarfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import ROOT
from processes import kill
from run import expect, expect_in
from yarp_runs import YarpRuns, quiet_runs

pytestmark = [pytest.mark.middleware("yarp"), pytest.mark.outside_network]
SUITES = ROOT / "tests/fixtures/yarp/suites"
HEAD = "/icubSim/head/state:o"


@pytest.fixture
def runs(rtf: str, tmp_path: Path) -> Iterator[YarpRuns]:
    """Runs of the suites, from which no packet leaves."""
    with quiet_runs(rtf, SUITES, tmp_path) as started:
        yield started


@pytest.mark.parametrize(
    ("suite", "expected"),
    [
        pytest.param("probe", f"the port {HEAD} does not answer at 127.0.0.1:", id="probe"),
        pytest.param("application", f"{HEAD} -> /reader is lost: the port {HEAD}", id="manager"),
    ],
)
def test_a_process_that_hangs_is_a_collapse(runs: YarpRuns, suite: str, expected: str) -> None:
    """It exists but does not answer, which is the reason."""
    run = runs.start(f"{suite}.xml")
    run.disturb(lambda: kill(runs.processes("yarpdev"), signal.SIGSTOP))
    expect("exit code", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["collapsed"])
    expect_in(expected, run.reason())
    runs.nothing_left()


@pytest.mark.parametrize(
    ("application", "expected"),
    [
        ("broken", "Could not find device <noSuchDevice>"),
        ("missing", "cannot run no-such-module on localhost"),
    ],
    ids=["broken", "missing"],
)
def test_a_module_that_does_not_start_fails_the_set_up(
    runs: YarpRuns, application: str, expected: str
) -> None:
    """Without waiting for the time-outs of YARP's manager."""
    run = runs.start("application.xml", "run", f"--set=application={application}")
    expect("exit code", run.wait(), 1)
    expect("skipped", len(list(run.events("test-skipped"))), 1)
    expect_in(expected, run.reason("fixture-broken"))
    runs.nothing_left()


def test_a_module_that_ends_badly_makes_the_run_red(runs: YarpRuns) -> None:
    """Although YARP's manager ignores it."""
    run = runs.start("ending.xml")
    expect("exit code", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["passed"])
    (problem,) = run.problems()
    expect_in("module `python3 ../ending.py 3` ended with exit code 3 after SIGTERM", problem)
    expect_in("module `python3 ../ending.py 11` was killed by SIGSEGV after SIGTERM", problem)
    expect("the module that ended well", "ending.py 0" in problem, False)
    runs.nothing_left()


def test_a_module_may_end_badly_if_that_is_allowed(runs: YarpRuns) -> None:
    run = runs.start("ending.xml", "run", "--set=options=--may-die python3")
    expect("exit code", run.wait(), 0)
    runs.nothing_left()


def test_parallel_suites_have_separate_namespaces(runs: YarpRuns) -> None:
    """Two suites with the same application in one network, in separate YARP namespaces."""
    run = runs.start("left.xml", "run", "--jobs", "2", str(runs.suites / "right.xml"))
    expect("exit code", run.wait(), 0)
    expect("verdicts", run.attempts(), ["passed", "passed"])
    servers: dict[int, dict[str, object]] = {}
    for event in run.events("fixture-provided"):
        servers.setdefault(event["fixture"], {})[event["name"]] = event["value"]
    spaces = {str(values["namespace"]) for values in servers.values()}
    expect("private namespaces", len(spaces), 2)
    for values in servers.values():
        number = int(str(values["namespace"]).removeprefix("/rtf"))
        expected = {"host": "127.0.0.1", "port": 10000 + 100 * number, "namespace": f"/rtf{number}"}
        expect("values of yarpserver", values, expected)
    runs.nothing_left()


def test_the_data_of_a_failed_test_is_attached(runs: YarpRuns) -> None:
    """The data of a port during a failed test is attached to that test, and nothing else."""
    run = runs.start("recorder.xml")
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"bad": "failed", "good": "passed"})
    (kept,) = run.events("attached")
    expect("test with the recording", run.name(kept), "bad")
    with tarfile.open(run.journal.parent / kept["attachment"]["path"]) as archive:
        names = {Path(name).name for name in archive.getnames()}
        expect("files", {"data.log", "info.log"} <= names, True)
        (data,) = [name for name in archive.getnames() if name.endswith("data.log")]
        stream = archive.extractfile(data)
        assert stream is not None, data
        lines = stream.read().decode().splitlines()
    # A number, a time stamp, and six encoders.
    expect("enough lines", len(lines) > 10, True)
    expect("numbers in a line", {len(line.split()) for line in lines}, {8})
    runs.nothing_left()


@pytest.mark.usefixtures("data_of_yarp")
def test_a_fixture_is_found_as_by_the_plug_in_of_yarp(runs: YarpRuns) -> None:
    """`--fixture head.xml` is found as by YARP's own plug-in: in a context of YARP's data."""
    run = runs.start("predecessor.xml")
    expect("exit code", run.wait(), 0)
    expect("verdicts", list(run.verdicts().values()), ["passed"])
    runs.nothing_left()


@pytest.mark.usefixtures("data_of_yarp")
def test_items_that_yarp_does_not_have_are_named(runs: YarpRuns) -> None:
    """Items that YARP lists are found; all others are named."""
    run = runs.start("plugins.xml", "plugins")
    expect("exit code", run.wait(), 0)
    absent = "--set=monitor=remote_controlboard"
    run = runs.start("plugins.xml", "absent", absent, "--set=carriers=tcp shmem")
    expect("exit code", run.wait(), 1)
    expected = "YARP does not have portmonitors: remote_controlboard, carriers: shmem"
    expect_in(expected, run.reason("fixture-broken"))
