"""What a call takes is what it computes with: arrays that change later, masks, short names, rows of numbers."""

import copy
import pickle

import matplotlib
import numpy as np
import poise
import pytest

matplotlib.use("Agg")


@pytest.fixture(scope="module")
def clamp():
    return poise.load("datasets/toggle_clamp.toml")


def refused(call, message):
    with pytest.raises(poise.InputError, match=message) as found:
        call()
    assert "\n" not in str(found.value)


def test_results_keep_the_numbers_that_were_solved(clamp):
    forces, stiffness = np.array([0.0, 10.0, 20.0]), np.array([300.0, 400.0])
    many = clamp.solve_many({"load.P": forces, "spring.rubber.stiffness": 400.0}, of="force.rubber")
    paths = clamp.path_many({"rubber.stiffness": stiffness}, vary=("P", 0, 60), proof=False)
    forces[:], stiffness[:] = 99.0, 500.0
    assert many["load.P"].tolist() == [0.0, 10.0, 20.0] == many.to_dict()["numbers"]["load.P"]["values"]
    assert paths.scene(0).numbers["spring.rubber.stiffness"] == 300.0
    assert paths.curve(0).folds[0]["load.P"] == pytest.approx(paths.fold[0], rel=1e-12)


def test_arrays_of_results_are_read_only(clamp):
    many = clamp.solve_many({"load.P": [[0.0, 38.0]]}, of=["force.rubber", "arm"], proved="all")
    paths = clamp.path_many({"rubber.stiffness": [300.0]}, vary=("P", 0, 60))
    rest, curve = clamp.solve(), clamp.path("load.P", 0, 60)
    one = pickle.loads(pickle.dumps(many))
    arrays = [many["force.rubber"], many["arm"], many["load.P"], many.x, many.si.x, many.si["arm"], many.radius,
              many.by, many.solved, many.proved, one["force.rubber"], one["load.P"], one.x, paths.fold, paths.status,
              paths.points, paths.unproved, rest.x, rest["push.handle.grip"], rest.point["arm.T"], curve["arm"],
              curve.si["arm"], curve.stability, curve.proved, curve.branch, curve.branches[0]["arm"]]
    assert [k for k, array in enumerate(arrays) if array.flags.writeable] == []


def test_masked_numbers_are_refused_wherever_arrays_are_taken(clamp):
    x = clamp.solve().x
    masked = np.ma.array(x, mask=[0, 1, 0])
    time = np.linspace(0.0, 1.0, 3)
    for call in [
        lambda: clamp.solve_many({"load.P": masked}),
        lambda: clamp.solve_many({"load.P": [masked, masked]}),
        lambda: clamp.path_many({"rubber.stiffness": masked}, vary=("P", 0, 60)),
        lambda: clamp.path_many({"rubber.stiffness": 300.0}, vary=("P", 0, np.ma.masked)),
        lambda: clamp.equations(masked), lambda: clamp.jacobian(masked), lambda: clamp.hessian(masked),
        lambda: clamp.hessian(x, np.ma.array([0.0, 0.0], mask=[1, 0])), lambda: clamp.certify(masked),
        lambda: clamp.path("load.P", 0, 60, at=masked), lambda: clamp.path("load.P", 0, np.ma.masked),
        lambda: clamp.solve(P=np.ma.masked), lambda: clamp.solve({"load.P": np.ma.masked}),
        lambda: clamp.with_numbers(P=np.ma.masked),
        lambda: clamp.tolerance({"load.P": np.ma.masked}, of="arm"),
        lambda: poise.SceneBuilder("a").body("b", {"P": np.ma.array([1.0, 2.0], mask=[0, 1])}),
        lambda: poise.Experiment("datasets/lift_experiment.toml", time=[np.ma.array(time, mask=[0, 0, 1])] * 6,
                                 readings={"angle": [time] * 6}),
    ]:
        refused(call, "masked$")
    whole = np.ma.array(x, mask=False)
    assert np.array_equal(clamp.equations(whole), clamp.equations(x))
    assert not isinstance(clamp.solve_many({"load.P": whole})["load.P"], np.ma.MaskedArray)


def test_options_without_effect_are_refused(clamp):
    for call in [
        lambda: clamp.solve(proof_seconds=1, proof=False),
        lambda: clamp.solve_many({"load.P": [1.0]}, proof_seconds=1),
        lambda: clamp.path_many({"rubber.stiffness": 300.0}, vary=("P", 0, 60), proof=False, proof_seconds=1),
    ]:
        refused(call, "proof_seconds: expected .* nothing is proved")


def test_ends_of_paths_name_numbers_that_vary(clamp):
    for short, long in [
        (clamp.path("P", 0, 60), clamp.path("load.P", 0, 60)),
        (clamp.path(vary="P=0..60"), clamp.path("load.P", 0, 60)),
        (clamp.find("stiffness", 200, 800, for_="force.rubber = -700"),
         clamp.find("spring.rubber.stiffness", 200, 800, for_="force.rubber = -700")),
        (clamp.loads("P", 0, 10), clamp.loads("load.P", 0, 10)),
    ]:
        assert (short.verdict, short.csv) == (long.verdict, long.csv)
    wedge = poise.load("datasets/friction/wedge.toml")
    assert wedge.hold("P").verdict == wedge.hold("load.P").verdict
    refused(lambda: clamp.path("Q", 0, 60), "--vary Q: expected the path of a number")
    # What can be driven is driven, as on the command line.
    assert clamp.path("angle.arm", 0, 1).number == "angle.arm"


def test_quantities_of_two_directions_are_asked_for_one_by_one(clamp):
    refused(lambda: clamp.solve_many({"load.P": [1.0]}, of="push.handle.grip"),
            r'did you mean "push\.handle\.grip\.x", "push\.handle\.grip\.y"')


def test_values_of_at_are_a_number_or_any_row(clamp):
    for at, values in [(10, [10]), (np.array(10), [10]), ((k for k in (10, 20)), [10, 20]), ({10}, [10]),
                       (np.float32(10), [10]), (range(10, 30, 10), [10, 20]), ("10,20", [10, 20])]:
        assert list(clamp.path("load.P", 0, 60, at=at).at) == values
    for at, message in [({10: 1}, "--at: expected a number"), (b"10", "--at: expected a number"),
                        (iter(int, 1), "--at: expected at most 100000 numbers"), (object(), "--at: expected a number")]:
        refused(lambda: clamp.path("load.P", 0, 60, at=at), message)


def test_what_is_missing_has_its_name_in_python(clamp):
    for call, message in [
        (lambda: clamp.find("load.P", 0, 60), r"^find: expected for_, found none; see help\(poise.Scene.find\)$"),
        (lambda: clamp.path(), r"^path: expected name, low, high \(or vary\), found none"),
        (lambda: clamp.find(), r"^find: expected name, low, high \(or vary\) and for_, found none"),
        (lambda: poise.identify(None), r"^identify: expected experiment, found none; see help\(poise.identify\)$"),
        (lambda: poise.identify([]), r"^identify: expected experiment, found none"),
        (lambda: clamp.sensitivity(None), r"^sensitivity: expected of, found none"),
    ]:
        refused(call, message)


def test_expressions_are_columns_by_the_words_that_were_asked_for(clamp):
    curve = clamp.path("load.P", 0, 60, show=["-angle.arm", "2*length.rubber"])
    for name, factor, of in [("-angle.arm", -1.0, "angle.arm"), ("2*length.rubber", 2.0, "length.rubber")]:
        assert np.allclose(curve[name], factor * curve[of], rtol=1e-14) and curve.unit(name) == curve.unit(of)
    equilibria = clamp.equilibria()
    assert np.array_equal(equilibria["-reaction.B"], -equilibria["reaction.B"])
    assert np.allclose(curve.si["-angle.arm"], -curve.si["angle.arm"], rtol=1e-14)
    drawn = curve.plot("-angle.arm")
    folds = next(line for line in drawn.lines if line.get_label() == "fold")
    assert np.allclose(folds.get_ydata(), [-event["angle.arm"] for event in curve.folds], rtol=1e-14)
    for name in ("(energy)", "energy,reaction.B"):
        refused(lambda: curve[name], "expected the name of one column")


def test_words_are_not_drawn(clamp):
    curve = clamp.path("load.P", 0, 60)
    for name in ("stability", "proof", "events"):
        refused(lambda: curve.plot(name), f"^plot: expected the name of numbers, found {name}")


def test_parts_of_results_pickle(clamp):
    curve, equilibria = clamp.path("load.P", 0, 60), clamp.equilibria()
    fit = poise.identify("datasets/lift_experiment.toml")
    for part in (curve.events[0], curve.folds[0], equilibria[0], fit["k"]):
        for other in (pickle.loads(pickle.dumps(part)), copy.copy(part), copy.deepcopy(part)):
            assert type(other) is type(part) and other == part and repr(other) == repr(part)
    branch = pickle.loads(pickle.dumps(curve.branches[0]))
    assert np.array_equal(branch["arm"], curve.branches[0]["arm"])
    for thing in (clamp.system(), clamp.certify(clamp.solve().x), poise.SceneBuilder("a"), poise.measures.x("b.P")):
        with pytest.raises(TypeError, match="pickle"):
            pickle.dumps(thing)


def test_texts_that_are_no_utf8_are_bad_input_everywhere(clamp):
    bad = "a\ud800"
    rest, equilibria = clamp.solve(), clamp.equilibria()
    calls = [
        lambda: poise.load(bad), lambda: poise.example(bad), lambda: clamp.unit(bad),
        lambda: clamp.solve({bad: 1}), lambda: clamp.with_numbers({bad: 1}), lambda: rest[bad], lambda: rest.why(bad),
        lambda: rest.unit(bad), lambda: rest.to_frame(bad), lambda: equilibria[bad], lambda: equilibria[0][bad],
        lambda: equilibria.columns[bad], lambda: clamp.path(bad, 0, 60), lambda: clamp.path("load.P", 0, 60, show=bad),
        lambda: clamp.path("load.P", 0, 60, set={bad: 1}), lambda: clamp.find("load.P", 0, 60, bad),
        lambda: clamp.tolerance(tolerances={bad: 1}, of="force.rubber"), lambda: poise.identify(bad),
        lambda: poise.Experiment(bad), lambda: poise.Experiment(clamp, sensors={bad: {}}, unknowns=[]).identify(),
        lambda: clamp.solve_many({bad: [1, 2]}), lambda: clamp.solve_many({"load.P": [1, 2]}, of=bad),
        lambda: clamp.path_many({"load.P": [1, 2]}, vary=(bad, 0, 1)), lambda: clamp.view(origin=bad, browser=False),
    ]
    for call in calls:
        refused(call, r"expected a text that UTF-8 can hold, found .*\\ud800")
