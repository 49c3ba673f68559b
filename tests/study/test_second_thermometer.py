"""A second thermometer is a witness of faults, or stands at another place: then it masks nothing, and this is said."""

import numpy as np
import pytest

from smarig.cli import run
from smarig.study import guess_table, mapping_draft
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand
from study.known_data import displacements, table_of

PERIOD_S = 0.5


def ramps(cycles=2, rows=160, low=25.0, high=105.0):
    """Temperatures of full cycles of equal ramps, with the direction of each row."""
    up = np.linspace(low, high, rows)
    return np.tile([*up, *up[::-1]], cycles), np.tile(np.repeat([1.0, -1.0], rows), cycles)


def guessed(u, other, name="T_oven"):
    t = np.arange(u.size) * PERIOD_S
    return guess_table(
        table_of(time_s=t, **{"T_wire [degC]": u, f"{name} [degC]": other}, x_mm=displacements(u))
    )


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(("offset", "lag"), [(2.0, 4.0), (-2.0, 4.5), (1.5, -4.2), (0.0, 4.7)])
def test_an_oven_that_lags_masks_nothing(offset, lag, swapped):
    u, way = ramps()
    other = u + offset - lag * way + 0.5 * np.random.default_rng(3).standard_normal(u.size)
    guess = guessed(*((other, u) if swapped else (u, other)))
    (oven,) = guess.of_role("elsewhere")
    assert not guess.of_role("compare")
    draft = mapping_draft(guess, "m")
    assert "[[compare]]" not in draft
    assert "while it heats" in draft[draft.index("[ignore]") :]
    sign = -1 if swapped else 1
    ways = [sign * (offset - lag), sign * (offset + lag)]
    words = [
        f"{'higher' if way > 0 else 'lower'} while it {verb}" for way, verb in zip(ways, ("heats", "cools"))
    ]
    assert all(word in guess.roles[oven.name].reason for word in words)


@pytest.mark.parametrize("where", [(40, 60), (170, 215), (300, 310)])
@pytest.mark.parametrize("of_input", [False, True])
@pytest.mark.parametrize("jump_K", [-12.0, 30.0, 200.0])
def test_a_burst_of_faults_has_a_witness(where, of_input, jump_K):
    u, way = ramps()
    other = u + 0.8 - 0.5 * way
    faulty = (u if of_input else other).copy()
    faulty[slice(*where)] += jump_K
    guess = guessed(*((faulty, other) if of_input else (u, faulty)))
    assert [c.name for c in guess.of_role("compare")] == ["T_oven [degC]"]
    assert "within = 5.0" in mapping_draft(guess, "m")


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("rows", [4, 30])
def test_masked_rows_come_first_with_their_share(tmp_path, capsys, rows):
    u, _ = ramps()
    faulty = u.copy()
    faulty[50 : 50 + rows] += 60.0
    lines = [
        f"{k * PERIOD_S},{a:.3f},{b:.3f},{x:.4f}"
        for k, (a, b, x) in enumerate(zip(faulty, u, displacements(u)))
    ]
    path = tmp_path / "a.csv"
    path.write_text("time_s,T_wire [degC],T_clamp [degC],x_mm\n" + "\n".join(lines) + "\n")
    assert run(["study", str(path), "-o", str(tmp_path / "out"), "--no-diagnosis"]) == 0
    first, *rest = capsys.readouterr().out.splitlines()
    assert f"in {rows} rows (lines 52–{51 + rows}), {100 * rows / u.size:.2g} % of all" in first
    assert not any("disagree by" in line for line in rest)


def test_a_place_elsewhere_is_a_sentence(tmp_path, capsys):
    u, way = ramps()
    lines = [
        f"{k * PERIOD_S},{a:.3f},{b:.3f},{x:.4f}"
        for k, (a, b, x) in enumerate(zip(u, u + 2 - 4 * way, displacements(u)))
    ]
    path = tmp_path / "a.csv"
    path.write_text("time_s,T_wire [degC],T_oven [degC],x_mm\n" + "\n".join(lines) + "\n")
    assert run(["study", str(path), "-o", str(tmp_path / "out"), "--no-diagnosis"]) == 0
    out = capsys.readouterr().out
    assert "'T_oven [degC]' is not used: it usually reads 2 K lower while it heats and 6 K higher" in out
    assert "differs by more than 5 K in 50 % of the rows" in out
    assert "only a heating branch" not in out


def day_cycles(days=4, rows=90):
    """Temperatures of a specimen in the sun, of the air, and of the box of the logger, which lags and warms less."""
    hour = np.arange(days * rows) * 24 / rows
    sun = np.clip(np.sin((hour - 6) / 24 * 2 * np.pi), 0, None)
    late = np.clip(np.sin((hour - 8) / 24 * 2 * np.pi), 0, None)
    return 10 + 27 * sun, 10 + 16 * sun, 11 + 15 * late


@pytest.mark.parametrize(
    "inside", ["PTemp_C", "Board temp [degC]", "Cold junction temp [degC]", "logger temp [degC]"]
)
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_the_thermometer_of_the_instrument_is_no_specimen(inside, order):
    specimen, air, box = day_cycles()
    named = [("TC1 [degC]", specimen), ("T_air [degC]", air), (inside, box)]
    t = np.arange(specimen.size) * 60.0
    columns = {"t [s]": t} | dict(named[k] for k in order) | {"x [mm]": displacements(specimen)}
    guess = guess_table(table_of(**columns))
    assert guess.first("input").name == "TC1 [degC]"
    assert not guess.of_role("compare")


@pytest.mark.parametrize("apart_K", [8.0, 15.0])
def test_a_difference_that_grows_slowly_is_that_of_a_place(apart_K):
    """As beside a fan that runs for some minutes; a fault comes from one row to the next."""
    u, _ = ramps()
    bump = apart_K * np.exp(-(((np.arange(u.size) - 200) / 30) ** 2))
    assert not guessed(u, u + bump, "T2").of_role("compare")
    assert guessed(u, u + np.where(bump > apart_K / 2, apart_K, 0.0), "T2").of_role("compare")


def test_an_input_that_the_user_named_is_not_blamed(tmp_path):
    u, _ = ramps()
    faulty = np.where(np.arange(u.size) // 20 == 7, u + 40, u)
    rows = (f"{k},{a:.3f},{b:.3f},{x:.4f}" for k, (a, b, x) in enumerate(zip(u, faulty, displacements(u))))
    path = tmp_path / "a.csv"
    path.write_text("t [s],T1 [degC],T2 [degC],x [mm]\n" + "\n".join(rows) + "\n")
    (free,) = understand([path], StudyOptions()).guesses
    (named,) = understand([path], StudyOptions(input="T1 [degC]", output="x [mm]")).guesses
    assert free.of_role("compare")
    assert not named.of_role("compare")
    assert "you named the input" in named.roles["T2 [degC]"].reason
