"""Builds the site of Poise: ``/usr/bin/python3 docs/site/build.py BUILD`` writes BUILD/site/html.

BUILD is a build folder with the program and the Python module. ``--quick`` leaves out the parts that need them.
"""

from __future__ import annotations

import argparse
import html
import importlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml

import check
from stage import HERE, SOURCE, DeadLinks, Stage

KATEX = Path("/usr/share/javascript/katex")
FORMULA = re.compile(r'<(span|div) class="arithmatex">\s*\\([(\[])(.*?)\\[)\]]\s*</\1>', re.DOTALL)


def navigation(entries: list[Any], pages: Path, build: Path, quick: bool) -> list[Any]:
    """The navigation, with the pages of the parts, which are written here."""
    result: list[Any] = []
    for entry in entries:
        if isinstance(entry, dict) and "part" in entry:
            if not quick:
                written = importlib.import_module(entry["part"]).write_pages(pages, build)
                result += written if isinstance(written, list) else [written]
        elif isinstance(entry, dict):
            result += [{title: navigation(inner, pages, build, quick) if isinstance(inner, list) else inner}
                       for title, inner in entry.items()]
        else:
            result.append(entry)
    return result


def run_mkdocs(site: Path, nav: list[Any]) -> None:
    here = SOURCE / HERE
    config = {"INHERIT": str(here / "mkdocs.yml"), "docs_dir": str(site / "pages"), "site_dir": str(site / "html"),
              "theme": {"custom_dir": str(here / "theme")}, "hooks": [str(here / "short_menu.py")], "nav": nav}
    (site / "mkdocs.yml").write_text(json.dumps(config), encoding="utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(site / "mkdocs.yml")]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("mkdocs:\n" + "\n".join(re.findall(r".*(?:WARNING|ERROR|Error).*", done.stderr)))
    # It would work at the root of a server only.
    (site / "html/404.html").unlink()


def render_formulas(site: Path) -> None:
    """Formulas become HTML that needs no script, only the style and the fonts of KaTeX."""
    pages = {path: path.read_text(encoding="utf-8") for path in sorted(site.rglob("*.html"))}
    pages = {path: text for path, text in pages.items() if FORMULA.search(text)}
    formulas = [{"tex": html.unescape(found[3]), "display": found[2] == "["}
                for text in pages.values() for found in FORMULA.finditer(text)]
    if not formulas:
        return
    done = subprocess.run(["node", SOURCE / HERE / "formulas.js", KATEX / "katex.js"], input=json.dumps(formulas),
                          capture_output=True, text=True, encoding="utf-8")
    if done.returncode != 0:
        sys.exit(f"KaTeX does not read a formula:\n{done.stderr}")
    rendered = iter(json.loads(done.stdout))
    style = (KATEX / "katex.min.css").read_text(encoding="utf-8")
    target = site / "assets/katex"
    (target / "fonts").mkdir(parents=True)
    # Every browser of today reads the smallest format.
    style = re.sub(r",url\([^)]*\.(?:woff|ttf)\) format\('\w+'\)", "", style)
    (target / "katex.css").write_text(style, encoding="utf-8")
    for font in KATEX.glob("fonts/*.woff2"):
        shutil.copy(font, target / "fonts")
    for path, text in pages.items():
        text = FORMULA.sub(lambda found: f'<{found[1]} class="arithmatex">{next(rendered)}</{found[1]}>', text)
        link = f'<link rel="stylesheet" href="{os.path.relpath(target / "katex.css", path.parent)}">'
        path.write_text(text.replace("</head>", f"{link}</head>", 1), encoding="utf-8")


def finish_search(site: Path, wishes: dict[str, dict[str, Any]], quick: bool) -> None:
    """The search knows words and weights of pages, leaves out copies of files, and is ready for theme/search.js."""
    file = site / "search/search_index.json"
    index = json.loads(file.read_text(encoding="utf-8"))
    index["docs"] = [entry for entry in index["docs"] if not entry["location"].startswith("files/")]
    places = {entry["location"]: entry for entry in index["docs"]}
    for page, words in wishes["words"].items():
        if page in places or not quick:  # the quick form lacks pages of parts
            places[page]["tags"] = words
    for place, entry in places.items():
        entry["boost"] = next((weight for name, weight in wishes["weights"].items() if place.startswith(name)), 1)
    text = json.dumps(index, separators=(",", ":"))
    file.write_text(text, encoding="utf-8")
    file.with_suffix(".js").write_text(f"giveSearchIndex({text});\n", encoding="utf-8")
    worker, = site.glob("assets/javascripts/workers/search.*.js")
    # The theme's worker knows no weights yet; lunr in it does.
    code = worker.read_text(encoding="utf-8")
    assert code.count("this.add(s)") == 1, f"{worker} adds pages in another way"
    code = code.replace("this.add(s)", "this.add(s,{boost:s.boost})")
    worker.write_text(code, encoding="utf-8")
    script = site / "assets/search.js"
    script.write_text(script.read_text(encoding="utf-8").replace("WORKER_TEXT", json.dumps(code)), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path)
    parser.add_argument("--quick", action="store_true", help="without the parts that need the program")
    parser.add_argument("--into", type=Path, help="BUILD/site where it is not given")
    options = parser.parse_args()
    site = (options.into or options.build / "site").resolve()
    shutil.rmtree(site, ignore_errors=True)
    (site / "pages").mkdir(parents=True)
    contents = yaml.safe_load((SOURCE / HERE / "contents.yml").read_text(encoding="utf-8"))
    nav = navigation(contents["nav"], site / "pages", options.build.resolve(), options.quick)
    try:
        Stage(site / "pages", complete=not options.quick).write()
    except DeadLinks as error:
        sys.exit(f"dead links:\n{error}")
    run_mkdocs(site, nav)
    finish_search(site / "html", contents["search"], options.quick)
    render_formulas(site / "html")
    faults = check.faults(site / "html")
    if faults:
        sys.exit("\n".join(faults))
    print(f"The site is {site}/html/index.html: {check.summary(site / 'html')}.")


if __name__ == "__main__":
    main()
