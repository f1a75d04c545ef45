"""The runner for unittest."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

from driver import PACKAGE
from session_host import UNITTEST, SessionHost, listed

if TYPE_CHECKING:
    from pathlib import Path

CLASS = "import os, signal, time, unittest\nclass Arm(unittest.TestCase):\n"


def write(directory: Path, text: str) -> None:
    (directory / "test_arm.py").write_text(CLASS + text, encoding="utf-8")


def run(directory: Path, text: str, *more: str, dropped: tuple[str, ...] = ()) -> SessionHost:
    write(directory, text)
    return SessionHost(directory, *UNITTEST, *more, "test_arm.py", dropped=dropped)


def test_tests_are_cases(tmp_path: Path) -> None:
    host = run(
        tmp_path,
        "  def test_a(self): pass\n"
        "  def test_b(self): self.fail('b')\n"
        "  def test_c(self): raise OSError('c')\n"
        "  def test_d(self): self.skipTest('d')\n",
        dropped=("test_arm.Arm.test_a",),
    )
    assert host.planned() == [f"test_arm.Arm.test_{name}" for name in "abcd"]
    assert host.results() == {
        "test_arm.Arm.test_b": "failure",
        "test_arm.Arm.test_c": "error",
        "test_arm.Arm.test_d": "skipped",
    }
    assert host.packets[-1]["method"] == "finished"
    assert host.code == 1


def test_the_exit_code_is_0_without_a_problem(tmp_path: Path) -> None:
    assert run(tmp_path, "  def test_a(self): pass\n").code == 0


def test_compared_numbers_are_reported(tmp_path: Path) -> None:
    host = run(
        tmp_path,
        "  def test_a(self): self.assertEqual([1, 2], [1, 3])\n"
        "  def test_b(self): self.assertAlmostEqual(1.0, 1.25, 1)\n"
        "  def test_c(self): self.assertEqual('a', 'b')\n",
    )
    failures = [message for message in host.of("message") if message["kind"] == "failure"]
    assert [failure.get("comparison") for failure in failures] == [
        {"expected": [1.0, 3.0], "got": [1.0, 2.0], "tolerance": 0.0},
        {"expected": [1.25], "got": [1.0], "tolerance": 0.05},
        None,
    ]


def test_a_forked_process_ends_with_a_signal_as_without_rtf(tmp_path: Path) -> None:
    text = (
        "  def test_a(self):\n"
        "    for _ in range(200):\n"
        "      child = os.fork()\n"
        "      if child == 0:\n"
        "        time.sleep(5)\n"
        "        os._exit(3)\n"
        "      os.kill(child, signal.SIGTERM)\n"
        "      self.assertEqual(os.WTERMSIG(os.waitpid(child, 0)[1]), signal.SIGTERM)\n"
    )
    assert run(tmp_path, text).results() == {"test_arm.Arm.test_a": "passed"}


def test_a_stop_request_reaches_a_test_that_forks(tmp_path: Path) -> None:
    text = (
        "  def tearDown(self): print('torn down', flush=True)\n"
        "  def test_a(self):\n"
        "    own = os.getpid()\n"
        "    if os.fork() == 0:\n"
        "      time.sleep(0.05)\n"
        "      os.kill(own, signal.SIGTERM)\n"
        "      os._exit(0)\n"
        "    end = time.monotonic() + 50\n"
        "    while time.monotonic() < end:\n"
        "      child = os.fork()\n"
        "      if child == 0:\n"
        "        os._exit(0)\n"
        "      os.waitpid(child, 0)\n"
    )
    host = run(tmp_path, text)
    assert "torn down" in host.output
    assert host.of("case-finished") == []


def test_a_stop_request_tears_down(tmp_path: Path) -> None:
    write(
        tmp_path,
        "  def setUp(self): self.addCleanup(open('cleaned', 'w').close)\n"
        "  def tearDown(self): open('parked', 'w').close()\n"
        "  @classmethod\n  def tearDownClass(cls): open('class parked', 'w').close()\n"
        "  def test_a(self):\n    os.kill(os.getpid(), signal.SIGTERM)\n    time.sleep(50)\n"
        "  def test_b(self): pass\n",
    )
    host = SessionHost(tmp_path, *UNITTEST, ".")
    names = ("parked", "cleaned", "class parked")
    assert [name for name in names if (tmp_path / name).exists()] == list(names)
    assert len(host.of("case-started")) == 1
    assert host.of("case-finished") == []


def test_a_custom_suite_keeps_its_class(tmp_path: Path) -> None:
    host = run(
        tmp_path,
        "  def test_a(self): pass\n"
        "  def test_b(self): self.assertTrue(os.path.exists('ran'))\n"
        "class Suite(unittest.TestSuite):\n"
        "  def run(self, result, debug=False):\n"
        "    open('ran', 'w').close()\n    return super().run(result, debug)\n"
        "def load_tests(loader, tests, pattern): return Suite(tests)\n",
        dropped=("test_arm.Arm.test_a",),
    )
    assert host.results() == {"test_arm.Arm.test_b": "passed"}


def test_the_list_contains_problems(tmp_path: Path) -> None:
    write(tmp_path, "  def test_a(self): pass\nprint('hello')\n")
    (tmp_path / "test_bad.py").write_text("import no_such_module\n", encoding="utf-8")
    problem, case, end = listed(tmp_path, *UNITTEST, ".")
    assert "test_bad: ModuleNotFoundError" in problem["problem"]["text"]
    location = {"file": str(tmp_path / "test_arm.py"), "line": 3}
    assert case == {"case": {"name": "test_arm.Arm.test_a", "location": location}}
    assert end == {"finished": True}


def test_without_a_host_it_is_an_ordinary_runner(tmp_path: Path) -> None:
    write(
        tmp_path,
        "  def test_a(self):\n"
        "    import rtf.session\n"
        "    session = rtf.session.current()\n"
        "    assert not session.is_connected()\n"
        "    assert session.measure('speed', 3, 'm/s', high=2) is False\n"
        "    assert session.sample('speed', 1) is True\n"
        "    session.report('text')\n"
        "    assert session.fixture_value('a.b', None) is None\n"
        "    with self.assertRaisesRegex(LookupError, 'a.b'):\n"
        "      session.fixture_value('a.b')\n",
    )
    done = subprocess.run(
        [sys.executable, *UNITTEST, "."],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(PACKAGE)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, "Ran 1 test" in done.stderr) == (0, True), done.stderr
