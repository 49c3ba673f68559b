"""Transformation temperatures of measurements by others, against a second implementation and published slopes."""

import numpy as np
import pytest

from smarig.exchange import import_file
from smarig.record import load_run
from smarig.transformation import TEMPERATURES, run_figures, transformation_temperatures
from transformation.second_tangents import corners, mean_branch

NITIHF = (7, 50, 100, 200, 300, 400)
NITICO = (7, 50, 150, 200)


@pytest.fixture
def measured(shared_data, tmp_path):
    def load(file, mapping):
        source = shared_data / file
        if not source.is_file():
            pytest.skip(f"real data {source.name} are not in {source.parent}")
        out = tmp_path / f"{source.stem.replace(' ', '_')}.run.sqlite"
        return load_run(import_file(source, format="csv", mapping=mapping, out=out).run)

    return load


def second(run):
    """The four temperatures of a run of one cycle by the second implementation."""
    u, y = run["input"], run["position"]
    turn = int(np.argmax(u)) if u[0] < u.mean() else int(np.argmin(u))
    parts = [(u[: turn + 1], y[: turn + 1]), (u[turn:], y[turn:])]
    (a_s, a_f), (m_f, m_s) = (corners(*part) for part in sorted(parts, key=lambda p: p[0][0] > p[0][-1]))
    return {"A_s": a_s, "A_f": a_f, "M_s": m_s, "M_f": m_f}


@pytest.mark.parametrize("stress", NITIHF)
def test_both_implementations_agree_within_a_kelvin_on_nitihf(measured, stress):
    run = measured(f"sma_isobaric/cal_sample_2/{stress} MPa.txt", "sma_isobaric_2")
    found = run_figures(run)
    for name, other in second(run).items():
        assert found.means[name].value == pytest.approx(other, abs=1.0), name


@pytest.mark.parametrize("stress", NITICO)
def test_both_implementations_agree_on_nitico_where_readings_allow(measured, stress):
    """Not M_f at 7 MPa, nor the heating at 50 MPa; neither implementation is at fault.

    At 7 MPa the second one finds no three readings on the plateau below M_f, and gives none. At 50 MPa 32 % of the
    output lies between two readings at -9.5 and -5.1 °C. The steepest readings, from -5.1 to -3.8 °C, have 2.2 times
    the slope of that chord; E3097 asks for the steepest, while the second one needs 30 % of the output and so takes
    the chord.
    """
    run = measured(f"sma_isobaric/cal_sample_1/{stress} MPa.txt", "sma_isobaric_1")
    found = run_figures(run)
    left_out = {7: {"M_f"}, 50: {"A_s", "A_f"}}.get(stress, set())
    for name, other in second(run).items():
        if name not in left_out:
            assert found.means[name].value == pytest.approx(other, abs=1.0), name
    if stress in (50, 150):
        assert any("lies between two readings" in note for note in found.notes)


@pytest.mark.long("takes three seconds")
def test_both_implementations_agree_on_fifty_noisy_cycles(measured):
    """The temperature has a noise of 5 K; the second implementation averages the cycles first.

    Its own temperatures move by 1.9 to 3.3 K with the share of the output that its steep tangent uses (the middle half
    to the middle fifth), so an agreement within 1 K is the choice of one share.
    """
    run = measured("sma_cycles/cycles.txt", "sma_cycles")
    found = run_figures(run)
    (unused,) = found.unused
    assert (unused.direction, unused.cycle) == ("heating", 1), "the first heating of an untransformed wire"
    assert found.counts["A_s"] == 49
    assert found.counts["M_s"] == 49, "all figures are of the same cycles"
    u, y = run["input"], run["position"]
    turns = [0]
    for k in range(1, u.size):  # turns of 150 K or more
        best = max(range(turns[-1], k + 1), key=lambda j: abs(u[j] - u[turns[-1]])) if k % 20 == 0 else None
        if best is not None and abs(u[best] - u[turns[-1]]) > 150 and abs(u[k] - u[best]) > 75:
            turns.append(best)
    branches = [(u[a : b + 1], y[a : b + 1]) for a, b in zip(turns[1:], turns[2:])]
    heating = mean_branch([b for b in branches if b[0][-1] > b[0][0]])
    cooling = mean_branch([b for b in branches if b[0][-1] < b[0][0]])
    (a_s, a_f), (m_f, m_s) = (corners(*b, middle=(0.3, 0.7)) for b in (heating, cooling))
    for name, other in {"A_s": a_s, "A_f": a_f, "M_s": m_s, "M_f": m_f}.items():
        low, high = found.means[name].ci95
        assert low <= other <= high, name
        assert found.means[name].value == pytest.approx(other, abs=2.0), name
    assert found.drift["stroke"].ci95[0] > 0, "the stroke grows"
    assert found.drift["A_s"].ci95[1] < 0, "A_s falls"
    assert found.means["residual"].ci95[0] > 0, "the cycles do not close"


def test_flexinol_follows_clausius_and_clapeyron(measured):
    """Published for NiTi: 7 to 10 MPa/K."""
    runs = [
        measured(f"flexinol_isobaric/filtered_data_{s}MPa.txt", "flexinol_isobaric") for s in (50, 100, 150)
    ]
    found = {s.temperature: s for s in transformation_temperatures(runs).stress}
    assert set(found) == set(TEMPERATURES)
    for name, s in found.items():
        assert s.C_MPa_per_K is not None
        assert 6.5 < s.C_MPa_per_K < 9.5, name
        low, high = s.C_ci95_MPa_per_K
        assert low < s.C_MPa_per_K < high
        assert s.load == "tension"
        assert s.n == 3


def test_nitihf_rises_with_stress_at_all_four_temperatures(measured):
    runs = [measured(f"sma_isobaric/cal_sample_2/{s} MPa.txt", "sma_isobaric_2") for s in NITIHF]
    found = {s.temperature: s for s in transformation_temperatures(runs).stress}
    for s in found.values():
        assert s.dT_dstress_ci95_K_per_MPa[0] > 0
        assert s.C_MPa_per_K is not None
        assert 7 < s.C_MPa_per_K < 18
    assert found["A_f"].C_MPa_per_K < found["A_s"].C_MPa_per_K, "the transformation widens with stress"
