"""Prints, reports and attaches markup that a careless page would execute."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import rtf

DIR = Path(os.environ["PAGE_TEST_DIR"])
SCRIPT = "<script>alert('x')</script><img src=x onerror=alert(1)>"


class Hostile(rtf.TestCase):
    """The page shows all of it as text."""

    def run(self) -> None:
        write(f"{SCRIPT}\n")
        write("\x1b[31mred\x1b[0m \x1b]0;owned\x07 \x1b[2J after\n")
        write("quotes \" ' ` & &amp; \\ nul:\0: right-to-left:\u202egnp.exe emoji:🤖\n")
        write("x" * 1_000_000 + "\n")
        write("the last line\n")
        self.report(SCRIPT)
        self.report("end </script></style><!-- <!--rtf-data--> \u2028 \u2029 ]]> of it")
        self.measure("<b>bold</b>", 1.0, '"unit"')
        page = DIR / "page.html"
        page.write_text(SCRIPT, encoding="utf-8")
        self.attach(page, "<svg onload=alert(1)>.html", "text/html")
        self.fail(f'{SCRIPT} "quoted"')


def write(text: str) -> None:
    """Writes to the pipe without buffering."""
    sys.stdout.write(text)
    sys.stdout.flush()
