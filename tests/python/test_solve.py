"""A scene is read and comes to rest, as on the command line."""

import poise
import pytest

CLAMP = "datasets/toggle_clamp.toml"


def test_a_scene_that_does_not_exist_is_bad_input():
    with pytest.raises(poise.InputError, match="nowhere.toml"):
        poise.load("nowhere.toml")


@pytest.mark.parametrize("numbers, words", [
    ({"sek": "any"}, ["sek", "did you mean \"seek\""]),
    ({"P": True}, ["P", "expected a number", "True"]),
    ({"P": 3, "load.P": 4}, ["load.P is given twice"]),
    ({"time": float("nan")}, ["--time", "expected a time"]),
    ({"time": 1.0}, ["--time", "no load or spring of the scene follows"]),
])
def test_what_solve_does_not_know_is_bad_input(numbers, words):
    with pytest.raises(poise.InputError) as error:
        poise.load(CLAMP).solve(**numbers)
    assert all(word in str(error.value) for word in words), error.value


def test_a_name_that_a_file_cannot_have_is_bad_input():
    with pytest.raises(poise.InputError, match="NUL"):
        poise.load(CLAMP + "\0junk")


def test_loops_that_do_not_close_are_no_exception():
    links = poise.load("datasets/redundant_parallelogram.toml")
    rest = links.solve({"point.crank2.B.x": 1.05 * links.numbers["point.crank2.B.x"]})
    assert not rest.found and rest.proved is False and "remains open" in rest.why
    assert rest.radius is None and rest.to_dict()["verdict"] == rest.why
    assert len(rest.x) == 0 and all(value != value for value in rest.angle.values())


def test_a_load_of_zero_keeps_its_direction():
    clamp = poise.load(CLAMP)
    unloaded = clamp.with_numbers(P=0)
    assert unloaded.path("load.P", 0, 60).verdict == clamp.path("load.P", 0, 60).verdict
    assert unloaded.with_numbers(P=25).solve()["force.rubber"] == clamp.solve()["force.rubber"]
    assert unloaded.check().to_dict()["scene"]["set"] == ["load.P=0"]
    assert list(unloaded.path_many({"spring.rubber.stiffness": [400.0]}, vary=("load.P", 0, 60)).status) == ["traced"]
    assert unloaded.path("load.P", 0, 60, set={"spring.rubber.stiffness": 300}).code == 0
