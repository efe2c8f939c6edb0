"""Notebooks run wherever they are opened, and their cells may be run again."""

import pytest

nbformat = pytest.importorskip("nbformat")
import notebooks  # noqa: E402: it needs nbformat


@pytest.fixture
def notebook():
    first = "with open('a.toml', 'w') as file:\n    file.write('\\nx = 1\\n')"
    second = "with open('a.toml', 'a') as file:\n    file.write('\\ny = 2\\n')"
    cell = notebooks.form.Cell
    parts = ["# Title", cell(3, first, {}, hidden=True), cell(7, second, {}, hidden=True),
             cell(9, "1 / 0", {"raises": "ZeroDivisionError"})]
    return notebooks.notebook_of(parts)


def test_cells_write_whole_files(notebook):
    assert [cell.source for cell in notebook.cells[1:3]] == [
        "%%writefile a.toml\nx = 1\n", "%%writefile a.toml\nx = 1\n\ny = 2\n"]


def test_notebooks_name_their_kernel_and_are_valid(notebook):
    nbformat.validate(notebook)
    assert notebook.metadata.kernelspec.name == "python3"
    assert notebook.cells[3].metadata.tags == ["raises-exception"]
