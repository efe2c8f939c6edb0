"""Makes programs and modules run where the libraries that they were linked with are not installed.

    bundle_libraries.py --into lib [--hashed-names] [--keep-out libstdc++.so.6] --licences licences FILE...

Copies the shared libraries that the files need, directly or not, into a folder, and lets files and copies find them
there, wherever the folders are moved together. Those of glibc stay out, because they belong to the loader of the
machine; `--keep-out` names another. `--hashed-names` gives the copies names that nothing else has, because a process
loads one library of each name only, which may be that of another wheel and of another version.

The licences are those of the Debian packages that the libraries come from, and of those in cmake/dependencies.cmake,
whose headers and static libraries are compiled in.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
DOCUMENTS = Path("/usr/share/doc")
GLIBC = re.compile(r"(ld-linux.*|lib(c|m|mvec|dl|rt|pthread|util|resolv|nsl|anl))\.so\.[0-9]+")
# Debian's BLAS and LAPACK are alternatives. The reference is the smallest, and as fast for the small matrices of Poise.
PREFERRED = ("blas", "lapack")
# Debian's Ceres is linked with the BLAS of ATLAS under its own name. Any BLAS has the same functions.
ANOTHER = {"libf77blas.so.3": "libblas.so.3"}

# Of MPI and Python only headers are used, and they are not passed on.
NOT_COMPILED_IN = ("libopenmpi-dev", "python3-dev")


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
            name = ANOTHER.get(name, name)
            if name in found or name in kept_out or GLIBC.fullmatch(name):
                continue
            found[name] = place[name].resolve()
            waiting.append(found[name])
    return found


def hashed(name: str, file: Path) -> str:
    """libblas.so.3 becomes libblas-5a1f0c3e.so.3."""
    stem, ending = name.split(".so", 1)
    return f"{stem}-{hashlib.sha256(file.read_bytes()).hexdigest()[:8]}.so{ending}"


def patch(file: Path, names: dict[str, str], folder: Path) -> None:
    """Lets a file look for its libraries in the folder, before it looks where LD_LIBRARY_PATH says."""
    # One change after the other: patchelf 0.14 mixes up strings of several that it makes at once.
    for name in needed(file):
        new = names.get(ANOTHER.get(name, name), name)
        if new != name:
            output("patchelf", "--replace-needed", name, new, file)
    beside = os.path.relpath(folder, file.parent)
    output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN" if beside == "." else f"$ORIGIN/{beside}", file)


def packages_of(libraries: dict[str, Path]) -> dict[str, str]:
    """The Debian packages that the libraries come from, by their names."""
    # Where /lib is a link to /usr/lib, packages may name either.
    names = {str(file): name for name, file in libraries.items()}
    names |= {place.removeprefix("/usr"): name for place, name in names.items()}
    run = subprocess.run(["dpkg-query", "--search", *names], capture_output=True, text=True)
    lines = re.findall(r"^([^:,\s]+)(?::\S+)?: (/.*)$", run.stdout, flags=re.MULTILINE)
    found = {names[place]: package for package, place in lines}
    if unknown := set(libraries) - set(found):
        raise SystemExit(f"bundle_libraries: {', '.join(sorted(unknown))}: expected files of Debian packages, whose "
                         "licences are known")
    return found


def compiled_in() -> list[str]:
    """The packages that Poise is compiled with: those of dependencies.cmake but for tests and benchmarks."""
    lines = (SOURCE / "cmake" / "dependencies.cmake").read_text().split("if(POISE_BUILD_TESTS)")[0]
    packages = re.findall(r"# apt: (.*)", lines)
    names = [name for line in packages for name in line.split()]
    return [name for name in names if name.endswith("-dev") and name not in NOT_COMPILED_IN]


class Licences:
    """A folder of licences: each text once, by the first package that has it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names: dict[str, str] = {}
        folder.mkdir(parents=True, exist_ok=True)

    def has(self, package: str) -> bool:
        return self._text(package) in self.names

    def add(self, package: str) -> str:
        """The name of the file with the licence of a package."""
        text = self._text(package)
        if text not in self.names:
            self.names[text] = f"{package}.txt"
            (self.folder / self.names[text]).write_text(text, encoding="utf-8")
            # Debian has the text of common licences once, and names its place.
            for common in re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])", text):
                if (DOCUMENTS.parent / "common-licenses" / common).exists():
                    shutil.copyfile(DOCUMENTS.parent / "common-licenses" / common, self.folder / f"{common}.txt")
        return self.names[text]

    @staticmethod
    def _text(package: str) -> str:
        return (DOCUMENTS / package / "copyright").read_text(encoding="utf-8", errors="replace")


def write_licences(folder: Path, libraries: dict[str, Path]) -> None:
    licences = Licences(folder)
    of_package: dict[str, list[str]] = {}
    for name, package in sorted(packages_of(libraries).items()):
        of_package.setdefault(package, []).append(name)
    rows = [(licences.add(package), package, " ".join(names)) for package, names in sorted(of_package.items())]
    # The headers of a library that is copied are under its licence.
    compiled = [package for package in compiled_in() if not licences.has(package)]
    rows += [(licences.add(package), package, "compiled in") for package in compiled]
    shutil.copyfile(SOURCE / "LICENSE", folder / "poise.txt")
    shutil.copyfile(SOURCE / "app" / "page" / "vendor" / "uplot" / "LICENSE", folder / "uplot.txt")
    versions = [output("dpkg-query", "--show", "--showformat", "${Version}", package) for _, package, _ in rows]
    lines = [f"{file:26} {package}={version}: {what}" for (file, package, what), version in zip(rows, versions)]
    (folder / "README.txt").write_text(
        "Poise is under the MIT license (poise.txt). It comes with libraries of Debian, unchanged but for names and\n"
        "folders by which they find each other, and is compiled with others. Their licences are in the files of this\n"
        "folder; their sources are those of the Debian package in the version named here:\n"
        "`apt-get source PACKAGE=VERSION`, or https://snapshot.debian.org. Where a licence names\n"
        "/usr/share/common-licenses/NAME, that is NAME.txt here. Each library is a file of its own, which may\n"
        "be replaced by another build of it. Parts of CHOLMOD (libcholmod3), with which Ceres Solver is linked, are\n"
        "under the GNU GPL.\n"
        "\n"
        f"{'uplot.txt':26} uPlot, in pages for the browser\n" + "\n".join(lines) + "\n", encoding="utf-8")


def bundle(files: list[Path], folder: Path, kept_out: set[str], with_hashes: bool) -> dict[str, Path]:
    folder.mkdir(parents=True, exist_ok=True)
    libraries = closure(files, kept_out)
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
    return libraries


def main() -> None:
    parser = argparse.ArgumentParser(description="Copies the shared libraries that files need beside them.")
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="programs and modules, which are changed")
    parser.add_argument("--into", type=Path, required=True, help="folder for the copies")
    parser.add_argument("--licences", type=Path, required=True, help="folder for the licences of what is copied")
    parser.add_argument("--hashed-names", action="store_true", help="give the copies names that nothing else has")
    parser.add_argument("--keep-out", action="append", default=[], metavar="NAME", help="a library that is not copied")
    given = parser.parse_args()
    libraries = bundle(given.files, given.into, set(given.keep_out), given.hashed_names)
    write_licences(given.licences, libraries)


if __name__ == "__main__":
    main()
