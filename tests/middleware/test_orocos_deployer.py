"""Runs the fixture `orocos` while its deployer is killed, hangs, and has components that break.

There are no packages of RTT, so a substitute for the deployer is built, which behaves like the
real one. Its components are real CORBA objects with RTT's published interface, served by omniORB
and registered in omniNames.
"""

from __future__ import annotations

import re
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
NAMES = "--names 127.0.0.1:${port:names}"
OWN_NAMES = f"--own-names {NAMES}"
"""Parameters of a fixture."""

ARM = """
loadComponent("arm", "ArmController")
server("arm", true)
arm.configure()
"""
"""A script."""


@pytest.fixture(autouse=True)
def _nothing_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(SUITES))
    yield
    expect("deployers left", running(DEPLOYER) + running("deployer-gnulinux"), [])
    expect("name servers left", running("omniNames"), [])
    files = ["rtf-orocos-*", "*.ior", "orocos.log", ".tb_history"]
    left = [path for each in files for root in (tmp_path, SUITES) for path in root.glob(each)]
    expect("files left", left, [])


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
    libraries = ["-lomniORB4", "-lomniDynamic4", "-lomnithread", "-pthread"]
    program = ["-I.", str(SUITES / "deployer.cpp"), "TaskContextSK.cc", "-o", DEPLOYER]
    flags = ["-std=c++17", "-Wall", "-Wextra"]
    subprocess.run(["c++", *flags, *program, *libraries], cwd=directory, check=True)
    shutil.copy(directory / DEPLOYER, directory / "deployer-gnulinux")


def suite(path: Path, *params: str, test: str = "Idle", param: str = "0") -> str:
    """Writes a suite with a fixture for each of the parameters, and a test; returns its path."""
    texts = [each.replace('"', "&quot;") for each in params]
    fixtures = [
        f'<fixture name="f{number}" restarts="0" param="{text}"> orocos </fixture>'
        for number, text in enumerate(texts)
    ]
    body = "\n".join([*fixtures, f'<test type="python" param="{param}"> {test} </test>'])
    path.write_text(f'<suite name="{path.stem}">\n{body}\n</suite>\n')
    return str(path)


def run_all(rtf: str, directory: Path, suites: list[str]) -> Run:
    """Runs suites at the same time."""
    return Run(rtf, suites[0], directory / "results", f"--jobs={len(suites)}", *suites[1:])


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


ERRORS = {
    "parse.ops": ("arm.configre()", ":Parse error at line 1: "),
    "type.ops": ('loadComponent("arm", "ArmControler")', "Unable to create Orocos Component"),
    "broken.xml": ("<properties><struct>", "Some error occured while parsing"),
    "extension.txt": ("", "Unknown extension of file"),
}
"""Scripts with errors, and what RTT's log says about them."""


@pytest.mark.usefixtures("deployer")
def test_an_error_in_the_script_fails_the_set_up(rtf: str, tmp_path: Path) -> None:
    """Although the deployer shows its prompt: only its option `--check` ends it."""
    for name, (text, _) in ERRORS.items():
        (tmp_path / name).write_text(text)
        checked = subprocess.run([DEPLOYER, "-s", name, "--check"], cwd=tmp_path, check=False)
        is_known = name == "extension.txt"  # an error that the deployer ignores
        expect(f"exit code with --check of {name}", checked.returncode, 0 if is_known else 255)
    for name in ("orocos.log", "Deployer.ior"):
        (tmp_path / name).unlink()
    params = {Path(name).stem: name for name in ERRORS}
    params["silent"] = "type.ops -- --no-consolelog"
    suites = [suite(tmp_path / f"of-{name}.xml", param) for name, param in params.items()]
    allowed = suite(tmp_path / "allowed.xml", 'type.ops --log-ok "unknown component type"')
    run = run_all(rtf, tmp_path, [*suites, allowed])
    expect("exit code", run.wait(), 1)
    expect("passed with --log-ok", run.attempts().count("passed"), 1)
    reasons = run.reasons("fixture-broken")
    expect("reasons", len(reasons), len(suites))
    for name, (_, text) in ERRORS.items():
        pattern = rf"set-up failed: the deployer reports: \d+\.\d+ \[ ERROR  \]\[\w+\] .*{text}"
        found = [reason for reason in reasons if re.match(pattern, reason)]
        expect(f"reasons for {name} in {reasons}", len(found), 2 if name == "type.ops" else 1)


XML = """<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE properties SYSTEM "cpf.dtd">
<properties>
  <struct name="arm" type="LoggingController">
    <struct name="Activity" type="Activity">
      <simple name="Period" type="double"><value>0.01</value></simple>
    </struct>
    <simple name="Server" type="boolean"><value>1</value></simple>
    <simple name="UseNamingService" type="boolean"><value>1</value></simple>
    <simple name="AutoStart" type="boolean"><value>1</value></simple>
  </struct>
  <struct name="camera" type="GripperController">
    <simple name="Server" type="boolean"><value>1</value></simple>
    <simple name="UseNamingService" type="boolean"><value>0</value></simple>
  </struct>
</properties>
"""
"""A component that logs at 100 Hz, and another one of which a reference is in a file."""

LATE = """
loadComponent("gripper", "GripperController")
server("gripper", true)
loadComponent("arm", "SlowController")
server("arm", true)
arm.configure()
"""
"""The gripper is in state Stopped before the script ends."""


@pytest.mark.usefixtures("deployer")
def test_ready_at_the_end_of_the_script(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also if log lines follow the prompt, and not before; files are in the run's directory."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "fixtures"))
    (tmp_path / "logging.xml").write_text(XML)
    (tmp_path / "late.ops").write_text(LATE)
    orb = "-- -- -ORBtraceLevel 10"
    param = f"logging.xml --component arm --until Running --alive arm.Updates {OWN_NAMES} {orb}"
    logging = suite(tmp_path / "logs.xml", param)
    param = f"late.ops --component gripper {OWN_NAMES}"
    late = suite(tmp_path / "late.xml", param, test="Configured", param="arm")
    run = run_all(rtf, tmp_path, [logging, late])
    expect("exit code", run.wait(), 0)
    logs = run.journal.parent / "logs"
    expect_in("omniORB: ", (logs / "logs.fixture-f0.log").read_text())
    expect_in("and file 'camera.ior'", (logs / "logs.f0.rtt-1.log").read_text())


@pytest.mark.usefixtures("deployer")
def test_a_component_that_cannot_be_monitored_is_named(rtf: str, tmp_path: Path) -> None:
    """With the reason."""
    (tmp_path / "arm.ops").write_text(ARM)
    (tmp_path / "new.ops").write_text(ARM.replace("arm.configure()", ""))
    (tmp_path / "unbound.ops").write_text(ARM.replace("true", "false"))
    (tmp_path / "empty.ops").touch()
    watched = f"--component arm --timeout 3 {OWN_NAMES}"
    other = f"--component arm --timeout 3 {NAMES}"
    suites = [
        suite(tmp_path / "new.xml", f"new.ops {watched}"),
        suite(tmp_path / "unbound.xml", f"unbound.ops {watched}"),
        suite(tmp_path / "missing.xml", f"arm.ops --alive arm.Beat {watched}"),
        suite(tmp_path / "type.xml", f"arm.ops --alive arm.Pose {watched}"),
        suite(tmp_path / "shared.xml", f"arm.ops {watched}", f"empty.ops {other}"),
        suite(tmp_path / "known.xml", f"arm.ops {watched}", f"empty.ops --anywhere {other}"),
    ]
    run = run_all(rtf, tmp_path, suites)
    expect("exit code", run.wait(), 1)
    reasons = sorted(run.reasons("fixture-broken"))
    late = "set-up failed: component arm is Stopped or Running: not within 3 s; "
    unbound = "TaskContexts/arm is not bound (CORBA exception NotFound): the script needs "
    patterns = [
        "set-up failed: arm: the attribute `Beat` is missing",
        "set-up failed: arm: the attribute `Pose` is a /KDL/Frame, not one of bool,",
        re.escape(late + unbound + '`server("arm", true)`, or `Server` and `UseNamingService`'),
        late + rf"TaskContexts/arm is served by {DEPLOYER} \(process \d+\), which this fixture ",
        late + "it is PreOperational",
    ]
    expect("reasons", len(reasons), len(patterns))
    for pattern, reason in zip(patterns, reasons, strict=True):
        expect(f"`{pattern}` in `{reason}`", bool(re.match(pattern, reason)), True)


@pytest.mark.usefixtures("deployer")
@pytest.mark.parametrize(
    ("program", "number", "reasons"),
    [
        pytest.param(DEPLOYER, signal.SIGUSR1, ["arm is in state FatalError"], id="fatal error"),
        pytest.param(DEPLOYER, signal.SIGUSR2, ["arm is in state Exception"], id="exception"),
        pytest.param(DEPLOYER, signal.SIGKILL, [f"{DEPLOYER} was killed by SIGKILL"], id="killed"),
        pytest.param(
            DEPLOYER,
            signal.SIGTERM,
            [f"{DEPLOYER} ended with exit code 0, as after SIGTERM or `quit`"],
            id="terminated",
        ),
        pytest.param(
            DEPLOYER,
            signal.SIGSTOP,
            ["does not answer: CORBA exception TRANSIENT: 127.0.0.1:"],
            id="hangs",
        ),
        pytest.param(
            DEPLOYER,
            signal.SIGALRM,
            ["arm is Running, but its attribute CycleCounter has not changed for "],
            id="update hangs",
        ),
        pytest.param(
            "omniNames",
            signal.SIGKILL,
            # The reason depends on which check detects it first.
            ["the name service has ended: omniNames was killed by SIGKILL", "the name service 127"],
            id="names killed",
        ),
    ],
)
def test_after_a_collapse_there_is_a_new_deployer(
    rtf: str, tmp_path: Path, program: str, number: signal.Signals, reasons: list[str]
) -> None:
    settings = ["--set=grace=0.2"] if number == signal.SIGSTOP else []
    settings += ["--set=stall=0.5"] if number == signal.SIGALRM else []
    run = Run(rtf, SUITE, tmp_path / "results", SECONDS, *settings)
    run.collapses(lambda: kill(running(program), number))
    expect(f"exit code after {number.name}", run.wait(), 1)
    reason = run.reason()
    expect(f"one of {reasons} in `{reason}`", any(each in reason for each in reasons), True)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("deployers left", running(DEPLOYER), [])


@pytest.mark.usefixtures("deployer")
def test_an_attribute_that_stands_still_is_a_collapse(rtf: str, tmp_path: Path) -> None:
    """Without a period, only one of `--alive` is expected to change."""
    (tmp_path / "arm.ops").write_text(ARM + "arm.start()")
    (tmp_path / "wrist.ops").write_text((ARM + "arm.start()").replace("arm", "wrist"))
    first = f"arm.ops --component arm --stall 0.2 --every 0.1 {OWN_NAMES}"
    second = f"wrist.ops --component wrist --alive wrist.Updates --stall 0.4 --every 0.1 {NAMES}"
    run = Run(rtf, suite(tmp_path / "two.xml", first, second, param="20"), tmp_path / "results")
    expect("exit code", run.wait(), 1)
    expect_in("wrist is Running, but its attribute Updates has not changed for 0.", run.reason())


@pytest.mark.usefixtures("deployer")
def test_a_name_service_of_another_fixture_is_monitored(rtf: str, tmp_path: Path) -> None:
    (tmp_path / "arm.ops").write_text(ARM)
    (tmp_path / "wrist.ops").write_text(ARM.replace("arm", "wrist"))
    first = f"arm.ops --component arm --every 60 {OWN_NAMES}"
    second = f"wrist.ops --component wrist --every 0.1 {NAMES}"
    run = Run(rtf, suite(tmp_path / "two.xml", first, second, param="20"), tmp_path / "results")
    run.collapses(lambda: kill(running("omniNames"), signal.SIGSTOP))
    kill(running("omniNames"), signal.SIGCONT)
    expect("exit code", run.wait(), 1)
    reason = r"the name service 127\.0\.0\.1:\d+ does not answer: "
    expect(f"`{reason}` in `{run.reason()}`", bool(re.match(reason, run.reason())), True)


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


@pytest.mark.usefixtures("deployer")
def test_a_deployer_that_does_not_quit_makes_the_run_red(rtf: str, tmp_path: Path) -> None:
    (tmp_path / "arm.ops").write_text('loadComponent("arm", "HangingController")\narm.start()')
    run = Run(rtf, suite(tmp_path / "arm.xml", "arm.ops --grace 0.2"), tmp_path / "results")
    expect("exit code", run.wait(), 1)
    late = "tear-down failed: deployer-gnulinux did not end within 0.2 s of `quit`"
    expect("problems", run.problems(), [f"{late}, and not within 0.2 s of SIGTERM: it was killed"])


def broken(run: Run) -> str:
    """The reason of the failed set-up."""
    return run.reason("fixture-broken")
