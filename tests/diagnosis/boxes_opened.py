"""Sealed boxes diagnosed from their files alone. The generator shares no code with the diagnosis."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from smarig.benchmark.boxes import draw, generate
from smarig.diagnosis.diagnose import Diagnosis, diagnose
from smarig.identification.identify import identify
from smarig.record import load_run

SEED, NULLS, ALPHA = 7, 100, 0.03


@cache
def answer(number: int, hidden=None, channels=(), without=()) -> Diagnosis:
    """Of a box with an effect at its usual strength hidden in it, "hard_null", or nothing."""
    contents = hidden if hidden == "hard_null" else {hidden: {}} if hidden else {}
    with TemporaryDirectory() as folder:
        box = generate(draw(SEED, number, hidden=contents, channels=channels), Path(folder))
        train = [load_run(path) for path in box.train]
        held_out = [load_run(path) for path in box.held_out]
        model = identify(train, "positive").model
        return diagnose(model, train, held_out, nulls=NULLS, alpha=ALPHA, without=without)
