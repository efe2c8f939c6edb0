"""Every fault of a site is found."""

import check
import pytest

MENU = '<a class="md-nav__link" href="index.html">Home</a><a class="md-nav__link" href="other.html">Other</a>'


def page(title, body):
    return f"<html><head><title>{title}</title></head><body>{MENU}{body}</body></html>"


@pytest.fixture
def site(tmp_path):
    (tmp_path / "index.html").write_text(page("Home", '<h1 id="home">Home</h1><a href="other.html#there">other</a>'))
    other = '<h1 id="there">Other<a>¶</a></h1><a href="https://example.org">web</a>'
    (tmp_path / "other.html").write_text(page("Other", other))
    (tmp_path / "style.css").write_text("a { background: url(picture.png) }")
    return tmp_path


def test_a_sound_site_has_no_fault(site):
    assert check.faults(site) == []


@pytest.mark.parametrize("body, fault", [
    ('<a href="none.html">x</a>', "index.html: nothing is at none.html"),
    ('<a href="../other.html">x</a>', "index.html: nothing is at ../other.html"),
    ('<img src="none.png">', "index.html: nothing is at none.png"),
    ('<a href="other.html#nowhere">x</a>', "index.html: no anchor other.html#nowhere"),
    ('<a href="#nowhere">x</a>', "index.html: no anchor #nowhere"),
    ('<script src="https://example.org/x.js"></script>', "index.html: loads https://example.org/x.js"),
    ('<img src="//example.org/x.png">', "index.html: loads //example.org/x.png"),
    ("<style>a { src: url('http://example.org/x') }</style>", "index.html: loads http://example.org/x"),
    ('<p style="background: url(http://example.org/y)">x</p>', "index.html: loads http://example.org/y"),
    ("<p>Every step\n- one</p>", "index.html: Markdown that is read as text: Every step\n- one"),
    ("<p>Names\n| a | b |</p>", "index.html: Markdown that is read as text: Names\n| a | b |"),
    ("<h3>get {#<b>get</b>}</h3>", "index.html: Markdown that is read as text: get {#"),
    ("<table><thead><tr><th>key</th><th></th></tr></thead></table>",
     "index.html: a table with a column without a heading: key, "),
    ("<h1>House</h1>", "index.html: the heading is House, the title Home"),
    ("<!-- file: x -->", "index.html: a comment: file: x"),
])
def test_faults_of_a_page(site, body, fault):
    (site / "index.html").write_text(page("Home", body))
    assert check.faults(site) == [fault]


def test_large_pages(site):
    (site / "index.html").write_text(page("Home", "x" * check.LARGEST))
    fault, = check.faults(site)
    assert fault.startswith("index.html: 1000") and fault.endswith(" bytes, more than 1000000")


def test_loads_of_styles(site):
    (site / "style.css").write_text("@import 'https://example.org/z.css';")
    assert check.faults(site) == ["style.css: loads https://example.org/z.css"]


def test_pages_that_no_menu_names(site):
    (site / "third.html").write_text(page("Third", ""))
    assert check.faults(site) == ["third.html: not in the navigation (docs/site/contents.yml)"]


def test_titles_are_unique(site):
    (site / "other.html").write_text(page("Home", '<h1 id="there">Home</h1>'))
    assert check.faults(site) == ["index.html and other.html: the same title, Home"]
