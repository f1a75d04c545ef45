#!/usr/bin/env python3
"""Checks the built guide.

    check_guide.py RTF HTML

Every link and anchor within the guide exists. Every page can be reached from the first page in
two clicks; the table of contents counts as part of each page. The guide's search finds every
verb and option of the command line, element and attribute of a suite, event, environment variable
and exit code.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from cli_reference import help_of, verbs

TOP = Path(__file__).resolve().parent.parent
CLICKS = 2
# Pages that are not part of the text: mdBook's table of contents is a separate page.
TABLE_OF_CONTENTS = "toc.html"
NOT_PAGES = {TABLE_OF_CONTENTS, "404.html"}


class Page(HTMLParser):
    """The links and anchors of a page."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(file.read_text())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Notes an element's link and anchor."""
        values = dict(attrs)
        self.anchors.update(
            value for name in ("id", "name") if (value := values.get(name)) is not None
        )
        link = values.get("src" if tag in {"img", "script"} else "href")
        if link and tag != "base":
            self.links.append(link)


def main() -> None:
    """Runs all checks and prints every problem."""
    rtf, html = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    pages = {file: Page(file) for file in sorted(html.rglob("*.html")) if is_page(html, file)}
    problems = [*broken_links(html, pages), *far_pages(html, pages), *lost_terms(rtf, html)]
    print("\n".join(f"error: {problem}" for problem in problems))
    print(f"{len(pages)} pages, {len(problems)} problems")
    sys.exit(1 if problems else 0)


def is_page(html: Path, file: Path) -> bool:
    """Whether mdBook wrote the page: the references in api/ are those of other programs."""
    return file.relative_to(html).parts[0] != "api"


def target(file: Path, link: str) -> tuple[Path, str] | None:
    """The file and the anchor of a link within the guide."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return None
    path = (file.parent / unquote(parts.path)).resolve() if parts.path else file
    return (path / "index.html" if path.is_dir() else path), unquote(parts.fragment)


def broken_links(html: Path, pages: dict[Path, Page]) -> list[str]:
    """Links to missing files or anchors."""
    problems = []
    for file, page in pages.items():
        for link in page.links:
            found = target(file, link)
            if found is None:
                continue
            path, anchor = found
            if not path.is_file():
                problems.append(f"{file.relative_to(html)}: `{link}`: no such file")
            elif anchor and path in pages and anchor not in pages[path].anchors:
                problems.append(f"{file.relative_to(html)}: `{link}`: no such anchor")
    return problems


def far_pages(html: Path, pages: dict[Path, Page]) -> list[str]:
    """Pages that need more than two clicks. The table of contents is on each page."""
    reached = {html / "index.html"}
    for _ in range(CLICKS):
        links = [
            (file, link)
            for start in reached
            for file in (start, html / TABLE_OF_CONTENTS)
            if start in pages
            for link in pages[file].links
        ]
        reached |= {found[0] for file, link in links if (found := target(file, link))}
    far = set(pages) - reached - {html / name for name in NOT_PAGES}
    return [f"{file.relative_to(html)}: more than {CLICKS} clicks away" for file in sorted(far)]


def lost_terms(rtf: Path, html: Path) -> list[str]:
    """Terms that the guide's search does not find."""
    queries = [*commands(rtf), *suite_names(), *events(), *variables(), *exit_codes()]
    script = TOP / "tools" / "search_guide.mjs"
    node = subprocess.run(
        [TOP / "tools" / "node.sh"], capture_output=True, text=True, check=True
    ).stdout.strip()
    ran = subprocess.run(
        [f"{node}/node", script, html],
        input=json.dumps(queries),
        capture_output=True,
        text=True,
        check=False,
    )
    if ran.returncode != 0:
        return [f"{script.name}: {ran.stderr[-500:]}"]
    print(f"the search was asked for {len(queries)} terms")
    return [f"the search does not find `{query}`" for query in json.loads(ran.stdout)]


def commands(rtf: Path) -> list[str]:
    """All verbs and options."""
    found: set[str] = set()
    for words in [(), *verbs(rtf, ())]:
        found.add(" ".join(("rtf", *words)))
        options = re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", help_of(rtf, words), re.M)
        found.update(options)
    return enough("options", sorted(found), 50)


def suite_names() -> list[str]:
    """The elements and attributes of suite files."""
    schema = ET.parse(TOP / "spec" / "suite.xsd")
    namespace = "{http://www.w3.org/2001/XMLSchema}"
    nodes = [*schema.iter(f"{namespace}element"), *schema.iter(f"{namespace}attribute")]
    return enough(
        "suite names", sorted({node.attrib["name"] for node in nodes if "name" in node.attrib}), 40
    )


def events() -> list[str]:
    """The types of events."""
    schema = json.loads((TOP / "schemas" / "event.json").read_text())
    found = {kind["properties"]["type"]["const"] for kind in schema["oneOf"]}
    return enough("events", sorted(found), 20)


def variables() -> list[str]:
    """The environment variables."""
    text = (TOP / "spec" / "environment.md").read_text()
    return enough("variables", sorted(set(re.findall(r"^\| .*?`(RTF_[A-Z_]+)`", text, re.M))), 20)


def exit_codes() -> list[str]:
    """Questions for the constants and the numbers of all exit codes."""
    text = (TOP / "crates" / "rtf-model" / "src" / "exit_code.rs").read_text()
    codes = re.findall(r"pub const (\w+): u8 = (\d+);", text)
    return enough(
        "exit codes", [name for name, _ in codes] + [f"exit code {code}" for _, code in codes], 12
    )


def enough(what: str, found: list[str], least: int) -> list[str]:
    """The terms, which must not be suspiciously few."""
    if len(found) < least:
        raise SystemExit(f"only {len(found)} {what} found: did the format of their source change?")
    return found


if __name__ == "__main__":
    main()
