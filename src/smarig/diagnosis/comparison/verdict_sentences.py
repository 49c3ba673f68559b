"""The sentences of a verdict: what is wrong, which causes are likely, with their parameters and probabilities."""

from collections.abc import Iterator, Mapping, Sequence

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.finding import Finding
from smarig.diagnosis.comparison.rules import SENTENCES, Verdict
from smarig.diagnosis.diagnosis_text import parameter_text
from smarig.diagnosis.variable_words import variable_words


def verdict_lines(
    verdict: Verdict, findings: Sequence[Finding], causes: Mapping[Part, float], silence: str
) -> Iterator[str]:
    """The verdict, one or two sentences per line; ``silence`` is the line of a silent one."""
    word, reason = verdict.word, SENTENCES[verdict.reason]
    if word == "silent":
        yield silence
    elif word == "not_identifiable":
        yield reason
    elif word == "unknown":
        dependence = f" and depends on {variable_words(verdict.depends_on)}" if verdict.depends_on else ""
        yield f"Something is wrong{dependence}, but no effect of the catalogue is certain. {reason}"
        if verdict.names:
            opening = "What competes" if len(verdict.names) > 1 else "The likeliest cause"
            yield f"{opening}: {_listed(verdict.names, causes)}"
    opening = {"named": "Found", "ambiguous": "Ambiguous, best explanation"}.get(word, "")
    for effect in findings:
        values = ", ".join(parameter_text(n, v) for n, v in effect.parameters.items())
        bracket = f" ({values})" if values else ""
        yield f"{opening}: {effect.name}{bracket}, probability {effect.probability:.2f}."
    if word == "ambiguous":
        yield f"The truth is likely among these: {_listed(verdict.names, causes)} {reason}"


def _listed(names: Sequence[str], causes: Mapping[Part, float]) -> str:
    """Names with their probabilities, as a sentence's end; a sum above 1 is explained."""
    by_name = {p.name: w for p, w in causes.items()}
    shown = ", ".join(f"{n} ({by_name.get(n, 0.0):.2f})" for n in names)
    together = sum(by_name.get(n, 0.0) for n in names) > 1.005
    return f"{shown}." + (" Several may act at once, so the sum exceeds 1." if together else "")
