"""Whether a characterised wire can be a Preisach operator, and how far its models are from a held-out run."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from smarig.core import spaced
from smarig.diagnosis import PREDICTION_LIMIT, RULES, CommandedDiagnosis, HeldOutGain
from smarig.identification import Representation, ratio_text
from smarig.report.models.evidence import Evidence, ExtensionEvidence
from smarig.report.models.model_tables import pooled_rms

_TESTS = {"wiping_out": "wiping-out", "congruency": "congruency"}
_AT_NOISE = RULES["adequate"].value  # times the noise: an error within it is explained


@dataclass(frozen=True)
class PreisachVerdict:
    """The verdict ``holds`` (None: nothing tests it), the sentences on why, and rms errors on held-out runs by model.

    ``effects``: those with which the operator describes the runs. ``errors`` begins with the chosen classical model.
    ``noise`` is that of the held-out points, in ``unit``.
    """

    holds: bool | None
    effects: tuple[str, ...]
    why: tuple[str, ...]
    errors: tuple[tuple[str, float], ...]
    noise: float | None
    unit: str

    @property
    def headline(self) -> str:
        """The verdict in one sentence."""
        if self.holds is None:
            return "These runs do not test whether this wire is a Preisach operator."
        if self.effects:
            return f"A Preisach operator alone does not describe this wire; {self._with_effects}."
        if self.holds and self.is_inaccurate:
            times = f"{ratio_text(self._least_error / (self.noise or 1.0))} × the noise floor"
            return f"Nothing speaks against a Preisach operator, but the best model misses the held-out run by {times}."
        if self.holds:
            return "These runs give no evidence that this wire is not a Preisach operator."
        return "This wire is no Preisach operator."

    @property
    def is_inaccurate(self) -> bool:
        """Whether even the best model misses the held-out runs by many times the noise."""
        return bool(self.noise) and self._least_error >= _AT_NOISE * self.noise

    @property
    def _least_error(self) -> float:
        return min((rms for _, rms in self.errors), default=0.0)

    @property
    def _with_effects(self) -> str:
        """What the effects leave of the error, as a clause; the last error is that of the model with them."""
        names = f"with {' + '.join(self.effects)}"
        if not self.errors or not self.noise:
            return f"{names} it does"
        times = self.errors[-1][1] / self.noise
        if times > _AT_NOISE:
            return f"{names}, {times:.0f} × the noise floor is left"
        return f"{names} it does, to {ratio_text(times)} × the noise floor"

    @property
    def errors_sentence(self) -> str:
        """The errors on held-out runs, each with its multiple of the noise; empty without held-out runs."""
        if not self.errors:
            return ""
        noise = self.noise
        parts = [
            f"{name} {rms:.3g}{spaced(self.unit)}"
            + (f" ({ratio_text(rms / noise)} × the noise floor)" if noise else "")
            for name, rms in self.errors
        ]
        level = f"; noise floor of the held-out run {noise:.2g}{spaced(self.unit)}" if noise else ""
        return f"Rms error at the settled points of held-out runs: {', '.join(parts)}{level}."

    def sentences(self) -> list[str]:
        """The headline, why, and the errors."""
        return [s for s in (self.headline, *self.why, self.errors_sentence) if s]

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        errors = [{"model": name, "rms": rms} for name, rms in self.errors]
        return {
            "holds": self.holds,
            "with": list(self.effects),
            "sentences": self.sentences(),
            "held_out": {"errors": errors, "noise": self.noise, "unit": self.unit},
        }


def against_preisach(tests: tuple[Representation, ...], diagnosis: CommandedDiagnosis | None) -> list[str]:
    """What speaks against a Preisach operator, one sentence each."""
    return [*_violated_tests(tests), *_seen_by_diagnosis(diagnosis)]


def preisach_verdict(e: Evidence) -> PreisachVerdict:
    """The verdict on the evidence of a characterisation.

    No operator: a test of §5.3 is violated, the errors depend on the history beyond any density, or the model
    of the diagnosis misses held-out runs by many times the prediction limit.
    """
    against, found = against_preisach(e.representation, e.diagnosis), e.verifications.get(e.chosen)
    tested = e.representation or e.diagnosis
    unit = e.best.model.unit if e.best else ""
    kept = [_test_text(test) for test in e.representation if test.holds]
    extension = [_extension_text(e.extension)] if e.extension and against else []
    return PreisachVerdict(
        holds=not against if tested else None,
        effects=_explaining_effects(e.diagnosis) if against else (),
        why=(*against, *kept, *extension),
        errors=tuple(_errors(e)),
        noise=found.noise_floor if found else None,
        unit=unit,
    )


def _explaining_effects(d: CommandedDiagnosis | None) -> tuple[str, ...]:
    """The effects that explain what speaks against an operator alone."""
    if d is None or d.verdict.word != "named" or (d.gain and d.gain.extended >= _AT_NOISE * d.gain.floor):
        return ()
    return d.verdict.names


def _violated_tests(tests: tuple[Representation, ...]) -> Iterator[str]:
    for test in tests:
        if not test.holds:
            yield _test_text(test)


def _test_text(test: Representation) -> str:
    size = f"{test.rms:.2g}{spaced(test.unit)} rms, {test.times_noise:.2g} × its noise"
    if test.holds:
        return f"The test of {_TESTS[test.name]} finds nothing against it ({size}, {test.p_text})."
    return f"The test of {_TESTS[test.name]} is violated ({size}, {test.p_text})."


def _seen_by_diagnosis(d: CommandedDiagnosis | None) -> Iterator[str]:
    if d is None:
        return
    if d.not_preisach:
        yield "The errors depend on the earlier history in a way that no density describes: minor loops do not return."
    if d.gain is not None and _ratio(d.gain) >= _AT_NOISE and d.verdict.word == "unknown":
        yield (
            f"With the likeliest density, the model misses the held-out runs by {d.gain.base:.3g}{spaced(d.error.unit)}"
            f" rms, {_ratio(d.gain):.0f} × the {PREDICTION_LIMIT}."
        )


def _ratio(gain: HeldOutGain) -> float:
    return gain.base / gain.floor


def _extension_text(found: ExtensionEvidence) -> str:
    if found.extended is None:
        return "No extension of the operator (§3.5) predicts runs left out better than the classical model."
    return f"Of the extensions of the operator (§3.5), {found.choice.chosen} predicts runs left out best."


def _errors(e: Evidence) -> Iterator[tuple[str, float]]:
    rms = {name: pooled_rms(v) for name, v in e.verifications.items()}
    known = {name: value for name, value in rms.items() if value is not None}
    if e.chosen in known:
        yield f"chosen classical model ({e.chosen})", known[e.chosen]
    if known and (best := min(known, key=lambda name: known[name])) != e.chosen:
        yield f"best classical model of the first-order curves ({best})", known[best]
    if e.extension is not None:
        yield from _extension_errors(e.extension)
    d = e.diagnosis
    if d is not None and d.gain is not None:
        causes = "a learned term" if d.learned else " + ".join(d.verdict.names)
        yield (
            f"model of the diagnosis{f' with {causes}' if d.extended else ''}",
            d.gain.settled_rms(d.gain.extended_error),
        )


def _extension_errors(found: ExtensionEvidence) -> Iterator[tuple[str, float]]:
    classical, extended = pooled_rms(found.classical), pooled_rms(found.extended)
    if classical is not None:
        yield "classical model of all other runs", classical
    if extended is not None:
        yield f"extension '{found.choice.chosen}' of it", extended
