"""Each gate before a name, alone: the name falls if, and only if, its gate is not passed."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.explain.channel_misfit import ChannelMisfit
from smarig.diagnosis.explain.discrepancy import Discrepancy
from smarig.diagnosis.explain.separate_evidence import SeparateEvidence
from smarig.diagnosis.name_gates import NameEvidence, gated

from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.plant import effects_from_pairs

QUIET = Discrepancy("", "", 0.0, room_K=0.05, correlation_s=120.0, noise=0.01)
NAMED = DiagnosisVerdict("named", ((("settling",), 1.0),))
SILENT = DiagnosisVerdict("silent")
BLOCKS = np.repeat(np.arange(12), 5)


def gain(base, extended, floor=0.1):
    wave = np.sqrt(2) * np.cos(np.arange(BLOCKS.size) * 2.0)
    return HeldOutGain(base * wave, extended * wave, BLOCKS, floor)


def uneven_gain(base, extended, extended_elsewhere, base_elsewhere=1.0):
    """Errors that are the same in all blocks but the first."""
    one, others = gain(base, extended), gain(base_elsewhere, extended_elsewhere)
    first = BLOCKS == 0
    return replace(
        others,
        base_error=np.where(first, one.base_error, others.base_error),
        extended_error=np.where(first, one.extended_error, others.extended_error),
    )


def level(strength=2.0, sd=0.1, name="settling", others=(), gain=400.0):
    (effect,) = effects_from_pairs([f"{name}={strength}"])
    spread = {(name, p): sd for p in (effect.kind.primary.name, *others)}
    return SimpleNamespace(best=SimpleNamespace(effects=(effect,), spread=spread), gain=gain)


CURRENT = ChannelMisfit("current", 100, before=3.0, after=1.5)

GOOD = NameEvidence(
    (level(),), 400.0, replace(QUIET, variable="time", gain=200.0), QUIET, gain(1.0, 0.2), 0.3, alarm=True
)


def test_a_name_that_passes_every_gate_stands():
    found = gated(NAMED, GOOD)
    assert found.verdict is NAMED
    assert not found.reason


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"levels": (level(strength=10.0),)}, "bound of its search"),
        ({"levels": (level(strength=9.7, sd=0.4),)}, "bound of its search"),
        ({"levels": (level(strength=9.5, sd=0.4),)}, ""),
        ({"levels": (level(strength=0.1, sd=0.2),)}, "contains no effect"),
        # A swing may be made up for by its period and phase; without all three the likelihood falls, or hardly:
        ({"levels": (level(1.0, 0.8, "ambient_drift", ("period_h", "phase"), gain=100.0),)}, ""),
        (
            {"levels": (level(1.0, 0.8, "ambient_drift", ("period_h", "phase"), gain=20.0),)},
            "contains no effect",
        ),
        ({"levels": (level(1.0, 0.8, "ambient_drift", gain=100.0),)}, "contains no effect"),
        ({"gain": None, "fitted_ratio": 1.05}, ""),
        ({"gain": None, "fitted_ratio": 1.15}, "the training runs are missed by more than without"),
        ({"gain": None, "fitted_ratio": 1.15, "channels": (replace(CURRENT, after=1.2),)}, ""),
        ({"fitted_ratio": 1.15}, ""),  # another channel shows it, and the positions pay for it
        (
            {"before": replace(QUIET, variable="cycle", gain=900.0)},
            "dependence on the number of cycles explains more",
        ),
        ({"after": replace(QUIET, variable="level", gain=90.0)}, "still depend on the output itself"),
        ({"gain": gain(1.0, 1.2)}, "predicts the held-out runs worse"),
        ({"gain": gain(1.0, 0.95)}, "do not bear out settling (R = 0.10)"),
        ({"gain": gain(1.0, 0.77)}, "do not bear out settling (R = 0.41)"),
        ({"gain": gain(1.0, 0.7)}, ""),
        ({"gain": gain(1.0, 0.95), "fitted_ratio": 0.98}, ""),  # another channel shows it
        ({"gain": gain(1.0, 1.01), "fitted_ratio": 0.98}, "do not bear out settling (R = -0.02)"),
        (
            {"before": replace(QUIET, variable="cycle", gain=395.0)},
            "dependence on the number of cycles explains more",
        ),
        ({"levels": (level(-3.0, name="walking"),)}, "bound of its search"),
        # Less than noise alone reaches, though more than the effect less its lead:
        ({"effect_nats": 20.0, "before": replace(QUIET, variable="cycle", gain=12.0)}, ""),
        # What is left is little compared with the effect, or with noise:
        ({"after": replace(QUIET, variable="level", gain=50.0)}, ""),
        ({"effect_nats": 100.0, "before": QUIET, "after": replace(QUIET, variable="level", gain=20.0)}, ""),
        # Slightly worse in every block; worse in one of them only; worse below the floor:
        ({"gain": gain(1.0, 1.05)}, "predicts the held-out runs worse"),
        # No worse than another density would be, of a name that another channel carries:
        ({"gain": gain(1.0, 1.01), "channels": (replace(CURRENT, after=1.2),)}, ""),
        ({"gain": uneven_gain(1.0, 2.0, 0.88), "channels": (replace(CURRENT, after=1.2),)}, ""),
        ({"gain": uneven_gain(1.0, 2.0, 0.88), "fitted_ratio": 0.98}, "do not bear out"),  # never at R ≤ 0
        ({"gain": gain(0.05, 0.08)}, ""),
        # A channel that carries the name, and still misses by more than its noise:
        ({"channels": (CURRENT,)}, "with settling, the current still misses by 1.5 × its noise"),
        ({"channels": (replace(CURRENT, after=1.2),)}, ""),
        ({"channels": (replace(CURRENT, expected=1.4),)}, ""),  # equations are approximations
        ({"channels": (replace(CURRENT, readings=30),)}, ""),  # the positions carry the name
        # Positions that a density makes up for decide nothing about a name that another channel carries:
        ({"gain": gain(1.0, 0.95), "channels": (replace(CURRENT, after=1.2),)}, ""),
        ({"gain": gain(1.0, 0.95), "channels": (replace(CURRENT, readings=30),)}, "do not bear out"),
        ({"gain": gain(1.0, 1.2), "channels": (replace(CURRENT, after=1.2),)}, "held-out runs worse"),
        # Most of the error is in one block, and the extended model is better in all others:
        ({"gain": uneven_gain(20.0, 19.0, 0.2)}, ""),
    ],
)
def test_each_gate_alone_takes_the_name_away(change, words):
    found = gated(NAMED, replace(GOOD, **change))
    if words:
        assert found.verdict.word == "unknown"
        assert words in found.reason
        assert found.verdict.explanations == NAMED.explanations  # the nearest name stays visible
    else:
        assert found.verdict.word == "named"


def test_at_the_floor_held_out_runs_decide_nothing():
    assert gated(NAMED, replace(GOOD, gain=gain(0.1, 0.1))).verdict.word == "named"


def test_a_variable_does_not_take_away_a_name_that_held_out_runs_bear_out():
    doubted = DiagnosisVerdict("unknown", NAMED.explanations, "time")
    assert gated(doubted, replace(GOOD, gain=gain(1.0, 0.15))).verdict.word == "named"
    assert gated(doubted, replace(GOOD, gain=gain(1.0, 0.8))).verdict == doubted
    assert gated(doubted, replace(GOOD, gain=None)).verdict == doubted


@pytest.mark.parametrize(
    ("held_out", "share"),
    [
        (gain(1.0, 0.456), 0.8),  # certain, but too small
        (uneven_gain(1.0, 1.2, 0.05), 0.89),  # large, but one block contradicts it
        (gain(0.11, 0.1), 1.0),  # of an error that is hardly more than the floor
    ],
)
def test_a_doubted_name_needs_a_large_and_certain_gain_above_the_floor(held_out, share):
    doubted = DiagnosisVerdict("unknown", NAMED.explanations, "time")
    assert held_out.removable_share == pytest.approx(share, abs=0.01)
    assert gated(doubted, replace(GOOD, gain=held_out)).verdict == doubted


def test_without_a_name_the_variable_is_that_of_a_clear_discrepancy():
    """Else that of the first test."""
    doubted = DiagnosisVerdict("unknown", NAMED.explanations, "level")
    clear = replace(GOOD, before=replace(QUIET, variable="cycle", gain=900.0))
    assert gated(doubted, clear).verdict.depends_on == "cycle"
    weak = replace(GOOD, effect_nats=10.0, before=replace(QUIET, variable="cycle", gain=20.0))
    assert gated(doubted, weak).verdict.depends_on == "level"


@pytest.mark.parametrize(
    ("before", "depends_on"),
    [
        (replace(QUIET, variable="walk", gain=60.0), "history"),
        (replace(QUIET, variable="rate", gain=60.0), "rate"),
        (replace(QUIET, room_K=0.35, correlation_s=300.0), "time"),
        (replace(QUIET, variable="walk", gain=60.0, room_K=0.35, correlation_s=300.0), "time"),
        (replace(QUIET, variable="walk", gain=160.0, room_K=0.35, correlation_s=300.0), "history"),
    ],
)
def test_nothing_is_silent_while_a_discrepancy_stands_out(before, depends_on):
    found = gated(SILENT, replace(GOOD, levels=(), before=before, after=None))
    assert found.verdict.word == "unknown"
    assert found.verdict.depends_on == depends_on


@pytest.mark.parametrize(
    "before",
    [
        QUIET,
        replace(QUIET, variable="rate", gain=15.0),
        replace(QUIET, room_K=0.3, correlation_s=30.0),
        replace(QUIET, room_K=0.1, correlation_s=300.0),
    ],
)
def test_noise_and_draughts_stay_silent(before):
    found = gated(SILENT, replace(GOOD, levels=(), before=before, after=None, gain=gain(0.2, 0.2)))
    assert found.verdict is SILENT


@pytest.mark.parametrize(
    ("change", "word", "variable"),
    [
        ({}, "silent", None),
        ({"before": QUIET}, "silent", None),
        ({"before": replace(QUIET, variable="level", gain=40.0)}, "unknown", "level"),
        ({"gain": gain(1.0, 0.15)}, "named", None),  # borne out beyond doubt
        ({"alarm": True}, "named", None),
    ],
)
def test_a_name_that_wires_without_an_effect_get_as_well_is_none(change, word, variable):
    """Unless held-out runs bear it out beyond doubt; a discrepancy is a finding by itself."""
    small = replace(GOOD, alarm=False, gain=gain(1.0, 0.7, floor=0.3), before=replace(QUIET, gain=12.0))
    found = gated(NAMED, replace(small, **change))
    assert (found.verdict.word, found.verdict.depends_on) == (word, variable)
    assert ("wires without an effect" in found.reason) == (word != "named")
    assert bool(found.verdict.explanations) == (word != "silent")


@pytest.mark.parametrize(("times_noise", "word"), [(1.3, "silent"), (4.5, "silent"), (31.0, "unknown")])
def test_nothing_is_silent_while_the_error_is_many_times_the_noise(times_noise, word):
    """No positive density follows a wire that is no Preisach operator, though each candidate gains little."""
    before = replace(QUIET, variable="step", gain=22.9)
    at_floor = gain(0.1, 0.1)
    found = gated(SILENT, replace(GOOD, levels=(), before=before, times_noise=times_noise, gain=at_floor))
    assert found.verdict.word == word
    assert found.verdict.depends_on == ("step" if word == "unknown" else None)
    assert ("31 × their remaining scatter" in found.reason) == (word == "unknown")


def separate(name, nats=400.0, over_discrepancy=300.0, **by_kind):
    (effect,) = effects_from_pairs([name])
    return SeparateEvidence(effect, nats, by_kind, over_discrepancy)


STILL_WRONG = replace(GOOD, gain=gain(3.0, 0.8), times_noise=12.0)  # R = 0.93, 8 × the floor


@pytest.mark.parametrize(
    ("one", "words"),
    [
        (separate("settling=2", settled=300.0, moving=100.0), ""),
        (
            separate("settling=2", over_discrepancy=150.0, settled=300.0),
            "dependence on one variable explains most",
        ),
        # What only transients show: in them, mostly in settled positions, in the resistance
        (separate("wire_lag=50", settled=10.0, moving=390.0), ""),
        (separate("wire_lag=50", settled=300.0, moving=100.0), "is in the moving positions"),
        (separate("latent_heat=24", moving=-30.0, resistance=430.0), "is in the moving positions"),
        (separate("latent_heat=24", settled=50.0, moving=90.0, resistance=220.0), ""),
        (separate("wire_lag=50", nats=20.0, moving=20.0), "is in the moving positions"),  # less than chance
        (separate("amplifier_gain=2", settled=100.0, current=300.0), ""),
        # A part of a classical density, whatever its likelihood:
        (
            separate("r_phase=5", nats=900.0, over_discrepancy=900.0, settled=900.0),
            "part of a classical density",
        ),
    ],
)
def test_an_effect_in_a_wrong_model_needs_evidence_of_its_own(one, words):
    kind = one.effect.kind
    named = DiagnosisVerdict("named", (((kind.name,), 1.0),))
    found_level = SimpleNamespace(
        best=SimpleNamespace(effects=(one.effect,), spread={(kind.name, kind.primary.name): 0.1}), gain=400.0
    )
    found = gated(named, replace(STILL_WRONG, levels=(found_level,), separate=(one,)))
    if not words:
        assert found.verdict is named
    else:
        assert found.verdict.word == "unknown"
        assert found.verdict.names == ()
        assert words in found.reason


def test_held_out_runs_bear_on_effects_of_positions_in_a_wrong_model():
    one = separate("settling=2", settled=400.0)
    found = gated(NAMED, replace(STILL_WRONG, gain=gain(1.0, 0.8), fitted_ratio=0.98, separate=(one,)))
    assert found.verdict.word == "unknown"
    assert "most of the error of the held-out runs remains (R = 0.36)" in found.reason


def test_in_a_wrong_model_the_candidates_are_those_with_evidence_of_their_own():
    """The set of an unknown finding holds no effect that only stands in for an error of the operator."""
    effects = separate("wire_lag=50", moving=390.0), separate("r_phase=5", settled=400.0)
    both = DiagnosisVerdict("unknown", ((("r_phase", "wire_lag"), 1.0),), "history")
    spread = {("r_phase", "share_percent"): 0.1, ("wire_lag", "change_percent"): 0.1}
    best = SimpleNamespace(effects=tuple(s.effect for s in effects), spread=spread)
    evidence = replace(STILL_WRONG, levels=(SimpleNamespace(best=best, gain=400.0),), separate=effects)
    found = gated(both, evidence)
    assert found.verdict.names == ("wire_lag",)
    assert found.verdict.depends_on is not None
    assert found.verdict.explanations == both.explanations


@pytest.mark.parametrize("channels", [(), (replace(CURRENT, after=1.2),)])
def test_a_model_that_stays_wrong_names_nothing_that_held_out_runs_do_not_bear_out(channels):
    """Unless another channel carries the name; else an effect with evidence of its own is a candidate."""
    one = separate("settling=2", settled=400.0)
    found = gated(NAMED, replace(STILL_WRONG, gain=gain(1.0, 0.6), channels=channels, separate=(one,)))
    assert found.verdict.word == ("named" if channels else "unknown")
    assert found.verdict.names == ("settling",)
    assert ("still misses the held-out runs by 6 ×" in found.reason) == (not channels)


def test_evidence_of_its_own_counts_only_where_the_model_is_wrong():
    """An effect that brings the model near the floor is judged by the gates for all."""
    one = separate("r_phase=5", settled=400.0)
    assert gated(NAMED, replace(GOOD, separate=(one,))).verdict is NAMED
    assert gated(NAMED, replace(STILL_WRONG, times_noise=2.0, separate=(one,))).verdict is NAMED


@pytest.mark.parametrize(
    ("before", "names"),
    [
        (replace(QUIET, variable="walk", gain=900.0), ()),  # minor loops do not return
        (replace(QUIET, variable="time", gain=900.0), ("settling",)),  # another gate alone: the nearest name
    ],
)
def test_where_minor_loops_do_not_return_a_refused_name_is_no_candidate(before, names):
    """An effect near the floor, of which a flexible dependence on the history explains most."""
    one = separate("settling=2", over_discrepancy=70.0, settled=400.0)
    found = gated(NAMED, replace(GOOD, before=before, separate=(one,) if not names else ()))
    assert found.verdict.word == "unknown"
    assert found.verdict.names == names
