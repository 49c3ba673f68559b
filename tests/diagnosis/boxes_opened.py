"""Sealed boxes diagnosed from their files alone. The generator shares no code with the diagnosis."""

from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.boxes import draw_box, write_box
from benchmarks.boxes.box_effects import EFFECTS
from computed_once import computed_once
from smarig.diagnosis import CommandedDiagnosis, diagnose_commanded
from smarig.identification.identify import identify
from smarig.record import load_run

SEED = 7


def strength(effect: str, times: float) -> dict[str, float]:
    """So many times what is usual, within its bounds."""
    kind = EFFECTS[effect]
    return {kind.strength: min(max(times * kind.typical, kind.lower), kind.upper)}


@computed_once
def answer(number: int, hidden=None, channels=(), without=(), times=1.0) -> CommandedDiagnosis:
    """Of a box with an effect hidden in it, so many times as strong as usual, "hard_null", or nothing."""
    contents = hidden if hidden == "hard_null" else {hidden: strength(hidden, times)} if hidden else {}
    with TemporaryDirectory() as folder:
        box = write_box(draw_box(SEED, number, hidden=contents, channels=channels), Path(folder))
        train = [load_run(path) for path in box.train]
        held_out = [load_run(path) for path in box.held_out]
        model = identify(train, "positive").model
        return diagnose_commanded(model, train, held_out, without=without)
