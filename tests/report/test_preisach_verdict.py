"""What a characterisation says about the operator: each piece of evidence alone turns the verdict."""

from types import SimpleNamespace as Some

import pytest

from smarig.identification import Verification
from smarig.report.characterisation_page import _preisach_notice
from smarig.report.models.preisach_verdict import preisach_verdict

UNIT = "mm"


def verification(rms, floor=0.005):
    return Verification("model", UNIT, (Some(settled=Some(n=40, rms=rms), noise_floor=floor),))


def compared(name="congruency", p_value=0.4, rms=0.004):
    return Some(
        name=name,
        p_value=p_value,
        p_text=f"p = {p_value:.2g}",
        rms=rms,
        noise=0.003,
        times_noise=1.7,
        unit=UNIT,
        holds=p_value >= 0.01,
    )


def diagnosed(word="silent", names=(), walk=False, errors=(0.012, 0.012)):
    return Some(
        verdict=Some(word=word, names=names),
        extended=word == "named",
        learned=None,
        not_preisach=walk,
        gain=Some(
            base=errors[0],
            extended=errors[1],
            floor=0.01,
            extended_error=errors[1],
            settled_rms=lambda error: error,
        ),
        error=Some(unit=UNIT),
    )


HOLDS, SILENT = (compared(),), diagnosed()


def evidence(tests=HOLDS, diagnosis=SILENT, extension=None):
    return Some(
        representation=tests,
        diagnosis=diagnosis,
        extension=extension,
        chosen="exponential",
        best=Some(model=Some(unit=UNIT)),
        verifications={"exponential": verification(0.35), "positive": verification(0.3)},
    )


def test_without_evidence_against_it_the_operator_holds():
    found = preisach_verdict(evidence())
    assert found.holds is True
    assert found.headline.startswith("These runs give no evidence")


@pytest.mark.parametrize(("error", "pleased"), [(0.012, True), (0.027, False)])
def test_nothing_against_it_is_no_praise_where_every_model_misses_by_many_times_the_noise(error, pleased):
    e = evidence(diagnosis=diagnosed(errors=(error, error)))
    found = preisach_verdict(e)
    assert found.holds is True
    assert ("give no evidence" in found.headline) == pleased
    assert ("the best model misses the held-out run by 5.4 × the noise floor." in found.headline) == (
        not pleased
    )
    assert ('"notice good"' in _preisach_notice(e)) == pleased
    assert ('"notice warning"' in _preisach_notice(e)) == (not pleased)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"tests": (compared(p_value=3e-5),)},
            "congruency is violated (0.004 mm rms, 1.7 × its noise",
        ),
        ({"tests": (compared("wiping_out", 1e-9),)}, "The test of wiping-out is violated"),
        ({"diagnosis": diagnosed("unknown", walk=True)}, "minor loops do not return."),
        (
            {"diagnosis": diagnosed("unknown", errors=(0.25, 0.25))},
            "by 0.25 mm rms, 25 × the prediction limit",
        ),
    ],
)
def test_each_kind_of_evidence_speaks_against_it(change, words):
    found = preisach_verdict(evidence(**change))
    assert found.holds is False
    assert found.headline == "This wire is no Preisach operator."
    assert any(words in sentence for sentence in found.why)


def test_an_undetermined_density_does_not():
    """The training runs may not determine it."""
    diagnosis = diagnosed("silent", errors=(0.25, 0.25))
    assert preisach_verdict(evidence(diagnosis=diagnosis)).holds is True


@pytest.mark.parametrize(("extended", "effects"), [(0.012, ("slip",)), (0.25, ())])
def test_a_named_effect_may_explain_a_violated_test(extended, effects):
    """If the model with it predicts held-out runs."""
    diagnosis = diagnosed("named", ("slip",), errors=(0.3, extended))
    found = preisach_verdict(evidence((compared(p_value=1e-6),), diagnosis))
    assert found.effects == effects
    assert ("with slip it does" in found.headline) == bool(effects)
    assert found.to_json()["with"] == list(effects)


def test_what_a_named_effect_leaves_is_said_in_the_headline():
    diagnosis = diagnosed("named", ("slip",), errors=(0.3, 0.019))
    found = preisach_verdict(evidence((compared(p_value=1e-6),), diagnosis))
    assert found.effects == ("slip",)
    assert found.headline.endswith("with slip, 4 × the noise floor is left.")


def test_the_errors_of_all_models_stand_beside_the_noise():
    choice = Some(chosen="moving")
    extension = Some(choice=choice, classical=verification(0.29), extended=verification(0.2))
    found = preisach_verdict(evidence((compared(p_value=1e-6),), extension=extension))
    assert [rms for _, rms in found.errors] == [0.35, 0.3, 0.29, 0.2, 0.012]
    assert "chosen classical model (exponential) 0.35 mm (70 × the noise floor)" in found.errors_sentence
    assert found.errors_sentence.endswith("noise floor of the held-out run 0.005 mm.")
    assert found.why[-1] == "Of the extensions of the operator (§3.5), moving predicts runs left out best."


def test_nothing_tested_is_said():
    assert preisach_verdict(evidence((), None)).holds is None
