"""The metrics and traces of rtf, read by Prometheus and by OpenTelemetry's decoder."""

from __future__ import annotations

import json
import os
import re
import subprocess
import urllib.request
from pathlib import Path

import prometheus_server as prometheus
import pytest
from arm_suite import SPANS, write_suite
from checkout import call, output_of, venv
from web_server import served

HERE = Path(__file__).parent
Values = dict[tuple[str, ...], float]
"""Samples by the name of their metric and the values of their labels."""


def run_suite(rtf: str, directory: Path, *options: str) -> None:
    """Runs a suite with a failing test."""
    write_suite(directory)
    ran = subprocess.run([rtf, "run", "suite.xml", *options], check=False, cwd=directory)
    assert ran.returncode == 1


@pytest.mark.first
def test_trace_is_read_by_the_decoder_of_opentelemetry(debug_rtf: str, tmp_path: Path) -> None:
    decoder = tmp_path / "decoder"
    path = f"{output_of('tools/go.sh')}:{os.environ['PATH']}"
    call("go", "build", "-o", decoder, ".", cwd=HERE, PATH=path, GOTOOLCHAIN="local")
    run_suite(debug_rtf, tmp_path, "--report", "otlp=trace.json")
    read = subprocess.run(
        [decoder, tmp_path / "trace.json"], check=True, stdout=subprocess.PIPE, text=True
    )
    print(read.stdout)
    lines = read.stdout.splitlines()
    assert [line.split(",")[0] for line in lines] == SPANS
    events = re.search(r"(\d+) events", next(line for line in lines if "> Good" in line))
    # Its phases, one measurement and one report.
    assert events and int(events[1]) >= 4


def test_metrics_are_read_by_prometheus(debug_rtf: str, tmp_path: Path) -> None:
    """By its parser, promtool, and a server."""
    programs = Path(output_of("tools/prometheus.sh"))
    run_suite(debug_rtf, tmp_path)
    serve = [debug_rtf, "serve", "--web=127.0.0.1:0", "--web-metrics"]
    with served(serve, tmp_path) as (url, _):
        values = metrics(url + "metrics", programs)
        with prometheus.scraping(programs, url, tmp_path) as server:
            check_scraped(server, values)


def metrics(url: str, programs: Path) -> Values:
    """The values of the run, as Prometheus' parser finds them."""
    with urllib.request.urlopen(url) as answer:
        text = answer.read().decode()
    print(text)
    prometheus.check_text(programs, text)
    reader = [venv("telemetry") / "python", HERE / "read_openmetrics.py"]
    read = subprocess.run(reader, input=text, check=True, stdout=subprocess.PIPE, text=True)
    values = {(name, *labels): value for name, labels, value in json.loads(read.stdout)}
    expected = {
        ("rtf_history_readable",): 1.0,
        ("rtf_runs", "red"): 1.0,
        ("rtf_runs", "green"): 0.0,
        ("rtf_last_run_green",): 0.0,
        ("rtf_last_run_tests", "passed"): 1.0,
        ("rtf_last_run_tests", "failed"): 1.0,
        ("rtf_recent_flaky_tests",): 0.0,
    }
    assert {name: values.get(name) for name in expected} == expected
    assert values[("rtf_last_run_duration_seconds",)] > 0
    return values


def check_scraped(server: str, values: Values) -> None:
    """The server has the values of `/metrics`, of which none changes without a run."""
    scraped = {
        (name, *labels): value
        for name in {name for name, *_ in values}
        for labels, value in prometheus.query(server, name).items()
    }
    assert scraped == values
    # The expression of docs/how-to/history.md.
    assert prometheus.query(server, "rtf_last_run_green == 0")
