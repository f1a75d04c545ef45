"""A Prometheus server that scrapes `/metrics`, and its checks of the text."""

from __future__ import annotations

import json
import subprocess
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from listening import free_port

CONFIGURATION = """
global:
  scrape_interval: 200ms
scrape_configs:
  - job_name: rtf
    static_configs:
      - targets: ["{target}"]
"""

LIMIT_SECS = 120
"""The server starts and scrapes within a second; a busy machine needs more."""


def check_text(programs: Path, text: str) -> None:
    """Fails if promtool finds something wrong with the metrics."""
    command = [str(programs / "promtool"), "check", "metrics"]
    checked = subprocess.run(command, check=False, input=text, text=True, capture_output=True)
    print(checked.stdout + checked.stderr, end="")
    assert checked.returncode == 0


@contextmanager
def scraping(programs: Path, url: str, folder: Path) -> Iterator[str]:
    """The address of a server that scrapes `url`/metrics within the block."""
    configuration = folder / "prometheus.yml"
    target = urllib.parse.urlsplit(url).netloc
    configuration.write_text(CONFIGURATION.format(target=target))
    address = f"127.0.0.1:{free_port()}"
    command = [
        str(programs / "prometheus"),
        f"--config.file={configuration}",
        f"--storage.tsdb.path={folder / 'prometheus'}",
        f"--web.listen-address={address}",
        "--log.level=warn",
    ]
    with subprocess.Popen(command) as server:
        try:
            wait_for_scrape(server, f"http://{address}")
            yield f"http://{address}"
        finally:
            server.terminate()


def wait_for_scrape(server: subprocess.Popen[bytes], address: str) -> None:
    """Waits until the server has scraped."""
    end = time.monotonic() + LIMIT_SECS
    while time.monotonic() < end:
        assert server.poll() is None, f"prometheus ended with {server.returncode}"
        try:
            if query(address, "up").get(()) == 1.0:
                return
        except (urllib.error.URLError, ConnectionError):
            pass
        time.sleep(0.1)
    raise AssertionError(f"prometheus did not scrape within {LIMIT_SECS} s")


def query(address: str, expression: str) -> dict[tuple[str, ...], float]:
    """The current values of an expression, by their labels except those of the target."""
    parameters = urllib.parse.urlencode({"query": expression})
    with urllib.request.urlopen(f"{address}/api/v1/query?{parameters}") as answer:
        results = json.load(answer)["data"]["result"]
    return {labels(found["metric"]): float(found["value"][1]) for found in results}


def labels(metric: dict[str, str]) -> tuple[str, ...]:
    """The values of labels that rtf wrote."""
    return tuple(
        value for name, value in metric.items() if name not in ("__name__", "instance", "job")
    )
