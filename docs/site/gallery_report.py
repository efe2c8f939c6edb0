"""Runs the command lines of gallery.toml and keeps their reports, so that a second run is quick."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import zlib
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Iterable

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATASETS = ROOT / "datasets"


class ReportError(RuntimeError):
    """A command line that leaves no report."""


def named_files(text: str) -> set[pathlib.Path]:
    """The files of datasets/ that a text names, and those that they name."""
    out: set[pathlib.Path] = set()
    folders = [ROOT]
    waiting = [text]
    while waiting:
        for name in re.findall(r"[\w./]+\.(?:toml|csv|svg)\b", waiting.pop()):
            for folder in folders:
                file = (folder / name).resolve()
                if file.is_file() and DATASETS in file.parents and file not in out:
                    out.add(file)
                    folders.append(file.parent)
                    waiting.append(file.read_text(encoding="utf-8"))
    return out


def document_of(page: str) -> dict[str, Any]:
    """The JSON object that a page of `--html` shows."""
    found = re.search(r'<script type="text/plain" id="document">(.*?)</script>', page, re.DOTALL)
    if found is None:
        raise ReportError("no document in the page")
    return dict(json.loads(zlib.decompress(base64.b64decode(found[1]))))


class Reports:
    """The reports of command lines that are run one after the other, in a folder that is kept."""

    def __init__(self, program: pathlib.Path, kept: pathlib.Path) -> None:
        self.program = program.resolve()
        self.kept = kept
        self.seal = hashlib.sha256(program.read_bytes()).hexdigest()
        kept.mkdir(parents=True, exist_ok=True)

    def file_of(self, lines: tuple[str, ...]) -> pathlib.Path:
        """Where the report of the last of these command lines is kept."""
        key = hashlib.sha256("\n".join([self.seal, *lines]).encode())
        for file in sorted(named_files("\n".join(lines))):
            key.update(file.read_bytes())
        return self.kept / f"{key.hexdigest()[:24]}.html"

    def make(self, lines: tuple[str, ...]) -> pathlib.Path:
        """The report of the last command line, run after the others in a folder with a link to datasets/."""
        file = self.file_of(lines)
        if file.is_file():
            return file
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "datasets").symlink_to(DATASETS)
            environment = {**os.environ, "PATH": f"{self.program.parent}:{os.environ['PATH']}"}
            for k, line in enumerate(lines):
                words = shlex.split(line) + (["--html", "report.html"] if k + 1 == len(lines) else [])
                run = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
                if run.returncode > 1:
                    raise ReportError(f"{line}: {run.stderr.strip()}")
            report = folder / "report.html"
            if not report.is_file():
                raise ReportError(f"{line}: no report; {run.stdout.strip()}")
            made = file.with_suffix(f".{os.getpid()}")
            made.write_bytes(report.read_bytes())
            made.replace(file)
        return file

    def make_all(self, wanted: Iterable[tuple[str, ...]]) -> None:
        """The same of many, on all cores. Raises one error with all that went wrong."""
        faults = []

        def make(lines: tuple[str, ...]) -> None:
            try:
                self.make(lines)
            except ReportError as error:
                faults.append(str(error))

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(make, wanted))
        if faults:
            raise ReportError("\n".join(faults))

    def forget_others(self, wanted: Iterable[tuple[str, ...]]) -> None:
        """Takes away the reports of former programs, scenes and command lines."""
        now = {self.file_of(lines) for lines in wanted}
        for file in self.kept.iterdir():
            if file not in now:
                file.unlink()
