"""Reversal-curve files: header, units, order, calibration points, inconsistent files, drift."""

import numpy as np
import pytest

from smarig.core.errors import DataError, UsageError
from smarig.exchange import ForcCurves, correct_drift_if_it_helps, drift_corrected
from smarig.exchange.checks.drift import corrected, held_out_misses

HEADER = """MicroMag 2900/3900 Data File (Series 0015)
First-order reversal curves
Configuration   :  VSM
Units of measure:  {units}
01/22/2015  17:35
"5 µm wires"

HCal           = +1.000000E+00
HSat           = +2.000000E+00
NCrv           = {curves}
Moment range   = +2.000000E+01

NData          = {points}
"""
END = "\nMicroMag 2900/3900 Data File ends\n"


def _moment(h, h_a):
    """A smooth family of reversal curves, saturated at 1."""
    return np.tanh(4 * h) * 0.5 + 0.5 * np.tanh(4 * h_a) + 0.1 * (h - h_a) * h_a


def _blocks(curves=8, points=9, gain=lambda k: 1.0):
    """Alternately [calibration point] and curve, in measured order; gain by running sample."""
    blocks, k = [], 0
    for h_a in np.linspace(0.4, -0.8, curves):
        for h in ([1.0], np.linspace(h_a, 0.9, points)):
            m = [_moment(x, h_a) if len(h) > 1 else 1.0 for x in h]
            blocks.append([(x, y * gain(k + j)) for j, (x, y) in enumerate(zip(h, m))])
            k += len(h)
    return blocks


def _text(blocks, units="Hybrid SI", **promises):
    n = sum(len(b) for b in blocks)
    promised = {"units": units, "curves": len(blocks) // 2, "points": n} | promises
    body = "\n\n".join("\n".join(f"{h:+.6E},{m:+.6E}" for h, m in b) for b in blocks)
    return HEADER.format(**promised) + "\n" + body + "\n" + END


def _imported(write, imported, text):
    return imported(write(text.encode("latin-1"), "x.forc"), format="forc")


def test_samples_stand_in_measured_order_with_curve_numbers(write, imported):
    blocks = _blocks()
    run = _imported(write, imported, _text(blocks))
    expected = np.array([point for block in blocks for point in block])
    np.testing.assert_allclose(run["input"], expected[:, 0], atol=1e-6)
    np.testing.assert_allclose(run["position"], expected[:, 1], atol=1e-6)
    assert run["step"].tolist() == [s for k in range(8) for s in [-1] + [k] * 9]
    assert run["input"][0] == 1.0  # positive saturation comes first
    assert run.steps == ()
    inputs, outputs = run.points()
    assert inputs.size == outputs.size == 80


def test_the_header_is_kept(write, imported):
    meta = _imported(write, imported, _text(_blocks())).meta
    assert meta["protocol"] == "first_order_reversal_curves"
    assert meta["forc"]["curves"] == 8
    assert meta["forc"]["calibration_points"] == 8
    assert meta["forc"]["HSat"] == "+2.000000E+00"
    assert meta["forc"]["Configuration"] == "VSM"
    assert meta["forc"]["line 6"] == '"5 µm wires"'  # a Latin-1 byte
    assert any("Latin-1" in w for w in meta["warnings"])


@pytest.mark.parametrize(
    ("units", "field", "moment"), [("Hybrid SI", "T", "A m^2"), ("cgs", "Oe", "emu"), ("SI", "A/m", "A m^2")]
)
def test_units_follow_the_header(write, imported, units, field, moment):
    run = _imported(write, imported, _text(_blocks(), units))
    assert (run.input_unit, run.unit) == (field, moment)


def test_a_lake_shore_8600_file_states_its_units_per_column(write, imported):
    """The system is called SiMuNaughtH there (µ0 H in T), and the line before the data names both units."""
    named = _imported(write, imported, _text(_blocks(), "SiMuNaughtH"))
    assert (named.input_unit, named.unit) == ("T", "A m^2")
    text = _text(_blocks(), "SomethingNew").replace("NData", "\tField\t\tMoment\n\t(Oe)\t\t(Am\xb2)\nNData")
    run = _imported(write, imported, text)
    assert (run.input_unit, run.unit) == ("Oe", "A m^2")


def test_the_newer_header_with_spaces_is_read(write, imported):
    text = _text(_blocks()).replace(":  ", "        ").replace(" = ", "      ")
    run = _imported(write, imported, text)
    assert run.meta["forc"]["Units of measure"] == "Hybrid SI"
    assert run.meta["forc"]["HCal"] == "+1.000000E+00"
    assert run.meta["forc"]["curves"] == 8


def test_the_initial_state_is_saturation_if_the_header_states_its_field(write, imported):
    assert _imported(write, imported, _text(_blocks())).info.initial == "positive"
    for field in (
        "HSat           = +5.000000E-01",
        "HSat           = unknown",
    ):  # below the points; no number
        text = _text(_blocks()).replace("HSat           = +2.000000E+00", field)
        assert _imported(write, imported, text).info.initial is None


def test_calibration_points_are_recognised_without_hcal(write, imported):
    text = "".join(x for x in _text(_blocks()).splitlines(keepends=True) if not x.startswith("HCal"))
    assert _imported(write, imported, text).meta["forc"]["calibration_points"] == 8


def test_a_curve_of_one_point_is_a_curve(write, imported):
    blocks = _blocks()
    blocks[1] = blocks[1][:1]
    run = _imported(write, imported, _text(blocks))
    assert run.meta["forc"]["curves"] == 8
    assert run["step"][:3].tolist() == [-1, 0, -1]


def _warned(write, imported, text):
    return " ".join(_imported(write, imported, text).meta["warnings"])


def test_a_truncated_file_is_read_and_reported(write, imported):
    whole = _text(_blocks())
    cut = whole[: int(len(whole) * 0.7)].rsplit("\n", 1)[0]
    said = _warned(write, imported, cut)
    assert "was cut off" in said
    assert "declares 80 points (NData), but the file holds" in said
    assert "declares 8 curves (NCrv), but the file holds" in said


def test_contradictions_are_reported(write, imported):
    blocks = _blocks()
    blocks[5][3], blocks[5][4] = blocks[5][4], blocks[5][3]
    said = _warned(write, imported, _text(blocks, curves=9))
    assert "declares 9 curves" in said
    assert "field does not rise within a curve in 1 place(s)" in said
    swapped = _blocks()
    swapped[5], swapped[7] = swapped[7], swapped[5]
    assert "Reversal fields do not descend in 1 place(s)" in _warned(write, imported, _text(swapped))
    assert "saturated at 2 T before each calibration point" in said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("hello\nworld\n", "holds no line 'field, moment'"),
        (_text(_blocks()).replace("Units of measure:  Hybrid SI\n", ""), "no 'Units of measure'"),
        (_text(_blocks(), "furlongs"), "'furlongs' are unknown"),
        (_text(_blocks()[::2]), "only 8 calibration points"),
        (_text(_blocks()).replace("+9.000000E-01,", "+9.000000E-01,x", 1), "is not a field and a moment"),
        ("", "is empty"),
    ],
)
def test_what_is_no_such_file_is_refused(write, imported, text, said):
    with pytest.raises(DataError, match=said):
        _imported(write, imported, text)


def test_a_mapping_is_refused(write, imported):
    path = write(_text(_blocks()).encode("latin-1"), "x.forc")
    with pytest.raises(UsageError, match="Leave out --rig and --map"):
        imported(path, format="forc", mapping="sma_cycles")


def _curves(gain=lambda k: 1.0, noise=0.0):
    blocks = _blocks(curves=40, points=30, gain=gain)
    h, m = np.array([p for b in blocks for p in b]).T
    number = np.concatenate([np.full(len(b), -1 if k % 2 == 0 else k // 2) for k, b in enumerate(blocks)])
    calibration = np.random.default_rng(7).normal(0, noise, m.size) * (number < 0)
    return ForcCurves(h, m + calibration, number)


def test_drift_of_gain_is_taken_out():
    def gain(k):
        return 1 + 0.05 * np.sin(k / 40)  # a period of eight curves

    drifting, steady = _curves(gain), _curves()
    curves, decision = correct_drift_if_it_helps(drifting)
    assert decision.kind == "multiplicative"
    assert decision.error["multiplicative"] < 0.5 * decision.error["none"]
    left = np.abs(curves.moment / curves.moment[0] - steady.moment)
    assert left.max() < 0.2 * np.abs(drifting.moment / drifting.moment[0] - steady.moment).max()


def test_noisy_calibration_points_correct_nothing():
    curves, decision = correct_drift_if_it_helps(_curves(noise=0.01))
    assert decision.kind == "none"
    assert decision.error["none"] < decision.error["multiplicative"]
    np.testing.assert_array_equal(curves.moment, _curves(noise=0.01).moment)
    assert "left as it is" in decision.sentence("emu")
    assert f"n = {decision.n}" in decision.sentence("emu")


def test_additive_drift_is_taken_out_exactly_where_it_is_linear():
    steady = _curves()
    k = np.arange(steady.moment.size)
    drifting = ForcCurves(steady.field, steady.moment + 1e-4 * k, steady.curve)
    fixed = corrected(drifting, "additive").moment
    between = slice(0, int(np.flatnonzero(steady.curve < 0)[-1]))
    np.testing.assert_allclose(np.ptp((fixed - steady.moment)[between]), 0, atol=1e-12)


def test_held_out_prediction_is_exact_where_curves_are_linear_in_their_reversal_field():
    h_a = np.linspace(0.5, -0.5, 9)
    parts = [(np.full(20, k), np.linspace(a, 1, 20), a) for k, a in enumerate(h_a)]
    number, field = (np.concatenate([p[j] for p in parts]) for j in (0, 1))
    moment = np.concatenate([p[1] + 0.3 * p[2] for p in parts])
    assert np.abs(held_out_misses(ForcCurves(field, moment, number))).max() < 1e-12


def test_the_run_stores_the_drift_decision_and_its_uncorrected_moments(write, imported):
    run = _imported(write, imported, _text(_blocks(40, 30, lambda k: 1 + 0.05 * np.sin(k / 40))))
    assert run.meta["forc"]["drift"]["kind"] == "multiplicative"
    moment, decision = drift_corrected(run)
    assert decision.record() == run.meta["forc"]["drift"]
    assert np.abs(moment - run["position"]).max() > 0.01


def test_drift_needs_calibration_points(write, imported, small_csv):
    with pytest.raises(DataError, match="no calibration points"):
        drift_corrected(imported(write(small_csv)))


@pytest.mark.parametrize(
    ("written", "units"),
    [
        ("SI (T, A·m²)", ("T", "A m^2")),
        ("cgs (kOe; emu)", ("kOe", "emu")),
        ("instrument's own (mT, Am2)", ("mT", "A m^2")),
    ],
)
def test_units_that_are_listed_behind_their_system_count(write, imported, written, units):
    run = _imported(write, imported, _text(_blocks(), units=written))
    assert (run.input_unit, run.unit) == units


def test_unknown_units_behind_a_system_are_refused(write, imported):
    with pytest.raises(DataError, match="units of measure 'SI .T, furlong.' are unknown"):
        _imported(write, imported, _text(_blocks(), units="SI (T, furlong)"))
