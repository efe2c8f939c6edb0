"""The licences of what Poise comes with: those of the Debian packages that libraries are of, and of those in
cmake/dependencies.cmake, whose headers and static libraries are compiled in.

    licences.py COMPONENT    prints the file copyright of a Debian package: of program, mpi, dev or python_debian
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
DOCUMENTS = Path("/usr/share/doc")
POISE = SOURCE / "LICENSE"
UPLOT = SOURCE / "app" / "page" / "vendor" / "uplot" / "LICENSE"

# Of MPI and Python only headers are used, and they are not passed on.
NOT_COMPILED_IN = ("libopenmpi-dev", "python3-dev")
# What components have less than the Python module, which has everything.
NOT_IN = {
    "program": ["pybind11-dev"],
    "dev": ["pybind11-dev", "libcli11-dev", "nlohmann-json3-dev"],
    "python_debian": [],
}

# Packages whose copyright names the GNU GPL too, of other files or with an exception, and what their library is under.
SUITE_SPARSE = "unlike CHOLMOD, SPQR and UMFPACK of the same sources"
RUNTIME = "GPL-3+ with the GCC Runtime Library Exception"
NOT_GPL = {
    "libamd2": f"BSD-3-clause, {SUITE_SPARSE}",
    "libcxsparse3": f"LGPL-2.1+, {SUITE_SPARSE}",
    "libgcc-s1": RUNTIME,
    "libgfortran5": RUNTIME,
    "libgmp10": "LGPL-3+ or GPL-2+",
    "libldl2": f"LGPL-2.1+, {SUITE_SPARSE}",
    "liblzma5": "in the public domain",
    "libquadmath0": "LGPL-2.1+",
    "libstdc++6": RUNTIME,
    "libsuitesparse-dev": f"AMD under BSD-3-clause and LDL under LGPL-2.1+, {SUITE_SPARSE}",
    "libsuitesparseconfig5": f"without restrictions, {SUITE_SPARSE}",
}


def compiled_in(component: str) -> list[str]:
    """The packages that it is compiled with: those of dependencies.cmake but for tests and benchmarks."""
    lines = (SOURCE / "cmake" / "dependencies.cmake").read_text().split("if(POISE_BUILD_TESTS)")[0]
    packages = re.findall(r"# apt: (.*)", lines)
    names = [name for line in packages for name in line.split()]
    left_out = [*NOT_COMPILED_IN, *NOT_IN[component]]
    return [name for name in names if name.endswith("-dev") and name not in left_out]


def text_of(package: str) -> str:
    """The file copyright of a package."""
    text = (DOCUMENTS / package / "copyright").read_text(encoding="utf-8", errors="replace")
    if package != "libboost-dev":
        return text
    # This package has nothing but the name of another, whose file copyright has 2 MB. Headers are under one licence.
    (headers,) = re.findall(r"libboost[0-9.]+-dev", dpkg_query("${Depends}", package))
    stanza = re.search(r"^License: BSL-1.0\n((?: .*\n)+)", text_of(headers), flags=re.MULTILINE)
    if stanza is None:
        raise SystemExit(f"licences: {DOCUMENTS / headers / 'copyright'}: expected the text of License: BSL-1.0")
    return "Boost, https://www.boost.org, copyright of its authors\n\n" + stanza[0]


def version_of(package: str) -> str:
    return dpkg_query("${Version}", package)


def dpkg_query(field: str, package: str) -> str:
    command = ["dpkg-query", "--show", "--showformat", field, package]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def packages_of(libraries: dict[str, Path]) -> dict[str, str]:
    """The Debian packages that the libraries come from, by their names."""
    # Where /lib is a link to /usr/lib, packages may name either.
    names = {str(file): name for name, file in libraries.items()}
    names |= {place.removeprefix("/usr"): name for place, name in names.items()}
    run = subprocess.run(["dpkg-query", "--search", *names], capture_output=True, text=True)
    lines = re.findall(r"^([^:,\s]+)(?::\S+)?: (/.*)$", run.stdout, flags=re.MULTILINE)
    found = {names[place]: package for package, place in lines}
    if unknown := set(libraries) - set(found):
        raise SystemExit(f"licences: {', '.join(sorted(unknown))}: expected files of Debian packages, whose licences "
                         "are known")
    return found


def names_gpl(copyright_text: str) -> bool:
    """Whether a copyright file of Debian has files under the GNU GPL, other than those by which Debian packs them."""
    if re.search(r"^Files:", copyright_text, flags=re.MULTILINE) is None:
        return re.search(r"(?<!Lesser )(?<!Library )General\s+Public\s+License", copyright_text) is not None
    for paragraph in re.split(r"\n\s*\n", copyright_text):
        files = re.search(r"^Files:\s*(\S.*)", paragraph, flags=re.MULTILINE)
        licence = re.search(r"^License:\s*(\S.*)", paragraph, flags=re.MULTILINE)
        if files and files[1].strip() != "debian/*" and licence and re.search(r"\bGPL", licence[1]):
            return True
    return False


def refuse_gpl(packages: list[str]) -> None:
    """Ends where a package is under the GNU GPL, which forbids to pass it on with Ipopt."""
    for package in packages:
        if package not in NOT_GPL and names_gpl(text_of(package)):
            raise SystemExit(f"licences: {package}: expected no library under the GNU GPL, which cannot be given to "
                             f"others together with Ipopt; if the library is under another licence than what "
                             f"{DOCUMENTS / package / 'copyright'} says of the GPL, name it in NOT_GPL")


class Licences:
    """A folder of licences: each text once, by the first package that has it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names: dict[str, str] = {}
        folder.mkdir(parents=True, exist_ok=True)

    def has(self, package: str) -> bool:
        return text_of(package) in self.names

    def add(self, package: str) -> str:
        """The name of the file with the licence of a package."""
        text = text_of(package)
        if text not in self.names:
            self.names[text] = f"{package}.txt"
            (self.folder / self.names[text]).write_text(text, encoding="utf-8")
            # Debian has the text of common licences once, and names its place.
            for common in re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])", text):
                if (DOCUMENTS.parent / "common-licenses" / common).exists():
                    shutil.copyfile(DOCUMENTS.parent / "common-licenses" / common, self.folder / f"{common}.txt")
        return self.names[text]


def write_licences(folder: Path, component: str, libraries: dict[str, Path], stand_ins: list[str]) -> None:
    """Writes the licences of libraries that are copied, and of what the component is compiled with, with an index of
    them. `stand_ins` are libraries that are ours."""
    of_package: dict[str, list[str]] = {}
    for name, package in sorted(packages_of(libraries).items()):
        of_package.setdefault(package, []).append(name)
    compiled = compiled_in(component)
    refuse_gpl([*of_package, *compiled])
    licences = Licences(folder)
    rows = [(licences.add(package), package, " ".join(names)) for package, names in sorted(of_package.items())]
    # The headers of a library that is copied are under its licence.
    rows += [(licences.add(package), package, "compiled in") for package in compiled if not licences.has(package)]
    shutil.copyfile(POISE, folder / "poise.txt")
    shutil.copyfile(UPLOT, folder / "uplot.txt")
    lines = [f"{'uplot.txt':26} uPlot, in pages for the browser"]
    lines += [f"{'poise.txt':26} {name} in the place of Debian's, which Poise never calls" for name in stand_ins]
    for file, package, what in rows:
        remark = f" ({NOT_GPL[package]})" if package in NOT_GPL else ""
        lines.append(f"{file:26} {package}={version_of(package)}: {what}{remark}")
    (folder / "README.txt").write_text(
        "Poise is under the MIT license (poise.txt). It comes with libraries of Debian, unchanged but for names and\n"
        "folders by which they find each other, and is compiled with others. Their licences are in the files of this\n"
        "folder; their sources are those of the Debian package in the version named here:\n"
        "`apt-get source PACKAGE=VERSION`, or https://snapshot.debian.org. Where a licence names\n"
        "/usr/share/common-licenses/NAME, that is NAME.txt here. Each library is a file of its own, which may\n"
        "be replaced by another build of it. A licence may also be that of files that are not here: what is said in\n"
        "brackets is that of the library. No library is under the GNU GPL without an exception.\n"
        "\n" + "\n".join(lines) + "\n", encoding="utf-8")


def debian_copyright(component: str) -> str:
    """The file copyright of a Debian package of Poise. Shared libraries are in packages of their own."""
    parts = [f"Poise\n\n{POISE.read_text()}"]
    if component in ("program", "python_debian"):
        parts.append(f"The pages that Poise writes contain uPlot\n\n{UPLOT.read_text()}")
    if component in NOT_IN:
        packages = compiled_in(component)
        refuse_gpl(packages)
        texts: dict[str, list[str]] = {}
        for package in packages:
            texts.setdefault(text_of(package), []).append(package)
        parts.append("Headers and static libraries of other Debian packages are compiled in. Their files copyright\n"
                     "follow, which also name files that are not compiled in.")
        for text, names in texts.items():
            versions = " and ".join(f"{name} {version_of(name)}" for name in names)
            parts.append(f"Compiled in: {versions}\n\n{text}")
    rule = "-" * 80
    return f"\n{rule}\n\n".join(part.rstrip("\n") + "\n" for part in parts)


if __name__ == "__main__":
    print(debian_copyright(sys.argv[1]), end="")
