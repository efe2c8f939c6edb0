"""The tutorials in Python (docs/python-*.md) as executed pages with their pictures, and as notebooks to download.

A page takes the place of the one in docs/ with the same name; its links are still those of docs/. Its pictures and its
notebook are in the folder notebooks/.
"""

from __future__ import annotations

import ast
import base64
import html
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import Any, Iterator

import nbformat
from nbconvert.preprocessors import ExecutePreprocessor

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "python"))
import page as form  # noqa: E402: the form of these pages, as tests/python/test_docs.py checks them

DOWNLOAD = (
    '<a href="notebooks/{name}.ipynb" download>Download this page as a notebook.</a> It runs where Poise is installed.')


def parts_of(text: str, cells: list[form.Cell]) -> Iterator[str | form.Cell]:
    """A page as prose and cells in their order, without comments and outputs."""
    lines = text.split("\n")
    shown = list(lines)
    for cell in cells:
        end = cell.line if cell.hidden else cell.line + len(cell.source.split("\n")) + 1
        shown[cell.line - 1:end] = [""] * (end - cell.line + 1)
        if cell.output is not None:
            begin, end = cell.output_line - 2, cell.output_line + len(cell.output)
            shown[begin:end] = [""] * (end - begin)
    begins = [0, *(cell.line for cell in cells), len(lines)]
    for k, cell in enumerate([None, *cells]):
        if cell is not None:
            yield cell
        words = re.sub(r"^<!--.*-->$", "", "\n".join(shown[begins[k]:begins[k + 1]]), flags=re.M)
        if words.strip():
            yield re.sub(r"\n{3,}", "\n\n", words.strip("\n"))


def file_of(cell: form.Cell) -> tuple[str, str, str]:
    """What a hidden cell writes: the name of the file, how it is opened, and the text."""
    written = re.fullmatch(r"with open\((.*), (.*)\) as file:\n    file\.write\((.*)\)", cell.source)
    assert written is not None
    name, mode, text = map(ast.literal_eval, written.groups())
    return name, mode, text.strip("\n")


def notebook_of(parts: list[str | form.Cell]) -> Any:
    """The parts as cells, each of which may be run again: one that adds to a file writes the whole of it."""
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = nbformat.v4.new_notebook(metadata={"kernelspec": kernel})
    files: dict[str, str] = {}
    for part in parts:
        if isinstance(part, str):
            # The pages that links lead to are not beside the notebook.
            words = re.sub(r"\[([^\]]+)\]\(([^):#]+)(#[^)]*)?\)", r"\1 (docs/\2)", part)
            notebook.cells.append(nbformat.v4.new_markdown_cell(words))
        elif part.hidden:
            name, mode, text = file_of(part)
            files[name] = f"{files[name]}\n\n{text}" if mode == "a" else text
            notebook.cells.append(nbformat.v4.new_code_cell(f"%%writefile {name}\n{files[name]}\n"))
        else:
            notebook.cells.append(nbformat.v4.new_code_cell(part.source))
            if "raises" in part.marks:
                notebook.cells[-1].metadata["tags"] = ["raises-exception"]
    return notebook


def execute(notebook: Any, module: Path) -> None:
    """Runs all cells with the module, in an empty folder."""
    os.environ.update({"PYTHONPATH": str(module), "PYDEVD_DISABLE_FILE_VALIDATION": "1"})
    with tempfile.TemporaryDirectory() as folder:
        ExecutePreprocessor(timeout=600, kernel_name="python3").preprocess(notebook, {"metadata": {"path": folder}})


def text_of(outputs: list[Any]) -> list[str]:
    """What a cell prints and shows as text, in lines."""
    text = ""
    for output in outputs:
        if output.output_type == "error":
            text += f"{output.ename}: {output.evalue}\n"
        else:
            text += output.text if output.output_type == "stream" else output.data.get("text/plain", "") + "\n"
    return text.splitlines()


def pictures_of(outputs: list[Any]) -> Iterator[tuple[str, bytes]]:
    """The pictures of a cell, each with the ending of its file."""
    for output in outputs:
        data = output.get("data", {})
        if "image/svg+xml" in data:
            yield "svg", data["image/svg+xml"].encode()
        elif "image/png" in data:
            yield "png", base64.b64decode(data["image/png"])


def executed_page(name: str, parts: list[str | form.Cell], notebook: Any, folder: Path) -> str:
    """The page with what its cells print and show; the pictures are written to the folder."""
    out: list[str] = []
    pictures: list[bytes] = []  # each is shown once
    for part, run in zip(parts, notebook.cells):
        if isinstance(part, str):
            out.append(part)
            continue
        if part.hidden:
            file, mode, text = file_of(part)
            title = f"added to {file}" if mode == "a" else file
            out.append(f'```toml title="{title}"\n{text}\n```')
            continue
        shown = []
        for ending, data in pictures_of(run.outputs):
            if data in pictures:
                continue
            pictures.append(data)
            file = f"{name}-{len(pictures)}.{ending}"
            (folder / file).write_bytes(data)
            what = html.escape(part.source.strip().split("\n")[-1], quote=True)
            shown.append(f'<img src="{folder.name}/{file}" alt="What {what} shows">')
        if part.output is not None:
            printed = text_of(run.outputs)
            lines = form.cut_like(part.output, printed) if form.difference(part.output, printed) else part.output
            shown.append("\n".join(["```text", *lines, "```"]))
        out.append(f"```python\n{part.source}\n```")
        if shown:
            out += ['<div class="result" markdown>', *shown, "</div>"]
    title, _, rest = "\n\n".join(out).partition("\n")
    return f"{title}\n\n{DOWNLOAD.format(name=name)}\n{rest}\n"


def write_pages(pages: Path, build: Path) -> list[Any]:
    folder = pages / "notebooks"
    folder.mkdir(parents=True, exist_ok=True)
    tutorials = sorted((SOURCE / "docs").glob("python-*.md"))
    for source in tutorials:
        name = source.stem
        parts = list(parts_of(source.read_text(), form.cells_of(source)))
        notebook = notebook_of(parts)
        execute(notebook, build / "python")
        nbformat.write(notebook, folder / f"{name}.ipynb")
        (pages / f"{name}.md").write_text(executed_page(name, parts, notebook, folder))
    print(f"Notebooks: {len(tutorials)}")
    return []  # docs/site/contents.yml names the pages, which are there in the quick form of the site too


if __name__ == "__main__":
    write_pages(Path(sys.argv[2]), Path(sys.argv[1]))
