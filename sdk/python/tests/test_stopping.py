"""Requests to stop, hangs, crashes and a runner that is gone."""

from __future__ import annotations

import os
import signal
import socket
import time
from contextlib import suppress
from pathlib import Path

import pytest
from driver import Host, arm, plugin

TEAR_DOWN = "    def tearDown(self):\n        self.sleep(0.01)\n        self.report('torn down')\n"


@pytest.mark.parametrize(
    "waiting",
    [
        "self.sleep(1000)",
        "self.wait_until(lambda: False, 1000, 'the end of days')",
        "self.ask('Does it end?', timeout=1000)",
        "import time; time.sleep(1000)",
        "while not self.interrupted(): pass",
        "import threading; threading.Event().wait()",
        "import subprocess; subprocess.run(['sleep', '1000'])",
        "while True: pass",
    ],
)
def test_a_request_to_stop_unwinds_the_plugin_and_tears_it_down(
    tmp_path: Path, waiting: str
) -> None:
    host = Host(tmp_path)
    body = arm(f"self.report('going')\n{waiting}", TEAR_DOWN)
    host.send("run-test", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    host.send("interrupt", {"reason": "the simulator collapsed"})
    assert host.answer()["result"] == {
        "outcome": "interrupted",
        "reason": "the simulator collapsed",
    }
    assert host.texts() == [("report", "going"), ("report", "torn down")]
    assert host.end()[0] == 0


def test_a_failure_before_the_request_to_stop_decides(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = arm("self.check(False, 'reached')\nself.sleep(1000)")
    host.send("run-test", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    host.send("interrupt", {"reason": "Ctrl-C"})
    assert host.answer()["result"] == {"outcome": "failed"}


def test_a_request_to_stop_that_comes_before_the_test_is_loaded_is_not_lost(
    tmp_path: Path,
) -> None:
    host = Host(tmp_path)
    sleeping = "    def setup(self, args):\n        self.sleep(1000)\n"
    host.send(
        "run-test", plugin(tmp_path, "import time\ntime.sleep(0.2)\n" + arm("pass", sleeping)), 2
    )
    host.send("interrupt", {"reason": "Ctrl-C"})
    assert host.answer()["result"]["outcome"] == "interrupted"
    assert "run" not in [phase["phase"] for phase in host.of("phase")]


def test_a_request_to_stop_while_nothing_runs_is_forgotten(tmp_path: Path) -> None:
    host = Host(tmp_path)
    host.send("interrupt", {"reason": "too early"})
    assert host.ask("run-test", plugin(tmp_path, arm("self.sleep(0)")))["result"] == {
        "outcome": "passed"
    }


def test_the_stack_of_a_hang_that_holds_the_interpreter_lock_is_dumped(tmp_path: Path) -> None:
    stack_file = tmp_path / "stack"
    host = Host(tmp_path, stack_file)
    assert host.initialized["result"]["stack"] == "signal"
    # No line of Python runs any more: only a signal handler written in C can help.
    # A mutex that is locked twice is waited for also after a signal.
    lock = "libc.pthread_mutex_lock(mutex)"
    body = (
        "import ctypes\nlibc = ctypes.PyDLL(None)\nmutex = ctypes.create_string_buffer(64)\n"
        + arm(f"{lock}\nself.report('hanging')\n{lock}")
    )
    host.send("run-test", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    end = time.monotonic() + 30
    while "plugin.py" not in stack_file.read_text() and time.monotonic() < end:
        host.process.send_signal(signal.SIGUSR2)
        os.sched_yield()
    assert "plugin.py" in stack_file.read_text()
    host.process.kill()
    assert host.end()[0] == -signal.SIGKILL


@pytest.mark.parametrize(
    ("death", "number"),
    [("import ctypes; ctypes.string_at(0)", signal.SIGSEGV), ("os.abort()", signal.SIGABRT)],
)
def test_a_crash_is_a_crash_and_nothing_before_it_is_lost(
    tmp_path: Path, death: str, number: signal.Signals
) -> None:
    host = Host(tmp_path)
    body = "import os\n" + arm(f"print('printed')\nself.report('told')\n{death}")
    host.send("run-test", plugin(tmp_path, body), number=2)
    code, output, errors = host.end()
    assert code == -number
    assert output == "printed\n"
    assert host.texts() == [("report", "told")]
    assert "Fatal Python error" in errors
    assert "plugin.py" in errors


def test_the_host_ends_with_its_runner_while_a_test_runs(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = arm("self.report('going')\nwhile True: pass", TEAR_DOWN)
    host.send("run-test", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    host.channel.shutdown(1)
    assert host.end()[0] == 1
    assert host.texts() == [("report", "going")]


def test_an_idle_host_ends_in_the_ordinary_way_with_the_channel(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = "import atexit\natexit.register(print, 'bye')\n" + arm("pass")
    host.ask("run-test", {**plugin(tmp_path, body), "is_last": False})
    host.channel.shutdown(1)
    assert host.end()[:2] == (0, "bye\n")


def test_children_have_neither_the_channel_nor_its_name(tmp_path: Path) -> None:
    body = arm(
        "import os, subprocess\n"
        "links = subprocess.run(['ls', '-l', '/proc/self/fd'], stdout=subprocess.PIPE,\n"
        "                       close_fds=False, text=True).stdout\n"
        "self.check('socket' not in links, links)\n"
        "self.check('RTF_CHANNEL' not in os.environ, 'no name')\n"
        "printed = subprocess.run('echo $RTF_CHANNEL', shell=True, stdout=subprocess.PIPE)\n"
        "self.check(printed.stdout == b'\\n', 'no name in a child')"
    )
    host = Host(tmp_path)
    assert host.ask("run-test", plugin(tmp_path, body))["result"] == {"outcome": "passed"}


def test_a_forked_child_that_comes_back_does_not_answer(tmp_path: Path) -> None:
    body = arm("import os\nchild = os.fork()\nif child: os.waitpid(child, 0)")
    host = Host(tmp_path)
    host.send("run-test", plugin(tmp_path, body), number=2)
    assert host.end()[0] == 0
    assert [message["id"] for message in host.seen if "id" in message] == [1, 2]


def test_a_request_that_comes_after_the_last_answer_is_not_missed(tmp_path: Path) -> None:
    """A test that fails ends its host, which may have been asked for the next one just then."""
    for _ in range(8):
        host = Host(tmp_path)
        params = {
            **plugin(tmp_path, arm("self.fail('no')")),
            "is_last": False,
            "end_marker": "\0mark\n",
        }
        host.send("run-test", params, number=2)
        host.wait_for("message")
        with suppress(OSError):  # it has ended already
            host.send("run-test", params, number=3)
        host.answer()
        with suppress(OSError):
            host.channel.shutdown(socket.SHUT_RDWR)
        assert host.end()[0] == 0


def test_two_requests_to_stop_a_test_do_not_disturb_the_next_one(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = "import time\n" + arm("self.report('going')\nself.sleep(1000)")
    body += "    def tearDown(self):\n        time.sleep(0.2)\n"
    host.send("run-test", {**plugin(tmp_path, body), "is_last": False}, number=2)
    host.wait_for("message")
    for _ in range(2):
        host.send("interrupt", {"reason": "Ctrl-C", "request": 2})
    assert host.answer()["result"]["outcome"] == "interrupted"
    # Longer than the time after which a test that does not end by itself gets SIGINT.
    later = plugin(tmp_path, arm("import time\ntime.sleep(1)"), "later.py")
    assert host.ask("run-test", later)["result"] == {"outcome": "passed"}
