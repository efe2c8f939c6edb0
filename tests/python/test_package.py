"""Programs are packed with their libraries and run where these are not; wheels name the glibc that they need."""

import datetime
import os
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
SCRIPTS = SOURCE / "cmake" / "package"
GLIBC = re.compile(r"lib(c|m|mvec|dl|rt|pthread)\.so\.[0-9]+")


def output(*command):
    run = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


@pytest.mark.skipif("POISE_SANITIZED" in os.environ, reason="the address sanitizer's library is loaded before others")
@pytest.mark.parametrize("names", [[], ["--hashed-names"]])
def test_a_program_and_its_libraries_run_from_any_folder(names, tmp_path):
    made, moved = tmp_path / "made", tmp_path / "moved elsewhere"
    program = made / "bin" / "poise"
    program.parent.mkdir(parents=True)
    shutil.copyfile(os.environ["POISE_EXECUTABLE"], program)
    program.chmod(0o755)
    output(sys.executable, SCRIPTS / "bundle_libraries.py", "--into", made / "lib", "--licences", made / "licences",
           "--keep-out", "libgcc_s.so.1", *names, program)
    made.rename(moved)
    program = moved / "bin" / "poise"

    loaded = dict(re.findall(r"(\S+) => (/.*) \(", output("ldd", program)))
    foreign = {name for name, file in loaded.items() if not Path(file).is_relative_to(moved)}
    assert {name for name in foreign if not GLIBC.fullmatch(name)} == {"libgcc_s.so.1"}
    assert any(re.fullmatch(r"libipopt-[0-9a-f]{8}\.so\.1" if names else r"libipopt\.so\.1", name) for name in loaded)
    assert "proved: stable" in output(program, "solve", SOURCE / "datasets" / "toggle_clamp.toml", "--method", "energy")

    index = (moved / "licences" / "README.txt").read_text()
    licences = dict(re.findall(r"^(\S+\.txt) +(\S+)", index, flags=re.MULTILINE))
    assert {"poise.txt", *licences} <= {file.name for file in (moved / "licences").iterdir()}
    listed = set(re.findall(r"lib\S+\.so\S*", index))
    stems = {re.sub(r"-[0-9a-f]{8}\.so", ".so", file.name) for file in (moved / "lib").iterdir()}
    assert stems == listed
    assert not [name for name in stems if re.match("lib(cholmod|spqr|umfpack|metis|gf2x|atlas|f77blas)", name)]
    assert "libntl.so.44 in the place of Debian's" in index


@pytest.fixture
def scripts(monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPTS))


def test_a_library_under_the_gpl_is_refused(scripts):
    licences = runpy.run_path(str(SCRIPTS / "licences.py"))
    libraries = {name: next(Path("/usr/lib").rglob(name)).resolve() for name in ("libgf2x.so.3", "libamd.so.2")}
    assert licences["packages_of"](libraries) == {"libgf2x.so.3": "libgf2x3", "libamd.so.2": "libamd2"}
    licences["refuse_gpl"](["libamd2", "libnlopt0", "libgfortran5", "coinor-libipopt1v5"])
    with pytest.raises(SystemExit, match="libgf2x3: expected no library under the GNU GPL"):
        licences["refuse_gpl"](["libamd2", "libgf2x3"])
    with pytest.raises(SystemExit, match="libcholmod3: expected no library under the GNU GPL"):
        licences["refuse_gpl"](["libcholmod3"])


def test_copyright_names_what_is_compiled_in():
    program, module, library, mpi = (output(sys.executable, SCRIPTS / "licences.py", component)
                                     for component in ("program", "python_debian", "dev", "mpi"))
    for text in (program, module, library, mpi):
        assert text.startswith("Poise\n\nMIT License")
    for name in ("libceres-dev", "libeigen3-dev", "librandom123-dev", "libboost-dev", "libcli11-dev", "libsleef-dev"):
        assert f"Compiled in: {name} " in program and f"Compiled in: {name} " in module
    assert "Compiled in: pybind11-dev" in module and "Compiled in: pybind11-dev" not in program
    assert "uPlot" in program and "uPlot" not in library + mpi
    assert "Compiled in" not in mpi
    assert "Boost Software License" in library and "CLI11" not in library


def test_the_changelog_of_debian_is_that_of_poise():
    changelog = runpy.run_path(str(SCRIPTS / "debian_changelog.py"))["debian_changelog"]
    now = datetime.datetime(2026, 3, 1, 12, tzinfo=datetime.timezone.utc)
    text = changelog("""# Changelog

## [0.2.0] - unreleased

### Added

- **Loads.** `poise loads` cuts links
  ([a](docs/a.md), [b](docs/b.md)). See [the page](docs/c.md).
- More.

## [0.1.0] - 2026-01-31

The first version.
""", "poise", "A <a@b.example>", now)
    assert text == """poise (0.2.0) unstable; urgency=medium

  [ Added ]
  * Loads. poise loads cuts links. See the page.
  * More.

 -- A <a@b.example>  Sun, 01 Mar 2026 12:00:00 +0000

poise (0.1.0) unstable; urgency=medium

  * The first version.

 -- A <a@b.example>  Sat, 31 Jan 2026 00:00:00 +0000
"""


def test_links_to_what_is_not_shipped_are_words(tmp_path):
    page = tmp_path / "page.md"
    (tmp_path / "beside.md").write_text("")
    page.write_text("[a](beside.md#b), [`c`](gone.md), ![d](gone.png), [e](https://x.example), [![f](g.png)](h)\n"
                    "```\n[i](gone)\n```\n")
    output(sys.executable, "-B", SCRIPTS / "drop_dead_links.py", tmp_path)
    assert page.read_text() == ("[a](beside.md#b), `c`, d, [e](https://x.example), f\n```\n[i](gone)\n```\n")


def test_the_platform_is_the_oldest_that_has_all_symbols():
    oldest = runpy.run_path(str(SCRIPTS / "platform_tag.py"))["oldest_glibc"]
    assert oldest({("GLIBC", (2, 2, 5)), ("GLIBC", (2, 36)), ("GLIBCXX", (3, 4, 29))}) == (2, 36)
    assert oldest({("GLIBC", (2, 17)), ("GLIBCXX", (3, 4)), ("GLIBCXX", (3, 4, 30))}) == (2, 35)
    assert oldest({("GLIBC", (2, 34)), ("GLIBCXX", (3, 4, 21))}) == (2, 34)
    with pytest.raises(SystemExit, match="GLIBCXX_3.4.99: expected at most"):
        oldest({("GLIBCXX", (3, 4, 99))})


def test_the_platform_is_read_from_files():
    tag = output(sys.executable, SCRIPTS / "platform_tag.py", os.environ["POISE_EXECUTABLE"])
    assert re.fullmatch(r"manylinux_2_[0-9]+_\w+\n", tag)
