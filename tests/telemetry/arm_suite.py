"""A suite with a failing test, and the spans of its trace."""

from __future__ import annotations

from pathlib import Path

FILES = {
    "suite.xml": """<suite name="arm">
  <fixture type="process" name="simulator"><command>sleep 1000</command></fixture>
  <test type="lua" name="Good">good.lua</test>
  <test type="lua" name="Bad">bad.lua</test>
</suite>
""",
    "good.lua": """function TestCase.run()
  rtf.measure("lag", 12.5, "ms", nil, 20)
  rtf.report("done")
end
""",
    "bad.lua": "function TestCase.run() rtf.measure('lag', 25, 'ms', nil, 20) end\n",
}
SPANS = [
    "rtf > rtf run: Error",
    "rtf run > arm: Error",
    "arm > fixture simulator: Ok",
    "arm > Good: Ok",
    "arm > Bad: Error",
]


def write_suite(directory: Path) -> None:
    """Writes the suite and its plug-ins."""
    for file, text in FILES.items():
        (directory / file).write_text(text)
