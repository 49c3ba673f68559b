"""The offset between the zero of a model and that of a run, where the record determines it."""

from smarig.identification.measured.zero_by_load import stress_at_start, zero_slope_of
from smarig.identification.run_zeros import has_own_zero
from smarig.record import FORC_PROTOCOL, Run
from smarig.replay import Model, driven_by_input, provenance, recorded_start, share_zero, stress_at_points


def known_offset(model: Model, run: Run) -> float | None:
    """The offset from the model's output to the run's zero, or None if the record does not determine it.

    It is 0 for the training runs, for runs of the same session with the same encoder zero, for runs of the same
    absolute sensor, and for reversal curves. It is −y(initial state) for a run zeroed at power-up in a named state.
    """
    if model.temperature is not None and not driven_by_input([run]):
        return _offset_under_load(model, run)
    mine = provenance(run)
    for made_from in model.provenance:
        same_file = mine.sha256 and mine.sha256 == made_from.sha256
        if same_file and has_own_zero(run) and made_from is not model.provenance[0]:
            return None
        if same_file or share_zero(mine, made_from):
            return 0.0
    if mine.protocol == FORC_PROTOCOL:
        return 0.0
    start = recorded_start(run)
    zeroed = "" if run.info.source == "import" else "power-up"  # others zero their sensors anywhere
    if start is not None and run.info.text_of("encoder_zero", zeroed) == "power-up":
        return -model.operator().reset(start)
    return None


def _offset_under_load(model: Model, run: Run) -> float | None:
    """The offset of a model of loads of a rig: −c (σ − σ₀) of the load under which the run was zeroed, if it is known.

    Without c, it is 0 for a constant load: its zero is then that of the runs that the model was made from.
    """
    known, start_MPa = zero_slope_of(model), stress_at_start(run)
    if not _zeroed_at_power_up(model, run) or start_MPa is None:
        return None
    if known is None:
        return None if stress_at_points(run) is not None else 0.0
    slope, reference_MPa = known
    return -slope * (start_MPa - reference_MPa)


def _zeroed_at_power_up(model: Model, run: Run) -> bool:
    """Whether a run and those of a model of loads were all zeroed at power-up: each under its load, in one state."""
    mine = provenance(run)
    zeros = {mine.encoder_zero, *(p.encoder_zero for p in model.provenance)}
    return zeros == {"power-up"} and recorded_start(run) is not None and run.info.source != "import"
