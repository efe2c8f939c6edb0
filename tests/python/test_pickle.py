"""Scenes and results go through pickle and to other processes, and are the same there."""

import copy
import multiprocessing
import operator
import os
import pickle

import numpy as np
import poise
import pytest

CLAMP = "datasets/toggle_clamp.toml"


@pytest.fixture(scope="module")
def clamp():
    return poise.load(CLAMP)


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def test_scenes_are_equal_that_say_the_same(clamp):
    changed = clamp.with_numbers({"load.P": 30, "point.link.B.x": 35.9})
    for scene in (clamp, changed):
        other = again(scene)
        assert other == scene and hash(other) == hash(scene) and other is not scene
        assert other.solve().x.tobytes() == scene.solve().x.tobytes()
    assert changed != clamp and clamp == poise.load(CLAMP) and clamp != 3
    assert changed == clamp.with_numbers({"point.link.B.x": 35.9, "load.P": 30})
    assert len({clamp, poise.load(CLAMP), changed}) == 2
    assert copy.copy(clamp) == clamp and copy.deepcopy([changed])[0] == changed


@pytest.mark.parametrize("options", [
    {}, {"proof": False}, {"seek": "any"}, {"seek": "stable", "method": "energy"}, {"proof_seconds": 5},
])
def test_a_rest_is_solved_again_to_the_same_bits(clamp, options):
    rest = clamp.solve({"spring.rubber.stiffness": 390}, P=25.123456789, **options)
    other = again(rest)
    assert other.x.tobytes() == rest.x.tobytes()
    assert (other.status, other.proved, other.radius, other.stability) == (
        rest.status, rest.proved, rest.radius, rest.stability)
    values = np.array(list(rest.values()))
    assert np.array(list(other.values())).tobytes() == values.tobytes()
    assert np.isfinite(values).any() and other.scene == rest.scene
    assert other.svg == rest.svg
    si = again(rest.si)
    assert si["angle.arm"] == rest.si["angle.arm"] != rest["angle.arm"]


def results(clamp):
    yield clamp.path("load.P", 0, 60, show="force.rubber")
    yield clamp.equilibria()
    yield clamp.tolerance(tolerances="datasets/toggle_clamp_tolerances.toml", of="force.rubber", samples=200)
    yield clamp.check()
    yield poise.identify("datasets/lift_experiment.toml")


def test_results_are_the_same_after_pickle(clamp):
    for found in results(clamp):
        other = again(found)
        assert type(other) is type(found)
        assert other.to_dict() == found.to_dict() and other.json() == found.json()
        assert (other.code, other.verdict, other.warnings) == (found.code, found.verdict, found.warnings)
        for level in ("quiet", "normal", "verbose"):
            assert other.text(level) == found.text(level)
        assert (other.csv, other.markdown, other.written) == (found.csv, found.markdown, found.written)
        assert other.svg == found.svg
        assert set(other.tables) == set(found.tables) and list(other.columns) == list(found.columns)
        for name in found.columns:
            if found.columns[name].dtype.kind == "U":
                assert np.array_equal(other.columns[name], found.columns[name])
            else:
                assert other.columns[name].tobytes() == found.columns[name].tobytes()
                assert not other.columns[name].flags.writeable
            assert other.columns.unit(name) == found.columns.unit(name)
        twice = again(other)
        assert twice.json() == found.json() and twice.svg == found.svg and twice.page == other.page


def test_a_curve_can_do_the_same_after_pickle(clamp):
    curve = clamp.path("load.P", 0, 60)
    other = again(curve)
    assert other._pictured is None and other["reaction.B"].tobytes() == curve["reaction.B"].tobytes()
    assert [event["load.P"] for event in other.events] == [event["load.P"] for event in curve.events]
    assert np.array_equal(again(curve.si)["angle.arm"], curve.si["angle.arm"])
    assert len(pickle.dumps(curve)) < 200_000


def test_equilibria_can_do_the_same_after_pickle(clamp):
    equilibria = clamp.equilibria()
    other = again(equilibria)
    assert other.svg == equilibria.svg and other["reaction.B"].tobytes() == equilibria["reaction.B"].tobytes()
    assert again(other)[0]["reaction.B"] == equilibria[0]["reaction.B"]
    assert np.array_equal(again(equilibria.si)["force.rubber"], equilibria.si["force.rubber"])


def test_a_fit_can_do_the_same_after_pickle():
    fit = poise.identify("datasets/lift_experiment.toml")
    other = again(fit)
    assert np.array_equal(other.covariance, fit.covariance) and other.covariance.names == fit.covariance.names
    assert again(fit.covariance)["mP", "k"] == fit.covariance["mP", "k"]
    judged, judged_by_other = (one.validate("datasets/lift_experiment.toml") for one in (fit, other))
    assert judged_by_other.verdict == judged.verdict


def test_results_are_their_own_copies(clamp):
    for found in (clamp.solve(), clamp.path("load.P", 0, 30)):
        assert copy.copy(found) is found and copy.deepcopy(found) is found


def test_other_processes_solve_scenes(clamp):
    scenes = [clamp.with_numbers(P=load) for load in (0.0, 10.5, 25.0, 38.0)]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        rests = pool.map(operator.methodcaller("solve"), scenes)
        curves = pool.map(operator.methodcaller("path", "load.P", 0, 40), scenes[1:3])
    for scene, rest in zip(scenes, rests):
        assert rest.x.tobytes() == scene.solve().x.tobytes() and rest.scene == scene
    assert curves[0]["load.P"].tobytes() == clamp.path("load.P", 0, 40)["load.P"].tobytes()


def test_a_rest_needs_no_file(clamp, tmp_path):
    file = tmp_path / "clamp.toml"
    file.write_text(clamp._core.text, encoding="utf-8")
    rest, curve = poise.load(file).solve(), poise.load(file).path("load.P", 0, 30)
    os.remove(file)
    assert again(rest).x.tobytes() == rest.x.tobytes() and again(curve).svg == curve.svg
