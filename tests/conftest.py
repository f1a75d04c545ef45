"""What the tests that run the program from outside share: a built rtf and an environment.

A test gets the path of a program as the fixture `rtf` (optimised) or `debug_rtf`, which are built
first, and its environment from the markers in pytest.ini.
"""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import uuid
from collections.abc import Generator

import network
import order
import pytest
from checkout import BUILD, ROOT, STARTED_WITH, TARGET, exports, venv

# Tests of the fixture managers, which import them, run apart: one is named `mcap`, as a library.
collect_ignore_glob = ["fixtures/test_*.py"]
# Tests as users write them, which rtf runs, and workspaces that tests copy.
collect_ignore = [
    "colcon/workspace",
    "ctest/project",
    "frameworks/descendants",
    "frameworks/launch_testing",
    "frameworks/pytest",
    "frameworks/pytest_projects",
    "frameworks/rostest",
    "frameworks/tap",
    "frameworks/unittest",
    "import/workspace",
    "predecessor/project",
]

ALL_TARGETS = ["--bins", "--tests", "--examples"]
BUILDS = {
    "release": ["tools/build.sh"],
    # With the tests, which change features of libraries: nothing is compiled again for them.
    "debug": ["cargo", "build", "--quiet", "--locked", "--workspace", *ALL_TARGETS],
}
RUN = uuid.uuid4().hex


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options of this directory."""
    parser.addoption("--no-build", action="store_true", help="take rtf as it is in target/")


def pytest_configure(config: pytest.Config) -> None:
    """Adds the record of durations."""
    config.pluginmanager.register(order)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item], config: pytest.Config) -> None:
    """Starts what takes longest before the others.

    Tests that share something of their module run in one process, which makes it once.
    """
    for item in (each for each in items if isinstance(each, pytest.Function)):
        definitions = item._fixtureinfo.name2fixturedefs.values()
        if any(each[-1].scope == "module" for each in definitions):
            item.add_marker(pytest.mark.xdist_group(item.nodeid.partition("::")[0]))
    order.longest_first(items, config)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Prints how each failed test is repeated."""
    failed = [each for kind in ("failed", "error") for each in terminalreporter.getreports(kind)]
    # A test that failed while it was set up or torn down may be in both lists.
    for name in dict.fromkeys(each.nodeid.partition("@")[0] for each in failed):
        terminalreporter.write_line(f"failed: tools/test.sh 'tests/{name}'", red=True)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Makes a skipped test fail: it installs what it lacks."""
    report = yield
    if report.skipped:
        report.outcome = "failed"
    return report


@pytest.fixture(scope="session")
def rtf(request: pytest.FixtureRequest) -> str:
    """The optimised program."""
    return built(request.config, "release")


@pytest.fixture(scope="session")
def debug_rtf(request: pytest.FixtureRequest) -> str:
    """The program as `cargo test` makes it."""
    return built(request.config, "debug")


def built(config: pytest.Config, profile: str) -> str:
    """Builds a profile once in each run of the tests, whichever process needs it first."""
    program = TARGET / profile / "rtf"
    if not config.getoption("no_build"):
        run = getattr(config, "workerinput", {}).get("testrunuid", RUN)
        BUILD.mkdir(exist_ok=True)
        with (BUILD / f"test-{profile}.lock").open("a+") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            lock.seek(0)
            if lock.read() != run:
                subprocess.run(BUILDS[profile], cwd=ROOT, check=True)
                lock.truncate(0)
                lock.write(run)
    if not program.is_file():
        pytest.fail(f"{program} is missing: leave `--no-build` out")
    return str(program)


@pytest.fixture(autouse=True)
def _environment(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The environment that the markers of a test ask for."""
    for marker in request.node.iter_markers("venv"):
        monkeypatch.setenv("PATH", f"{venv(*marker.args)}:{os.environ['PATH']}")
    for marker in request.node.iter_markers("middleware"):
        for name, value in exports("tools/middleware.sh", *marker.args).items():
            rest = os.environ["PATH"] if name == "PATH" else ""
            monkeypatch.setenv(name, value + rest)
    # The processes of a test inherit it, see harness/processes.py.
    monkeypatch.setenv("RTF_CHECK", uuid.uuid4().hex)


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Runs a test that counts packets in a process with a separate network."""
    if pyfuncitem.get_closest_marker("outside_network") is None or network.is_inside():
        return None
    options = ["-p", "no:xdist", "--no-build", "-s", "-q"]
    # xdist appends the group of a test.
    name = pyfuncitem.nodeid.partition("@")[0]
    pytest_here = [sys.executable, "-m", "pytest", *options, name]
    root = pyfuncitem.config.rootpath
    # Its markers change the environment again.
    ran = subprocess.run(network.command(pytest_here), cwd=root, env=STARTED_WITH, check=False)
    assert ran.returncode == 0, "the test failed in its network"
    return True
