"""The module is installed, by pip and by CMake, and works from there: nothing is compiled a second time."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["POISE_BUILD_FOLDER"])
PROGRAM = """
import pathlib, poise
print(pathlib.Path(poise.__file__).parent)
print(poise.__version__)
try:
    poise.load("nowhere.toml")
except poise.InputError as error:
    print(type(error).__mro__[1].__name__)
print(poise.example("toggle_clamp").solve().verdict)
"""
FILES = {"__init__.py", "py.typed", "_poise.pyi", "_found.py", "_scene.py"}


def output(*command, **variables):
    """What a command prints in an environment that knows of no other poise."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    run = subprocess.run(
        [str(word) for word in command], cwd=SOURCE, env=environment | variables, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


@pytest.fixture(scope="module")
def venv(tmp_path_factory):
    """A virtual environment with Debian's packages, and poise installed into it by pip."""
    folder = tmp_path_factory.mktemp("venv")
    output(sys.executable, "-m", "venv", "--system-site-packages", folder)
    output(
        folder / "bin" / "python", "-m", "pip", "install", "--no-build-isolation", "--no-index", "--quiet",
        "--disable-pip-version-check", SOURCE, POISE_BUILD_FOLDER=str(BUILD),
    )
    return folder


def test_pip_installs_what_runs_elsewhere(venv, tmp_path):
    folder, version, error, verdict = output(venv / "bin" / "python", "-c", PROGRAM).splitlines()
    assert Path(folder).is_relative_to(venv)
    assert f"project(poise VERSION {version} " in (SOURCE / "CMakeLists.txt").read_text()
    assert error == "ValueError"
    assert verdict == "In equilibrium, proved: stable."
    assert f"Version: {version}" in output(venv / "bin" / "python", "-m", "pip", "show", "poise")


def files_below(folder):
    return {file.relative_to(folder) for file in folder.rglob("*") if file.is_file()}


def test_pip_installs_types_and_examples(venv):
    folder = Path(output(venv / "bin" / "python", "-c", PROGRAM).splitlines()[0])
    installed = {file.name for file in folder.iterdir() if file.is_file()}
    sources = {file.name for file in (SOURCE / "python" / "poise").iterdir() if file.is_file()}
    libraries = [name for name in installed if name.endswith(".so")]
    assert FILES <= installed
    assert len(libraries) == 1 and installed - set(libraries) == sources
    assert files_below(folder / "datasets") == files_below(SOURCE / "datasets")


def test_cmake_installs_the_same(tmp_path):
    output("cmake", "--install", BUILD, "--component", "python", DESTDIR=str(tmp_path))
    (folder,) = tmp_path.rglob("poise/__init__.py")
    folder = folder.parent
    assert FILES <= {file.name for file in folder.iterdir()}
    assert files_below(folder / "datasets") == files_below(SOURCE / "datasets")
    found = output(sys.executable, "-c", PROGRAM, PYTHONPATH=str(folder.parent)).splitlines()[0]
    assert Path(found) == folder
