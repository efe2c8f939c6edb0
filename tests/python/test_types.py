"""Types: the package is checked strictly, its stub fits the compiled part, and wrong programs of users are noticed."""

import os
import re
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["POISE_BUILD_FOLDER"])
CACHE = ["--cache-dir", str(BUILD / "mypy")]


def checked(*words):
    """Exit code and lines of a program of mypy, to which the package is one that a user has installed."""
    environment = {key: value for key, value in os.environ.items() if key != "LD_PRELOAD" or "stubtest" in words[0]}
    environment["MYPYPATH"] = str(BUILD / "python")
    run = subprocess.run([sys.executable, "-m", *words], cwd=SOURCE, env=environment, capture_output=True, text=True)
    return run.returncode, (run.stdout + run.stderr).splitlines()


def test_package_is_strict():
    code, lines = checked("mypy", "--strict", *CACHE, "-p", "poise")
    assert code == 0, "\n".join(lines)


def test_stub_fits_the_compiled_part():
    _, lines = checked("mypy.stubtest", "poise._poise", "--concise", "--mypy-config-file", "pyproject.toml")
    # Classes of pybind11 have a metaclass of their own, and say nothing of what they are made of.
    of_pybind = re.compile(r"metaclass differs$|__init__ is inconsistent, stub does not have \*args|^Success")
    wrong = [line for line in lines if not of_pybind.search(line)]
    assert not wrong, "\n".join(wrong)


# A line that ends with "# wrong: CODE" has an error of this code, and no other line has any.
PROGRAM = '''
import numpy as np
import poise

clamp = poise.load("datasets/toggle_clamp.toml")
poise.load(3)                                       # wrong: arg-type
rest = clamp.solve(P=25)
clamp.solved(P=25)                                  # wrong: attr-defined
if rest.proved + 1 > 0:                             # wrong: operator
    pass
handle: float = rest.angle["handle"]
name: str = rest.angle["handle"]                    # wrong: assignment
rest.angle[3]                                       # wrong: index
force: float = rest["force.rubber"]
radius: float = rest.radius                         # wrong: assignment
curve = clamp.path("load.P", 0, 60)
for event in curve.events:
    print(event["load.P"])
curve.evens                                         # wrong: attr-defined
clamp.path("load.P", "a lot", 60)                   # wrong: arg-type
data: dict[str, object] = rest.to_dict()
text: str = rest.text("verbose")
rest.text(2)                                        # wrong: arg-type
try:
    poise.load("nowhere.toml")
except poise.InputError as error:
    print(error)
'''


def test_errors_of_programs_are_noticed(tmp_path):
    file = tmp_path / "program.py"
    file.write_text(PROGRAM)
    _, lines = checked("mypy", "--strict", *CACHE, "--no-error-summary", str(file))
    expected = {
        (number, found.group(1))
        for number, line in enumerate(PROGRAM.splitlines(), 1)
        if (found := re.search(r"# wrong: ([a-z-]+)$", line))
    }
    errors = [re.search(r":([0-9]+): error: .*\[([a-z-]+)\]$", line) for line in lines]
    assert {(int(error[1]), error[2]) for error in errors if error} == expected, "\n".join(lines)
