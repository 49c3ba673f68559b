"""The first sentences of a characterisation say what its figures say, for every pattern of figures."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from report.pages import run_of, step
from smarig.diagnosis import Finding
from smarig.identification import ErrorLevel, Verification, error_verdict
from smarig.plant.effects.walking import walking
from smarig.report.models.assessment import assessment

WORDS = ("named", "ambiguous", "unknown", "not_identifiable", "silent", None)
ERRORS = {
    "none": None,
    "good": (0.01, 0.02),
    "fair": (0.05, 0.02),
    "poor": (0.2, 0.02),
    "unmeasured": (0.2, None),
}


def run():
    t = np.arange(100.0)
    columns = {"t_s": t, "input": t, "position": t / 10}
    return run_of(columns, (step(0, 1.0, 2.0), step(1, 2.0, 3.0)), output={"unit": "mm"}, input={"unit": "K"})


class Gain(SimpleNamespace):
    """Errors on held-out runs, the same in both measures."""

    @property
    def extended_error(self):
        return self.extended

    def settled_rms(self, error):
        return error


def diagnosis(word, gains, own_stroke=0.9):
    if word is None:
        return None
    effect = walking(0.3)
    value = {"value": 0.3, "ci95": [0.2, 0.4], "unit": "%/cycle"}
    finding = Finding("walking", 0.97, {"percent_per_cycle": value})
    return SimpleNamespace(
        verdict=SimpleNamespace(word=word, names=("walking", "creep"), depends_on="level"),
        findings=(finding,) if word == "named" else (),
        likely_effects=(effect,) if word == "named" else (),
        gain=Gain(base=0.5, extended=0.1 if gains else 0.6, floor=1.0),
        not_preisach=False,
        learned=None,
        extended=word == "named",
        error=SimpleNamespace(unit="mm"),
        model=SimpleNamespace(
            unit="mm", hysteresis=SimpleNamespace(lower=0, upper=1, everett=lambda *_: own_stroke)
        ),
        timeline=SimpleNamespace(unit="mm"),
    )


def evidence(word, error, *, model=True, holds=True, gains=True):
    rms_floor = ERRORS[error]
    one = rms_floor and SimpleNamespace(
        noise_floor=rms_floor[1], settled=SimpleNamespace(n=5, rms=rms_floor[0], nrmse=rms_floor[0] / 10)
    )
    test = SimpleNamespace(
        name="congruency", holds=holds, rms=0.3, times_noise=3, unit="mm", p_text="p = 0.5"
    )
    return SimpleNamespace(
        runs={"made": run()},
        representation=(test,),
        extension=None,
        best=SimpleNamespace(model=SimpleNamespace(unit="mm", provenance=())) if model else None,
        of=lambda *_: [],
        chosen="table",
        verifications={"table": Verification("model", "mm", (one,))} if one else {},
        diagnosis=diagnosis(word, gains),
    )


@pytest.mark.parametrize(
    ("word", "error", "model", "holds", "gains"),
    list(itertools.product(WORDS, ERRORS, *[(True, False)] * 3)),
)
def test_no_sentence_contradicts_the_figures(word, error, model, holds, gains):
    found = assessment(evidence(word, error, model=model, holds=holds, gains=gains))
    text = f"{found.measured} {found.quality} {found.advice}"
    alone = " (0.900 mm without walking and creep)" if word == "named" else ""
    assert found.measured == (
        f"Measured: a stroke of 1.00 mm{alone} over 1 K, 2 settled points in 1 run, 99 s on the rig."
    )
    loud = word in ("named", "ambiguous", "unknown")
    usable = model and error == "good" and word in ("silent", None)
    assert ("can be used as it is" in text) == usable
    assert (found.level == "good") == usable
    assert (found.level == "bad") == (not model or error == "poor" or loud)
    assert ("the noise floor: good" in found.quality) == (model and error == "good")
    rejected = model and error != "none" and not holds
    assert ("Preisach operator" in text) == rejected
    assert ("no Preisach operator" in text) == (rejected and word != "named")
    if model:
        assert ("Cause: walking" in text) == (word == "named")
        smaller = error in ("good", "fair")  # than that of the extended model
        assert ("the extended model (" in text) == (word == "named" and gains and not smaller)
        assert ("Candidates, not proved: walking, creep" in text) == (word == "unknown")
        assert ("no effect of the catalogue is certain" in text) == (word == "unknown")
        assert ("Measure minor loops of equal amplitude" in text) == (word == "unknown")
        assert ("No disturbance" in text) == (word == "silent" and error in ("good", "none"))
    else:
        assert "No model was identified" in text
    assert all(sentence.endswith(".") for sentence in (found.measured, found.quality, found.advice))
    assert "  " not in text


@pytest.mark.parametrize(
    ("rms", "floor", "share", "level"),
    [
        (0.1, 0.1, 0.5, ErrorLevel.GOOD),
        (0.2, 0.1, 0.0, ErrorLevel.FAIR),
        (0.9, 0.1, 0.0, ErrorLevel.POOR),
        (0.9, None, 0.3, ErrorLevel.POOR),
        (0.9, None, 0.01, ErrorLevel.UNKNOWN),
        (0.0, 0.0, 0.0, ErrorLevel.UNKNOWN),
    ],
)
def test_the_verdict_follows_the_noise_and_without_it_the_travel(rms, floor, share, level):
    assert error_verdict(rms, floor, share).level == level


@pytest.mark.parametrize(("error", "words"), [(0.02, "good"), (0.05, "fair"), (0.18, "poor")])
def test_the_recommended_model_is_judged_too(error, words):
    found = evidence("named", "poor")
    found.diagnosis.gain.base, found.diagnosis.gain.extended = 2.0, error
    assert f"held-out error {error:.3g} mm" in assessment(found).advice
    assert ("Until then" in assessment(found).advice) == (words == "poor")
    assert f"the noise floor: {words})" in assessment(found).advice


def test_a_poor_extended_model_that_is_no_better_is_not_offered():
    found = evidence("named", "poor")
    found.diagnosis.gain.base, found.diagnosis.gain.extended = 2.0, ERRORS["poor"][0]
    assert "does not predict better" in assessment(found).advice
    assert "nearest" not in assessment(found).advice


def test_a_named_cause_says_what_it_does():
    """Which way, and by how much: a share of the stroke of the model, 0.9 mm."""
    advice = assessment(evidence("named", "poor")).advice
    assert "With every full cycle the position rises by 0.0027 mm. " in advice


def test_a_named_cause_says_what_helps_against_it():
    advice = assessment(evidence("named", "poor")).advice
    assert advice.endswith(f" Against walking: {walking.remedy}.")
    assert "Against" not in assessment(evidence("silent", "good")).advice


@pytest.mark.parametrize(
    ("choice", "basis"), [(None, "the training runs"), (SimpleNamespace(), "held-out curves")]
)
def test_the_basis_of_the_choice_is_named(choice, basis):
    found = evidence("silent", "poor")
    found.choice = choice
    nearer = SimpleNamespace(settled=SimpleNamespace(n=5, rms=0.01, nrmse=0.001))
    found.verifications["constant"] = Verification("model", "mm", (nearer,))
    assert f"It was chosen on {basis};" in assessment(found).quality


@pytest.mark.parametrize(("other", "told"), [(0.15, True), (0.19, False), (0.3, False)])
def test_a_surface_that_is_much_nearer_on_the_held_out_run_is_named(other, told):
    found = evidence("silent", "poor")
    found.choice = None
    rms = SimpleNamespace(n=5, rms=other, nrmse=other / 10)
    found.verifications["constant"] = Verification("model", "mm", (SimpleNamespace(settled=rms),))
    words = f"on these data the constant model comes nearer, to {other:.3g} mm."
    assert (words in assessment(found).quality) == told


def test_a_named_cause_without_a_gain_still_offers_a_much_better_model():
    """The base of the diagnosis may already be good, if the refitted density absorbs the effect."""
    found = evidence("named", "poor", gains=False)
    found.diagnosis.gain.base, found.diagnosis.gain.extended = 0.0098, 0.0099
    judged = f"held-out error 0.0099 mm, 0.99 % of the stroke, {error_verdict(0.0099, ERRORS['poor'][1], 0.0).text})"
    assert f"Use the model of the diagnosis ({judged}" in assessment(found).advice
    found.diagnosis.gain.extended = 0.8 * ERRORS["poor"][0]
    assert "does not predict better" in assessment(found).advice
