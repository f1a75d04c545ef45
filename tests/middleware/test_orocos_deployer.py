"""Runs the fixture `orocos` while its deployer is killed, hangs, and has components that break.

There are no packages of RTT, so a substitute for the deployer is built. Its
components are real CORBA objects with RTT's published interface, served by omniORB and
registered in omniNames.
"""

from __future__ import annotations

import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import ROOT, exports
from pages import run_fixture_page
from processes import kill, running
from run import Run, expect, expect_in

pytestmark = pytest.mark.middleware("orocos")
SUITES = ROOT / "tests/fixtures/orocos"
SUITE, PROMPT = str(SUITES / "suite.xml"), str(SUITES / "prompt.xml")
SECONDS = "--set=seconds=20"
"""How long the first test runs, in seconds: long enough to disturb it."""

DEPLOYER = "deployer-corba"


@pytest.fixture(autouse=True)
def _nothing_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    yield
    expect("deployers left", running(DEPLOYER) + running("deployer-gnulinux"), [])
    expect("name servers left", running("omniNames"), [])
    expect("directories left", list(tmp_path.glob("rtf-orocos-*")), [])


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The directory with the substitute for both deployers."""
    exports("tools/middleware.sh", "orocos")
    directory = tmp_path_factory.mktemp("deployers") / "bin"
    build(directory)
    return directory


@pytest.fixture
def deployer(programs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There is a deployer on PATH."""
    monkeypatch.setenv("PATH", str(programs), prepend=":")


def build(directory: Path) -> None:
    """Builds the substitute for both deployers."""
    directory.mkdir()
    subprocess.run(["omniidl", "-bcxx", str(SUITES / "TaskContext.idl")], cwd=directory, check=True)
    libraries = ["-lomniORB4", "-lomnithread", "-pthread"]
    program = ["-I.", str(SUITES / "deployer.cpp"), "TaskContextSK.cc", "-o", DEPLOYER]
    flags = ["-std=c++17", "-O1", "-Wall", "-Wextra"]
    subprocess.run(["c++", *flags, *program, *libraries], cwd=directory, check=True)
    shutil.copy(directory / DEPLOYER, directory / "deployer-gnulinux")


def test_a_missing_deployer_is_named(rtf: str, tmp_path: Path) -> None:
    found = shutil.which("deployer-gnulinux")
    assert found is None, f"{found} is on PATH: this check needs a PATH without it"
    run = Run(rtf, PROMPT, tmp_path / "results")
    expect("exit code without a deployer", run.wait(), 1)
    expect_in("set-up failed: there is no program `deployer-gnulinux` on PATH", broken(run))


@pytest.mark.usefixtures("deployer")
@pytest.mark.parametrize("suite", [PROMPT, SUITE], ids=["prompt", "corba"])
def test_all_pass(rtf: str, tmp_path: Path, suite: str) -> None:
    run = Run(rtf, suite, tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})


@pytest.mark.usefixtures("deployer")
def test_page(rtf: str, tmp_path: Path) -> None:
    run_fixture_page(rtf, "orocos", tmp_path / "page", SUITES)


@pytest.mark.usefixtures("deployer")
@pytest.mark.parametrize(
    ("number", "reasons"),
    [
        pytest.param(signal.SIGUSR1, ["arm is in state FatalError"], id="fatal error"),
        pytest.param(signal.SIGUSR2, ["arm is in state Exception"], id="exception"),
        pytest.param(
            signal.SIGKILL,
            # The reason depends on which check detects it first.
            [f"{DEPLOYER} was killed by SIGKILL", "does not answer: CORBA exception"],
            id="killed",
        ),
        pytest.param(
            signal.SIGSTOP,
            ["does not answer: CORBA exception TRANSIENT: 127.0.0.1:"],
            id="hangs",
        ),
    ],
)
def test_after_a_collapse_there_is_a_new_deployer(
    rtf: str, tmp_path: Path, number: signal.Signals, reasons: list[str]
) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", SECONDS)
    run.collapses(lambda: kill(running(DEPLOYER), number))
    expect(f"exit code after {number.name}", run.wait(), 1)
    reason = run.reason()
    expect(f"one of {reasons} in `{reason}`", any(each in reason for each in reasons), True)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("deployers left", running(DEPLOYER), [])


@pytest.mark.usefixtures("deployer")
def test_a_component_that_is_not_loaded_is_named(rtf: str, tmp_path: Path) -> None:
    """With the last reply."""
    run = Run(rtf, SUITE, tmp_path / "results", "--set=second=elbow", "--set=timeout=1")
    expect("exit code", run.wait(), 1)
    expect_in("CORBA exception NotFound", broken(run))
    expect_in("component elbow is Running", broken(run))


@pytest.mark.usefixtures("deployer")
@pytest.mark.parametrize("may_die", [False, True], ids=["unexpected", "allowed"])
def test_a_deployer_that_crashes_at_the_end_makes_the_run_red(
    rtf: str, tmp_path: Path, *, may_die: bool
) -> None:
    """Unless that is allowed."""
    options = ["--set=options=--may-die"] if may_die else []
    run = Run(rtf, str(SUITES / "crashing.xml"), tmp_path / "results", *options)
    expect("exit code", run.wait(), 0 if may_die else 1)
    if not may_die:
        reason = "tear-down failed: deployer-gnulinux was killed by SIGSEGV after `quit`"
        expect("problems", run.problems(), [reason])


def broken(run: Run) -> str:
    """The reason of the failed set-up."""
    return run.reason("fixture-broken")
