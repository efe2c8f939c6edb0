"""Leaves of links in Markdown the words alone where what they lead to is not beside the file, as in packages that have
some of the pages.

    drop_dead_links.py FILE or FOLDER...    changes the files, and all *.md below the folders
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "site"))
from stage import LINK, outside_code  # noqa: E402


def without_dead_links(text: str, folder: Path) -> str:
    def link(found: re.Match[str]) -> str:
        mark, words, address = found.groups()
        words = LINK.sub(link, words)
        leads = re.match(r"[a-z]+:|#", address) or (folder / address.partition("#")[0]).exists()
        return f"{mark}[{words}]({address})" if leads else words

    return outside_code(text, lambda part: LINK.sub(link, part))


def main() -> None:
    for given in map(Path, sys.argv[1:]):
        for file in sorted(given.rglob("*.md")) if given.is_dir() else [given]:
            file.write_text(without_dead_links(file.read_text(encoding="utf-8"), file.parent), encoding="utf-8")


if __name__ == "__main__":
    main()
