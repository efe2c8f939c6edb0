"""Makes programs and modules run where the libraries that they were linked with are not installed.

    bundle_libraries.py --into lib [--hashed-names] [--keep-out libstdc++.so.6] --licences licences FILE...

Copies the shared libraries that the files need, directly or not, into a folder, and lets files and copies find them
there, wherever the folders are moved together. Those of glibc stay out, because they belong to the loader of the
machine; `--keep-out` names another. `--hashed-names` gives the copies names that nothing else has, because a process
loads one library of each name only, which may be that of another wheel and of another version.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from licences import write_licences

GLIBC = re.compile(r"(ld-linux.*|lib(c|m|mvec|dl|rt|pthread|util|resolv|nsl|anl))\.so\.[0-9]+")
# Debian's BLAS and LAPACK are alternatives. The reference is the smallest, and as fast for the small matrices of Poise.
PREFERRED = ("blas", "lapack")
# FLINT can convert to the numbers of NTL, which Poise never does. NTL needs gf2x, which is under the GNU GPL.
LEFT_OUT = ("libntl.so.44",)


def output(*command: object, **variables: str) -> str:
    words = [str(word) for word in command]
    run = subprocess.run(words, env=os.environ | variables, capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"bundle_libraries: {' '.join(words)}: {run.stderr.strip()}")
    return run.stdout


def needed(file: Path) -> list[str]:
    return output("patchelf", "--print-needed", file).split()


def places(files: list[Path]) -> dict[str, Path]:
    """Where this machine has the libraries that the files need, directly or not."""
    libraries = Path(output("gcc", "-print-file-name=libc.so.6").strip()).parent
    folders = ":".join(str(libraries / name) for name in PREFERRED)
    lines = output("ldd", *files, LD_LIBRARY_PATH=folders)
    if missing := re.findall(r"(\S+) => not found", lines):
        raise SystemExit(f"bundle_libraries: not installed here: {', '.join(missing)}")
    return {name: Path(file) for name, file in re.findall(r"(\S+) => (/\S+)", lines)}


def closure(files: list[Path], kept_out: set[str]) -> dict[str, Path]:
    """The libraries to be copied by the names under which they are needed."""
    place = places(files)
    found: dict[str, Path] = {}
    waiting = list(files)
    while waiting:
        for name in needed(waiting.pop()):
            if name in found or name in kept_out or GLIBC.fullmatch(name):
                continue
            found[name] = place[name].resolve()
            if name not in LEFT_OUT:
                waiting.append(found[name])
    return found


def symbols(file: Path, *options: str) -> dict[str, tuple[str, int]]:
    """The dynamic symbols of a library, with their kinds and sizes in bytes."""
    lines = output("nm", "--dynamic", "--format=posix", "--without-symbol-versions", *options, file).splitlines()
    words = [line.split() for line in lines]
    return {word[0]: (word[1], int(word[3], 16) if len(word) > 3 else 0) for word in words}


def stand_in(name: str, library: Path, users: list[Path], folder: Path) -> Path:
    """Makes a library that has the symbols of another that its users ask for. Its functions end the process."""
    has = symbols(library, "--defined-only")
    asked = sorted({symbol for user in users for symbol in symbols(user, "--undefined-only")} & set(has))
    thread_local = {line.split()[-1] for line in output("readelf", "--dyn-syms", "--wide", library).splitlines()
                    if " TLS " in line}
    lines = ["#include <stdio.h>", "#include <stdlib.h>"]
    for number, symbol in enumerate(asked):
        if symbol in thread_local:
            lines.append(f'__thread char held_{number}[{has[symbol][1]}] __asm__("{symbol}") '
                         "__attribute__((aligned(16)));")
        else:
            lines += [f'void called_{number}(void) __asm__("{symbol}");',
                      f"void called_{number}(void) {{",
                      f'  fputs("fatal: {symbol} of {name} is left out of this copy of Poise\\n", stderr);',
                      "  abort();", "}"]
    source = folder / f"{name}.c"
    source.write_text("\n".join(lines) + "\n", encoding="utf-8")
    output("gcc", "-O2", "-shared", "-fPIC", f"-Wl,-soname,{name}", "-o", folder / name, source)
    return folder / name


def hashed(name: str, file: Path) -> str:
    """libblas.so.3 becomes libblas-5a1f0c3e.so.3."""
    stem, ending = name.split(".so", 1)
    return f"{stem}-{hashlib.sha256(file.read_bytes()).hexdigest()[:8]}.so{ending}"


def patch(file: Path, names: dict[str, str], folder: Path) -> None:
    """Lets a file look for its libraries in the folder, before it looks where LD_LIBRARY_PATH says."""
    # One change after the other: patchelf 0.14 mixes up strings of several that it makes at once.
    for name in needed(file):
        new = names.get(name, name)
        if new != name:
            output("patchelf", "--replace-needed", name, new, file)
    beside = os.path.relpath(folder, file.parent)
    output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN" if beside == "." else f"$ORIGIN/{beside}", file)


def bundle(files: list[Path], folder: Path, kept_out: set[str], with_hashes: bool, licences: Path) -> None:
    libraries = closure(files, kept_out)
    left_out = sorted(set(LEFT_OUT) & set(libraries))
    component = "python_debian" if any(".so" in file.suffixes for file in files) else "program"
    debian = {name: file for name, file in libraries.items() if name not in left_out}
    write_licences(licences, component, debian, left_out)
    with tempfile.TemporaryDirectory() as work:
        for name in left_out:
            users = [file for file in [*files, *libraries.values()] if name in needed(file)]
            libraries[name] = stand_in(name, libraries[name], users, Path(work))
        copy_beside(files, libraries, folder, with_hashes)


def copy_beside(files: list[Path], libraries: dict[str, Path], folder: Path, with_hashes: bool) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    names = {name: hashed(name, file) if with_hashes else name for name, file in libraries.items()}
    # Before patchelf moves sections, which strip does not expect.
    output("strip", "--strip-unneeded", *files)
    for name, file in libraries.items():
        copy = folder / names[name]
        shutil.copyfile(file, copy)
        copy.chmod(0o755)
        output("patchelf", "--set-soname", names[name], copy)
        patch(copy, names, folder)
    for file in files:
        patch(file, names, folder)


def main() -> None:
    parser = argparse.ArgumentParser(description="Copies the shared libraries that files need beside them.")
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="programs and modules, which are changed")
    parser.add_argument("--into", type=Path, required=True, help="folder for the copies")
    parser.add_argument("--licences", type=Path, required=True, help="folder for the licences of what is copied")
    parser.add_argument("--hashed-names", action="store_true", help="give the copies names that nothing else has")
    parser.add_argument("--keep-out", action="append", default=[], metavar="NAME", help="a library that is not copied")
    given = parser.parse_args()
    bundle(given.files, given.into, set(given.keep_out), given.hashed_names, given.licences)


if __name__ == "__main__":
    main()
