"""Wrong calls of everything public never crash or hang the interpreter, and are answered by one line.

A few hundred in `make test`; 10 000 with another seed in each round of `make campaign TESTS=Python.misuse`.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
ROUND = int(os.environ.get("POISE_CAMPAIGN", "0"))
SEED = 40_001 + 1_000_003 * ROUND
CALLS = 250  # of one process
PROCESSES = 2 if ROUND == 0 else 40


@pytest.mark.parametrize("part", range(PROCESSES))
def test_wrong_calls_are_answered(part, tmp_path):
    shutil.copyfile(SOURCE / "datasets" / "toggle_clamp.toml", tmp_path / "clamp.toml")
    shutil.copytree(SOURCE / "datasets", tmp_path / "datasets")  # a copy: calls may write files
    log = tmp_path / "calls.txt"
    run = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("misuse.py")), f"{SEED}:{part}", str(CALLS), str(log)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        errors="replace",
        env=os.environ | {"MPLBACKEND": "Agg", "BROWSER": "true"},
    )
    calls = log.read_text().splitlines()[1:]
    assert run.returncode == 0, f"{calls[-1] if calls else 'no call'}\n{run.stderr[-4000:]}"
    found = json.loads(run.stdout.splitlines()[-1])
    print(found["outcomes"])
    wrong = [f"{calls[one['call']]}\n  {one['error']}: {one['why']}" for one in found["wrong"]]
    assert not wrong, "\n".join(wrong)
    assert sum(found["outcomes"].values()) == CALLS
