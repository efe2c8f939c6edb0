"""What a call from Python costs over the same one in C++, and what a million variants cost.

make bench runs it; alone: PYTHONPATH=build/python /usr/bin/python3 benchmarks/python_calls.py
C++ and Python take turns.
"""

import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable

import numpy as np
import poise
from poise import _poise


def row(name: str, figure: float, unit: str, limit: float | None = None, more: str = "") -> bool:
    kept = limit is None or figure <= limit
    verdict = "" if limit is None else f"limit {limit:g} {'kept' if kept else 'BROKEN'}"
    print(f"{name:<58} {figure:>10.2f} {unit:<4} {verdict:<18} {more}")
    return kept


def quick(times: list[float]) -> float:
    """The fastest tenth is the least disturbed; us."""
    return 1e6 * float(np.quantile(times, 0.1))


def beside(calls: list[Callable[[], float]], rounds: int) -> list[float]:
    """The time of each call, us. They take turns one by one, so that all meet the same machine."""
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(rounds):
        for call, kept in zip(calls, times):
            kept.append(call())
    return [quick(kept) for kept in times]


def timed(work: Callable[[], object]) -> Callable[[], float]:
    def call() -> float:
        begin = time.perf_counter()
        work()
        return time.perf_counter() - begin

    return call


def calls() -> bool:
    kept = True
    for name in ("four_bar_torsion", "toggle_clamp", "six_bar"):
        scene = poise.load(f"datasets/{name}.toml")
        for proof in (True, False):
            in_python = (lambda: scene.solve()) if proof else (lambda: scene.solve(proof=False))
            native = lambda: _poise.seconds_of_solves(scene._core, 1, proof)  # noqa: E731
            in_cpp, python = beside([native, timed(in_python)], 4000)
            what = f"{name}.solve({'' if proof else 'proof=False'}) over C++"
            kept &= row(what, python - in_cpp, "us", 5.0, f"C++ {in_cpp:.1f} us")
    clamp = poise.load("datasets/toggle_clamp.toml")
    forces = iter(np.linspace(20, 30, 2000))
    solves = [lambda: clamp.solve(), lambda: clamp.solve(P=25), lambda: clamp.solve(P=next(forces))]
    same, known, new = beside([timed(work) for work in solves], 2000)
    row("toggle_clamp.solve(P=25), a number met before, over solve()", known - same, "us")
    row("toggle_clamp.solve(P=...), a new number, over solve()", new - same, "us")
    x, out = clamp.start(), np.empty(3)
    system = clamp.system()
    evaluations = [lambda: clamp.equations(x), lambda: system.equations(x, out=out), lambda: clamp.jacobian(x)]
    for what, took in zip(("clamp.equations(x)", "system.equations(x, out=out)", "clamp.jacobian(x)"),
                          beside([timed(work) for work in evaluations], 20000)):
        row(what, took, "us")
    return kept


def imports() -> bool:
    """In fresh processes, which have the files compiled, as an installed package has."""
    folder = tempfile.TemporaryDirectory()
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    kept["PYTHONPYCACHEPREFIX"] = folder.name

    def took(statement: str) -> tuple[float, float]:
        clocks = "(time.perf_counter(), time.process_time())"
        code = f"import time; a = {clocks}; {statement}; b = {clocks}; print(b[0] - a[0], b[1] - a[1])"
        run = [sys.executable, "-c", code]
        times = [subprocess.run(run, env=kept, capture_output=True, check=True).stdout.split() for _ in range(10)]
        return 1e3 * min(float(wall) for wall, _ in times), 1e3 * min(float(cpu) for _, cpu in times)

    numpy, ours = took("import numpy"), took("import poise")
    # Where others work too, the time of the processor is what it takes alone.
    return row("import poise, time of the processor", ours[1], "ms", 100.0,
               f"of which numpy {numpy[1]:.1f}; by the clock {ours[0]:.1f} and {numpy[0]:.1f} ms")


def threads() -> None:
    scene = poise.load("datasets/six_bar.toml")

    def took(number: int) -> float:
        workers = [threading.Thread(target=lambda: [scene.solve() for _ in range(400)]) for _ in range(number)]
        begin = time.perf_counter()
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        return time.perf_counter() - begin

    one, two = min(took(1) for _ in range(3)), min(took(2) for _ in range(3))
    row("solves on two threads of Python: times as many as on one", 2 * one / two, "")


def batches() -> None:
    clamp = poise.load("datasets/toggle_clamp.toml")
    rng = np.random.default_rng(1)
    stiffness = 400 * (1 + 0.02 * rng.standard_normal(1_000_000))
    force = 25 + 2 * rng.standard_normal(1_000_000)
    for jobs in (1, 2):
        begin = time.perf_counter()
        many = clamp.solve_many({"load.P": force, "spring.rubber.stiffness": stiffness}, of="force.rubber", jobs=jobs)
        each = (time.perf_counter() - begin) / many.variants
        row(f"solve_many of 10^6 clamps, {jobs} thread{'s'[:jobs > 1]}, each", 1e6 * each, "us", None, many.simd)


if __name__ == "__main__":
    good = calls() & imports()
    threads()
    batches()
    sys.exit(0 if good else 1)
