"""Serves the runner: one thread reads requests, the main thread carries them out.

The plug-in runs in the main thread, as in any Python program: signals, GUI
toolkits and robot middleware rely on that.
"""

from __future__ import annotations

import faulthandler
import json
import os
import signal
import sys
import threading
from _thread import start_new_thread
from queue import SimpleQueue

from rtf import _exceptions, _session
from rtf._session import RequestState, Session
from rtf._stop import StepEnded
from rtf._task import Task
from rtf.host import channel, shared_host, steps

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rtf._fixture import FixtureManager

PROTOCOL_VERSION = 1

PARSE_ERROR = -32700
INVALID_REQUEST = -32600
METHOD_NOT_FOUND = -32601
INVALID_PARAMS = -32602
VERSION_MISMATCH = -32001

# A plug-in that polls `interrupted()` has this time to end by itself. Then it gets SIGINT,
# as on Ctrl-C, so that its tear-down still runs.
_STOP_GRACE_SECONDS = 0.5

_THREAD_START_SECONDS = 5


class Request:
    """A request of the runner."""

    def __init__(self, message: dict[str, object]) -> None:
        """Read a message with a number and a method."""
        self.number = message["id"]
        self.method = message.get("method")
        params = message.get("params", {})
        self.params: dict[str, object] = params if isinstance(params, dict) else {}
        self.state = RequestState()
        # Held until `conclude`. An event takes longer to create.
        self._answered = threading.Lock()
        self._answered.acquire()

    def conclude(self) -> None:
        """End it: the answer follows."""
        self._answered.release()

    def is_answered_within(self, seconds: float) -> bool:
        """Wait for its answer. Several threads may: one for each request to stop."""
        is_answered = self._answered.acquire(timeout=seconds)
        if is_answered:
            self._answered.release()
        return is_answered


class Reader:
    """Reads the channel, also while a plug-in runs."""

    def __init__(self, line: channel.Channel) -> None:
        """Read `line`; before `start_thread`, on the thread that calls `next`."""
        self._requests: SimpleQueue[Request | None] = SimpleQueue()
        # Without the runner, no process would stop a fixture.
        self.fixture_is_up = False
        self._channel = line
        self._open: list[Request] = []
        self._lock = threading.Lock()
        self._has_thread = False
        self._is_last_answered = False
        self._thread_start = threading.Lock()

    def next(self) -> Request | None:
        """Return the next request; `None` when the runner is gone."""
        while not self._has_thread and self._requests.empty():
            self._receive()
        return self._requests.get()

    def has_next(self) -> bool:
        """Whether another request has arrived."""
        return not self._requests.empty()

    def start_thread(self) -> None:
        """Continue in a thread, which does not keep the process alive.

        It is not a `threading.Thread`: the plug-in does not see it.
        """
        if not self._has_thread:
            self._has_thread = True
            self._thread_start.acquire()
            start_new_thread(self._read, ())

    def wait_for_thread(self) -> None:
        """Wait until the thread runs: an interpreter that ends before that crashes."""
        # With a time limit: a forked child of the plug-in does not have the thread.
        if self._thread_start.acquire(timeout=_THREAD_START_SECONDS):
            self._thread_start.release()

    def finish(self, request: Request, *, fixture_is_up: bool, last: bool = False) -> None:
        """Forget a request before its answer, after which the runner may close the channel.

        With the last one, forget all requests that have not begun or still arrive.
        """
        request.conclude()
        with self._lock:
            self._open.remove(request)
            if last:
                self._open.clear()
                self._is_last_answered = True
            self.fixture_is_up = fixture_is_up

    def _read(self) -> None:
        self._thread_start.release()
        while self._receive():
            pass

    def _receive(self) -> bool:
        """Handle the lines that arrived; whether there may be more."""
        lines = self._channel.receive()
        if lines is not None:
            for line in lines:
                self._handle_line(line)
            return True
        with self._lock:
            if self._open or self.fixture_is_up:
                channel.end_without_runner()
        self._requests.put(None)
        return False

    def _handle_line(self, line: bytes) -> None:
        try:
            message = json.loads(line)
        except ValueError as problem:
            self._channel.refuse(None, PARSE_ERROR, f"not a JSON text: {problem}")
            return
        if isinstance(message, dict) and isinstance(message.get("method"), str):
            self._handle(message)
        else:
            self._channel.refuse(None, INVALID_REQUEST, "not a request")

    def _handle(self, message: dict[str, object]) -> None:
        if message.get("method") == "interrupt":
            params = message.get("params")
            params = params if isinstance(params, dict) else {}
            self._interrupt(str(params.get("reason") or "asked to stop"), params.get("request"))
        elif message.get("method") == "question-closed":
            self._close_question(message.get("params"))
        elif message.get("method") in {"episodes", "end-of-episodes"}:
            self._add_episodes(message.get("params"))
        elif message.get("id") is not None:
            request = Request(message)
            with self._lock:
                if not self._is_last_answered:
                    self._open.append(request)
            self._requests.put(request)

    def _close_question(self, params: object) -> None:
        with self._lock:
            waiting = self._open[:1]
        if isinstance(params, dict) and isinstance(params.get("question"), int):
            answer = params.get("answer")
            problem = str(params.get("problem") or "no answer")
            for request in waiting:
                text = None if answer is None else str(answer)
                request.state.close_question(params["question"], text, problem)

    def _add_episodes(self, params: object) -> None:
        arrived = params.get("episodes") if isinstance(params, dict) else None
        with self._lock:
            waiting = self._open[:1]
        for request in waiting:
            request.state.episodes.put(arrived)

    def _interrupt(self, reason: str, number: object) -> None:
        with self._lock:
            waiting = list(self._open)
        if number is not None:
            # Crossed the answer to that request, if another one is carried out.
            waiting = waiting[:1] if waiting and waiting[0].number == number else []
        for request in waiting:
            request.state.request_stop(reason)
        session = _session.running()
        if session is not None:
            # The plug-in may hang and be killed.
            session.sampling.send()
        if waiting:
            threading.Thread(target=_stop_later, args=(waiting[0],), daemon=True).start()


def _stop_later(request: Request) -> None:
    if not request.is_answered_within(_STOP_GRACE_SECONDS):
        request.state.announce_signal()
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)


class Host:
    """Carries out requests in order."""

    def __init__(self, line: channel.Channel) -> None:
        """Answer on `line`."""
        self._channel = line
        self._is_initialized = False
        self._fixture: FixtureManager | None = None
        self._task: Task | None = None
        self._shared: shared_host.SharedHost | None = None

    def carry_out(self, request: Request, reader: Reader) -> bool:
        """Carry out a request and answer; whether there may be another one."""
        last = False
        try:
            if request.method == "initialize":
                result = self._initialize(request.params)
            elif not self._is_initialized:
                raise _Refused(INVALID_REQUEST, "the first request must be `initialize`")
            else:
                result, last = self._dispatch(request)
        except _Refused as refused:
            reader.finish(request, fixture_is_up=self._fixture is not None)
            self._channel.refuse(request.number, refused.code, refused.text)
            return True
        reader.finish(request, fixture_is_up=self._fixture is not None, last=last)
        # Sent with the announcement of the next test.
        held = "continues" in result and reader.has_next()
        self._channel.answer(request.number, result, held=held)
        return not last

    def _dispatch(self, request: Request) -> tuple[steps.Answer, bool]:
        if request.method == "run-test":
            task = _task(request.params)
            session = self._enter(task, request)
            if not task.end_marker:
                return steps.run_test(session), task.last
            return self._run_shared(session)
        if request.method == "set-up-fixture":
            task = _task(request.params)
            session = self._enter(task, request)
            self._fixture, answer = steps.set_up_fixture(session, self._fixture)
            self._task = task
            return answer, False
        known = {"check-fixture", "test-started", "test-finished", "tear-down-fixture"}
        if request.method not in known:
            raise _Refused(METHOD_NOT_FOUND, f"unknown method `{request.method}`")
        task = self._task or Task({"file": "", "name": ""})
        task.attachments_dir = str(request.params.get("attachments_dir") or "")
        session = self._enter(task, request)
        if request.method == "check-fixture":
            return steps.check_fixture(session, self._fixture), False
        if request.method != "tear-down-fixture":
            method = str(request.method)
            return steps.notify_fixture(session, self._fixture, method, request.params), False
        fixture, self._fixture = self._fixture, None
        return steps.tear_down_fixture(session, fixture), False

    def _run_shared(self, session: Session) -> tuple[steps.Answer, bool]:
        task = session.task
        if self._shared is None and not task.last:
            self._shared = shared_host.SharedHost.begin()
        session.announce("load")
        os.environ.update(task.variables)
        answer = steps.run_test(session)
        outcomes = ("passed", "failed", "skipped") if task.continues_after_failure else ("passed",)
        continues = answer["outcome"] in outcomes and not task.last
        if continues and self._shared is not None and self._shared.end_test(task.end_marker):
            return {**answer, "continues": True}, False
        return answer, True

    def _initialize(self, params: dict[str, object]) -> dict[str, object]:
        if params.get("protocol") != PROTOCOL_VERSION:
            raise _Refused(
                VERSION_MISMATCH,
                f"rtf {params.get('rtf')} speaks version {params.get('protocol')} of the host"
                f" protocol, this host version {PROTOCOL_VERSION}",
            )
        stack_file = params.get("stack_file")
        stack = "none"
        if isinstance(stack_file, str):
            flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC
            stacks = os.open(stack_file, flags, 0o666)
            faulthandler.register(signal.SIGUSR2, file=stacks, all_threads=True)
            stack = "signal"
        self._is_initialized = True
        name = sys.implementation.name.replace("cpython", "python")
        host = f"{name} {'.'.join(map(str, sys.version_info[:3]))}"
        return {
            "protocol": PROTOCOL_VERSION,
            "host": host,
            "stack": stack,
            "supports_shared": True,
            "selects_cases": True,
            "runs_episodes": True,
        }

    def _enter(self, task: Task, request: Request) -> Session:
        if not task.end_marker:
            self._channel.flush()
        session = Session(task, request.state, self._channel)
        _session.enter(session)
        return session


class _Refused(Exception):  # noqa: N818 - the protocol's term
    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text


def _task(params: dict[str, object]) -> Task:
    try:
        return Task(params)
    except TypeError as problem:
        raise _Refused(INVALID_PARAMS, str(problem)) from None


def _report_thread_exception(raised: threading.ExceptHookArgs) -> None:
    """Report an exception that ends a thread of the plug-in as an error."""
    session = _session.running()
    problem = raised.exc_value
    if session is not None and problem is not None and not isinstance(problem, StepEnded):
        _exceptions.report(session, problem)


def prepare() -> None:
    """Prepare the process; forks inherit this from their server."""
    faulthandler.enable()
    signal.signal(signal.SIGINT, steps.stop_by_signal)
    threading.excepthook = _report_thread_exception
    for stream in (sys.stdout, sys.stderr):
        # A crash must not lose printed lines with the buffer.
        stream.reconfigure(line_buffering=True)  # type: ignore[union-attr]


def serve(descriptor: int | None = None) -> int:
    """Serve the runner and return the exit code."""
    try:
        if descriptor is None:
            line = channel.Channel.from_environment()
        else:
            line = channel.Channel(descriptor)
    except (ValueError, OSError) as problem:
        sys.stderr.write(f"error: this is a host, which `rtf` starts by itself: {problem}\n")
        return 2
    reader = Reader(line)
    host = Host(line)
    try:
        while True:
            request = reader.next()
            if request is None:
                return 0
            if request.method != "initialize":
                reader.start_thread()
            if not host.carry_out(request, reader):
                return 0
    finally:
        reader.wait_for_thread()
