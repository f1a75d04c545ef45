"""Collectors that get the trace of a run: one of OpenTelemetry, and some that refuse it."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread

import pytest
from arm_suite import SPANS, write_suite
from checkout import output_of
from listening import free_port

CONFIGURATION = """
receivers:
  otlp:
    protocols:
      http:
        endpoint: 127.0.0.1:{port}
exporters:
  debug:
    verbosity: detailed
    use_internal_logger: false
service:
  telemetry:
    metrics:
      level: none
    logs:
      level: warn
  pipelines:
    traces:
      receivers: [otlp]
      exporters: [debug]
"""

SPAN = re.compile(
    r"^ +Parent ID +: (\w*)\n +ID +: (\w+)\n +Name +: (.*)\n(?:.*\n)*? +Status code +: (\w+)$", re.M
)
"""A span as the `debug` exporter prints it: parent, id, name and status."""

PASSWORD, KEY = "pass-word-7", "api-key-8"
HEADERS = f"api-key={KEY}%2C9,x-tenant=robots"
EXPECTED = {
    "authorization": "Basic bWU6cGFzcy13b3JkLTc=",
    "api-key": f"{KEY},9",
    "x-tenant": "robots",
    "content-type": "application/json",
}
"""Headers of a request to an address with the password; `me:pass-word-7` in Base64."""

WAIT_SECS = 120
"""A collector listens within a second; a busy machine needs more."""


@pytest.fixture
def command(debug_rtf: str, tmp_path: Path) -> list[str]:
    """Runs a suite of `tmp_path` with a failing test."""
    write_suite(tmp_path)
    return [debug_rtf, "run", "suite.xml"]


@pytest.mark.first
def test_collector_of_opentelemetry_gets_the_spans(command: list[str], tmp_path: Path) -> None:
    collector = output_of("tests/telemetry/collector/build.sh")
    port = free_port()
    configuration, output = tmp_path / "collector.yaml", tmp_path / "collector.txt"
    configuration.write_text(CONFIGURATION.format(port=port))
    with (
        output.open("wb") as out,
        subprocess.Popen([collector, "--config", f"file:{configuration}"], stdout=out) as server,
    ):
        try:
            wait_until(lambda: is_listening(port), server)
            assert reported(command, tmp_path, f"http://127.0.0.1:{port}").stderr == ""
            wait_until(lambda: len(SPAN.findall(output.read_text())) >= len(SPANS), server)
        finally:
            server.terminate()
    text = output.read_text()
    names = {number: name for _, number, name, _ in SPAN.findall(text)}
    found = [
        f"{names.get(parent, 'rtf')} > {name}: {status}"
        for parent, _, name, status in SPAN.findall(text)
    ]
    assert found == SPANS
    assert "service.name: Str(rtf)" in text


def test_collector_that_rejects_spans(command: list[str], tmp_path: Path) -> None:
    with answering(b'{"partialSuccess":{"rejectedSpans":"2"}}', 200) as (address, requests):
        warned(command, tmp_path, f"http://me:{PASSWORD}@{address}", "it rejected 2 spans")
    assert {name: requests[0].get(name) for name in EXPECTED} == EXPECTED


def test_busy_collector(command: list[str], tmp_path: Path) -> None:
    with answering(b"busy", 503) as (address, _):
        warned(command, tmp_path, f"http://{address}", "it answered with 503 Service Unavailable")


def test_collector_that_does_not_exist(command: list[str], tmp_path: Path) -> None:
    warned(command, tmp_path, f"http://127.0.0.1:{free_port()}", "connection refused")


def test_silent_collector(command: list[str], tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"http://127.0.0.1:{silent.getsockname()[1]}"
        warned(command, tmp_path, address, "no answer within 3 s")


def wait_until(condition: Callable[[], bool], server: subprocess.Popen[bytes]) -> None:
    """Waits for a condition while the collector is active."""
    end = time.monotonic() + WAIT_SECS
    while not condition():
        assert server.poll() is None, "the collector has ended"
        assert time.monotonic() < end, "the collector is not ready"
        time.sleep(0.05)


def is_listening(port: int) -> bool:
    """Whether a server listens."""
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def reported(command: list[str], folder: Path, address: str) -> subprocess.CompletedProcess[str]:
    """The run of a suite with a failing test, whose trace goes to an address."""
    variables = {name: value for name, value in os.environ.items() if "proxy" not in name.lower()}
    run = subprocess.run(
        [*command, "--report", f"otlp={address}"],
        check=False,
        cwd=folder,
        env={**variables, "OTEL_EXPORTER_OTLP_HEADERS": HEADERS},
        capture_output=True,
        text=True,
    )
    print(run.stderr, end="")
    assert run.returncode == 1
    return run


def warned(command: list[str], folder: Path, address: str, reason: str) -> None:
    """The run has one warning with the reason, and no secret is anywhere."""
    run = reported(command, folder, address)
    shown = address.replace(f"me:{PASSWORD}@", "")
    start = f"warning: the trace was not sent to `{shown}/v1/traces`: {reason} ("
    assert run.stderr.startswith(start)
    assert run.stderr.count("\n") == 1
    journal = (folder / "rtf-results" / "latest" / "events.jsonl").read_text()
    for secret in (PASSWORD, KEY):
        assert secret not in run.stderr + run.stdout + journal


@contextmanager
def answering(body: bytes, status: int) -> Iterator[tuple[str, list[dict[str, str]]]]:
    """The address of a server with one answer, and the headers of the requests to it."""
    requests: list[dict[str, str]] = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            requests.append({name.lower(): value for name, value in self.headers.items()})
            self.rfile.read(int(self.headers["Content-Length"]))
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"127.0.0.1:{server.server_port}", requests
        finally:
            server.shutdown()
            thread.join()
