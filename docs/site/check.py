"""Finds what is wrong with a built site: ``/usr/bin/python3 docs/site/check.py HTML``."""

from __future__ import annotations

import re
import sys
import urllib.parse
from collections import defaultdict
from html.parser import HTMLParser
from pathlib import Path

LARGEST = 1_000_000  #: Bytes of a page.
#: Attributes that load what they name.
LOADED = {"img": "src", "script": "src", "iframe": "src", "link": "href", "source": "src", "video": "src",
          "object": "data"}
STYLE_URL = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")
#: What Markdown makes of a list or a table that it did not read as one.
UNREAD = re.compile(r"\n(?:- |\* |\| .*\|)")


class Page(HTMLParser):
    """What a page has and names."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.in_menu: list[str] = []  #: Addresses of the navigation; None of them in pages that mkdocs did not make.
        self.title = ""  #: The name in the menu, and that of the site.
        self.heading = ""
        self.heads: list[list[str]] = []  #: Of tables, the words of each column.
        self.unread: list[str] = []
        self.comments: list[str] = []
        self._open = ""
        self._within = ""  # "h1" or "th"
        self._paragraph = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.anchors.update(values[name] for name in ("id", "name") if name in values)
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
            if "md-nav__link" in values.get("class", "") or "md-nav__link" in self._open:
                self.in_menu.append(values["href"])
        if LOADED.get(tag) in values:
            self.loaded.append(values[LOADED[tag]])
        if "style" in values:
            self._style(values["style"])
        self._open = f"{tag} {values.get('class', '')}"
        if tag == "p":
            self._paragraph = "\n"
        elif tag == "thead":
            self.heads.append([])
        elif tag in ("h1", "th"):
            self._within = tag
            if tag == "th":
                self.heads[-1].append("")

    def handle_data(self, data: str) -> None:
        if re.match(r"h\d ", self._open) and "{#" in data:
            self.unread.append(data.strip()[:60])
        if self._within == "h1":
            self.heading = self.heading + data.strip("¶")
        elif self._within == "th":
            self.heads[-1][-1] += data
        elif self._open.startswith("title "):
            self.title += data
        elif self._open.startswith("style "):
            self._style(data)
        elif self._paragraph:
            self._paragraph += data

    def handle_endtag(self, tag: str) -> None:
        self._open = ""
        if tag == self._within:
            self._within = ""
        if tag == "p":
            if UNREAD.search(self._paragraph[1:]):
                self.unread.append(self._paragraph.strip()[:60])
            self._paragraph = ""

    def handle_comment(self, data: str) -> None:
        self.comments.append(data.strip()[:60])

    def _style(self, text: str) -> None:
        self.loaded += style_urls(text)


def style_urls(text: str) -> list[str]:
    return [found[1] or found[2] for found in STYLE_URL.finditer(text)]


def is_of_the_web(address: str) -> bool:
    return re.match(r"(https?:)?//", address) is not None


def read_pages(site: Path) -> dict[Path, Page]:
    return {path: Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}


def target_of(address: str, page: Path) -> tuple[Path, str]:
    """File and anchor that an address leads to."""
    place, _, anchor = address.partition("#")
    place = urllib.parse.unquote(place.partition("?")[0])
    path = (page.parent / place).resolve() if place else page
    return (path / "index.html" if path.is_dir() else path), urllib.parse.unquote(anchor)


def dead_links(pages: dict[Path, Page], site: Path) -> list[str]:
    faults = []
    for path, page in pages.items():
        for address in dict.fromkeys(page.links + page.loaded):
            if re.match(r"[a-z]+:|//", address) or address in ("", "#"):
                continue
            target, anchor = target_of(address, path)
            if not target.is_relative_to(site) or not target.is_file():
                faults.append(f"{path.relative_to(site)}: nothing is at {address}")
            elif anchor and target in pages and page.in_menu and anchor not in pages[target].anchors:
                faults.append(f"{path.relative_to(site)}: no anchor {address}")
    return faults


def loads_of_the_web(pages: dict[Path, Page], site: Path) -> list[str]:
    loaded = {path: page.loaded for path, page in pages.items()}
    loaded.update({path: style_urls(path.read_text(encoding="utf-8")) for path in site.rglob("*.css")})
    return [f"{path.relative_to(site)}: loads {address}"
            for path, addresses in loaded.items() for address in addresses if is_of_the_web(address)]


def left_out_of_the_menu(pages: dict[Path, Page], site: Path) -> list[str]:
    """Pages that no navigation names; copies of files are reached from the page that links them."""
    named = {target_of(address, path)[0] for path, page in pages.items() for address in page.in_menu}
    return [f"{path.relative_to(site)}: not in the navigation (docs/site/contents.yml)"
            for path, page in pages.items()
            if page.in_menu and path not in named and path.relative_to(site).parts[0] != "files"]


def twice_the_same_title(pages: dict[Path, Page], site: Path) -> list[str]:
    titles = defaultdict(list)
    for path, page in pages.items():
        if page.in_menu:
            titles[page.title].append(str(path.relative_to(site)))
    return [f"{' and '.join(paths)}: the same title, {title}" for title, paths in titles.items() if len(paths) > 1]


def other_name_in_the_menu(pages: dict[Path, Page], site: Path) -> list[str]:
    """A title is the name in the menu and that of the site; the first page has the latter alone."""
    return [f"{path.relative_to(site)}: the heading is {page.heading}, the title {page.title}"
            for path, page in pages.items()
            if page.in_menu and page.heading not in (page.title, page.title.rpartition(" - ")[0])]


def faults(site: Path) -> list[str]:
    """All that is wrong with a site, one sentence each."""
    site = site.resolve()
    pages = read_pages(site)
    large = [f"{path.relative_to(site)}: {path.stat().st_size} bytes, more than {LARGEST}"
             for path in pages if path.stat().st_size >= LARGEST]
    unread = [f"{path.relative_to(site)}: Markdown that is read as text: {text}"
              for path, page in pages.items() if page.in_menu for text in page.unread]
    heads = [f"{path.relative_to(site)}: a table with a column without a heading: {', '.join(head)}"
             for path, page in pages.items() if page.in_menu for head in page.heads if any(head) and not all(head)]
    comments = [f"{path.relative_to(site)}: a comment: {text}"
                for path, page in pages.items() if page.in_menu for text in page.comments]
    return [*dead_links(pages, site), *loads_of_the_web(pages, site), *large, *left_out_of_the_menu(pages, site),
            *twice_the_same_title(pages, site), *other_name_in_the_menu(pages, site), *unread, *heads, *comments]


def summary(site: Path) -> str:
    sizes = [path.stat().st_size for path in site.rglob("*.html")]
    everything = sum(path.stat().st_size for path in site.rglob("*") if path.is_file())
    return f"{len(sizes)} pages, the largest of {max(sizes) / 1e3:.0f} kB, {everything / 1e6:.1f} MB in all"


if __name__ == "__main__":
    found = faults(Path(sys.argv[1]))
    sys.exit("\n".join(found) if found else None)
