"""The sentences of a verdict: what is wrong, which causes are likely, with their parameters and probabilities."""

from collections.abc import Iterator, Mapping, Sequence

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.finding import Finding
from smarig.diagnosis.comparison.verdict_rules import SENTENCES, Verdict
from smarig.diagnosis.diagnosis_text import parameter_text
from smarig.diagnosis.variable_words import variable_words

LEAST_SHOWN = 0.005  # probability that is not written as 0.00
AS_LIKELY = 0.5  # of the likeliest variable's probability: as good as equally likely


def verdict_lines(
    verdict: Verdict, findings: Sequence[Finding], causes: Mapping[Part, float], silence: str
) -> Iterator[str]:
    """The verdict, one or two sentences per line; ``silence`` is the line of a silent one."""
    word, reason = verdict.word, SENTENCES[verdict.reason]
    if word == "silent":
        yield f"{silence} {reason}" if verdict.reason == "too_small" else silence
    elif word == "not_identifiable":
        yield reason
    elif word == "unknown":
        dependence = f" and depends on {_variables(verdict.depends_on, causes)}" if verdict.depends_on else ""
        yield f"Something is wrong{dependence}, but no effect of the catalogue is certain. {reason}"
        if competing := _competing(verdict, causes):
            yield competing
    opening = {"named": "Found", "ambiguous": "Ambiguous, likeliest cause"}.get(word, "")
    for effect in findings:
        values = ", ".join(parameter_text(n, v) for n, v in effect.parameters.items())
        bracket = f" ({values})" if values else ""
        yield f"{opening}: {effect.name}{bracket}, probability {effect.probability:.2f}."
    if word == "ambiguous":
        yield f"The truth is likely among these: {_listed(verdict.names, causes)} {reason}"


def doubtful_causes(verdict: Verdict, causes: Mapping[Part, float]) -> str:
    """The causes that an unknown verdict does not name, and why not."""
    return " ".join(filter(None, (_competing(verdict, causes), SENTENCES[verdict.reason])))


def _competing(verdict: Verdict, causes: Mapping[Part, float]) -> str:
    """The causes of an unknown verdict; "" if none of them has a probability that a text would show."""
    by_name = {p.name: w for p, w in causes.items()}
    likely = [n for n in verdict.names if by_name.get(n, 1.0) >= LEAST_SHOWN]
    opening = "What competes" if len(likely) > 1 else "The likeliest cause"
    return f"{opening}: {_listed(likely, causes)}" if any(n in by_name for n in likely) else ""


def _variables(likeliest: str, causes: Mapping[Part, float]) -> str:
    """The variable of a verdict in words, and those that are hardly less likely."""
    by_name = {p.name: w for p, w in causes.items() if p.kind == "variable"}
    least = AS_LIKELY * by_name.get(likeliest, 1.0)
    others = [n for n, w in by_name.items() if n != likeliest and w >= least]
    return " or on ".join(variable_words(n) for n in (likeliest, *others))


def _listed(names: Sequence[str], causes: Mapping[Part, float]) -> str:
    """Names with their probabilities, as a sentence's end; a sum above 1 is explained.

    A name without a probability was not tried, as in these data it does the same as another.
    """
    by_name = {p.name: w for p, w in causes.items()}
    shown = ", ".join(f"{n} ({by_name[n]:.2f})" if n in by_name else f"{n} (the same here)" for n in names)
    together = sum(by_name.get(n, 0.0) for n in names) > 1.005
    return f"{shown}." + (" Several may act at once, so the sum exceeds 1." if together else "")
