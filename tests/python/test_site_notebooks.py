"""The tutorials in Python on the site (docs/site/notebooks.py): executed pages, and notebooks to download."""

import os
import sys
from pathlib import Path

import nbformat
import pytest

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "docs" / "site"))
import notebooks  # noqa: E402

PAGE = """# A page

Words with a [link](other.md#there).

<!-- saved: other.md given.toml -->

```python
print(open("given.toml").read().strip())
for k in range(4):
    print("line" if k < 3 else "last line", k)
```

```output
title = "given"
...
last line 7
```

<!-- picture -->
```python
import poise
poise.example("toggle")
```

The end.
"""
OTHER = """<!-- file: given.toml -->
```toml
title = "given"
```
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The page and the notebook of a small tutorial."""
    source, pages = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("pages")
    (source / "docs").mkdir()
    (source / "docs" / "python-some.md").write_text(PAGE)
    (source / "docs" / "other.md").write_text(OTHER)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(notebooks, "SOURCE", source)
        patch.setattr(notebooks.form, "DOCS", source / "docs")
        notebooks.write_pages(pages, Path(os.environ["POISE_BUILD_FOLDER"]))
    return pages, (pages / "python-some.md").read_text(), nbformat.read(pages / "notebooks" / "python-some.ipynb", 4)


def test_pages_show_what_cells_print_and_draw(written):
    pages, page, _ = written
    assert page.startswith('# A page\n\n<a href="notebooks/python-some.ipynb" download>')
    assert '<div class="result" markdown>\n\n```text\ntitle = "given"\n...\nlast line 3\n```\n\n</div>' in page
    assert '```toml title="given.toml"\ntitle = "given"\n```' in page
    assert '<img src="notebooks/python-some-1.svg" alt=' in page and "<!--" not in page
    assert "[link](other.md#there)" in page and page.rstrip().endswith("The end.")
    assert "<svg" in (pages / "notebooks" / "python-some-1.svg").read_text()


def test_notebooks_can_be_run_elsewhere(written):
    notebook = written[2]
    sources = [cell.source for cell in notebook.cells]
    assert '%%writefile given.toml\ntitle = "given"\n' in sources
    assert any("Words with a link (docs/other.md)." in source for source in sources)
    assert [cell.outputs != [] for cell in notebook.cells if cell.cell_type == "code"] == [True] * 3


def test_every_tutorial_is_on_the_site():
    contents = (SOURCE / "docs" / "site" / "contents.yml").read_text()
    for page in (SOURCE / "docs").glob("python-*.md"):
        assert f"- {page.name}\n" in contents
