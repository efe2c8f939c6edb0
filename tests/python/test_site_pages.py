"""The gallery and the pages of commands of the site (docs/site/)."""

import os
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ["POISE_EXECUTABLE"])
sys.path.insert(0, str(ROOT / "docs" / "site"))

import commands  # noqa: E402
import gallery  # noqa: E402
import gallery_picture  # noqa: E402
import gallery_report  # noqa: E402

GROUPS = gallery.groups_of_table()
DATASETS = {dataset.name: dataset for _, datasets in GROUPS for dataset in datasets}


@pytest.fixture
def pages(tmp_path):
    return gallery.Gallery(tmp_path / "gallery", gallery_report.Reports(PROGRAM, tmp_path / "kept"))


def made(pages, dataset):
    pages.reports.make_all(dataset.runs)
    pages.write(dataset)
    return (pages.folder / f"{dataset.slug}.md").read_text()


def test_every_dataset_is_shown():
    files = {file.relative_to(ROOT / "datasets").as_posix() for file in (ROOT / "datasets").rglob("*.toml")}
    # The catalogue lists the files of cases; its page is that of all hard cases.
    assert files - {"hard/catalogue.toml"} == set(DATASETS)
    titles = [dataset.title for dataset in DATASETS.values()]
    assert len(titles) == len(set(titles))


@pytest.mark.parametrize("name, kind", [
    ("over_centre_latch.toml", "drawing"), ("friction/drawer.toml", "drawing"), ("desk_lamp_design.toml", "drawing"),
    ("structures/three_hinged_portal.toml", "drawing"), ("assemblies/platform_on_legs.toml", "cards"),
])
def test_pages_that_play(pages, name, kind):
    dataset = DATASETS[name]
    page = made(pages, dataset)
    places = re.findall(r'<iframe src="([^"]*)"', page)
    assert len(places) == len(dataset.runs)
    reports = [(pages.folder / dataset.slug).parent / place for place in places]
    assert all(report.stat().st_size < gallery.LARGEST for report in reports)
    figures = [gallery_picture.figure_that_plays(gallery_report.document_of(report.read_text())) for report in reports]
    assert kind in [figure["kind"] for figure in figures if figure is not None]
    picture = ElementTree.parse(pages.folder / dataset.slug / "picture.svg").getroot()
    assert len(picture.findall(".//{http://www.w3.org/2000/svg}*")) > 5
    for line in dataset.text.split("\n"):
        assert line in page


def test_a_report_that_several_pages_show_is_written_once(pages):
    first, second = DATASETS["hard/cusp_rod.toml"], DATASETS["hard/cusps.cases.toml"]
    place = 'src="../hard/cusp_rod/report.html"'
    assert place in made(pages, first)
    page = made(pages, second)
    assert place in page
    assert "[hard/soft_arm.toml](../hard/soft_arm.md)" in page
    assert [file.name for file in pages.folder.rglob("report*")] == ["report.html"]


@pytest.mark.parametrize("line, why", [
    ("poise check datasets/toggle_clamp.toml", "nothing moves in the reports"),
    ("poise path datasets/toggle_clamp.toml --vary load.Q=0..1", "load.Q: expected the path of a number"),
    ("poise modes datasets/heaton_timme.toml --quiet", "nothing moves in the reports"),
])
def test_reports_that_are_refused(pages, line, why):
    with pytest.raises(gallery_report.ReportError, match=why):
        made(pages, gallery.Dataset("toggle_clamp.toml", [line], None))


def test_large_reports_are_refused(pages, monkeypatch):
    monkeypatch.setattr(gallery, "LARGEST", 100_000)
    with pytest.raises(gallery_report.ReportError, match="expected fewer than 100000"):
        made(pages, DATASETS["over_centre_latch.toml"])


def test_reports_are_kept_until_what_they_are_made_of_changes(tmp_path, monkeypatch):
    monkeypatch.setattr(gallery_report, "ROOT", tmp_path)
    monkeypatch.setattr(gallery_report, "DATASETS", tmp_path / "datasets")
    (tmp_path / "datasets").mkdir()
    for name in ("tailgate_design.toml", "tailgate.toml", "struts.csv", "toggle.toml"):
        (tmp_path / "datasets" / name).write_bytes((ROOT / "datasets" / name).read_bytes())
    reports = gallery_report.Reports(PROGRAM, tmp_path / "kept")
    run = ("poise check datasets/toggle.toml",)
    file = reports.make(run)
    file.write_text("kept")
    assert reports.make(run).read_text() == "kept"
    design = ("poise design datasets/tailgate_design.toml",)
    before = reports.file_of(design)
    with (tmp_path / "datasets" / "struts.csv").open("a") as struts:
        struts.write("\n")
    assert reports.file_of(design) != before
    assert reports.file_of(run) == file
    reports.forget_others([design])
    assert not file.exists()


def test_comments_become_paragraphs():
    lines = gallery.first_comment("# a < b\n# and `c`:\n#   x = 1\n#     y\n# after\n#\n# last\ntitle = 1\n# no\n")
    assert gallery.as_html(lines) == ("<p>a &lt; b and <code>c</code>:</p>\n<pre><code>  x = 1\n    y</code></pre>\n"
                                      "<p>after</p>\n<p>last</p>")


def anchors_of(page):
    headings = re.findall(r"^#+ (.*)$", (ROOT / "docs" / page).read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_features_lead_to_sections():
    for word, place, has in gallery.FEATURES:
        page, _, anchor = place.partition("#")
        assert not anchor or anchor in anchors_of(page), place
        assert any(has(dataset.data) for dataset in DATASETS.values()), word


def test_every_command_has_a_page(tmp_path):
    entries = commands.entries_of(pathlib.Path(os.environ["POISE_BUILD_FOLDER"]))
    assert {entry["name"] for entry in entries} == set(commands.GUIDES)
    for entry in entries:
        page = commands.page(entry)
        text = subprocess.run([PROGRAM, entry["name"], "--help"], capture_output=True, text=True, check=True).stdout
        shown = {name for name in re.findall(r"--[a-z][a-z-]*", text) if name != "--help"}
        assert shown == set(re.findall(r"--[a-z][a-z-]*", page))
        words = [word for option in entry["options"] for word in option["help"].split()]
        plain = re.sub(r"\\(.)", r"\1", page)
        assert all(word in plain or "docs/" in word or word.endswith(":") for word in words)
        for guide in commands.GUIDES[entry["name"]]:
            words = " ".join((ROOT / "docs" / f"{guide}.md").read_text().split())
            assert f"poise {entry['name']}" in words, guide


def test_the_index_of_commands(tmp_path):
    nav = commands.write_pages(tmp_path, PROGRAM.parent)
    index = (tmp_path / "commands" / "index.md").read_text()
    assert "Exit code: 0 solved and confirmed" in index
    for name in commands.GUIDES:
        assert f"[poise {name}]({name}.md)" in index
        assert {f"poise {name}": f"commands/{name}.md"} in nav[0]["Commands"]
