"""Runs plug-ins that open ports of YARP, with and without a network that they make.

Most are as for RTF 1.x and 2.x, where a fixture in their process had made the network.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import BUILD, ROOT, call
from observed import observe
from run import expect
from yarp_runs import YarpRuns, quiet_runs

pytestmark = [pytest.mark.middleware("yarp"), pytest.mark.outside_network]
SOURCES = "tests/fixtures/yarp/plugins"


@functools.cache
def plugins() -> Path:
    """Builds the plug-ins, and returns their directory."""
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
