"""Pages of the documentation as notebooks: cells of Python, what they print, and files that they need.

    ```python    a cell; the cells of a page share one working folder with a copy of datasets/
    ```output    what the cell before it prints and shows as text, where "..." stands for any lines
                 <!-- picture -->: before a cell, which shows a picture
                 <!-- raises: NAME -->: before a cell, which ends with this exception, whose text is its output
    <!-- saved: PAGE FILE -->, <!-- added: PAGE FILE -->: the TOML that the page PAGE saves as FILE, or adds to it
"""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
NUMBER = re.compile(r"<?([+-]?[0-9]+)(\.[0-9]+)?(e[+-]?[0-9]+)?")
CUT = "..."


@dataclasses.dataclass
class Cell:
    line: int
    source: str
    marks: dict[str, str]
    output: list[str] | None = None
    output_line: int = 0  # of the first line of the output, from 1
    hidden: bool = False


def toml_of(page: str, file: str, mark: str) -> str:
    """The TOML that a page shows under "<!-- file: FILE -->" or "<!-- added to: FILE -->"."""
    found = re.search(
        rf"^<!-- {mark}: {re.escape(file)} -->\n```toml\n(.*?)^```$", (DOCS / page).read_text(), re.S | re.M
    )
    if found is None:
        raise ValueError(f"{page}: expected a block <!-- {mark}: {file} -->")
    return found.group(1)


def saving(words: str, mark: str, mode: str) -> str:
    page, file = words.split()
    text = toml_of(page, file, mark)
    return f"with open({file!r}, {mode!r}) as file:\n    file.write({chr(10) + text!r})"


def cells_of(page: Path) -> list[Cell]:
    """The cells of a page in their order."""
    cells: list[Cell] = []
    marks: dict[str, str] = {}
    block: tuple[str, int, list[str]] | None = None
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if line.startswith("```"):
            if block is None:
                block = (line[3:], number, [])
                continue
            kind, begin, lines = block
            if kind == "python":
                cells.append(Cell(begin, "\n".join(lines), marks))
            elif kind == "output":
                cells[-1].output, cells[-1].output_line = lines, begin + 1
            block, marks = None, {}
        elif block is not None:
            block[2].append(line)
        elif mark := re.fullmatch(r"<!-- ([a-z]+)(?:: (.*))? -->", line):
            marks[mark.group(1)] = mark.group(2) or ""
            for key, of, mode in (("saved", "file", "w"), ("added", "added to", "a")):
                if key == mark.group(1):
                    cells.append(Cell(number, saving(mark.group(2), of, mode), {}, hidden=True))
        elif line:
            marks = {}
    return cells


def words_and_numbers(line: str) -> tuple[str, list[tuple[float, float]]]:
    """A line with "#" for its numbers, and these with one unit of their last decimal, 0 for whole ones.

    Durations are words, since they differ from run to run.
    """
    line = re.sub(r"(^|[\s(])<?[0-9.e+-]+ (ns|µs|ms|min)(?![A-Za-z/])", r"\1TIME", line)
    numbers = []
    for whole, decimals, power in NUMBER.findall(line):
        unit = 0.0 if not decimals and not power else 10.0 ** (1 - len(decimals or ".")) * float("1" + (power or "e0"))
        numbers.append((float(whole + decimals + power), unit))
    return " ".join(NUMBER.sub("#", line).split()), numbers


def differs(expected: str, printed: str) -> bool:
    words, numbers = words_and_numbers(expected)
    other_words, other_numbers = words_and_numbers(printed)
    if words != other_words:
        return True
    for (a, unit), (b, other_unit) in zip(numbers, other_numbers):
        largest = max(abs(a), abs(b))
        if largest >= 1e-9 and abs(a - b) > max(1e-6 * largest, 3.001 * unit, 3.001 * other_unit):
            return True
    return False


def pieces_of(lines: list[str]) -> list[list[str]]:
    """The lines between cuts."""
    out: list[list[str]] = [[]]
    for line in lines:
        if line == CUT:
            out.append([])
        else:
            out[-1].append(line)
    return out


def difference(expected: list[str], printed: list[str]) -> str:
    """The first difference of an output, or nothing."""
    pieces, at = pieces_of(expected), 0
    for index, piece in enumerate(pieces):
        last = index == len(pieces) - 1
        begins = [at] if index == 0 else range(at, len(printed) - len(piece) + 1)
        if last and index > 0:
            begins = [len(printed) - len(piece)] if len(printed) - len(piece) >= at else []
        for begin in begins:
            if begin + len(piece) <= len(printed) and not any(map(differs, piece, printed[begin:])):
                at = begin + len(piece)
                break
        else:
            return "expected:\n" + "\n".join(piece)
    return "" if at == len(printed) else "printed more: " + printed[at]


def cut_like(expected: list[str], printed: list[str]) -> list[str]:
    """What is printed, with the cuts of what was expected: a piece begins and ends at the lines most like its own."""

    def most_like(line: str, begin: int) -> int:
        words = set(words_and_numbers(line)[0].split())

        def likeness(k: int) -> float:
            other = set(words_and_numbers(printed[k])[0].split())
            return len(words & other) / max(len(words | other), 1)

        return max(range(begin, len(printed)), key=lambda k: (likeness(k), -k))

    if CUT not in expected:
        return printed
    pieces, out, at = pieces_of(expected), [], 0
    for index, piece in enumerate(pieces):
        if index > 0:
            out.append(CUT)
        if not piece or at >= len(printed):
            continue
        begin = 0 if index == 0 else most_like(piece[0], at)
        end = len(printed) if index == len(pieces) - 1 else most_like(piece[-1], begin) + 1
        out += printed[begin:end]
        at = end
    return out
