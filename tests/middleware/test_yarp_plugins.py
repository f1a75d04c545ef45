"""Runs plug-ins that open ports of YARP, with and without a network that they make.

Most are as for RTF 1.x and 2.x, where a fixture in their process had made the network.
"""

from __future__ import annotations

import fcntl
import functools
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import BUILD, ROOT, call
from observed import observe
from run import Run, expect
from yarp_runs import YarpRuns, quiet_runs

pytestmark = [pytest.mark.middleware("yarp"), pytest.mark.outside_network]
SOURCES = "tests/fixtures/yarp/plugins"


@functools.cache
def plugins() -> Path:
    """Builds the plug-ins, one process at a time, and returns their directory."""
    BUILD.mkdir(exist_ok=True)
    with (BUILD / "yarp-plugins.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        call("tools/plugins.sh", SOURCES)
    return BUILD / SOURCES


@pytest.fixture
def runs(rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[YarpRuns]:
    """Runs of the suites, from which no packet leaves."""
    sdk = ROOT / "sdk/cpp/cmake"
    monkeypatch.setenv("RTF_DIR", str(sdk / "rtf"))
    monkeypatch.setenv("RobotTestingFramework_DIR", str(sdk / "RobotTestingFramework"))
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(plugins()))
    monkeypatch.setenv("VALUES_LIBRARY", str(plugins() / "libvalues.so"))
    with quiet_runs(rtf, ROOT / "tests/fixtures/yarp/suites", tmp_path) as started:
        yield started


@pytest.mark.parametrize(
    ("suite", "tests", "options"),
    [
        pytest.param("separate", 7, (), id="alone"),
        pytest.param("separate", 21, ("--repeat", "3"), id="repeated"),
        pytest.param("shared", 12, (), id="shared"),
    ],
)
def test_plugins_find_a_network(
    runs: YarpRuns, suite: str, tests: int, options: tuple[str, ...]
) -> None:
    run = runs.start(f"ports-{suite}.xml", "run", *options)
    expect("exit code", run.wait(), 0)
    verdicts = [event["verdict"] for event in run.events("test-finished")]
    expect("verdicts", verdicts, ["passed"] * tests)
    own = [test for name, test in observe(run.events()).items() if name.startswith("OwnNetwork")]
    for test in own:
        expect("output", "the network is left: 0" in test.output["stdout"], True)
    expect("tests with a network", len(own), 2 if suite == "shared" else 1)
    runs.nothing_left()


SENT = [f"joint {joint} is sent" for joint in range(5)]


@pytest.mark.usefixtures("data_of_yarp")
def test_a_suite_of_2x_uses_the_name_server_of_the_user(runs: YarpRuns) -> None:
    """In the form of icub-tests: it had a private namespace, without a name server."""
    with runs.name_server():
        run = runs.start("basics.xml")
        expect("exit code", run.wait(), 0)
        checks_pass(run)
        (prepared,) = run.events("suite-prepared")
        private = {each["name"] for each in prepared["variables"]}
        expect("the namespace is private", "YARP_NAMESPACE" in private, False)
    runs.nothing_left()


@pytest.mark.usefixtures("data_of_yarp")
def test_a_suite_of_2x_uses_its_own_name_server(runs: YarpRuns, tmp_path: Path) -> None:
    """The same suite with the fixture `yarpserver`, while the user's server runs."""
    text = (runs.suites / "basics.xml").read_text()
    suite = tmp_path / "basics.xml"
    suite.write_text(text.replace("<fixture ", "<fixture> yarpserver </fixture>\n    <fixture ", 1))
    with runs.name_server():
        run = runs.start(str(suite))
        expect("exit code", run.wait(), 0)
        checks_pass(run)
    runs.nothing_left()


def checks_pass(run: Run) -> None:
    """Each of the five tests has passed and has reported its check as a check."""
    expect("verdicts", run.attempts(), ["passed"] * 5)
    messages = [event["message"] for event in run.events("message")]
    checks = [message["text"] for message in messages if message["kind"] == "check"]
    expect("checks", checks, SENT)
    names = [message["text"] for message in messages if message["kind"] == "report"]
    expect("names", names, [f"test name: Neck {axis}" for axis in ("pitch", "roll", "yaw")])
