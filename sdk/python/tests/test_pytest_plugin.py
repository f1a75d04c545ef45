"""The pytest plug-in, with real runs of pytest."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

from driver import PACKAGE
from session_host import PYTEST, SessionHost, listed

from rtf.frameworks.pytest_worker import Selection

if TYPE_CHECKING:
    from pathlib import Path


def write(directory: Path, text: str, name: str = "test_arm.py") -> None:
    (directory / name).write_text("import os, pytest, signal\n" + text, encoding="utf-8")


def run(directory: Path, text: str, *more: str, dropped: tuple[str, ...] = ()) -> SessionHost:
    write(directory, text)
    return SessionHost(directory, *PYTEST, *more, ".", dropped=dropped)


def test_cases_are_planned_started_and_finished_in_order(tmp_path: Path) -> None:
    host = run(tmp_path, "def test_a(): pass\ndef test_b(): pass\n")
    assert [packet["method"] for packet in host.packets] == [
        "cases-planned",
        *["case-started", "case-finished"] * 2,
        "finished",
    ]
    assert host.planned() == ["test_arm.py::test_a", "test_arm.py::test_b"]
    location = {"file": str(tmp_path / "test_arm.py"), "line": 2}
    assert host.of("case-started")[0] == {"name": "test_arm.py::test_a", "location": location}
    assert host.code == 0


def test_items_that_the_host_does_not_want_are_deselected(tmp_path: Path) -> None:
    dropped = ("test_arm.py::test_a",)
    host = run(tmp_path, "def test_a(): 1 / 0\ndef test_b(): pass\n", dropped=dropped)
    assert host.results() == {"test_arm.py::test_b": "passed"}
    assert "1 deselected" in host.output


def test_many_long_names_are_planned_in_portions(tmp_path: Path) -> None:
    text = (
        "@pytest.mark.parametrize('n', range(3000), ids=lambda n: f'{n:0100}')\n"
        "def test_a(n): pass\n"
    )
    names = [f"test_arm.py::test_a[{n:0100}]" for n in range(3000)]
    host = run(tmp_path, text, dropped=tuple(names[:-2]))
    assert len(host.of("cases-planned")) > 1
    assert host.planned() == names
    assert list(host.results()) == names[-2:]


def test_a_long_failure_is_sent_in_parts(tmp_path: Path) -> None:
    text = "def test_a():\n    pytest.fail('\\n'.join(f'line {n} é' for n in range(9000)))\n"
    host = run(tmp_path, text)
    texts = [message["text"] for message in host.of("message") if message["kind"] == "failure"]
    assert len(texts) > 1
    assert "".join(texts) == "Failed: " + "\n".join(f"line {n} é" for n in range(9000))


def test_a_comparison_belongs_to_the_assertion_that_failed(tmp_path: Path) -> None:
    text = (
        "def test_a():\n"
        "    try:\n        assert 1 == 2\n    except AssertionError:\n        pass\n"
        "    assert False\n"
        "def test_b(): assert [1.5, 2] == pytest.approx([1.5, 3])\n"
        "def test_c(): assert 'a' == 'b'\n"
        "def test_d(): assert 7 == 8, 'text'\n"
        "def test_e(): assert True == 8\n"
    )
    host = run(tmp_path, text)
    failures = [message for message in host.of("message") if message["kind"] == "failure"]
    assert [failure.get("comparison") for failure in failures] == [
        None,
        None,
        None,
        {"expected": [8.0], "got": [7.0], "tolerance": 0.0},
        None,
    ]


def test_a_process_that_a_test_forks_reports_without_waiting(tmp_path: Path) -> None:
    text = (
        "def test_a(rtf):\n"
        "    pid = os.fork()\n"
        "    if pid == 0:\n"
        "        code = 1\n"
        "        try:\n            code = int(not rtf.measure('speed', 1))\n"
        "        finally:\n            os._exit(code)\n"
        "    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0\n"
    )
    host = run(tmp_path, text)
    assert host.results() == {"test_arm.py::test_a": "passed"}
    assert [params["name"] for params in host.of("measured")] == ["speed"]
    answered = [packet for packet in host.packets if packet["method"] == "measured"]
    assert [packet["answer"] for packet in answered] == [False]


def test_samples_arrive_in_their_case(tmp_path: Path) -> None:
    text = (
        "def test_a(rtf):\n    for n in range(300): rtf.sample('x', n, 'm', at=n)\n"
        "def test_b(rtf): rtf.sample('x', float('nan'), 'm')\n"
    )
    host = run(tmp_path, text)
    methods = [packet["method"] for packet in host.packets[1:-1]]
    assert methods[0] == "case-started"
    assert methods[-3:] == ["case-started", "sampled", "case-finished"]
    points = [point for batch in host.of("sampled") for point in batch["points"]]
    assert len(points) == 301
    assert points[:2] == [[0, 0.0], [1, 1.0]]
    assert points[300][1] is None


def test_values_of_fixtures_are_read(tmp_path: Path) -> None:
    text = (
        "def test_a(rtf):\n"
        "    assert rtf.fixture_value('simulator.port') == 40123\n"
        "    with pytest.raises(LookupError, match='there are: simulator.port'):\n"
        "        rtf.fixture_value('other')\n"
    )
    assert run(tmp_path, text).results() == {"test_arm.py::test_a": "passed"}


def test_a_stop_request_tears_down(tmp_path: Path) -> None:
    write(
        tmp_path,
        "import time\n"
        "@pytest.fixture\ndef arm():\n    yield\n    open('parked', 'w').close()\n"
        "def test_a(arm):\n    os.kill(os.getpid(), signal.SIGTERM)\n    time.sleep(50)\n"
        "def test_b(arm): pass\n",
    )
    host = SessionHost(tmp_path, *PYTEST, ".")
    assert (tmp_path / "parked").exists()
    assert host.of("case-finished") == []
    assert host.packets[-1]["method"] == "finished"


def test_a_handler_of_the_user_gets_the_stop_request(tmp_path: Path) -> None:
    text = "signal.signal(signal.SIGTERM, lambda *_: None)\n"
    write(tmp_path, text + "def test_a(): os.kill(os.getpid(), signal.SIGTERM)\n")
    host = SessionHost(tmp_path, *PYTEST, ".")
    assert host.results() == {"test_arm.py::test_a": "passed"}


def test_exit_ends_the_open_case(tmp_path: Path) -> None:
    host = run(tmp_path, "def test_a(): pytest.exit('no power')\ndef test_b(): pass\n")
    (finished,) = host.of("case-finished")
    assert finished["outcome"] == "error"
    assert "no power" in finished["reason"]


def test_stacks_are_written_on_a_signal(tmp_path: Path) -> None:
    text = "import time\ndef test_a():\n    os.kill(os.getpid(), signal.SIGUSR2)\n"
    host = run(tmp_path, text)
    assert host.results() == {"test_arm.py::test_a": "passed"}
    assert "in test_a" in host.stack_file.read_text(encoding="utf-8")


def test_an_internal_error_is_reported(tmp_path: Path) -> None:
    hook = "def pytest_runtest_logfinish():\n    raise OSError('broken plug-in')\n"
    write(tmp_path, hook, "conftest.py")
    host = run(tmp_path, "def test_a(): pass\n")
    errors = [message["text"] for message in host.of("message") if message["kind"] == "error"]
    assert any("broken plug-in" in text for text in errors)


def test_children_do_not_inherit_the_session(tmp_path: Path) -> None:
    write(tmp_path, "assert 'RTF_SESSION' not in os.environ\n", "conftest.py")
    assert run(tmp_path, "def test_a(): pass\n").code == 0


def test_a_program_without_the_descriptor_of_the_session_reports_nothing() -> None:
    deed = "import rtf.session; assert rtf.session.current().measure('speed', 1.0, high=2.0)"
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "RTF_SESSION": "fd:99"}
    done = subprocess.run(
        [sys.executable, "-c", deed],
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    assert done.stderr == (
        "rtf: the descriptor in RTF_SESSION is not open here: "
        "results of this process are not reported\n"
    )
    assert done.returncode == 0


def test_collection_errors_are_reported(tmp_path: Path) -> None:
    host = run(tmp_path, "import no_such_module\n")
    error, long = host.of("message")
    assert error["kind"] == "error"
    assert "No module named 'no_such_module'" in error["text"]
    assert "import no_such_module" in long["text"]
    assert host.code == 2


def test_the_list_is_complete_although_modules_print(tmp_path: Path) -> None:
    write(
        tmp_path,
        "print('hello')\nos.write(1, b'hello')\n"
        "@pytest.mark.slow\n@pytest.mark.parametrize('n', [1])\ndef test_a(n): pass\n",
    )
    lines = listed(tmp_path, *PYTEST, "--collect-only", "-qq", ".")
    location = {"file": str(tmp_path / "test_arm.py"), "line": 4}
    case = {
        "name": "test_arm.py::test_a[1]",
        "location": location,
        "tags": ["slow"],
        "parameters": [{"name": "n", "value": "1"}],
    }
    assert lines == [{"case": case}, {"finished": True}]


def test_problems_are_listed(tmp_path: Path) -> None:
    write(tmp_path, "import no_such_module\n")
    write(tmp_path, "pytest.skip('no arm', allow_module_level=True)\n", "test_skipped.py")
    problem, skipped, end = listed(tmp_path, *PYTEST, "--collect-only", "-qq", ".")
    assert "cannot be collected: ModuleNotFoundError" in problem["problem"]["text"]
    assert (skipped, end) == ({"case": {"name": "test_skipped.py"}}, {"finished": True})


def test_the_fixture_can_be_installed_in_addition(tmp_path: Path) -> None:
    host = run(
        tmp_path, "def test_a(rtf): rtf.measure('x', 1)\n", "-p", "rtf.frameworks.pytest_fixture"
    )
    assert host.results() == {"test_arm.py::test_a": "passed"}
    assert host.of("measured")[0]["value"] == 1


def test_a_fixture_of_the_user_has_precedence(tmp_path: Path) -> None:
    write(tmp_path, "@pytest.fixture\ndef rtf(): return 7\n", "conftest.py")
    host = run(tmp_path, "def test_a(rtf): assert rtf == 7\n")
    assert host.results() == {"test_arm.py::test_a": "passed"}


def test_doctests_are_cases(tmp_path: Path) -> None:
    text = "def increment(n):\n    '''\n    >>> 1 + 1\n    3\n    '''\n"
    host = run(tmp_path, text, "--doctest-modules")
    assert host.results() == {"test_arm.py::test_arm.increment": "failure"}
    (failure,) = [message for message in host.of("message") if message["kind"] == "failure"]
    assert "Expected:\n    3\nGot:\n    2" in failure["text"]


def test_a_failure_with_another_outcome_is_that_of_an_attempt(tmp_path: Path) -> None:
    hook = (
        "@pytest.hookimpl(hookwrapper=True)\n"
        "def pytest_runtest_makereport(item, call):\n"
        "    report = (yield).get_result()\n"
        "    if report.failed: report.outcome = 'rerun'\n"
    )
    write(tmp_path, hook, "conftest.py")
    host = run(tmp_path, "def test_a(): assert 1 == 2\n")
    assert [message["kind"] for message in host.of("message")] == ["failure", "report"]
    (finished,) = host.of("case-finished")
    assert finished["rerun"] is True


def test_workers_select_what_the_runner_selects() -> None:
    names = ("tests/a.py::x", "tests/a.py::y[1/2]", "tests2/a.py::x", "b.py::z")

    def selected(*wanted: dict[str, str], finished: tuple[str, ...] = ()) -> list[str]:
        selection = Selection({"wanted": list(wanted), "finished": finished})
        return [name for name in names if selection.includes(name)]

    assert selected() == list(names)
    assert selected(finished=names[:3]) == ["b.py::z"]
    assert selected({"equals": "tests"}) == ["tests/a.py::x", "tests/a.py::y[1/2]"]
    assert selected({"equals": "tests/a.py::x"}, finished=names[:1]) == []
    assert selected({"equals": "b.py::z/subtest"}) == ["b.py::z"]
    assert selected({"contains": "a.py::x"}, {"equals": "b.py::z"}) == [*names[::2], "b.py::z"]
