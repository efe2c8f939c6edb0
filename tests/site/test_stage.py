"""What becomes of Markdown on its way to the site."""

import pytest
import stage


@pytest.fixture
def source(tmp_path, monkeypatch):
    """A repository of a few files; what is under test reads it in the place of this one."""
    files = {"README.md": "# Poise\n", "docs/a.md": "# A\n", "docs/b.md": "# Of `b`\n", "docs/picture.svg": "<svg/>",
             "docs/report.html": "<body></body>", "datasets/x.toml": "x = 1\n", "datasets/y.toml": "y = 1\n",
             "model/scene.hpp": "int x;\n", "model/laws/law.hpp": "int y;\n", "docs/site/landing.md": "# L\n",
             "docs/site/install.md": "# I\n",
             "docs/site/site.css": "", "docs/site/theme/search.js": "", "docs/site/framed.html": "<style></style>"}
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(stage, "SOURCE", tmp_path)
    return tmp_path


def written(source, page, text, complete=True):
    """The page of the site that a page of the repository becomes."""
    (source / page).write_text(text)
    pages = source / "pages"
    for name, words in {"gallery/x.md": "# X\n", "cpp/model-laws.md": "## law.hpp {#law.hpp}\n"}.items():
        (pages / name).parent.mkdir(parents=True)
        (pages / name).write_text(words)
    here = stage.Stage(pages, complete)
    here.write()
    return (pages / here.names[stage.Path(page)]).read_text()


@pytest.mark.parametrize("link, staged", [
    ("[b](b.md#there)", "[b](b.md#there)"),
    ("[b.md](b.md)", "[Of `b`](b.md)"),
    ("[here](#here)", "[here](#here)"),
    ("[web](https://example.org/x.md)", "[web](https://example.org/x.md)"),
    ("[top](../README.md#first)", "[top](tour.md#first)"),
    ("[played](../datasets/x.toml)", "[played](gallery/x.md)"),
    ("[`y.toml`](../datasets/y.toml)", "[`y.toml`](files/datasets/y.toml.md)"),
    ("[described](../model/laws/law.hpp)", "[described](cpp/model-laws.md#law.hpp)"),
    ("[header](../model/scene.hpp)", "[header](files/model/scene.hpp.md)"),
    ("[folder](../model)", "folder"),
    ("![drawing](picture.svg)", "![drawing](picture.svg)"),
    ("[![drawing](picture.svg)](b.md)", "[![drawing](picture.svg)](b.md)"),
])
def test_links_lead_to_the_same(source, link, staged):
    assert written(source, "docs/a.md", f"See {link}.\n") == f"See {staged}.\n"


def test_links_of_the_readme_lose_their_folder(source):
    assert written(source, "README.md", "# Poise\n\n[docs/b.md](docs/b.md), [b.md](docs/b.md)\n") == (
        "# Tour of the commands\n\n[Of `b`](b.md), [Of `b`](b.md)\n")


def test_pages_of_parts_stand_for_those_of_docs(source):
    (source / "pages").mkdir()
    (source / "pages/b.md").write_text("# B, executed\n\n[x](../datasets/x.toml)\n")
    written(source, "docs/a.md", "# A\n")
    assert (source / "pages/b.md").read_text() == "# B, executed\n\n[x](gallery/x.md)\n"


def test_files_that_are_named_become_pages_with_the_file_beside(source):
    written(source, "docs/a.md", "[y](../datasets/y.toml)\n")
    assert "````toml\ny = 1\n````" in (source / "pages/files/datasets/y.toml.md").read_text()
    assert (source / "pages/files/datasets/y.toml").read_text() == "y = 1\n"


def test_reports_know_that_they_are_framed(source):
    written(source, "docs/a.md", "[report](report.html)\n")
    assert (source / "pages/report.html").read_text() == "<body><style></style></body>"


@pytest.mark.parametrize("link", ["[c](c.md)", "[z](../datasets/z.toml)", "![no](no.svg)", "[part](site/cpp/none.md)"])
def test_links_to_nowhere_are_errors(source, link):
    with pytest.raises(stage.DeadLinks, match=r"docs/a.md: nothing is at"):
        written(source, "docs/a.md", f"See {link}.\n")


def test_the_quick_form_has_no_links_to_parts(source):
    assert written(source, "docs/a.md", "See [part](site/gallery/none.md).\n", complete=False) == "See part.\n"


def test_comments_vanish_but_in_code(source):
    text = "<!-- program: x -->\n```html\n<!-- [kept](nowhere.md) -->\n```\nafter <!-- two\nlines --> it\n"
    assert written(source, "docs/a.md", text) == "```html\n<!-- [kept](nowhere.md) -->\n```\nafter  it\n"


def test_lists_begin_behind_an_empty_line():
    text = "Every step\n- one\n  goes on\n- two\n"
    assert stage.as_python_markdown(text) == "Every step\n\n- one\n  goes on\n- two\n"
