#!/usr/bin/env python3
"""Every relative link of the Markdown files below a directory leads to a file in it.

check_links.py DIRECTORY
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from urllib.parse import unquote, urlsplit

LINK = re.compile(r"\]\(([^()\s]+)\)")
CODE = re.compile(r"^```.*?^```$|`[^`\n]*`", re.M | re.S)


def main() -> None:
    """Prints the broken links."""
    top = Path(sys.argv[1]).resolve()
    pages = sorted(top.rglob("*.md"))
    broken = [
        f"{page.relative_to(top)}: {link}" for page in pages for link in broken_links(top, page)
    ]
    if broken or not pages:
        raise SystemExit("\n".join(["these links lead to no file:", *broken]))


def broken_links(top: Path, page: Path) -> list[str]:
    """The links of a page that lead to no file below `top`."""
    links = LINK.findall(CODE.sub("", page.read_text(encoding="utf-8")))
    return [link for link in links if not leads_somewhere(top, page, link)]


def leads_somewhere(top: Path, page: Path, link: str) -> bool:
    """Whether a link leads to a file, or elsewhere on the web."""
    parts = urlsplit(link)
    if parts.scheme or not parts.path:
        return True
    file = (page.parent / unquote(parts.path)).resolve()
    return file.is_relative_to(top) and file.exists()


if __name__ == "__main__":
    main()
