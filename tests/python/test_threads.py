"""One scene serves several threads with the same bits, work lets other threads run, and nothing leaks."""

import gc
import os
import pickle
import resource
import subprocess
import sys
import threading
import time

import numpy as np
import poise
import pytest


def on_threads(number, work):
    """What work(k) gives on threads of their own; errors are raised here."""
    out, errors = [None] * number, []

    def run(k):
        try:
            out[k] = work(k)
        except BaseException as error:  # noqa: BLE001
            errors.append(error)

    threads = [threading.Thread(target=run, args=(k,)) for k in range(number)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
    return out


@pytest.mark.parametrize("name", ["toggle_clamp", "six_bar", "cam_follower"])
def test_threads_get_the_same_bits(name):
    scene = poise.load(f"datasets/{name}.toml")
    alone = poise.load(f"datasets/{name}.toml").solve()
    # Fresh: the threads race for what is compiled at the first call.
    for rests in on_threads(4, lambda _: [scene.solve() for _ in range(20)]):
        for rest in rests:
            assert np.array_equal(rest.x, alone.x) and rest.radius == alone.radius


def test_threads_change_numbers_of_one_scene():
    scene = poise.load("datasets/toggle_clamp.toml")
    forces = np.linspace(10, 30, 21)
    alone = [poise.load("datasets/toggle_clamp.toml").solve(P=force).x for force in forces]
    for k in on_threads(4, lambda _: [scene.solve(P=force).x for force in forces]):
        assert np.array_equal(k, alone)


def test_work_lets_other_threads_run():
    scene = poise.load("datasets/toggle_clamp.toml")
    done, ticks = threading.Event(), 0

    def work():
        scene.path_many({"spring.rubber.stiffness": np.linspace(300, 500, 12)}, vary=("load.P", 0, 60), jobs=1)
        done.set()

    thread = threading.Thread(target=work)
    begin = time.perf_counter()
    thread.start()
    while not done.wait(1e-3):
        ticks += 1
    thread.join()
    # With the interpreter's lock held it would be one or two.
    assert ticks > 20 * min(1.0, time.perf_counter() - begin)


def test_results_of_other_threads_are_measured_here():
    scene = poise.load("datasets/six_bar.toml")
    rest = on_threads(1, lambda _: scene.solve())[0]
    names = [name for name in scene._core.quantities if name.startswith("reaction.")]
    first = [rest[name] for name in names]
    for values in on_threads(4, lambda _: [rest[name] for name in names]):
        assert np.array_equal(values, first, equal_nan=True)


def test_nothing_but_numpy_is_imported():
    code = "import sys, poise; print(*{'pandas', 'matplotlib', 'scipy', 'IPython'} & set(sys.modules))"
    assert not subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout.split()


def resident():
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")


@pytest.mark.skipif(SANITIZED, reason="the sanitizer keeps what is freed")
@pytest.mark.parametrize(
    "what, first, count",
    [
        ("solves without proof", 2_000, 100_000),
        ("solves with proof", 300, 3_000),
        ("changed numbers", 100, 2_000),
        ("equations", 5_000, 200_000),
        ("certificates", 200, 3_000),
        ("paths", 5, 60),
        ("batches", 50, 500),
        ("wrong calls", 500, 20_000),
        ("pickles", 200, 1_000),
    ],
)
def test_nothing_leaks(what, first, count):
    scene = poise.load("datasets/toggle_clamp.toml")
    x = scene.solve().x
    numbers = iter(np.linspace(1, 30, 100_000))

    def wrong():
        with pytest.raises(poise.InputError):
            scene.equations([1, np.nan, 2])

    work = {
        "solves without proof": lambda: scene.solve(proof=False),
        "solves with proof": lambda: scene.solve()["force.rubber"],
        "changed numbers": lambda: scene.solve({"load.P": next(numbers)}, proof=False),
        "equations": lambda: scene.equations(x),
        "certificates": lambda: scene.certify(x).x,
        "paths": lambda: scene.path_many({"spring.rubber.stiffness": [400.0]}, vary=("load.P", 0, 60), proof=False),
        "batches": lambda: scene.solve_many({"load.P": np.linspace(0, 30, 500)}, of="arm", proved=1)["arm"],
        "wrong calls": wrong,
        "pickles": lambda: pickle.loads(pickle.dumps(scene)).solve(proof=False),
    }[what]
    for _ in range(first):
        work()
    before = resident()
    for _ in range(count):
        work()
    # Each object is larger than the allowance over the count.
    assert resident() - before < max(1_000_000, 20 * count)


@pytest.mark.parametrize("call", [
    "clamp.solve(P=25)", 'clamp.path_many({"spring.rubber.stiffness": [400.0] * 50}, vary=("load.P", 0, 60))',
    'clamp.path("load.P", 0, 60, progress=lambda doing: None)',
])
def test_a_daemon_thread_in_a_call_does_not_abort_the_end_of_the_program(call):
    program = f"""
import threading, time, poise
clamp = poise.load("datasets/toggle_clamp.toml")
threading.Thread(target=lambda: [{call} for _ in range(10**5)], daemon=True).start()
time.sleep(0.3)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0 and run.stderr == ""
