"""Plug-ins of RTF 1.x, and improvements of the predecessor's classes."""

from __future__ import annotations

import json
import os
import shlex
import socket
import subprocess
import tempfile
from email.message import Message
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest
from predecessor_sides import build, journal
from run import expect

HERE = Path(__file__).resolve().parent
REPLACED = "\N{REPLACEMENT CHARACTER}"
# The lines of the program `web`, without their ends.
UPDATE = [
    '"blue"><b> Starting test runner. ',
    '"blue"><b> Test suite a &apos;suite&apos; started... ',
    '"blue"><b> Test case a &quot;quoted&quot; test started... ',
    '"green"><b>[INFO]&nbsp;&nbsp; (a &quot;quoted&quot; test) reports : '
    f"&lt;/script&gt; \\ <br> {REPLACED} é  !.",
    '"red"><b>[FAIL]&nbsp;&nbsp; (a &quot;quoted&quot; test) assertion failed : it fails.',
    '"blue"><b> Test case a &quot;quoted&quot; test failed! ',
    '"blue"><b> Test suite a &apos;suite&apos; failed! ',
    '"blue"><b> Ending test runner. ',
]
VERDICTS = {
    "well": "passed",
    "setup-false": "error",
    "error-if": "error",
    "error": "error",
    "fail-if": "failed",
    "fail": "failed",
    "test-fail-if": "failed",
    "check": "failed",
}


@pytest.fixture(scope="module")
def package(prefix: Path) -> str:
    """The option of CMake that finds the installed rtf."""
    return f"-DCMAKE_PREFIX_PATH={prefix}"


@pytest.fixture(scope="module", params=["by-hand", "cmake"])
def plugins(request: pytest.FixtureRequest, prefix: Path, work: Path, package: str) -> Path:
    """The plug-ins of 1.x, compiled with only the include path changed, or with CMake."""
    if request.param == "by-hand":
        return compiled_by_hand(prefix, work)
    build(HERE / "generation1", work / "generation1", package)
    return work / "generation1"


@pytest.fixture(scope="module")
def programs(work: Path, package: str) -> Path:
    """The programs of the directory `ours`."""
    build(HERE / "ours", work / "ours", package)
    return work / "ours"


def compiled_by_hand(prefix: Path, work: Path) -> Path:
    """Builds the plug-ins of 1.x with only the include path changed."""
    directory = work / "by-hand"
    directory.mkdir()
    compiler = shlex.split(os.environ.get("CXX", "c++"))
    for source in sorted((HERE / "generation1").glob("*.cpp")):
        includes = [f"-I{prefix}/include/rtf1", f"-I{prefix}/include"]
        flags = ["-std=c++11", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-pthread"]
        library = directory / f"{source.stem}.so"
        subprocess.run([*compiler, *flags, *includes, str(source), "-o", str(library)], check=True)
    return directory


def run(prefix: Path, *words: str) -> tuple[int, list[str], list[dict[str, Any]]]:
    """Runs rtf: exit code, verdicts, and the events."""
    with tempfile.TemporaryDirectory() as directory:
        ran = subprocess.run([str(prefix / "bin/rtf"), "run", *words], cwd=directory, check=False)
        file = Path(directory) / "rtf-results/latest/events.jsonl"
        events = [json.loads(line) for line in file.read_text().splitlines()]
        return ran.returncode, journal(Path(directory)), events


def texts(events: list[dict[str, Any]]) -> list[str]:
    """The texts of all messages."""
    return [event["message"]["text"] for event in events if event["type"] == "message"]


@pytest.mark.parametrize("how", VERDICTS)
def test_macros_of_the_first_generation(prefix: Path, plugins: Path, how: str) -> None:
    _, got, events = run(prefix, str(plugins / "EncoderTest.so"), "--param", how)
    assert got == [VERDICTS[how]]
    assert texts(events)[-1] == f"{how} is over"


def test_test_as_in_the_paper(prefix: Path, plugins: Path) -> None:
    code, got, events = run(prefix, str(plugins / "PaperTest.so"), "--param", "--well")
    assert (code, got) == (0, ["passed"])
    assert texts(events)[0] == "PaperTest", "it has the plug-in's name"


def test_fixture_as_in_the_paper(prefix: Path, plugins: Path, tmp_path: Path) -> None:
    suite = tmp_path / "suite.xml"
    suite.write_text(
        f"<suite name='paper'><fixture param='simulator'>{plugins}/PaperRig.so</fixture>"
        f"<test param='--well'>{plugins}/PaperTest.so</test></suite>"
    )
    code, got, events = run(prefix, str(suite))
    assert (code, got) == (0, ["passed"])
    of_fixture = [event for event in events if "fixture" in event.get("source", {})]
    assert texts(of_fixture) == ["simulator is up"], "it reports to its suite"


def test_collapse_that_a_watchdog_thread_reports(
    prefix: Path, plugins: Path, tmp_path: Path
) -> None:
    module, suite = tmp_path / "module", tmp_path / "suite.xml"
    suite.write_text(
        f"<suite name='watched'><fixture param='{module}'>{plugins}/WatchedRig.so</fixture>"
        f"<test param='{module}'>{plugins}/KillerTest.so</test></suite>"
    )
    code, got, events = run(prefix, str(suite))
    assert (code, got) == (1, ["collapsed"])
    reasons = [event["reason"] for event in events if event["type"] == "fixture-collapsed"]
    assert reasons == ["the simulator died"]
    assert texts(events) == ["stopped when asked to"], "the test's own interrupt() was called"


@pytest.mark.parametrize("standard", [11, 14, 17, 20])
@pytest.mark.parametrize("directory", ["robottestingframework", "rtf1"])
def test_headers_have_no_warnings(
    prefix: Path, tmp_path: Path, directory: str, standard: int
) -> None:
    include = prefix / "include"
    others = [f"-I{include}/rtf1"] if directory == "rtf1" else []
    source = tmp_path / f"{directory}.cpp"
    top = include / directory if others else include
    found = sorted((include / directory).rglob("*.h"))
    assert found
    source.write_text("".join(f"#include <{file.relative_to(top)}>\n" for file in found))
    flags = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-std=c++{standard}"]
    compiler = shlex.split(os.environ.get("CXX", "c++"))
    words = [*compiler, *flags, "-fsyntax-only", *others, f"-I{include}", str(source)]
    assert subprocess.run(words, capture_output=True, text=True, check=False).stderr == ""


def get(port: int, path: str, host: str = "127.0.0.1") -> tuple[int, str]:
    """Sends a request to the web listener."""
    status, _, body = answer_to(port, path, host)
    return status, body


def answer_to(port: int, path: str, host: str = "127.0.0.1") -> tuple[int, Message, str]:
    """The status, the head and the body of an answer."""
    connection = HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request("GET", path, headers={"Host": f"{host}:{port}"})
    answer = connection.getresponse()
    return answer.status, answer.headers, answer.read().decode()


def read_once(port: int, request: str) -> str:
    r"""The JSON that a client of 2.x finds.

    It reads 255 bytes, and only once, takes the line with a brace, and strips its `\r`.
    """
    with socket.create_connection(("127.0.0.1", port), 10) as connection:
        connection.sendall(request.encode())
        lines = connection.recv(255).decode().split("\n")
    return next(line for line in lines if line.startswith("{"))[:-1]


def test_web_page(programs: Path) -> None:
    """Valid JSON with any names and messages of tests, and loopback only."""
    program = programs / "web"
    with subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        port = int(process.stdout.readline())
        status, page = get(port, "/")
        expect("the page", (status, page.startswith("<!DOCTYPE html>")), (200, True))
        news = json.loads(get(port, "/events?from=0")[1])
        told = [(event["kind"], event["name"], event["text"]) for event in news["events"]]
        name = 'a "quoted" test'
        expected = [
            ("suite-started", "a 'suite'", ""),
            ("test-started", name, ""),
            ("report", name, f"</script> \\ \n {REPLACED} é \0!"),
            ("failure", name, "it fails"),
            ("test-ended", name, "failed"),
            ("suite-ended", "a 'suite'", "failed"),
        ]
        expect("valid JSON", told, expected)
        rest = json.loads(get(port, f"/events?from={news['next']}")[1])
        expect("only new events", (news["running"], rest["events"]), (False, []))
        for request in ("GET /status HTTP/1.0\r\n\r\n", "GET /status\n\n"):
            state = '{"name":"a \'suite\'","testStatus":[2]}'
            expect(f"{request!r}, read once", read_once(port, request), state)
        for path, origin in (("/status", "*"), ("/update", "*"), ("/events", None), ("/", None)):
            head = answer_to(port, path)[1]
            expect(f"sites that read {path}", head["Access-Control-Allow-Origin"], origin)
        html = get(port, "/update")[1].replace("</b></font>", "").removesuffix("\r\n")
        expect("HTML as in 2.x", html.split("<br> <font color=")[1:], UPDATE)
        expect("another site's page", get(port, "/events", "robot.example")[0], 403)
        expect("no such page", get(port, "/secret")[0], 404)
        with socket.socket() as other:
            refused = other.connect_ex(("127.0.0.2", port)) != 0
        expect("loopback's own address only", refused, True)
        process.communicate(b"\n")
    expect("the program ends", process.returncode, 0)


def test_scripts_in_a_program(programs: Path, tmp_path: Path) -> None:
    """The program uses the runner's hosts."""
    broken = tmp_path / "broken.py"
    broken.write_text("def broken(:\n")
    command = [programs / "scripts", HERE / "ours/Good.lua", HERE / "ours/bad.py", broken]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0
    for words in (
        "refused: error: the plug-in `broken.py` cannot be loaded",
        "environment --robot simulator",
        "Test case Good.lua passed!",
        'the "tool\\tip" is 2 µm off: \U0001f916\n',
        "Test case bad.py failed!",
    ):
        assert words in ran.stdout


def test_test_without_a_name_in_a_program(programs: Path, plugins: Path) -> None:
    loaded = [programs / "loader", plugins / "PaperTest.so"]
    assert subprocess.check_output(loaded, text=True) == "PaperTest\n"
