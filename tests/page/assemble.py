#!/usr/bin/env python3
"""Writes one self-contained page from a document: assemble.py DOCUMENT.json PAGE.html

This is what the build and `poise ... --html` do; here for tests of the page alone. Modules are joined to one module
script: lines that import and comments are left out, and so are indentation and the word `export`. No text of a module
may go on in a second line therefore."""

import base64
import html
import json
import pathlib
import re
import sys
import zlib

PAGE = pathlib.Path(__file__).resolve().parents[2] / "app" / "page"


def joined_modules():
    names = (PAGE / "modules.txt").read_text(encoding="utf-8").split()
    lines = []
    for name in names:
        for line in (PAGE / name).read_text(encoding="utf-8").splitlines():
            bare = line.strip()
            if bare and not bare.startswith("//") and not line.startswith("import "):
                lines.append(bare.removeprefix("export "))
    return "\n".join(lines)


def embedded(document):
    """The document as app/present/html.cpp embeds it."""
    return base64.b64encode(zlib.compress(document.encode(), 9)).decode()


def page(document):
    try:
        title = json.loads(document).get("title") or "Poise"
    except (ValueError, AttributeError):
        title = "Poise"
    vendor = PAGE / "vendor" / "uplot"
    parts = {
        "styles": (vendor / "uPlot.min.css").read_text(encoding="utf-8")
        + "\n"
        + (PAGE / "page.css").read_text(encoding="utf-8"),
        "libraries": (vendor / "uPlot.iife.min.js").read_text(encoding="utf-8"),
        "scripts": joined_modules(),
        "document": embedded(document),
        "title": html.escape(title),
    }
    # All at once, so that braces in the document are no placeholders.
    skeleton = (PAGE / "index.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], skeleton)


if __name__ == "__main__":
    source, target = map(pathlib.Path, sys.argv[1:])
    target.write_text(page(source.read_text(encoding="utf-8")), encoding="utf-8")
