#!/usr/bin/env python3
"""Checks the metrics and traces of rtf with the readers of others.

    check.py RTF DECODER PROMETHEUS COLLECTOR

Prometheus' parser reads `/metrics` of `rtf serve`, promtool checks it, and a Prometheus server
scrapes it; both programs are in the directory PROMETHEUS. DECODER, built from decode.go with the
decoder of the OpenTelemetry collector, reads the trace of a run, and COLLECTOR gets it. The
interpreter has the packages of tools/requirements-telemetry.txt.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

from prometheus_client.openmetrics.parser import text_string_to_metric_families as parse

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools")]

import collectors  # noqa: E402
import prometheus  # noqa: E402
from check_web_api import served  # noqa: E402

SUITE = """<suite name="arm">
  <fixture type="process" name="simulator"><command>sleep 1000</command></fixture>
  <test type="lua" name="Good">good.lua</test>
  <test type="lua" name="Bad">bad.lua</test>
</suite>
"""

GOOD = """function TestCase.run()
  rtf.measure("lag", 12.5, "ms", nil, 20)
  rtf.report("done")
end
"""

BAD = "function TestCase.run() rtf.measure('lag', 25, 'ms', nil, 20) end\n"

Values = dict[tuple[str, ...], float]
"""Samples by the name of their metric and the values of their labels."""

SPANS = [
    "rtf > rtf run: Error",
    "rtf run > arm: Error",
    "arm > fixture simulator: Ok",
    "arm > Good: Ok",
    "arm > Bad: Error",
]


def main() -> int:
    """Runs a suite, and checks its trace and its metrics."""
    arguments = (str(Path(argument).resolve()) for argument in sys.argv[1:5])
    rtf, decoder, programs, collector = arguments
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in [("suite.xml", SUITE), ("good.lua", GOOD), ("bad.lua", BAD)]:
            (folder / file).write_text(text)
        command = [rtf, "run", "suite.xml", "--report", "otlp=trace.json"]
        run = subprocess.run(command, check=False, cwd=folder, stdout=subprocess.PIPE)
        if run.returncode != 1:
            sys.exit(f"a run with a failing test ended with {run.returncode}")
        check_trace(decoder, folder / "trace.json")
        with served([rtf, "serve", "--web=127.0.0.1:0", "--web-metrics"], folder) as (url, _):
            values = check_metrics(url + "metrics", Path(programs))
            with prometheus.scraping(Path(programs), url, folder) as server:
                check_scraped(server, values)
        collectors.check([rtf, "run", "suite.xml"], folder, collector, SPANS)
    return 0


def check_trace(decoder: str, trace: Path) -> None:
    """Exits unless the collector's decoder finds the spans of the suite."""
    read = subprocess.run([decoder, str(trace)], check=False, stdout=subprocess.PIPE, text=True)
    print(read.stdout, end="")
    found = [line.split(",")[0] for line in read.stdout.splitlines()]
    if read.returncode != 0 or found != SPANS:
        sys.exit(f"expected the spans {SPANS}")
    good = next(line for line in read.stdout.splitlines() if "> Good" in line)
    events = re.search(r"(\d+) events", good)
    # Its phases, one measurement and one report.
    if events is None or int(events.group(1)) < 4:
        sys.exit(f"events are missing: {good}")


def check_metrics(url: str, programs: Path) -> Values:
    """Exits unless Prometheus' parser finds the values of the run; returns them."""
    with urllib.request.urlopen(url) as answer:
        text = answer.read().decode()
    print(text, end="")
    prometheus.check_text(programs, text)
    values = {
        (sample.name, *sample.labels.values()): float(sample.value)
        for family in parse(text)
        for sample in family.samples
    }
    expected = {
        ("rtf_history_readable",): 1.0,
        ("rtf_runs", "red"): 1.0,
        ("rtf_runs", "green"): 0.0,
        ("rtf_last_run_green",): 0.0,
        ("rtf_last_run_tests", "passed"): 1.0,
        ("rtf_last_run_tests", "failed"): 1.0,
        ("rtf_recent_flaky_tests",): 0.0,
    }
    wrong = {name: values.get(name) for name in expected if values.get(name) != expected[name]}
    if wrong:
        sys.exit(f"unexpected values: {wrong}")
    if values[("rtf_last_run_duration_seconds",)] <= 0:
        sys.exit("the run has no duration")
    return values


def check_scraped(server: str, values: Values) -> None:
    """Exits unless the server has the values of `/metrics`, of which none changes without a run."""
    names = {name for name, *_ in values}
    scraped = {
        (name, *labels): value
        for name in names
        for labels, value in prometheus.query(server, name).items()
    }
    if scraped != values:
        differences = set(scraped.items()) ^ set(values.items())
        sys.exit(f"a Prometheus server has other values: {differences}")
    # The expression of docs/how-to/history.md.
    if not prometheus.query(server, "rtf_last_run_green == 0"):
        sys.exit("the alert for a red run finds nothing")
    print(f"prometheus: {len(scraped)} equal values")


if __name__ == "__main__":
    sys.exit(main())
