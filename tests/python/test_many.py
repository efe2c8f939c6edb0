"""Many variants at once have the answers that they have one by one, and what is not known is marked."""

import json
import os
import pickle
import signal
import threading
import time

import numpy as np
import pandas
import poise
import pytest
from poise._many import Varied
from scenes import MASS_ON_SPRING


@pytest.fixture(scope="module")
def clamp():
    return poise.load("datasets/toggle_clamp.toml")


def parse(text, name="scene.toml"):
    return poise.Scene(poise._poise.Scene.parse(text, name, []))


def test_masses_hang_where_their_springs_hold_them():
    rng = np.random.default_rng(1)
    stiffness, mass = rng.uniform(1, 9, (40, 1)), rng.uniform(0.1, 3, 30)
    many = parse(MASS_ON_SPRING).solve_many({"spring.k.stiffness": stiffness, "body.block.mass": mass},
                                            of=["travel.rail", "force.k"])
    assert many.shape == (40, 30) and many.variants == 1200 and many.solved.all() and bool(many)
    assert np.allclose(many["travel.rail"], 100 - mass * 9.81 / stiffness, rtol=1e-13, atol=0)
    assert np.allclose(many["force.k"], np.broadcast_to(-mass * 9.81, (40, 30)), rtol=1e-11, atol=0)
    assert many.unit("travel.rail") == "mm" and many.si.unit("travel.rail") == "m"
    assert np.allclose(many.si["travel.rail"], many["travel.rail"] * 1e-3, rtol=1e-15)
    assert many.x.shape == (40, 30, 1) and many.coordinates == [("rail", "mm")]
    assert np.allclose(many.x[..., 0], many["travel.rail"], rtol=1e-15)
    assert np.array_equal(many["body.block.mass"][7], mass) and many.unit("spring.k.stiffness") == "N/mm"


@pytest.mark.parametrize(
    "name, of, number, spread",
    [
        ("toggle_clamp", "force.rubber", "load.P", (5, 30)),
        ("toggle_clamp", "reaction.B", "point.link.B.x", (35.5, 36.5)),
        ("six_bar", "energy", None, None),
        ("four_bar_torsion", "energy", None, None),
        ("cam_follower", "energy", None, None),
    ],
)
def test_answers_are_those_one_by_one(name, of, number, spread):
    scene = poise.load(f"datasets/{name}.toml")
    if number is None:
        number = next(path for path in scene.numbers if path.startswith(("load.", "body.")) and "mass" in path
                      or path.startswith("load."))
        spread = (0.95 * scene.numbers[number], 1.05 * scene.numbers[number])
    values = np.linspace(*spread, 25)
    many = scene.solve_many({number: values}, of=of)
    for k, value in enumerate(values):
        rest = scene.solve({number: float(value)})
        assert many.solved[k] == rest.found
        if rest.found:
            size = np.maximum(1.0, np.abs(rest.x))
            assert np.abs((many.x[k] - rest.x) / size).max() < 1e-12
            assert many[of][k] == pytest.approx(rest[of], rel=1e-10)


def test_proofs_are_what_was_asked_for(clamp):
    forces = np.linspace(10, 30, 50)
    unasked = clamp.solve_many({"load.P": forces})
    assert unasked.proved is None and unasked.radius is None and len(unasked) == 0
    every = clamp.solve_many({"load.P": forces}, proved="all")
    assert every.proved.dtype == bool and every.proved.all() and (every.radius < 1e-9).all()
    some = clamp.solve_many({"load.P": forces}, proved=5)
    assert isinstance(some.proved, np.ma.MaskedArray) and some.proved.count() == 5 and some.proved.all()
    assert np.isfinite(some.radius).sum() == 5
    one = clamp.solve(P=forces[-1])
    assert abs(every.x[-1] - one.x).max() < 1e-12 and every.radius[-1] < 1e-11


def test_what_lanes_cannot_do_is_searched_and_marked(clamp):
    # Beyond 37.09 N the clamp is open, which lanes do not find from the closed start.
    forces = np.array([25.0, 36.0, 38.0, 60.0])
    many = clamp.solve_many({"P": forces}, of="arm")
    assert list(many.by[:2]) == ["lanes", "lanes"] and list(many.by[2:]) == ["search", "search"]
    assert np.allclose(many["arm"], [clamp.solve(P=force)["angle.arm"] for force in forces], rtol=1e-12, atol=1e-12)
    assert many["angle.arm"] is not None and "search" in repr(many)


def test_variants_without_equilibrium_are_marked():
    # The slide is horizontal and frictionless, and nothing but the load acts where the spring has no stiffness.
    text = MASS_ON_SPRING
    many = parse(text).solve_many({"spring.k.stiffness": [4.0, 0.0, 2.0]}, of="travel.rail", proved="all")
    assert list(many.solved) == [True, False, True] and not many and many.by[1] == "none"
    assert np.isnan(many["travel.rail"][1]) and np.isnan(many.radius[1]) and list(many.proved) == [True, False, True]
    assert many.why(1) and many.why(0) == "" and many.why(-2) == many.why(1)
    assert many.to_dict()["quantities"]["travel.rail"]["values"][1] is None


def test_quantities_without_a_value_say_why(clamp):
    # The clamp rests on one stop or on the other, and cannot move there: no push at the grip has a leverage.
    forces, of = [25.0, 30.0, 38.0, 60.0], ["force.rubber", "push.handle.grip.x"]
    many = clamp.solve_many({"P": forces}, of=of)
    assert list(many.by) == ["lanes", "lanes", "search", "search"]
    for at, force in enumerate(forces):
        rest = clamp.solve(P=force)
        assert np.isnan(many["push.handle.grip.x"][at]) and np.isnan(rest["push.handle.grip.x"])
        assert many.why(at) == f"push.handle.grip.x: {rest.why('push.handle.grip.x')}"
    assert clamp.solve_many({"P": forces}, of="force.rubber").why(0) == ""
    lots = clamp.solve_many({"P": np.linspace(20, 30, 1500)}, of=of)
    assert lots.why(999) == many.why(0)
    assert lots.why(1499) == "a quantity has no value; reasons are kept of the first 1000 variants alone"


def test_shapes_are_kept(clamp):
    for values, shape in [(25.0, ()), ([25.0], (1,)), (np.full((2, 1, 3), 25.0), (2, 1, 3))]:
        many = clamp.solve_many({"load.P": values}, of="force.rubber", proved="all")
        assert many.shape == many["force.rubber"].shape == many.solved.shape == many.by.shape == shape
        assert many.proved.shape == many.radius.shape == shape and many.x.shape == (*shape, 3)
        assert np.allclose(many["force.rubber"], -724.53765593476838031, rtol=1e-12)
    mixed = clamp.solve_many({"load.P": np.array([24, 25], np.int16), "rubber.stiffness": np.float32(400)})
    assert mixed.shape == (2,) and mixed.solved.all()
    assert clamp.solve_many({"load.P": pandas.Series([24.0, 25.0])}).shape == (2,)
    assert clamp.solve_many({"load.P": np.arange(20.0, 30.0)[::3]}).solved.all()
    grid = clamp.solve_many({"load.P": [[24.0, 25.0]], "rubber.stiffness": [[400.0], [410.0]]}, of="arm")
    assert grid.why((1, 1)) == "" == grid.why(3) and list(grid.to_frame().index[-1]) == [1, 1]


def test_nothing_is_copied(clamp):
    values = np.linspace(10, 30, 12).reshape(3, 4)
    (_, flat), (_, one) = Varied("", clamp._core, {"load.P": values, "rubber.stiffness": 400}).flat()
    assert np.shares_memory(flat, values) and flat.shape == (12,) and one.shape == (1,)
    many = clamp.solve_many({"load.P": values}, of=["arm", "force.rubber"], proved="all")
    assert np.shares_memory(many.si["arm"], many.si["arm"])
    assert np.shares_memory(many["force.rubber"], many.si["force.rubber"])
    assert np.shares_memory(many.radius, many.radius)
    kept = many.si["arm"].copy()
    view = many.si["arm"]
    del many
    assert np.array_equal(view, kept)


def test_results_pickle_and_show_themselves(clamp):
    stiffness = np.linspace(390, 410, 64)
    many = clamp.solve_many({"rubber.stiffness": stiffness, "P": 25}, of=["reaction.B", "force.rubber"], proved=8)
    again = pickle.loads(pickle.dumps(many))
    assert np.array_equal(again["force.rubber"], many["force.rubber"]) and repr(again) == repr(many)
    assert (again.proved == many.proved).all() and np.array_equal(again.si.x, many.si.x)
    json.dumps(many.to_dict(), allow_nan=False)
    assert many.to_dict()["by"].count("lanes") == 64 and many.to_dict()["numbers"]["load.P"]["unit"] == "N"
    page = many._repr_html_()
    assert page.count("<svg") == 2 and "64 in lanes" in page
    frame = many.to_frame()
    names = ["spring.rubber.stiffness", "load.P"]
    assert list(frame.columns) == [*names, "reaction.B", "force.rubber", "by", "proved", "radius"]
    assert frame["proved"].sum() == 8 and frame["proved"].isna().sum() == 56 and frame.attrs["units"]["load.P"] == "N"


def test_results_depend_on_nothing_but_the_numbers(clamp, monkeypatch):
    forces = np.random.default_rng(2).uniform(0, 45, 700)
    one = clamp.solve_many({"load.P": forces}, of="force.rubber", jobs=1)
    two = clamp.solve_many({"load.P": forces}, of="force.rubber", jobs=2)
    assert np.array_equal(one.x, two.x) and np.array_equal(one["force.rubber"], two["force.rubber"])
    turned = clamp.solve_many({"load.P": forces[::-1]}, of="force.rubber")
    assert np.array_equal(turned.x[::-1], one.x)
    monkeypatch.setenv("POISE_SIMD", "plain")
    plain = clamp.solve_many({"load.P": forces})
    assert plain.simd == "plain" and np.abs(plain.x - one.x).max() < 1e-12
    monkeypatch.setenv("POISE_SIMD", "mmx")
    with pytest.raises(poise.InputError, match="POISE_SIMD"):
        clamp.solve_many({"load.P": forces})


def test_progress_is_told_and_may_stop_it(clamp):
    said = []
    clamp.solve_many({"load.P": np.linspace(0, 45, 3000)}, proved="all", progress=said.append)
    assert said and said[0].endswith("of 3000 variants")

    def stop(doing):
        raise RuntimeError(doing)

    with pytest.raises(RuntimeError, match="of 100000 variants"):
        clamp.solve_many({"load.P": np.linspace(0, 30, 100_000)}, proved="all", progress=stop)
    with pytest.raises(RuntimeError, match="of 50 variants"):
        clamp.path_many({"rubber.stiffness": np.linspace(300, 500, 50)}, vary=("load.P", 0, 60), progress=stop)


def interrupted_soon(work):
    time.sleep(2.1)  # a second Ctrl-C within two seconds is Python's
    ended = threading.Event()
    begin = time.process_time()

    def interrupt():
        # A busy machine may not have let the work begin by then.
        while not ended.wait(0.3) and time.process_time() - begin < 0.6:
            pass
        os.kill(os.getpid(), signal.SIGINT)

    interrupter = threading.Thread(target=interrupt)
    interrupter.start()
    try:
        return work()
    finally:
        ended.set()
        interrupter.join()


def test_interrupts_leave_what_was_solved(clamp):
    # Beyond the load at which the clamp opens each is searched alone.
    forces = np.linspace(30, 60, 400_000)
    many = interrupted_soon(lambda: clamp.solve_many({"load.P": forces}, of="arm"))
    assert many.interrupted and (many.by == "not solved").any() and many.solved.any() and not many
    assert np.isnan(many["arm"][many.by == "not solved"]).all() and "not solved" in repr(many)
    assert many.why(int(np.argmax(many.by == "not solved"))) == "an interrupt came before its turn"
    forces = np.linspace(0, 30, 200_000)
    many = interrupted_soon(lambda: clamp.solve_many({"load.P": forces}, proved="all"))
    assert many.interrupted and many.solved.all() and many.proved.all() and 0 < many.proved.count() < 200_000
    stiffness = np.linspace(300, 500, 5000)
    paths = interrupted_soon(
        lambda: clamp.path_many({"rubber.stiffness": stiffness}, vary=("load.P", 0, 60), proof=False)
    )
    assert paths.status[0] == "traced" and paths.status[-1] == "not started" and not paths and np.isnan(paths.fold[-1])


@pytest.mark.parametrize(
    "call, message",
    [
        (dict(numbers=7), "solve_many: expected arrays by name"),
        (dict(numbers={}), "solve_many: expected numbers that vary"),
        (dict(numbers={"load.P": []}), r"solve_many: expected at least one variant, found arrays of shape \(0,\)"),
        (dict(numbers={"load.Q": 1}), 'expected a number of the scene, found "load.Q"'),
        (dict(numbers={3: 1}), "expected a name in quotes, found 3"),
        (dict(numbers={"load.P": "many"}), "load.P: expected an array of real numbers, found 'many'"),
        (dict(numbers={"load.P": [1, None]}), "load.P: expected an array of real numbers"),
        (dict(numbers={"load.P": [1, [2]]}), "load.P: expected an array"),
        (dict(numbers={"load.P": [1, 2j]}), "load.P: expected an array of real numbers"),
        (dict(numbers={"load.P": [[1, 2], [3, np.nan]]}), "load.P: expected finite numbers, found nan at index 1, 1"),
        (dict(numbers={"load.P": [1, 2], "P": [3, 4]}), "load.P is given twice"),
        (dict(numbers={"load.P": [1, 2], "rubber.stiffness": [1, 2, 3]}), r"one shape, found load.P \(2,\), "),
        (dict(numbers={"rubber.stiffness": [400, -1]}), "expected a finite number >= 0, found -1"),
        (dict(numbers={"load.P": 1}, of="angle.leg"), "leg"),
        (dict(numbers={"load.P": 1}, of=7), "of: expected names of quantities, found 7"),
        (dict(numbers={"load.P": 1}, of=["arm", None]), "of: expected names of quantities"),
        (dict(numbers={"load.P": 1}, proved=True), 'proved: expected "all", a number of variants, or None, found True'),
        (dict(numbers={"load.P": 1}, proved="some"), "proved: expected"),
        (dict(numbers={"load.P": 1}, proved=0), "proved: expected"),
        (dict(numbers={"load.P": 1}, jobs=-1), "jobs: expected a number from 0"),
        (dict(numbers={"load.P": 1}, jobs=1.5), "jobs: expected a whole number, found 1.5"),
    ],
)
def test_bad_input_is_one_line(clamp, call, message):
    with pytest.raises(poise.InputError, match=message) as found:
        clamp.solve_many(**call)
    assert "\n" not in str(found.value)


def test_bad_questions_are_one_line(clamp):
    many = clamp.solve_many({"load.P": [1.0, 2.0]}, of="angle.arm")
    for ask, message in [
        (lambda: many["force.rubber"], "force.rubber: expected a quantity that was asked for"),
        (lambda: many[0], "expected a name in quotes"),
        (lambda: many.unit("x"), "x: expected"),
        (lambda: many.why(2), r"expected the index of a variant in the shape \(2,\), found 2"),
        (lambda: many.why((0, 0)), "expected the index"),
        (lambda: many.why("a"), "expected the index"),
    ]:
        with pytest.raises(poise.InputError, match=message):
            ask()


def test_paths_fold_where_their_closed_forms_say(clamp):
    paths = clamp.path_many({"rubber.stiffness": [300.0, 400.0]}, vary=("P", 0, 60))
    # The load at which the clamp opens, to 20 digits, from its data set.
    assert paths.fold[1] == pytest.approx(37.093431951696662419, rel=1e-12) and paths.unit == "N"
    # Without gravity all of it would be proportional to the stiffness; with it, linear.
    more = clamp.path_many({"rubber.stiffness": np.array([[300.0, 350.0, 400.0]])}, vary=("load.P", 0, 60), proof=False)
    assert more.fold[0, 1] == pytest.approx((more.fold[0, 0] + more.fold[0, 2]) / 2, rel=1e-12)
    assert more.unproved is None and (paths.unproved == 0).all() and (more.points > 10).all()
    assert bool(paths) and set(paths.status) == {"traced"}
    assert [event.kind for event in paths.events(0)][:2] == ["stop", "fold"]
    event = next(event for event in paths.events(1) if event.kind == "fold")
    assert event.before == "stable" and event.after == "unstable" and event.error < 1e-10
    assert np.array_equal(paths.folds(1)[:1], [paths.fold[1]])
    curve = paths.curve(0)
    assert curve.folds[0]["load.P"] == paths.fold[0]
    assert paths.scene(0).numbers["spring.rubber.stiffness"] == 300


def test_paths_depend_on_nothing_but_the_numbers(clamp):
    stiffness = np.linspace(300, 500, 6).reshape(2, 3)
    one = clamp.path_many({"rubber.stiffness": stiffness}, vary=("load.P", 0, 60), jobs=1)
    two = clamp.path_many({"rubber.stiffness": stiffness}, vary=("load.P", 0, 60), jobs=2)
    assert one.to_dict() == two.to_dict() and one.fold.shape == (2, 3)
    again = pickle.loads(pickle.dumps(one))
    assert again.to_dict() == one.to_dict() and "<svg" in again._repr_html_()
    frame = one.to_frame()
    folds = frame[frame["kind"] == "fold"].groupby("variant")["value"].first()
    assert np.array_equal(folds, one.fold.ravel()) and frame["spring.rubber.stiffness"].iloc[-1] == 500
    json.dumps(one.to_dict(), allow_nan=False)


@pytest.mark.parametrize(
    "call, message",
    [
        (dict(vary=("load.P", 0)), "vary: expected a name and a range"),
        (dict(vary="load.P"), "vary: expected a name and a range"),
        (dict(vary=("load.P", 0, "60")), "vary: expected an array of real numbers|vary: expected"),
        (dict(vary=("load.P", 0, np.inf)), "vary: expected finite numbers"),
        (dict(vary=("load.P", 1, 1)), "load.P: the range 1..1 has no length"),
        (dict(vary=("load.Q", 0, 1)), 'did you mean "load.P"'),
        (dict(vary=("rubber.stiffness", 0, 1)), "rubber.stiffness"),
        (dict(vary=("spring.rubber.stiffness", 1, 2)), "spring.rubber.stiffness is what vary varies"),
        (dict(vary=("load.P", 0, 60), follow="slowly"), "follow: expected unstable or jump"),
        (dict(vary=("load.P", 0, 60), from_="here"), "here"),
        (dict(vary=("load.P", 0, 60), proof=1), "proof: expected True or False, found 1"),
        (dict(vary=("load.P", 0, 60), jobs=None), "jobs: expected a whole number"),
    ],
)
def test_bad_paths_are_one_line(clamp, call, message):
    with pytest.raises(poise.InputError, match=message) as found:
        clamp.path_many({"rubber.stiffness": [300.0, 400.0]}, **call)
    assert "\n" not in str(found.value)
