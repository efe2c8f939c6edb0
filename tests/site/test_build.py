"""The quick form of the site is built without a fault, into the folder that Site.pages looks at."""

import html
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import build
import pytest

SITE = Path(os.environ["POISE_SITE"])


#: What the site is built with, and whether it is here.
NEEDED = {"mkdocs": importlib.util.find_spec("mkdocs") is not None,
          "mkdocs-material": Path("/usr/share/mkdocs/themes/material").is_dir(),
          "libjs-katex": build.KATEX.is_dir(),
          "node": shutil.which("node") is not None}
MISSING = [name for name, is_here in NEEDED.items() if not is_here]

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"{MISSING} missing; cmake/setup.sh site installs it")


@pytest.fixture(scope="module")
def site():
    command = [sys.executable, build.SOURCE / "docs/site/build.py", SITE, "--quick", "--into", SITE.parent]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return SITE


def test_every_page_of_docs_is_there(site):
    for path in (build.SOURCE / "docs").glob("*.md"):
        title = path.read_text().split("\n")[0].lstrip("# ").replace("`", "")
        text = re.sub("</?code>", "", (site / f"{path.stem}.html").read_text())
        assert title in html.unescape(text)


def test_the_search_knows_words_and_weights_also_from_disk(site):
    text = (site / "search/search_index.json").read_text()
    assert (site / "search/search_index.js").read_text() == f"giveSearchIndex({text});\n"
    entries = json.loads(text)["docs"]
    assert not [entry for entry in entries if entry["location"].startswith("files/")]
    places = {entry["location"]: entry for entry in entries}
    assert "snap" in places["load-paths.html"]["tags"]
    assert (places["friction.html"]["boost"], places["json.html"]["boost"]) == (1, 0.2)


def test_formulas_become_pages_without_a_script(tmp_path):
    inline = '<span class="arithmatex">\\(a &lt; b\\)</span>'
    displayed = '<div class="arithmatex">\\[\n\\sqrt{x}\n\\]</div>'
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/page.html").write_text(f"<head></head><p>{inline}</p>{displayed}")
    build.render_formulas(tmp_path)
    text = (tmp_path / "folder/page.html").read_text()
    assert text.count('<span class="katex">') == 2 and text.count('<span class="katex-display">') == 1
    assert "<mo>&lt;</mo>" in text
    assert '<link rel="stylesheet" href="../assets/katex/katex.css"></head>' in text and "<script" not in text
    style = (tmp_path / "assets/katex/katex.css").read_text()
    assert "url(fonts/KaTeX_Main-Regular.woff2)" in style and ".ttf" not in style and ".woff)" not in style
    assert (tmp_path / "assets/katex/fonts/KaTeX_Main-Regular.woff2").is_file()


def test_formulas_that_cannot_be_read_are_errors(tmp_path):
    (tmp_path / "page.html").write_text('<span class="arithmatex">\\(\\sqrt{\\)</span>')
    with pytest.raises(SystemExit, match="KaTeX"):
        build.render_formulas(tmp_path)


def test_parts_take_their_place_in_the_navigation(tmp_path, monkeypatch):
    (tmp_path / "some_part.py").write_text("def write_pages(pages, build):\n    return [{'Some': ['some/index.md']}]\n")
    monkeypatch.syspath_prepend(tmp_path)
    entries = [{"API": ["library.md", {"part": "some_part"}]}]
    assert build.navigation(entries, tmp_path, tmp_path, quick=True) == [{"API": ["library.md"]}]
    with_part = [{"API": ["library.md", {"Some": ["some/index.md"]}]}]
    assert build.navigation(entries, tmp_path, tmp_path, quick=False) == with_part
    with pytest.raises(ModuleNotFoundError):
        build.navigation([{"part": "no_such_part"}], tmp_path, tmp_path, quick=False)
