"""Pages of the Python reference (docs/site/python_api.py)."""

import html
import os
import re
import sys
from pathlib import Path

import poise
import pytest

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "docs" / "site"))
import python_api  # noqa: E402


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    python_api.write_pages(folder, Path(os.environ["POISE_BUILD_FOLDER"]))
    return {page.stem: page.read_text() for page in (folder / "python").glob("*.md")}


def test_every_public_name_is_there(pages):
    names = [name for name in poise.__all__ if name != "measures"] + [f"measures.{n}" for n in ("angle", "sum")]
    anchors = [anchor for page in pages.values() for anchor in re.findall(r"\{#(.*?)\}", page)]
    assert not set(names) - set(anchors)
    for page in pages.values():
        within = re.findall(r"\{#(.*?)\}", page)
        assert len(within) == len(set(within))


def test_commands_have_their_options(pages):
    for command in poise._poise.commands():
        if command["name"] in ("solve", "view"):
            continue
        text = pages["commands"] + pages["identification"]
        for option in command["options"]:
            name = option["name"].removeprefix("--").replace("-", "_")
            if option["name"].startswith("--") and name not in ("json", "csv", "markdown", "svg", "html", "quiet",
                                                                "verbose", "scene", "help"):
                assert re.search(rf"^- `{name}_?`: ", text, re.M), (command["name"], name)


def test_docstrings_and_signatures(pages):
    scenes = html.unescape(re.sub(r"<[^>]*>", "", pages["scenes"]))
    assert "solve(*numbers: dict[str, Any], **options: Any) -> Rest" in scenes
    assert re.search(r"- `proof`: False leaves out the proof", scenes)
    assert "```pycon\n>>> import poise" in scenes
    assert '<a href="results.html#Rest">Rest</a>' in pages["scenes"]
    # What is compiled: the signature of the stub, the docstring of the module.
    equations = html.unescape(re.sub(r"<[^>]*>", "", pages["equations"]))
    assert "energy(x: npt.ArrayLike) -> float\n\nV, force times length; nan with loads" in equations


def test_links_lead_to_anchors(pages):
    for name, page in pages.items():
        for target, anchor in re.findall(r"\]\(([a-z]*)(?:\.md)?#([^)]*)\)", page):
            assert f"{{#{anchor}}}" in pages[target or name], (name, target, anchor)
