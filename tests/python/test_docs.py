"""Cells of README.md and docs/ run as notebooks, print what the pages show, and show the pictures that they promise.

With POISE_UPDATE_DOCS set, the pages are rewritten with what the cells print now.
"""

import os
import re
import shutil
from pathlib import Path

import nbformat
import page as pages
import pytest
from nbclient.exceptions import CellExecutionError
from nbconvert.preprocessors import ExecutePreprocessor

SOURCE = Path(__file__).resolve().parents[2]
WITH_CELLS = [page for page in [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))] if pages.cells_of(page)]
PICTURES = {"image/svg+xml", "image/png"}


def printed(outputs):
    """What a cell prints and shows, as lines."""
    text = ""
    for output in outputs:
        if output.output_type == "stream":
            text += output.text  # a part of what is printed, which may end within a line
        elif output.output_type == "execute_result":
            text += output.data["text/plain"] + "\n"
        elif output.output_type == "error":
            text += f"{output.ename}: {output.evalue}\n"
    return text.splitlines()


def shown(outputs):
    """The kinds in which a cell shows what it shows."""
    return {kind for output in outputs if "data" in output for kind in output.data}


def run_notebook(notebook, folder):
    """Runs all cells; what a cell raises that should not is a failure with its cell."""
    try:
        ExecutePreprocessor(timeout=600, kernel_name="python3").preprocess(
            notebook, {"metadata": {"path": str(folder)}}
        )
    except CellExecutionError as error:
        pytest.fail(re.sub(r"\x1b\[[0-9;]*m", "", f"{error.ename}: {error.evalue}\n{error}")[:3000], pytrace=False)


@pytest.mark.parametrize("page", WITH_CELLS, ids=lambda page: page.stem)
def test_cells_print_what_the_page_shows(page, tmp_path):
    shutil.copytree(SOURCE / "datasets", tmp_path / "datasets")
    cells = pages.cells_of(page)
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell.source) for cell in cells])
    for cell, run in zip(cells, notebook.cells):
        if "raises" in cell.marks:
            run.metadata["tags"] = ["raises-exception"]
    run_notebook(notebook, tmp_path)
    lines, wrong, moved = page.read_text().splitlines(), [], 0
    for cell, run in zip(cells, notebook.cells):
        if cell.hidden:
            continue
        if "picture" in cell.marks and not shown(run.outputs) & PICTURES:
            wrong.append(f"{page.name}:{cell.line}: expected a picture, found {sorted(shown(run.outputs))}")
        if "raises" in cell.marks and not re.match(rf"(\w+\.)*{cell.marks['raises']}: ", printed(run.outputs)[-1]):
            wrong.append(f"{page.name}:{cell.line}: expected {cell.marks['raises']}, found {printed(run.outputs)}")
        if cell.output is None:
            continue
        why = pages.difference(cell.output, printed(run.outputs))
        if why and "POISE_UPDATE_DOCS" in os.environ:
            begin = cell.output_line - 1 + moved
            new = pages.cut_like(cell.output, printed(run.outputs))
            lines[begin:begin + len(cell.output)] = new
            moved += len(new) - len(cell.output)
        elif why:
            wrong.append(f"{page.name}:{cell.line}: {why}\nall of it:\n" + "\n".join(printed(run.outputs)))
    if moved or lines != page.read_text().splitlines():
        page.write_text("\n".join(lines) + "\n")
    assert not wrong, "\n\n".join(wrong)


def test_outputs_are_compared():
    """The comparison fails where it should: it knows numbers from words, and what a cut stands for."""
    assert not pages.difference(["a 1.50 N", "...", "end"], ["a  1.51 N", "b", "c", "end"])
    assert pages.difference(["a 1.50 N"], ["a 1.60 N"])
    assert pages.difference(["a 1.50 N"], ["a 1.50 kN"])
    assert pages.difference(["2 folds"], ["3 folds"])
    assert pages.difference(["a"], ["a", "b"])
    assert pages.difference(["a", "...", "c"], ["a", "b"])
    assert pages.cut_like(["a 1", "...", "c 3"], ["a 2", "b 2", "c 4"]) == ["a 2", "...", "c 4"]
