"""Opened boxes written by hand, in the form that a trial returns."""


def record(number=0, verdict_word="silent", hidden=None, **given):
    """An answer and its truth; ``verdict_word`` is the verdict or the names of the first explanation, ``hidden``
    {name: δ}.
    """
    hidden = hidden or {}
    names = verdict_word.split("+") if "+" in verdict_word or verdict_word in KNOWN else []
    known = {
        "number": number,
        "seconds": 10.0,
        "verdict": "named" if names else verdict_word,
        "explanations": [[names, 1.0]] if names else [],
        "effects": [],
        "nothing": 0.0 if names else 1.0,
        "intervals90": {},
        "set": names,
        "depends_on": None,
        "held_out": None,
        "category": {0: "empty", 1: "one", 2: "two"}[len(hidden)],
        "hidden": {name: {STRENGTH[name]: 2.0} for name in hidden},
        "delta": dict(hidden),
        "left_out": "",
        "channels": ["current", "voltage", "transients"],
    }
    return known | given


def ambiguous(*explanations, **given):
    """Several explanations (names, probability), all of them in the set."""
    names = list(dict.fromkeys(name for found, _ in explanations for name in found))
    return record(
        verdict_word="ambiguous", explanations=[[list(n), p] for n, p in explanations], set=names, **given
    )


def parameter(name, value, low, high):
    """The answer's effects and intervals: one effect, with its strength and its 90 % interval."""
    effects = [{"name": name, "parameters": {STRENGTH[name]: {"value": value}}}]
    return {"effects": effects, "intervals90": {f"{name}.{STRENGTH[name]}": [low, high]}}


STRENGTH = {
    "walking": "percent_per_cycle",
    "slip": "jump_percent",
    "settling": "share_percent",
    "creep": "percent_per_decade",
    "dead_zone": "half_width_A",
    "end_conduction": "share_percent",
    "backlash": "play_percent",
}
KNOWN = frozenset(STRENGTH)
