"""A second thermometer is a witness of faults, or stands at another place: then it masks nothing, and this is said."""

import numpy as np
import pytest

from smarig.cli import run
from smarig.study import guess_table, mapping_draft
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
