"""The variables of a dependence in words, each with the experiment that shows it; JSON keeps their names."""

_WORDS = {
    "rate": ("the rate of the input", "Repeat the same run at half the rate."),
    "speed": ("the speed of the input", "Repeat the same run at half the rate."),
    "time": ("the time", "Repeat the same run later, with the wire at rest in between."),
    "cycle": ("the number of cycles", "Repeat the same run several times in a row."),
    "history": (
        "the earlier history",
        "Reach the same inputs by other ways, by minor loops for example.",
    ),
    "level": (
        "the output itself",
        "Measure minor loops of equal amplitude at several outputs.",
    ),
    "temperature": ("the temperature", "Repeat the same steps from another temperature."),
    "heating_rate": ("the rate of heating", "Reach the same temperatures by smaller steps."),
    "power": ("the power", "Repeat the same run with steps of another height."),
    "run": ("the run", "Repeat the same run on another day."),
    "input": ("the input", "Repeat the same run over another range of the input."),
    "stress": ("the stress", "Repeat the same run under another load."),
    "time_since_reversal": (
        "the time since the last reversal",
        "Hold for different times after a reversal.",
    ),
}


def variable_words(variable: str) -> str:
    """A variable in words; one without words as it is.

    >>> variable_words("level"), variable_words("load")
    ('the output itself', 'load')
    """
    return _WORDS[variable][0] if variable in _WORDS else variable


def variable_experiment(variable: str) -> str:
    """The experiment that shows a dependence on a variable, as a sentence.

    >>> variable_experiment("rate")
    'Repeat the same run at half the rate.'
    """
    if variable in _WORDS:
        return _WORDS[variable][1]
    return f"Change {variable} alone and keep everything else constant: the change shows the effect."
