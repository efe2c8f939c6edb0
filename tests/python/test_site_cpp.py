"""Pages of the C++ reference (docs/site/cpp_api.py): what becomes of a header, and of the comments of Poise's own."""

import html
import re
import shutil
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "docs" / "site"))
import cpp_api  # noqa: E402

pytestmark = pytest.mark.skipif(shutil.which("doxygen") is None, reason="Doxygen is missing (cmake/setup.sh site)")

HEADER = """#pragma once

// What the header is about.

#include <vector>

namespace poise {

/// A place, see docs/scene-files.md#units. With x_1 * x_2 < 3
///
///   F(x) = 0,   J^T y
///
/// and with
///   - one item that
///     goes on,
///   - another.
struct Place {
  double x = 0.0, y = 0.0;  ///< m
  int silent = 0;
  /// Of the body.
  double turn = 0.0;

 private:
  int hidden_ = 0;
};

/// Whether they are near: is_far() is the opposite.
bool is_near(const Place& a, const Place& b,
             double within = 1e-3);
bool is_far(const Place& a, const Place& b, double within);
bool is_else(int number);

}  // namespace poise
"""


@pytest.fixture
def written(tmp_path, monkeypatch):
    """The page of a folder with one header, and the reference that wrote it."""
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "CMakeLists.txt").write_text("poise_add_library(part\n  HEADERS\n    place.hpp\n  SOURCES\n  a.cpp)\n")
    (tmp_path / "part" / "place.hpp").write_text(HEADER)
    monkeypatch.setattr(cpp_api, "SOURCE", tmp_path)
    headers = cpp_api.public_headers()
    assert headers == {"part": ["part/place.hpp"]}
    reference = cpp_api.Reference(
        cpp_api.read_declarations(cpp_api.run_doxygen(headers["part"], tmp_path / "doxygen")), headers)
    return reference.folder_page("part", ""), reference


def seen(text):
    """What a reader sees of a part of a page."""
    return html.unescape(re.sub(r"</?[a-z][^>]*>|`|\]\([^)]*\)|\[(?=`)", "", text))


def test_comments_keep_formulas_and_lists(written):
    text = seen(written[0])
    assert "What the header is about." in text
    assert "With x_1 * x_2 < 3\n\ntext\nF(x) = 0,   J^T y\n" in text
    assert "- one item that goes on,\n- another." in text


def test_comments_stand_beside_what_they_are_about(written):
    text = seen(written[0])
    assert "double x = 0.0, y = 0.0\n    m\n\n- int silent = 0\n\n- double turn = 0.0\n    Of the body." in text
    near = "bool is_near(const Place& a, const Place& b,\n             double within = 1e-3)\n"
    assert f"{near}bool is_far(const Place& a, const Place& b, double within)\n\nWhether they are near" in text
    assert re.search(r"bool is_else\(int number\)\s*$", text)
    assert "hidden_" not in text


def test_names_are_links(written):
    page, reference = written
    assert '<a href="#Place">Place</a>' in page and "(#is_far)" in page and "(../scene-files.md#units)" in page
    # Without a comment: silent and is_else.
    assert reference.without_words == {"variable": 1, "function": 1}


def test_comments_of_poise_are_all_there(tmp_path):
    folder = "statics/proof"
    headers = cpp_api.public_headers()
    declarations = cpp_api.read_declarations(cpp_api.run_doxygen(headers[folder], tmp_path))
    page = cpp_api.Reference(declarations, {folder: headers[folder]}).folder_page(folder, "")

    def words(text):
        return re.sub(r"[^\w=+*/^<>|().,]+", "", text)

    shown = words(seen(re.sub(r"```(text|cpp)", "", page)))
    comments = [comment for header in headers[folder]
                for comment in re.findall(r"(?:^ *///(?![/<]).*\n)+|///<.*", (SOURCE / header).read_text(), re.M)]
    assert len(comments) > 30

    def named(comment):
        """With the headings of pages in the place of their files."""
        return re.sub(r"docs/([\w-]+)\.md", lambda file: cpp_heading(file[1]), comment)

    def cpp_heading(page):
        return re.search(r"^# (.*)", (SOURCE / "docs" / f"{page}.md").read_text(), re.M)[1]

    missing = [one for one in comments if words(named(re.sub(r"^ *///<?|`", "", one, flags=re.M))) not in shown]
    assert not missing


def test_pages_of_docs_have_the_tables_of_the_index():
    assert ["a proof about any position", "`certify`", "`<poise/statics/proof/certificate.hpp>`"] in cpp_api.tasks_of_library()
    folders = set(cpp_api.public_headers())
    assert folders <= set(cpp_api.what_folders_contain())
