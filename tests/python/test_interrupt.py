"""Ctrl-C stops long work, which returns what it has."""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import poise
import pytest

EXPERIMENT = "datasets/lift_experiment.toml"

#: Each runs for minutes where nothing stops it.
LONG_CALLS = {
    "equilibria": 'poise.load("datasets/double_pendulum.toml").equilibria(seconds=0, starts=1000000, jobs=1, **told)',
    "tolerance":
        'poise.load("datasets/toggle_clamp.toml").tolerance({"point.*": 0.1}, "force.rubber", samples=10**7, **told)',
    "montecarlo": f'poise.montecarlo("{EXPERIMENT}", trials=1000000, **told)',
    "identify": f'poise.identify("{EXPERIMENT}", bootstrap=1000000, **told)',
    "design": 'poise.design("datasets/eighteen_points_design.toml", starts=1_000_000, **told)',
    "kept trials": f'poise.montecarlo("{EXPERIMENT}", trials=1000000, output="trials", **told)',
}

#: Says when the work is going on; then waits for the signal that its parent sends.
PROGRAM = """
import json, poise
begun = []
def tell(doing):
    if not begun:
        begun.append(doing)
        print("begun", flush=True)
told = {"progress": tell}
found = CALL
print(json.dumps({"text": found.text(), "code": found.code, "svg": found.svg}))
"""


def interrupted(call, folder):
    program = PROGRAM.replace("CALL", call.replace("datasets/", os.getcwd() + "/datasets/"))
    environment = {**os.environ, "TMPDIR": str(folder / "tmp")}
    (folder / "tmp").mkdir()
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          cwd=folder, env=environment) as process:
        try:
            assert process.stdout.readline() == "begun\n", process.stderr.read()
            process.send_signal(signal.SIGINT)
            out, errors = process.communicate(timeout=30)
        finally:
            process.kill()
    assert process.returncode == 0, errors
    return json.loads(out)


@pytest.mark.parametrize("name", LONG_CALLS)
def test_it_returns_what_it_has(name, tmp_path):
    found = interrupted(LONG_CALLS[name], tmp_path)
    assert "interrupted" in found["text"].lower()
    # Nothing is left of temporary files, and of what is kept no file is half written.
    assert list((tmp_path / "tmp").iterdir()) == []
    kept = [file for file in tmp_path.rglob("*") if file.is_file()]
    assert (kept != []) == (name == "kept trials")
    for file in kept:
        assert not file.name.endswith((".tmp", ".part")) and file.stat().st_size > 0


def test_a_call_in_another_thread_is_stopped_by_its_progress():
    stop = threading.Event()
    raised = []

    def tell(doing):
        if stop.is_set():
            raise KeyboardInterrupt

    def work():
        try:
            poise.montecarlo(EXPERIMENT, trials=1000000, progress=tell)
        except KeyboardInterrupt:
            raised.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    stop.set()
    thread.join(timeout=30)
    assert raised == [True] and not thread.is_alive()


def test_a_call_of_the_main_thread_is_stopped_and_that_of_another_goes_on():
    found = {}
    main_goes_on = threading.Event()

    def work():
        main_goes_on.wait(30)
        os.kill(os.getpid(), signal.SIGINT)
        found["other"] = poise.montecarlo(EXPERIMENT, trials=3, jobs=1)

    thread = threading.Thread(target=work)
    thread.start()
    found["main"] = poise.montecarlo(EXPERIMENT, trials=1000000, progress=lambda doing: main_goes_on.set())
    thread.join(timeout=30)
    assert found["main"].to_dict()["interrupted"] is True
    assert found["other"].to_dict()["interrupted"] is False and found["other"].to_dict()["trials"] == 3


def test_what_was_interrupted_is_not_computed_again_for_its_picture():
    scene = poise.load("datasets/toggle_clamp.toml")
    time.sleep(2.1)  # a second Ctrl-C within two seconds is Python's
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    curve = scene.path("load.P", 0, 60, variant={str(k): {"spring.rubber.stiffness": 300 + k} for k in range(200)},
                       search=1000)
    timer.join()
    assert curve.svg == "" and "interrupted" in curve.text().lower()


#: Calls that have ended before anybody wants to stop them; a loop over them ends by Ctrl-C all the same.
LOOPS = {
    "check": "scene.check()",
    "find": 'scene.find("spring.rubber.stiffness", 300, 500, "force.rubber = -700")',
    "solve_many": 'scene.solve_many({"load.P": [1.0, 2.0]})',
    "solve": "scene.solve()",
}


@pytest.mark.parametrize("name", LOOPS)
def test_a_loop_over_short_calls_ends(name):
    program = f"""
import poise
scene = poise.load("datasets/toggle_clamp.toml")
print("begun", flush=True)
try:
    while True:
        {LOOPS[name]}
except KeyboardInterrupt:
    print("ended", flush=True)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "begun\n"
            for _ in range(2):  # one that cuts a call short, and one behind it
                time.sleep(0.3)
                if process.poll() is None:
                    process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=20)
        finally:
            process.kill()
    assert out == "ended\n"


class Interrupted:
    """An object during whose conversion Ctrl-C comes."""

    def stop(self, *_, **__):
        raise KeyboardInterrupt

    __array__ = __float__ = __getitem__ = __iter__ = __len__ = stop


@pytest.mark.parametrize("call", [
    lambda scene, value: scene.solve(P=value),
    lambda scene, value: scene.with_numbers(P=value),
    lambda scene, value: scene.solve_many({"load.P": value}),
    lambda scene, value: scene.solve_many({"load.P": [1.0, value]}),
    lambda scene, value: scene.path_many({"spring.rubber.stiffness": value}, "load.P", 0, 60),
    lambda scene, value: scene.path("load.P", value, 60),
    lambda scene, value: scene.equations(value),
    lambda scene, value: scene.certify(value),
    lambda scene, value: poise.Scene("a").body("b", mass=value),
])
def test_ctrl_c_during_a_conversion_is_not_taken_for_a_wrong_value(call):
    with pytest.raises(KeyboardInterrupt):
        call(poise.load("datasets/toggle_clamp.toml"), Interrupted())


def test_a_handler_of_the_program_is_left_alone():
    program = """
import signal, poise
called = []
signal.signal(signal.SIGINT, lambda *_: called.append(1))
scene = poise.load("datasets/double_pendulum.toml")
def tell(doing):
    if not called:
        signal.raise_signal(signal.SIGINT)
found = scene.equilibria(seconds=0, starts=2000, jobs=1, progress=tell)
print(called != [], "nterrupted" in found.text())
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert run.stdout == "True False\n", run.stderr
