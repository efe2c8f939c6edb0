"""A sample of what damage.py judges: damaged records are harmless or named, and sound ones are believed.

Another sample in each round of `make campaign TESTS=Python.damage`.
"""

import os

import damage
import pytest

ROUND = int(os.environ.get("POISE_CAMPAIGN", "0"))
PROGRAM = os.environ["POISE_EXECUTABLE"]
#: Of the kinds of damage, one in so many.
ONE_IN = 31


def test_there_are_64_kinds_of_damage():
    assert len({one.title for one in damage.DAMAGES}) >= 64


@pytest.mark.parametrize("one", damage.DAMAGES[ROUND % ONE_IN::ONE_IN], ids=lambda one: one.title)
def test_damage_is_harmless_or_named(one):
    judged = damage.judge(PROGRAM, one, seed=ROUND + 1)
    assert judged.is_right, f"{judged.outcome}: {judged.words}"


@pytest.mark.parametrize("rig", ["swing", "cart"])
def test_sound_records_are_believed(rig):
    for title, records in damage.sound([rig], seed=ROUND + 1, count=2):
        code, said, _ = damage.ask(PROGRAM, records)
        assert code == 0, f"{title}: {said}"
