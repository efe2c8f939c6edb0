"""The examples that come with the package are found by name, wherever the process runs, and all of them load."""

from pathlib import Path

import poise
import pytest

DATASETS = Path(__file__).resolve().parents[2] / "datasets"


def test_an_example_is_the_scene_of_its_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    clamp = poise.example("toggle_clamp")
    assert clamp.toml == (DATASETS / "toggle_clamp.toml").read_text()
    assert clamp.solve().proved
    clamp.solve().save("clamp.svg")
    assert (tmp_path / "clamp.svg").read_text().rstrip().endswith("</svg>")


def test_examples_are_those_of_the_sources_by_name_and_title():
    found = poise.examples()
    files = {file.stem for file in DATASETS.glob("*.toml") if "\ntitle = " in "\n" + file.read_text()}
    assert {name for name in found if "/" not in name} == files
    assert {"friction/wedge", "structures/elastica", "assemblies/double_butterfly"} <= set(found)
    assert not any(name.startswith("hard/") for name in found)
    assert found["lift_experiment"] == "Lift: six runs, one stiffness"


def test_all_scenes_load_and_others_say_what_they_are():
    scenes = 0
    for name, title in poise.examples().items():
        if name.endswith(("_design", "_plan")) or "_experiment" in name:
            with pytest.raises(poise.InputError, match="expected the name of a scene; poise.example_path"):
                poise.example(name)
        else:
            assert poise.example(name).title == title
            scenes += 1
    assert scenes > 60


def test_files_are_those_that_commands_read():
    assert poise.design(poise.example_path("knee_press_design")).code == 0
    assert poise.Experiment(poise.example_path("lift_experiment")).identifiability().code == 0
    assert poise.example_path("toggle_clamp.toml") == poise.example_path("toggle_clamp")
    assert poise.example("hard/ziegler").title


@pytest.mark.parametrize("name, why", [
    ("togle_clamp", 'did you mean "toggle_clamp"?'),
    ("TOGGLE_CLAMP", 'did you mean "toggle_clamp"?'),
    ("wedge", 'did you mean "friction/wedge"?'),
    ("structures/wegde", 'did you mean "friction/wedge"?'),
    ("struts", 'did you mean "struts.csv"?'),
    ("struts.csv.toml", 'did you mean "struts.csv"?'),
    ("README.md", "README.md: expected the name of an example; known here: "),
    ("answers.json", "answers.json: expected the name of an example"),
    ("clamp" * 1000, "clamp" * 20 + "...: expected the name of an example"),
    ("two\nlines", "'two\\nlines': expected the name of an example"),
    ("a clamp", "known here: "),
    ("../README.md", "expected the name of an example"),
    ("/etc/passwd", "expected the name of an example"),
    ("", "expected the name of an example"),
    (3, "expected a name in quotes, found 3"),
])
def test_other_names_are_bad_input(name, why):
    for call in (poise.example, poise.example_path):
        with pytest.raises(poise.InputError) as error:
            call(name)
        assert why in str(error.value)
