"""The requests of docs/how-to/web.md: most against a live run, the rest against `rtf serve`.

Each request must succeed. A stream of live events is read for some seconds.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from checkout import ROOT, call
from web_server import served

PAGE = ROOT / "docs/how-to/web.md"
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.M | re.S)

QUICK = "function TestCase.run() rtf.report('done') end\n"
PATIENT = """function TestCase.run()
  print("waiting")
  io.flush()
  rtf.report("waiting")
  rtf.measure("settling time", 0.7, "s")
  rtf.sample("elbow", 0.5, "rad")
  rtf.sleep(1000)
end
"""
# The page stops test 3, skips the rest of suite 0, and then stops the run.
ARM = """<suite name="arm">
  <test type="lua" name="a">quick.lua</test>
  <test type="lua" name="b">quick.lua</test>
  <test type="lua" name="c">quick.lua</test>
  <test type="lua" name="d">patient.lua</test>
  <test type="lua" name="e">patient.lua</test>
</suite>
"""
FAILING = "function TestCase.run() rtf.fail('it is broken') end\n"
HAND = '<suite name="hand"><test type="lua">patient.lua</test></suite>\n'

# Fails for an error of the server. A stream does not end (exit code 28).
CURL = """curl() {
  local status=0
  command curl --fail --silent --show-error --max-time 5 "$@" || status=$?
  [ $status -eq 0 ] || [[ $status -eq 28 && $1 == -N ]]
}
"""
# The page asks for results of test 3.
WAIT = """for i in $(seq 600); do
  ! command curl --silent "$U/latest/tests/3/attempts/1/series" | grep -q elbow || exit 0
  sleep 0.1
done
echo "test 3 does not run" >&2
exit 1
"""


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    """A directory with suites."""
    for file, text in [
        ("quick.lua", QUICK),
        ("patient.lua", PATIENT),
        ("failing.lua", FAILING),
        ("arm.xml", ARM),
        ("hand.xml", HAND),
    ]:
        (tmp_path / file).write_text(text)
    return tmp_path


def test_requests_to_a_run(rtf: str, directory: Path) -> None:
    requests = [line for line in requests_of_the_page() if "/rerun" not in line]
    assert len(requests) >= 10, "was the format of the page changed?"
    # The server stays when its run was stopped.
    live = [rtf, "run", "arm.xml", "hand.xml", "--web=127.0.0.1:0", "--web-linger=5s"]
    with served(live, directory) as (url, token):
        request(directory, url, token, [WAIT, *requests])


def test_requests_to_a_server(rtf: str, directory: Path) -> None:
    requests = [line for line in requests_of_the_page() if "/rerun" in line]
    assert len(requests) == 1, "was the format of the page changed?"
    subprocess.run([rtf, "run", "failing.lua"], cwd=directory, check=False)
    with served([rtf, "serve", "--web=127.0.0.1:0"], directory) as (url, token):
        request(directory, url, token, requests)


def requests_of_the_page() -> list[str]:
    """The lines with requests."""
    blocks = BLOCK.findall(PAGE.read_text())
    return [line for block in blocks for line in block.splitlines() if "curl" in line]


def request(directory: Path, url: str, token: str, lines: list[str]) -> None:
    """Runs the lines in a shell."""
    for line in lines:
        call("bash", "-euc", CURL + line, cwd=directory, U=f"{url}api/v1/runs", TOKEN=token)
