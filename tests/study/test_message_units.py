"""Records of messages whose convention is SI units; the offers for a unit begin with that of SI."""

import numpy as np
import pytest

from smarig.study import guess_table
from smarig.study.questions import StudyCommand, answering
from smarig.study.study_options import StudyOptions
from study.known_data import table_of

T = np.arange(240) * 0.02
U = 2e5 - 2e5 * np.cos(T * 6)
X = 0.25 - 0.04 * np.tanh((U - 2e5) / 5e4)


@pytest.mark.parametrize(
    ("stamp", "prefix"),
    [("field.header.stamp", "field."), ("/rig/header/stamp/secs", "/rig/"), ("header.stamp", "")],
)
@pytest.mark.parametrize(("name", "unit"), [("length", "m"), ("position", "m"), ("angle", "rad")])
def test_messages_are_in_si_units(stamp, prefix, name, unit):
    columns = {
        "%time": T * 1e9 + 1.5e18,
        stamp: T * 1e9 + 1.5e18,
        f"{prefix}pressure": U,
        f"{prefix}{name}": X,
    }
    guess = guess_table(table_of(**columns))
    assert not guess.doubts
    assert [(c.unit, c.unit_is_assumed) for role in ("input", "output") for c in guess.of_role(role)] == [
        ("Pa", False),
        (unit, False),
    ]


@pytest.mark.parametrize(("name", "first"), [("Druck", "Pa"), ("chamber pressure", "Pa")])
def test_the_offers_for_a_pressure_begin_with_pascal(name, first):
    guess = guess_table(table_of(**{"t [s]": T, name: U, "x [mm]": X}))
    assert guess.doubts == [f"unit {name}"]
    commands = answering(guess, StudyCommand((guess.table.path,), StudyOptions()))
    assert commands.index(f"'{name}={first}'" if " " in name else f"{name}={first}") < commands.index("=bar")
    assert "=1" not in commands
