"""Prints CHANGELOG.md in the form of the file changelog of a Debian package.

    debian_changelog.py PACKAGE "NAME <ADDRESS>"
"""

from __future__ import annotations

import datetime
import email.utils
import re
import sys
import textwrap
from pathlib import Path

CHANGELOG = Path(__file__).resolve().parents[2] / "CHANGELOG.md"


def plain(markdown: str) -> str:
    """A text without marks and links, which lead to pages that are elsewhere."""
    text = re.sub(r"\s*\((?:\[[^\]]*\]\([^)]*\)(?:, )?)+\)", "", " ".join(markdown.split()))
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text).replace("**", "").replace("`", "")


def debian_changelog(markdown: str, package: str, contact: str, now: datetime.datetime) -> str:
    """The versions in their order; one that is not released yet has the date of now."""
    entries = []
    for version, date, body in re.findall(r"^## \[([0-9.]+)\] - (\S+)\n(.*?)(?=^## |\Z)", markdown, flags=re.M | re.S):
        when = now
        if date != "unreleased":
            when = datetime.datetime.fromisoformat(date).replace(tzinfo=datetime.timezone.utc)
        lines = [f"{package} ({version}) unstable; urgency=medium", ""]
        for block in re.findall(r"^(?:### |- |(?=\w)).+?(?=^- |\n\n|\Z)", body, flags=re.M | re.S):
            text = plain(re.sub(r"^(### |- )", "", block))
            if block.startswith("### "):
                lines += [*([""] if lines[-1] else []), f"  [ {text} ]"]
            else:
                lines += textwrap.wrap(text, 79, initial_indent="  * ", subsequent_indent="    ")
        entries.append("\n".join([*lines, "", f" -- {contact}  {email.utils.format_datetime(when)}", ""]))
    if not entries:
        raise SystemExit('debian_changelog: CHANGELOG.md: expected versions, "## [0.1.0] - 2026-01-31"')
    return "\n".join(entries)


if __name__ == "__main__":
    print(debian_changelog(CHANGELOG.read_text(encoding="utf-8"), sys.argv[1], sys.argv[2],
                           datetime.datetime.now(datetime.timezone.utc)), end="")
