"""What a comparison of runs shows: what was compared, whether the wire has changed, and what to do."""

from collections.abc import Sequence

import numpy as np

from smarig.core import spaced
from smarig.identification import ErrorLevel
from smarig.record import Run
from smarig.report.components.numbers import number, signed
from smarig.report.components.page_summary import Assessment, box_level
from smarig.report.components.run_description import display_unit, extent, protocol_name, started
from smarig.report.runs.own_characterisation import earlier_model_sentence, named_causes, own_diagnoses
from smarig.report.runs.run_alignment import AlignedRun, RunChange, run_change
from smarig.report.runs.run_family import FamilyFigures
from smarig.report.runs.temperature_change import change_sentences, temperature_change

_FEWEST = (
    3  # common steps: fewer show nothing of a loop, and where an offset is fitted their difference is zero
)
_NEARLY_ALL = 0.9  # of the squared difference: less is a part of it only
_FIND_A_CAUSE = (
    "To find a cause, characterise the wire again, or diagnose all runs of the later day with the model of the earlier "
    "one."
)
_ORDER = (ErrorLevel.GOOD, ErrorLevel.UNKNOWN, ErrorLevel.FAIR, ErrorLevel.POOR)


def comparison_assessment(found: Sequence[AlignedRun], family: FamilyFigures) -> Assessment:
    """The assessment of aligned runs (the first is the reference), built from their figures."""
    first, *others = found
    common = [each for each in others if each.difference.size >= _FEWEST]
    if not common:
        return _without_common_steps(first, others)
    changes = [(each, run_change(first, each)) for each in common]
    worst, change = max(changes, key=lambda pair: (_ORDER.index(pair[1].level), pair[0].rms))
    named = bool(named_causes([first.run, worst.run]))
    predicted = earlier_model_sentence(first, worst)
    diagnosed = own_diagnoses({each.name: each.run for each in (first, worst)})
    return Assessment(
        box_level(change.level),
        _compared(first, others),
        f"{_change_text(worst, change, len(others))} {_strokes(found, family)}".strip(),
        f"{_advice(worst, change, diagnosed, named=named)}{f' {predicted}' if predicted else ''}"
        f"{_stated_effects(first, others)}",
    )


def _common_text(others: Sequence[AlignedRun]) -> str:
    most = max((each.difference.size for each in others), default=0)
    return f"only {most} step{'s' * (most > 1)} in common" if most else "no steps in common"


def _without_common_steps(first: AlignedRun, others: Sequence[AlignedRun]) -> Assessment:
    """Runs whose outputs may not be subtracted: the figures of their full branches, where they have some."""
    changes = temperature_change(first.run, others[0].run) if len(others) == 1 else []
    if not changes:
        return Assessment(
            "warning",
            _compared(first, others),
            f"The runs have {_common_text(others)}. The output depends on the history of the input, so they are drawn "
            "but not subtracted.",
            "To compare two days, run the same protocol with the same settings on both.",
        )
    moved = any(change.significant for change in changes)
    return Assessment(
        "warning" if moved else "good",
        _compared(first, others),
        f"The runs have {_common_text(others)}. {change_sentences(changes)}",
        (
            "Check ambient temperature, load and number of cycles; smarig diagnose on all runs of the later day tests "
            "causes."
            if moved
            else "A model of one of these runs can be tried on the other (smarig verify)."
        )
        + _stated_effects(first, others),
    )


def _stated_effects(first: AlignedRun, others: Sequence[AlignedRun]) -> str:
    """The effects that the records of twins state, if they are not the same in all runs."""
    stated = {each.name: ", ".join(each.run.info.effects) or "none" for each in (first, *others)}
    if len(set(stated.values())) == 1:
        return ""
    return f" The twins were given these effects: {'; '.join(f'{name}: {text}' for name, text in stated.items())}."


def _compared(first: AlignedRun, others: Sequence[AlignedRun]) -> str:
    wires = {each.run.info.wire for each in (first, *others)}
    same = f" of wire {first.run.info.wire}" if len(wires) == 1 and first.run.info.wire else ""
    different = ", of different wires" if len(wires) > 1 else ""
    names = others[0].name if len(others) == 1 else f"{len(others)} runs"
    return (
        f"Compared: {names}{_date(others[0].run) if len(others) == 1 else ''} with {first.name}{_date(first.run)}, "
        f"{protocol_name(first.run)}{same}{different}."
    )


def _date(run: Run) -> str:
    when = started(run)
    return f" ({when})" if when else ""


def _change_text(worst: AlignedRun, change: RunChange, others: int) -> str:
    unit = spaced(display_unit(worst.run.unit))
    which = "" if others == 1 else f" (the largest, {worst.name})"
    size = f"{number(worst.rms)}{unit} rms at {worst.difference.size} common steps{which}"
    noise = f"σ of a difference {number(worst.noise, 2)}{unit}" if worst.noise else "the noise is unknown"
    if change.level == ErrorLevel.GOOD:
        zero = ", apart from the zero, which was fitted" if worst.offset_kind == "fitted" else ""
        return f"No change beyond the noise{zero}: {size}, {noise}."
    if change.level == ErrorLevel.UNKNOWN:
        return f"The runs differ by {size}; {noise}, so it is not known whether this is a change."
    verb = "may have changed" if change.level == ErrorLevel.FAIR else "has changed"
    ratio = (
        f", {number(worst.rms / worst.noise, 2)} times the noise ({noise})" if worst.noise else f"; {noise}"
    )
    return f"The behaviour {verb}: {size}{ratio}."


def _strokes(found: Sequence[AlignedRun], family: FamilyFigures) -> str:
    unit = spaced(display_unit(found[0].run.unit))
    if len(found) == 2:
        before, after = extent(found[0].run, "position"), extent(found[1].run, "position")
        if not (np.isfinite(before) and np.isfinite(after) and before):
            return ""
        percent = signed(100 * (after / before - 1), 2)
        causes = named_causes([each.run for each in found])
        part = f"; {' and '.join(causes)} may account for this" if causes else ""
        return f"Stroke {number(before, 4)} → {number(after, 4)}{unit} ({percent} %){part}."
    known = [value for value in family.strokes if np.isfinite(value)]
    if not known:
        return ""
    order, variable = family.variable.order, family.variable
    ends = f"{number(family.strokes[order[0]], 4)} → {number(family.strokes[order[-1]], 4)}{unit}"
    if not variable.unit:
        return f"Stroke {ends} from the first to the last run."
    return f"Stroke {ends} from {variable.text(order[0])} to {variable.text(order[-1])} of {variable.name.lower()}."


def _advice(worst: AlignedRun, change: RunChange, diagnosed: str, *, named: bool) -> str:
    """What explains the difference, and what to do; ``diagnosed`` (``named``: it has a cause) before half a reason."""
    if change.level == ErrorLevel.GOOD:
        return "A model of one of these runs holds for the other."
    causes = []
    if change.is_shift and change.shift is not None:
        unit = spaced(display_unit(worst.run.input_unit))
        causes.append(
            f"a shift of the input by {signed(change.shift[0])} ± {number(change.shift[1], 2)}{unit} (check ambient "
            "temperature, load and the input's sensor)"
        )
    if change.is_gain_change and change.gain is not None:
        causes.append(
            f"a change of the output by {signed(100 * change.gain[0])} ± {number(100 * change.gain[1], 2)} % "
            "(check load, cycles and slip)"
        )
    if causes:
        share, what = f"{100 * change.explained:.0f} %", " and ".join(causes)
        if change.explained >= _NEARLY_ALL:
            return (
                f"The difference is that of {what}; this explains {share} of its square. {diagnosed}".strip()
            )
        if not named:
            words = f"A part of the difference looks like {what}: {share} of its square."
            return f"{words} The rest has another cause. {diagnosed or _FIND_A_CAUSE}"
    if diagnosed:
        return diagnosed
    return f"Neither a shift of the input nor a change of the output explains the difference. {_FIND_A_CAUSE}"
