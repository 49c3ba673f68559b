"""The transformation temperatures of one run: its cycles, their means, and their drift from cycle to cycle."""

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from smarig.core import Array, UsageError, spaced
from smarig.identification import Estimate
from smarig.record import Run
from smarig.transformation.branch_tangents import BranchTangents, branch_tangents, with_borrowed_plateau
from smarig.transformation.chosen_cycles import comparable_cycles, complete_cycles, left_out_note
from smarig.transformation.cycle_drift import cycle_drift
from smarig.transformation.cycle_figures import (
    CORNERS,
    DIFFERENCES,
    FIGURES,
    TEMPERATURES,
    CycleFigures,
    Drawn,
    cycle_figures,
)
from smarig.transformation.decades import in_decades
from smarig.transformation.full_branches import COOLING, HEATING, FullBranch, UnusedBranch, full_branches
from smarig.transformation.heat_loss_error import with_heat_loss
from smarig.transformation.lag_of_temperatures import lag_note, with_lag
from smarig.transformation.tangent_ranges import JUMP
from smarig.transformation.temperature_record import TemperatureRecord, temperature_record

_SMALL_STROKE = 0.5  # of the median of its direction: a branch with less is not that of a transforming wire
_CLOSED = 0.1  # of the stroke: a loop that closes within it has one plateau at an end
_STILL_STEEP = 0.5  # of the steep slope: a branch that ends with more is not through
_MOST_REASONS = 2  # branches that cover only a part of the range: so many are described
_SAME = 1e-9  # of the range of the output: means of equal readings differ by rounding
_SOURCE = "tangents"


@dataclass(frozen=True, eq=False)
class RunFigures:
    """One run. ``means`` over the cycles ``averaged``, by figure; ``drift`` per cycle, or the reason against it.

    The interval of a mean contains the common choice of the tangents' readings in full, and the noise averaged.
    ``gaps``: the two inputs between which nothing was measured, for temperatures that lie between them.
    """

    run: Run
    record: TemperatureRecord
    cycles: tuple[CycleFigures, ...]
    unused: tuple[UnusedBranch, ...]
    means: dict[str, Drawn]
    counts: dict[str, int]
    averaged: tuple[int, ...]
    drift: dict[str, Estimate]
    no_drift: str
    gaps: dict[str, tuple[float, float]]
    notes: tuple[str, ...]

    @property
    def name(self) -> str:
        """The name of the run."""
        return self.run.name

    @property
    def wire(self) -> str:
        """The name of the wire, "" if none was recorded."""
        return self.run.info.wire or ""

    @property
    def start_epoch(self) -> float | None:
        """The start of the run in seconds since 1970, None if not recorded."""
        return self.run.info.start_epoch

    @property
    def stress_MPa(self) -> float | None:
        """The mean of the recorded condition ``stress``, None without one in MPa."""
        mean, unit = self.mean_of("stress")
        return mean if unit == "MPa" else None

    def mean_of(self, condition: str) -> tuple[float | None, str]:
        """The mean of a recorded condition, None without one, and its unit."""
        stored = self.run.info.conditions.get(condition)
        if not isinstance(stored, dict):
            return None, ""
        mean = stored.get("mean")
        known = isinstance(mean, int | float) and np.isfinite(mean)
        return (float(mean), str(stored.get("unit"))) if known else (None, "")

    @property
    def at_least(self) -> tuple[str, ...]:
        """The figures that are lower bounds, for the output is clipped."""
        clipped = any(t.clipped for c in self.cycles for t in (c.heating, c.cooling) if t is not None)
        return ("stroke",) if clipped else ()

    @property
    def assembled(self) -> tuple[str, ...]:
        """The directions that every loop has from first-order curves only; () if one is a full loop of its own."""
        if not all(cycle.assembled for cycle in self.cycles):
            return ()
        return tuple(dict.fromkeys(d for cycle in self.cycles for d in cycle.assembled))

    def unit_of(self, figure: str) -> str:
        """The unit of a figure: of the temperature, K for differences, of the output."""
        if figure in TEMPERATURES:
            return self.record.input_unit
        return "K" if figure in DIFFERENCES else self.record.unit

    def estimate(self, figure: str) -> Estimate:
        """The mean over the cycles with its interval; n is the number of cycles."""
        drawn = self.means[figure]
        return Estimate(drawn.value, drawn.ci95, self.unit_of(figure), _SOURCE, self.counts[figure])

    def degC(self, kelvin: float) -> float | None:
        """A temperature of this run in °C; None if the ambient temperature is not known."""
        shift = self.record.to_degC_K
        return None if shift is None else kelvin + shift


def run_figures(run: Run) -> RunFigures:
    """The figures of a run. Raises UsageError, with the reason, unless it contains a full loop."""
    record = in_decades(temperature_record(run), run.info.output.quantity)
    branches, unused = full_branches(record)
    tangents: dict[int, BranchTangents] = {}
    for k, branch in enumerate(branches):
        try:
            found = branch_tangents(
                *branch.rising(),
                seed=k,
                curve_seed=zlib.crc32(f"{run.name} {branch.direction}".encode(errors="surrogateescape")),
                unit=_shown_unit(record.input_unit),
            )
            tangents[k] = found
        except UsageError as error:
            unused.append(_unused(branch, str(error)))
    _leave_out_small(branches, tangents, unused)
    cycles = _cycles(branches, tangents, record)
    if not any(c.whole for c in cycles):
        raise UsageError(_no_loop(run, record, cycles, unused))
    averaged = complete_cycles(cycles)
    gaps = _gaps(averaged)
    means, counts = _means(averaged)
    comparable, reason = comparable_cycles(averaged)
    drift, scattered = cycle_drift(
        [c.number for c in comparable], [c.figures for c in comparable], _units(record)
    )
    return RunFigures(
        run=run,
        record=record,
        cycles=tuple(cycles),
        unused=tuple(unused),
        means=means,
        counts=counts,
        averaged=tuple(c.number for c in averaged),
        drift=drift,
        no_drift=reason or scattered,
        gaps={name: (low, high) for name, (low, high, _) in gaps.items()},
        notes=(
            *record.notes,
            *([note] if (note := lag_note(branches, record.lag_s, "K")) else []),
            *left_out_note(cycles, averaged),
            *_clipped_notes(averaged, record),
            *_interruptions(branches),
            *_notes(averaged),
            *_jumps(cycles, record),
            *_gap_notes(gaps, _shown_unit(record.input_unit)),
        ),
    )


def _cycles(
    branches: Sequence[FullBranch], tangents: dict[int, BranchTangents], record: TemperatureRecord
) -> list[CycleFigures]:
    found: list[CycleFigures] = []
    for number in dict.fromkeys(b.cycle for b in branches):
        own = [k for k, b in enumerate(branches) if b.cycle == number]
        used = {branches[k].direction: tangents[k] for k in own if k in tangents}
        if not used:
            continue
        if set(used) == {HEATING, COOLING}:
            used = _with_borrowed(used)
        used = {d: _without_clipped(t, record) for d, t in used.items()}
        parts = {branches[k].direction: branches[k] for k in own if k in tangents}
        used = {d: with_lag(t, parts[d], record.lag_s) for d, t in used.items()}
        used = {d: with_heat_loss(t, record.heat_loss) for d, t in used.items()}
        found.append(cycle_figures(number, parts, used, seed=1000 + number))
    return found


def _with_borrowed(used: dict[str, BranchTangents]) -> dict[str, BranchTangents]:
    """Both branches; where one has no plateau at an end, but the loop closes there, that of the other serves.

    Not where the branch ends on its steep part: the other then starts from a wire that is not through.
    """
    found = dict(used)
    for direction, other in ((HEATING, COOLING), (COOLING, HEATING)):
        for side in ("low", "high"):
            branch, donor = used[direction], used[other]
            if getattr(branch, side) is None and _closes(branch, donor, side) and _through(branch, side):
                found[direction] = with_borrowed_plateau(found[direction], donor, side)
    return found


def _without_clipped(tangents: BranchTangents, record: TemperatureRecord) -> BranchTangents:
    """Without the corners at which the range of the sensor ends: the plateau of the wire lies beyond."""
    sides = dict(_clipped_sides(tangents.u, tangents.y, record.clipped_at))
    unit = spaced(_shown_unit(record.unit))
    reasons = {side: f"the output is clipped at {value:.4g}{unit} there" for side, value in sides.items()}
    return replace(
        tangents,
        low=None if "low" in sides else tangents.low,
        high=None if "high" in sides else tangents.high,
        why_not=tangents.why_not | reasons,
        clipped=sides,
    )


def _clipped_sides(u: Array, y: Array, clipped_at: Sequence[float]) -> Iterator[tuple[str, float]]:
    """The sides of a branch at which its output is clipped, "low" or "high", and the value that it has there."""
    for value in clipped_at:
        at = np.abs(y - value) <= _SAME * np.ptp(y)
        if at.sum() > 1:
            yield ("low" if u[at].mean() < u.mean() else "high"), value


def _closes(branch: BranchTangents, other: BranchTangents, side: str) -> bool:
    k = 0 if side == "low" else -1
    return abs(branch.y[k] - other.y[k]) <= _CLOSED * float(np.ptp(branch.y))


def _through(branch: BranchTangents, side: str) -> bool:
    """Whether the slope at an end, over the last three readings or 5 % of the range, is below half of the steep one."""
    away = branch.u - branch.u.min() if side == "low" else branch.u.max() - branch.u
    rows = np.argsort(away, kind="stable")[: max(3, int(np.count_nonzero(away <= 0.05 * np.ptp(branch.u))))]
    if np.ptp(branch.u[rows]) == 0:
        return False
    slope = float(np.polyfit(branch.u[rows], branch.y[rows], 1)[0])
    return abs(slope * branch.steep.du_dy) <= _STILL_STEEP


def _leave_out_small(
    branches: Sequence[FullBranch], tangents: dict[int, BranchTangents], unused: list[UnusedBranch]
) -> None:
    """Move branches with less than half of the usual rise to the unused ones: a wire that did not transform."""
    for direction in (HEATING, COOLING):
        own = {k: _rise(t) for k, t in tangents.items() if branches[k].direction == direction}
        if len(own) < 3:
            continue
        usual = float(np.median(list(own.values())))
        for k, rise in own.items():
            if abs(rise) < _SMALL_STROKE * abs(usual) or rise * usual < 0:
                del tangents[k]
                reason = f"its output moves by {100 * abs(rise / usual):.0f} % of what is usual in this run"
                unused.append(_unused(branches[k], reason))


def _rise(tangents: BranchTangents) -> float:
    """The output at the hot end minus that at the cold end."""
    few = max(1, tangents.y.size // 50)
    return float(tangents.y[-few:].mean() - tangents.y[:few].mean())


def _unused(branch: FullBranch, reason: str) -> UnusedBranch:
    return UnusedBranch(branch.direction, branch.cycle, float(branch.u[0]), float(branch.u[-1]), reason)


def _means(cycles: Sequence[CycleFigures]) -> tuple[dict[str, Drawn], dict[str, int]]:
    means: dict[str, Drawn] = {}
    counts: dict[str, int] = {}
    for name in FIGURES:
        own = [c.figures[name] for c in cycles if name in c.figures]
        if own:
            draws = np.mean([d.draws for d in own], axis=0)
            means[name], counts[name] = Drawn(float(np.mean([d.value for d in own])), draws), len(own)
    return means, counts


def _notes(cycles: Sequence[CycleFigures]) -> list[str]:
    notes = []
    borrowed = [n for n in TEMPERATURES if any(n in c.borrowed for c in cycles)]
    for name in borrowed:
        own, other = ("heating", "cooling") if name[0] == "A" else ("cooling", "heating")
        notes.append(
            f"{name}: the {own} branch has no plateau of its own there, so the tangent is that of the {other} branch, "
            f"with which the loop closes; {'M_f may be lower' if name == 'M_f' else f'{name} may lie further out'}."
        )
    for direction in dict.fromkeys(d for c in cycles for d in c.assembled):
        notes.append(
            f"The {direction} branch is assembled from first-order curves up to their reversals, so the run has no "
            "residual."
        )
    return notes


def _clipped_notes(cycles: Sequence[CycleFigures], record: TemperatureRecord) -> Iterator[str]:
    """A sentence for each side of the loop at which the output is clipped."""
    own = [t.clipped for c in cycles for t in (c.heating, c.cooling) if t is not None]
    sides = {side: value for clipped in own for side, value in clipped.items()}
    for side, value in sides.items():
        names = " and ".join(name for name, (_, at) in CORNERS.items() if at == side)
        yield (
            f"{names} are not known: the output is clipped at {value:.4g}{spaced(_shown_unit(record.unit))}, where the "
            "range of the sensor ends. The stroke is a lower bound."
        )


def _interruptions(branches: Sequence[FullBranch]) -> Iterator[str]:
    """A sentence for each branch that goes on after inner loops."""
    for b in branches:
        if b.inner_loops:
            loops = "an inner loop" if b.inner_loops == 1 else f"{b.inner_loops} inner loops"
            yield (
                f"Cycle {b.cycle}, {b.direction}: {loops} interrupted the branch; it goes on where the temperature was "
                "back, as if the loop had not been."
            )


def _jumps(cycles: Sequence[CycleFigures], record: TemperatureRecord) -> Iterator[str]:
    """A sentence for each direction in which readings are missing on the steep part."""
    for direction in (HEATING, COOLING):
        own = [(t.jump, c.number) for c in cycles if (t := getattr(c, direction)) is not None]
        (share, low, high), number = max(own, default=((0.0, 0.0, 0.0), 0))
        if share > JUMP:
            names = "A_s and A_f" if direction == HEATING else "M_s and M_f"
            yield (
                f"Cycle {number}, {direction}: {100 * share:.0f} % of the output lies between two readings at "
                f"{low:.4g} and {high:.4g} {_shown_unit(record.input_unit)}; {names} would differ if the "
                "readings between them were known."
            )


def _gaps(cycles: Sequence[CycleFigures]) -> dict[str, tuple[float, float, int]]:
    """The widest gap (low, high, cycle) of each temperature that lies in one in most of its cycles."""
    found: dict[str, tuple[float, float, int]] = {}
    for name, (direction, side) in CORNERS.items():
        corners = [(getattr(t, side), c.number) for c in cycles if (t := getattr(c, direction))]
        own = [(*corner.gap, number) for corner, number in corners if corner and corner.gap]
        if 2 * len(own) > len(corners):
            found[name] = max(own, key=lambda gap: gap[1] - gap[0])
    return found


def _gap_notes(gaps: dict[str, tuple[float, float, int]], unit: str) -> Iterator[str]:
    for name, (low, high, number) in gaps.items():
        yield (
            f"Cycle {number}, {CORNERS[name][0]}: {name} lies between two readings at {low:.4g} and {high:.4g} {unit}. "
            "Nothing is measured between them, so its interval is at least as wide."
        )


def _no_loop(
    run: Run, record: TemperatureRecord, cycles: Sequence[CycleFigures], unused: Sequence[UnusedBranch]
) -> str:
    unit = _shown_unit(record.input_unit)
    used = {d for c in cycles for d in (HEATING, COOLING) if getattr(c, d) is not None}
    have = f" It has only a {next(iter(used))} branch." if len(used) == 1 else ""
    full, partial = [u for u in unused if u.cycle], [u for u in unused if not u.cycle]
    widest = sorted(partial, key=lambda branch: -abs(branch.to - branch.from_))[:_MOST_REASONS]
    why = "".join(f" {branch.sentence(unit)}" for branch in (*full, *widest))
    example = "" if run.meta.get("imported") else ", for example with the protocol constant_force_cycles"
    if more := len(partial) - len(widest):
        why += f" {more} other {'branch covers' if more == 1 else 'branches cover'} less of it."
    return (
        f"{run.name} contains no full loop of heating and cooling with ten readings or more on each branch.{have}{why} "
        f"Heat and cool the specimen through its whole transformation{example}."
    )


def _units(record: TemperatureRecord) -> dict[str, str]:
    return {n: "K" if n in (*TEMPERATURES, *DIFFERENCES) else record.unit for n in FIGURES}


def _shown_unit(unit: str) -> str:
    return unit.replace("degC", "°C")
