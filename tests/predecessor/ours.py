"""Checks RTF 1.x plug-ins, and improvements of the predecessor's classes.

ours.py PREFIX WORK: an installed rtf, and a directory to work in.
"""

from __future__ import annotations

import json
import os
import shlex
import socket
import subprocess
import sys
import tempfile
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

from sides import build, journal

HERE = Path(__file__).resolve().parent
REPLACED = "\N{REPLACEMENT CHARACTER}"


def expect(what: str, got: object, expected: object) -> None:
    """One comparison."""
    if got != expected:
        raise SystemExit(f"WRONG  {what}\n  expected {expected}\n  got      {got}")
    print(f"ok     {what}")


def run(prefix: Path, *words: str) -> tuple[int, list[str], list[dict[str, Any]]]:
    """Runs rtf: exit code, verdicts, and the events."""
    with tempfile.TemporaryDirectory() as directory:
        ran = subprocess.run([str(prefix / "bin/rtf"), "run", *words], cwd=directory, check=False)
        file = Path(directory) / "rtf-results/latest/events.jsonl"
        events = [json.loads(line) for line in file.read_text().splitlines()]
        return ran.returncode, journal(Path(directory)), events


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


def first_generation(prefix: Path, plugins: Path) -> None:
    """Checks the macros of 1.x, and a fixture whose watchdog thread reports a collapse."""
    verdicts = {
        "well": "passed",
        "setup-false": "error",
        "error-if": "error",
        "error": "error",
        "fail-if": "failed",
        "fail": "failed",
        "test-fail-if": "failed",
        "check": "failed",
    }
    for how, verdict in verdicts.items():
        _, got, events = run(prefix, str(plugins / "EncoderTest.so"), "--param", how)
        expect(f"EncoderTest {how}", got, [verdict])
        texts = [event["message"]["text"] for event in events if event["type"] == "message"]
        expect(f"EncoderTest {how} is torn down", texts[-1], f"{how} is over")
    code, got, events = run(prefix, str(plugins / "PaperTest.so"), "--param", "--well")
    expect("a test as in the paper", (code, got), (0, ["passed"]))
    texts = [event["message"]["text"] for event in events if event["type"] == "message"]
    expect("it has the plug-in's name", texts[0], "PaperTest")
    with tempfile.TemporaryDirectory() as name:
        suite = Path(name) / "suite.xml"
        suite.write_text(
            f"<suite name='paper'><fixture param='simulator'>{plugins}/PaperRig.so</fixture>"
            f"<test param='--well'>{plugins}/PaperTest.so</test></suite>"
        )
        code, got, events = run(prefix, str(suite))
    expect("a fixture as in the paper", (code, got), (0, ["passed"]))
    said = [
        event for event in events if event["type"] == "message" and "fixture" in event["source"]
    ]
    expect(
        "it reports to its suite", [event["message"]["text"] for event in said], ["simulator is up"]
    )
    with tempfile.TemporaryDirectory() as name:
        module = f"{name}/module"
        suite = Path(name) / "suite.xml"
        suite.write_text(
            f"<suite name='watched'><fixture param='{module}'>{plugins}/WatchedRig.so</fixture>"
            f"<test param='{module}'>{plugins}/KillerTest.so</test></suite>"
        )
        code, got, events = run(prefix, str(suite))
    expect("a collapse that a watchdog thread reports", (code, got), (1, ["collapsed"]))
    reasons = [event["reason"] for event in events if event["type"] == "fixture-collapsed"]
    expect("its reason", reasons, ["the simulator died"])
    texts = [event["message"]["text"] for event in events if event["type"] == "message"]
    expect("the test's own interrupt() was called", texts, ["stopped when asked to"])


def headers(prefix: Path, work: Path) -> None:
    """Compiles every header without warnings in each supported version of C++."""
    include = prefix / "include"
    for directory, others in (("robottestingframework", []), ("rtf1", [f"-I{include}/rtf1"])):
        source = work / f"{directory}.cpp"
        top = include if not others else include / directory
        found = sorted((include / directory).rglob("*.h"))
        source.write_text("".join(f"#include <{file.relative_to(top)}>\n" for file in found))
        for standard in (11, 14, 17, 20):
            flags = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-std=c++{standard}"]
            compiler = shlex.split(os.environ.get("CXX", "c++"))
            words = [*compiler, *flags, "-fsyntax-only", *others, f"-I{include}", str(source)]
            ran = subprocess.run(words, capture_output=True, text=True, check=False)
            expect(f"{len(found)} headers of {directory}, C++{standard}", ran.stderr, "")


def get(port: int, path: str, host: str = "127.0.0.1") -> tuple[int, str]:
    """Sends a request to the web listener."""
    connection = HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request("GET", path, headers={"Host": f"{host}:{port}"})
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


def read_once(port: int, request: str) -> str:
    """The response to a client that reads 255 bytes, and only once."""
    with socket.create_connection(("127.0.0.1", port), 10) as connection:
        connection.sendall(request.encode())
        return connection.recv(255).decode()


def web(program: Path) -> None:
    """Checks for valid JSON with any names and messages of tests, and for loopback only."""
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
            line = read_once(port, request).splitlines()[-1]
            state = {"name": "a 'suite'", "testStatus": [2]}
            expect(f"{request!r}, read once", json.loads(line), state)
        html = json.loads(get(port, "/update")[1])
        expect("HTML in one JSON string", html.count("<br>"), 6)
        expect(
            "a test's message is text",
            ("</script>" in html, "&#34;quoted&#34;" in html),
            (False, True),
        )
        expect("another site's page", get(port, "/events", "robot.example")[0], 403)
        expect("no such page", get(port, "/secret")[0], 404)
        with socket.socket() as other:
            refused = other.connect_ex(("127.0.0.2", port)) != 0
        expect("loopback's own address only", refused, True)
        process.communicate(b"\n")
    expect("the program ends", process.returncode, 0)


def scripts(program: Path, work: Path) -> None:
    """Checks a program that runs scripts with the runner's hosts."""
    broken = work / "broken.py"
    broken.write_text("def broken(:\n")
    files = [str(HERE / "ours/Good.lua"), str(HERE / "ours/bad.py"), str(broken)]
    ran = subprocess.run([program, *files], capture_output=True, text=True, check=False)
    expect("scripts", ran.returncode, 0)
    for words in (
        "refused: error: the plug-in `broken.py` cannot be loaded",
        "environment --robot simulator",
        "Test case Good.lua passed!",
        'the "tool\\tip" is 2 µm off: \U0001f916\n',
        "Test case bad.py failed!",
    ):
        expect(f"scripts: {words!r}", words in ran.stdout, True)


def main() -> None:
    """Runs all checks."""
    prefix, work = (Path(argument).resolve() for argument in sys.argv[1:3])
    headers(prefix, work)
    first_generation(prefix, compiled_by_hand(prefix, work))
    package = f"-DCMAKE_PREFIX_PATH={prefix}"
    build(HERE / "generation1", work / "generation1", package)
    first_generation(prefix, work / "generation1")
    build(HERE / "ours", work / "ours", package)
    web(work / "ours/web")
    scripts(work / "ours/scripts", work)
    loaded = [work / "ours/loader", work / "generation1/PaperTest.so"]
    expect(
        "a test without a name, in a program",
        subprocess.check_output(loaded, text=True),
        "PaperTest\n",
    )


if __name__ == "__main__":
    main()
