"""The kind of a finding of an import, from its sentence: what a run file stores are sentences."""

PHRASES = {
    "leads its input": "output leads its input",
    "the loop does not close": "loop does not close",
    "was not constant": "condition not constant",
    "drop-outs": "drop-outs",
    "The output jumps": "jump",
    "single-row spikes": "spikes",
    "is clipped": "clipped channel",
    "time gaps": "time gaps",
    "repeat the row before": "repeated rows",
    "repeat the time": "repeated times",
}


def finding_kind(sentence: str) -> str | None:
    """The kind of a finding that makes data suspicious; None for other findings, and for repairs.

    >>> finding_kind("The output jumps by more than 10% of its range."), finding_kind("It comes in steps of 1 mm.")
    ('jump', None)
    """
    if sentence.startswith(("Repaired:", "The unused column")):
        return None
    return next((kind for phrase, kind in PHRASES.items() if phrase in sentence), None)
