#!/usr/bin/env python3
"""Runs the fixture `orocos` while its deployer is killed, hangs, and has components that break.

    check_fixture_orocos.py RTF DIRECTORY

There are no packages of RTT, so this script builds a substitute for the deployer. Its
components are real CORBA objects with RTT's published interface, served by omniORB and
registered in omniNames.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from pages import run_fixture_page
from processes import kill, running
from run import Run, expect, expect_in

SECONDS = "--set=seconds=20"
"""How long the first test runs, in seconds: long enough to disturb it."""

DEPLOYER = "deployer-corba"


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, sources = (Path(argument).resolve() for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as directory:
        home = Path(directory)
        os.environ["TMPDIR"] = directory
        missing(str(rtf), str(sources / "prompt.xml"), home / "missing")
        build(sources, home / "bin")
        os.environ["PATH"] = f"{home / 'bin'}:{os.environ['PATH']}"
        checks(str(rtf), sources, home)
        expect("deployers left", running(DEPLOYER) + running("deployer-gnulinux"), [])
        expect("name servers left", running("omniNames"), [])
        expect("directories left", list(home.glob("rtf-orocos-*")), [])
    return 0


def checks(rtf: str, sources: Path, home: Path) -> None:
    """The fixture's behaviour if there is a deployer."""
    suite = str(sources / "suite.xml")
    undisturbed(rtf, str(sources / "prompt.xml"), home / "prompt")
    undisturbed(rtf, suite, home / "undisturbed")
    run_fixture_page(rtf, "orocos", home / "page", sources)
    fatal = ["arm is in state FatalError"]
    collapses(Run(rtf, suite, home / "fatal", SECONDS), signal.SIGUSR1, fatal)
    exception = ["arm is in state Exception"]
    collapses(Run(rtf, suite, home / "exception", SECONDS), signal.SIGUSR2, exception)
    # The reason depends on which check detects it first.
    killed = [f"{DEPLOYER} was killed by SIGKILL", "does not answer: CORBA exception"]
    collapses(Run(rtf, suite, home / "killed", SECONDS), signal.SIGKILL, killed)
    hangs = ["does not answer: CORBA exception TRANSIENT: 127.0.0.1:"]
    collapses(Run(rtf, suite, home / "hangs", SECONDS), signal.SIGSTOP, hangs)
    never_there(rtf, suite, home / "never")
    ends_badly(rtf, str(sources / "crashing.xml"), home)


def build(sources: Path, directory: Path) -> None:
    """Builds the substitute for both deployers."""
    directory.mkdir()
    subprocess.run(
        ["omniidl", "-bcxx", str(sources / "TaskContext.idl")], cwd=directory, check=True
    )
    libraries = ["-lomniORB4", "-lomnithread", "-pthread"]
    program = ["-I.", str(sources / "deployer.cpp"), "TaskContextSK.cc", "-o", DEPLOYER]
    flags = ["-std=c++17", "-O1", "-Wall", "-Wextra"]
    subprocess.run(["c++", *flags, *program, *libraries], cwd=directory, check=True)
    shutil.copy(directory / DEPLOYER, directory / "deployer-gnulinux")


def missing(rtf: str, suite: str, directory: Path) -> None:
    """Without a deployer, the reason says so."""
    if found := shutil.which("deployer-gnulinux"):
        raise SystemExit(f"{found} is on PATH: this check needs a PATH without it")
    run = Run(rtf, suite, directory)
    expect("exit code without a deployer", run.wait(), 1)
    expect_in("set-up failed: there is no program `deployer-gnulinux` on PATH", broken(run))


def undisturbed(rtf: str, suite: str, directory: Path) -> None:
    """All tests pass."""
    run = Run(rtf, suite, directory)
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})


def collapses(run: Run, number: signal.Signals, reasons: list[str]) -> None:
    """After a signal to the deployer, the test is `collapsed`; the next has a new deployer."""
    run.collapses(lambda: kill(running(DEPLOYER), number))
    expect(f"exit code after {number.name}", run.wait(), 1)
    reason = run.reason()
    expect(f"one of {reasons} in `{reason}`", any(each in reason for each in reasons), True)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("deployers left", running(DEPLOYER), [])


def never_there(rtf: str, suite: str, directory: Path) -> None:
    """If the script does not load a component, the reason has the last reply."""
    run = Run(rtf, suite, directory, "--set=second=elbow", "--set=timeout=1")
    expect("exit code", run.wait(), 1)
    expect_in("CORBA exception NotFound", broken(run))
    expect_in("component elbow is Running", broken(run))


def ends_badly(rtf: str, suite: str, home: Path) -> None:
    """A deployer that crashes while it quits makes the run red, unless that is allowed."""
    run = Run(rtf, suite, home / "crashing")
    expect("exit code", run.wait(), 1)
    reason = "tear-down failed: deployer-gnulinux was killed by SIGSEGV after `quit`"
    expect("problems", run.problems(), [reason])
    run = Run(rtf, suite, home / "may-die", "--set=options=--may-die")
    expect("exit code", run.wait(), 0)


def broken(run: Run) -> str:
    """The reason of the failed set-up."""
    return run.reason("fixture-broken")


if __name__ == "__main__":
    sys.exit(main())
