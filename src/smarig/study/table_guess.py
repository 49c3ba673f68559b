"""Guesses which column of a table is the time, the input, the output and a condition, each with its reason."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from smarig.core import UsageError, correlation, shown, suggestion
from smarig.exchange import FoundTable, convert, dimension
from smarig.study import quantity_words as q
from smarig.study.branch_pairs import (
    backward_branches,
    branch_pairs,
    branches_by_words,
    branches_written_twice,
    goes_one_way,
    with_shared_input,
)
from smarig.study.column_guess import (
    LIKELY,
    STATED,
    UNSURE,
    WEAK,
    ColumnGuess,
    guess_columns,
)
from smarig.study.derived_charges import line_that_names
from smarig.study.displacement_places import rival_displacements
from smarig.study.heat_flow_columns import with_heat_flows
from smarig.study.held_quantities import holds_still, is_noise
from smarig.study.known_masses import with_read_masses
from smarig.study.nameless_columns import doubt_by_loop, roles_by_loop, unless_rivals
from smarig.study.pulled_wires import pulled_roles
from smarig.study.second_thermometer import SecondThermometer, second_thermometer, witness_reason
from smarig.study.signal_columns import input_column, is_grid, output_column, rivals_of, voltage_with_charge
from smarig.study.strain_columns import other_strains
from smarig.study.thermometer_places import IN_INSTRUMENT, distance
from smarig.study.typed_names import typed_name
from smarig.study.unused_columns import reason_unused

_HEATING = (q.CURRENT, q.VOLTAGE, q.POWER, q.DUTY)
_LEAST_TURN = 0.3  # correlation of output and input above which the output clearly falls with the input


@dataclass(frozen=True)
class Role:
    """What a column is used for (time, fraction of a time, input, output, condition, ambient, command, voltage,
    temperature, compare, elsewhere for a thermometer that is no witness, ignored), and why."""

    role: str
    reason: str
    confidence: float = LIKELY


@dataclass(frozen=True, eq=False)
class TableGuess:
    """The meaning of a table: guesses of its columns and their roles by name.

    ``scale`` multiplies the output, with ``sign`` as its reason. ``by_loop``: why one of two columns without names
    is the input, "" for columns with names. ``branches`` pairs the columns of a heating branch
    with those of a cooling branch in the same rows, a shared input with itself; ``backward`` are the branches ("up",
    "down") that are read from the last row to the first, None for names that differ in one letter. ``settled``: each
    row is one settled reading.
    """

    table: FoundTable
    columns: tuple[ColumnGuess, ...]
    roles: dict[str, Role]
    scale: float = 1.0
    sign: str = ""
    branches: dict[str, str] = field(default_factory=dict)
    backward: tuple[str, ...] | None = None
    settled: bool = False
    by_loop: str = ""

    def of_role(self, role: str) -> list[ColumnGuess]:
        """The columns in a role, in the order of the table."""
        return [g for g in self.columns if self.roles[g.name].role == role]

    def first(self, role: str) -> ColumnGuess | None:
        """The first column in a role."""
        return next(iter(self.of_role(role)), None)

    def shown_role(self, name: str) -> Role:
        """The role of a column as shown: that of the second branch has that of the first."""
        first = next((a for a, b in self.branches.items() if b == name != a), None)
        role = self.roles[first].role if first else "ignored"
        if first is None or role == "ignored":
            return self.roles[name]
        if self.backward is None:
            return Role(f"{role}, second branch", f"beside {shown(first)}, whose name differs in one letter")
        order = "from the last row to the first" if "down" in self.backward else "in the order of the rows"
        return Role(f"{role}, second branch", f"read after {shown(first)}, {order}: two branches of one loop")

    @property
    def doubts(self) -> list[str]:
        """The roles that need an answer: "input", "output", or a column whose unit is not clear."""
        doubts = []
        for role in ("input", "output"):
            guess = self.first(role)
            sure = (
                self.roles[guess.name].confidence if guess else float(role == "output" and self.heating_only)
            )
            if sure < UNSURE:
                doubts.append(role)
        for guess in [*self.of_role("input"), *self.of_role("output"), *self.of_role("time")]:
            if guess.unit_confidence < UNSURE:
                doubts.append(f"unit {guess.name}")
        return doubts

    @property
    def heating_only(self) -> bool:
        """Whether the table shows only how a temperature follows what heats."""
        return self.first("output") is None and self.first("temperature") is not None


def guess_table(
    table: FoundTable,
    *,
    input: str | None = None,
    output: str | None = None,
    units: dict[str, str] | None = None,
    files: Sequence[str] = (),
) -> TableGuess:
    """The meaning of a table. ``input``, ``output`` and ``units`` by column are given by the user and count.

    ``files`` are names of files of the same layout, which may state values. UsageError for a column that is missing.
    """
    for name in [n for n in (input, output, *(units or {})) if n is not None]:
        if name not in table.names:
            known = [typed_name(table, own) for own in table.names]
            raise UsageError(f"{table.path} has no column {shown(name)}{suggestion(name, known)}.")
    columns = with_read_masses(with_heat_flows(table, guess_columns(table, units or {}, files)))
    pairs, by_words = branch_pairs(columns), False
    if not pairs:
        twice = branches_written_twice(columns, output)
        pairs, by_words = branches_by_words(columns, output) or twice, True
        columns = with_shared_input(columns, pairs)
    moving = [c for c in columns if c.facts.known.size > 1 and c.facts.span > 0 and c.facts.kind != "text"]
    _check_named(table, {"input": input, "output": output}, columns, moving)
    candidates = [c for c in moving if c.name not in pairs.values()]
    roles: dict[str, Role] = {}
    time = _time([c for c in columns if c.name not in (input, output)])
    if time is not None:
        roles[time.name] = Role("time", time.quantity_reason, time.quantity_confidence)
    if time is not None and (fraction := _fraction([c for c in columns if c is not time], time)) is not None:
        roles[fraction.name] = Role("fraction", f"the fraction of {shown(time.name)}: one clock", LIKELY)
    left = [
        c
        for c in candidates
        if c is not time and (not (c.quantity in q.NO_SIGNALS or c.is_flag) or c.name in (input, output))
    ]
    out = output_column(left, output, input)
    drive = input_column(left, out, input)
    warm = next((c for c in left if c.quantity == q.TEMPERATURE and not holds_still(c)), None)
    heats = next((c for c in left if c.quantity in _HEATING and input in (None, c.name)), None)
    if out is None and warm is not None and heats is not None:
        roles[warm.name] = Role("temperature", "what the heating warms; there is no output", LIKELY)
        drive = heats
    if (
        out is None
        and output is None
        and drive is not None
        and "temperature" not in [r.role for r in roles.values()]
    ):
        out = _moved_by(drive, left, pairs)
    found = None
    if drive is not None and out is not None and input is None and output is None and not pairs:
        found = roles_by_loop(drive, out)
    if found is not None:
        found = unless_rivals(found, left)
        drive, out = found.drive, found.out
        columns = [next((c for c in (drive, out) if c.name == g.name), g) for g in columns]
        roles |= {
            drive.name: Role("input", found.reason, found.confidence),
            out.name: Role(
                "output", found.rivals or found.reason, UNSURE / 2 if found.rivals else found.confidence
            ),
        }
    else:
        roles |= {out.name: _role("output", out, output)} if out is not None else {}
        roles |= {drive.name: _role("input", drive, input)} if drive is not None else {}
        if drive is not None and out is not None and output is not None and input is None and len(left) > 2:
            against = doubt_by_loop(drive, out)  # of two columns, the answer on one settles the other
            roles |= {drive.name: Role("input", against, UNSURE / 2)} if against else {}
    if drive is not None and out is not None and None is input is output:
        drive, out, pulled = pulled_roles(drive, out)
        roles |= {c.name: Role(role, pulled) for c, role in ((drive, "input"), (out, "output")) if pulled}
    _further_roles(columns, roles, drive, out)
    if (
        drive is not None
        and input is None
        and not pairs
        and (tie := _equal_thermometer(columns, roles, drive, out)) is not None
    ):
        names = f"{shown(drive.name)} and {shown(tie.name)}"
        roles[drive.name] = Role("input", f"no name says which of {names} is at the specimen", UNSURE / 2)
    again = drive is not None and any(c.name.startswith(f"{drive.name} (2") for c in columns)
    if out is not None and output is None and not again and (others := _further_strains(out, left)):
        names = ", ".join(shown(c.name) for c in (out, *others))
        roles[out.name] = Role("output", f"no name says which of {names} is along the load", UNSURE / 2)
    if out is not None and output is None and not again and (others := _further_displacements(out, left)):
        names = ", ".join(shown(c.name) for c in (out, *others))
        roles[out.name] = Role("output", f"no name says which of {names} is at the specimen", UNSURE / 2)
    if out is not None and output is None and out is voltage_with_charge(left):
        roles[out.name] = _sensor_role(out, left, table)
    guess = TableGuess(table, tuple(columns), roles, by_loop=found.reason if found else "")
    if drive is not None and out is not None and out.name in pairs and (by_words or drive.name in pairs):
        guess = _of_two_branches(guess, {drive.name: drive.name} | pairs, by_words)
    scale, sign = _sign(drive, out)
    shown_columns = tuple(_as_used(c, guess) for c in guess.columns)
    return replace(guess, columns=shown_columns, scale=scale, sign=sign, settled=_is_staircase(drive, guess))


def _as_used(c: ColumnGuess, guess: TableGuess) -> ColumnGuess:
    """A column, without the unit that nobody states and the motion that only its numbers suggest if it is not used."""
    if guess.shown_role(c.name).role != "ignored":
        return c
    by_numbers = c.by_numbers and c.quantity in (q.DISPLACEMENT, q.STRAIN)
    return (
        replace(c, quantity="", quantity_confidence=0.0).with_stated_unit()
        if by_numbers
        else c.with_stated_unit()
    )


def _of_two_branches(guess: TableGuess, branches: dict[str, str], by_words: bool) -> TableGuess:
    """The guess of a table whose rows hold two branches; they share no clock, and neither witnesses the other."""
    partners = {b: Role("ignored", "the other branch", LIKELY) for a, b in branches.items() if a != b}
    guess = replace(
        guess, roles=guess.roles | {name: r for name, r in partners.items() if name in guess.roles}
    )
    if not by_words:
        return replace(guess, branches=branches)
    of_name = {c.name: c for c in guess.columns}
    drive, out = (guess.of_role(role)[0].name for role in ("input", "output"))
    ends = [(of_name[name], of_name[branches[name]]) for name in (drive, out)]
    if not all(goes_one_way(u, y) for u, y in zip(*ends, strict=True)):
        return guess
    clock = [*guess.of_role("time"), *guess.of_role("fraction")]
    shared = {c.name: Role("ignored", "two branches share the rows", LIKELY) for c in clock}
    return replace(guess, branches=branches, backward=backward_branches(*ends), roles=guess.roles | shared)


def _check_named(
    table: FoundTable,
    named: dict[str, str | None],
    columns: Sequence[ColumnGuess],
    moving: Sequence[ColumnGuess],
) -> None:
    """Raise UsageError, with the reason, for a column that the user named but that no loop can be made of."""
    for role, name in named.items():
        for c in (c for c in columns if c.name == name and c not in moving):
            why = (
                "some of its cells are texts"
                if c.facts.kind == "text"
                else "its value is the same in every row"
            )
            why = why if c.facts.known.size else "it holds no numbers"
            raise UsageError(f"{table.path}: column {shown(c.name)} cannot be the {role}: {why}.")


def _moved_by(
    drive: ColumnGuess, left: Sequence[ColumnGuess], pairs: Mapping[str, str]
) -> ColumnGuess | None:
    """The output where no quantity says which it is: the field of a magnet that a current drives, or the first column
    of the same or of no quantity, or one that was read on two ways of the input, as ``pairs`` say.
    """
    field = q.FIELD if drive.quantity == q.CURRENT else ""
    able = (field, "", drive.quantity)
    rest = [c for c in left if c is not drive and (c.quantity in able or {drive.name, c.name} <= set(pairs))]
    return min(rest, key=lambda c: (is_noise(c), c.quantity != field), default=None)


def _time(columns: Sequence[ColumnGuess]) -> ColumnGuess | None:
    """The clock: a column of times that never runs backwards, or that a resumed log starts again from its beginning."""
    times = [c for c in columns if c.quantity == q.TIME and 2 * c.facts.missing < c.facts.values.size]
    times.sort(key=lambda c: c.facts.missing > 0)  # rows without a time are left out
    resumed = [c for c in times if c.facts.restarts and c.facts.kind != "clock" and not c.by_numbers]
    first = next((c for c in times if c.facts.rising), next(iter(resumed), None))
    return next((c for c in times if first is not None and _is_finer(c, first)), first)


def _is_finer(c: ColumnGuess, clock: ColumnGuess) -> bool:
    """Whether a time is that of a clock of whole seconds, but finer: they agree within a second, as rounding does."""
    if (
        clock.facts.kind != "clock"
        or clock.facts.missing
        or c.facts.missing
        or not clock.facts.whole
        or not c.facts.rising
        or dimension(c.unit) != "time"
    ):
        return False
    seconds = convert(c.facts.values, c.unit, "s")
    apart = seconds - seconds[0] - (clock.facts.values - clock.facts.values[0])
    return bool(np.ptp(apart) <= 1 and (seconds != np.round(seconds)).any())


def _fraction(others: Sequence[ColumnGuess], time: ColumnGuess) -> ColumnGuess | None:
    """The column of fractions of a second beside a clock that repeats whole seconds: with it, each row is later than
    the row before.
    """
    seconds = time.facts.values
    if time.facts.kind != "clock" or time.facts.missing or not (np.diff(seconds) == 0).any():
        return None
    for c in others:
        part = convert(c.facts.values, c.unit, "s") if dimension(c.unit) == "time" else np.full(1, np.nan)
        if (part >= 0).all() and (part < 1).all() and (np.diff(seconds + part) > 0).all():
            return c
    return None


def _is_staircase(drive: ColumnGuess | None, guess: TableGuess) -> bool:
    """Whether each row is a settled reading, as of a staircase of currents."""
    return bool(drive and drive.quantity == q.CURRENT and any(is_grid(c) for c in guess.columns))


def _role(role: str, guess: ColumnGuess, named: str | None) -> Role:
    if named is not None:
        return Role(role, "given by you", 1.0)
    if not guess.quantity:
        return Role(role, "the only columns that move; no name says more", 0.3)
    kind = "drives the hysteresis" if role == "input" else "is what moves"
    kind = "is a rate" if guess.quantity == q.HEAT_FLOW else kind
    return Role(role, f"{guess.quantity}, which {kind}: {guess.quantity_reason}", guess.quantity_confidence)


def _further_roles(
    columns: Sequence[ColumnGuess], roles: dict[str, Role], drive: ColumnGuess | None, out: ColumnGuess | None
) -> None:
    """Give every other column a role: ambient, command, condition, comparison, or none."""
    for c in columns:
        if c.name in roles:
            continue
        if c.facts.kind == "text" or not c.facts.known.size:
            few = 2 * c.facts.known.size < c.facts.values.size
            why = "no numbers" if few else "of another pair of columns, or not in every file"
            roles[c.name] = Role("ignored", why, STATED)
        elif c.quantity == q.AMBIENT and dimension(c.unit) == "temperature":
            roles[c.name] = Role("ambient", c.quantity_reason, c.quantity_confidence)
        elif drive is not None and c.quantity == drive.quantity == q.CURRENT and (c.commanded or is_grid(c)):
            how = "its name or comment says so" if c.commanded else "it lies on a grid of equal steps"
            roles[c.name] = Role("command", f"the commanded current: {how}", LIKELY)
        elif _with_current(c, drive, columns, roles):
            role = "voltage" if c.quantity == q.VOLTAGE else "temperature"
            roles[c.name] = Role(
                role, f"{c.quantity} beside the current: {c.quantity_reason}", c.quantity_confidence
            )
        elif (
            drive is not None and (second := second_thermometer(c, drive)) is not None and not holds_still(c)
        ):
            roles[c.name] = _second_role(second, c, drive)
        elif _is_held(c, drive, out) and _new(c, columns, roles):
            roles[c.name] = Role(
                "condition", f"{c.quantity}, which was held: {c.quantity_reason}", c.quantity_confidence
            )
        else:
            roles[c.name] = Role("ignored", reason_unused(c, out), LIKELY)


def _is_held(c: ColumnGuess, drive: ColumnGuess | None, out: ColumnGuess | None) -> bool:
    """Whether a column is a load or a temperature that was held; in a unit that is not known, nobody knows what it is.

    A second thermometer beside a temperature that drives the loop is none.
    """
    sure = c.quantity_confidence >= WEAK and c.unit_confidence >= WEAK
    if c.quantity == q.TEMPERATURE:
        signals = [g.quantity for g in (drive, out) if g is not None]
        sure = sure and q.TEMPERATURE not in signals and not c.commanded and len(signals) > 1
    return sure and c.quantity in q.HELD and holds_still(c)


def _new(c: ColumnGuess, columns: Sequence[ColumnGuess], roles: dict[str, Role]) -> bool:
    """Whether a condition says more than a stress, or a column of its quantity, that is one already."""
    known = [g for g in columns if g.name in roles and roles[g.name].role == "condition"]
    if any(g.quantity == c.quantity for g in known):
        return False
    if c.quantity in (q.FIELD, q.TEMPERATURE):
        return True
    stress = next((g for g in columns if g.quantity == q.STRESS and _is_held(g, None, None)), None)
    return c.quantity == q.STRESS or stress is None


def _with_current(
    c: ColumnGuess, drive: ColumnGuess | None, columns: Sequence[ColumnGuess], roles: dict[str, Role]
) -> bool:
    """Whether a column is the first voltage or temperature beside a current that drives the wire; a voltage that stays
    the same while the current changes is that of the supply.
    """
    if drive is None or drive.quantity != q.CURRENT or c.quantity not in (q.VOLTAGE, q.TEMPERATURE):
        return False
    if c.quantity == q.VOLTAGE and c.facts.constant:
        return False
    before = [g for g in columns if g.name in roles and g.quantity == c.quantity]
    return not before and c.unit_confidence > UNSURE


def _second_role(second: SecondThermometer, c: ColumnGuess, drive: ColumnGuess) -> Role:
    """The role of a second thermometer that moves: to compare both, or none at another place."""
    if second.is_witness and distance(c) != IN_INSTRUMENT:
        return Role("compare", witness_reason(c, drive), LIKELY)
    return Role("elsewhere", second.difference(drive), LIKELY)


def _equal_thermometer(
    columns: Sequence[ColumnGuess], roles: dict[str, Role], drive: ColumnGuess, out: ColumnGuess | None
) -> ColumnGuess | None:
    """A thermometer that usually reads otherwise than that of the input, and whose name says as much of its place; not
    that of a second group of columns, where the name of the output is written again, too.
    """
    if out is not None and any(c.name.startswith(f"{out.name} (2") for c in columns):
        return None
    others = [c for c in columns if c.name in roles and distance(c) == distance(drive)]
    moving = [c for c in others if roles[c.name].role in ("compare", "elsewhere")]
    return next((c for c in moving if _differs(second_thermometer(c, drive))), None)


def _differs(second: SecondThermometer | None) -> bool:
    return second is not None and not (second.is_witness and second.is_at_one_place)


def _further_strains(out: ColumnGuess, left: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """Strains that differ from the output, known as well as it is, and may be the one along the load."""
    strains = [c for c in left if c.quantity == out.quantity == q.STRAIN and c.by_numbers == out.by_numbers]
    return other_strains(out, [c for c in strains if not holds_still(c) and not is_noise(c)])


def _further_displacements(out: ColumnGuess, left: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """Displacements that differ from the output, known as well as it is, and may be that of the specimen."""
    if out.quantity not in (q.DISPLACEMENT, q.ANGLE) or out.by_numbers:
        return []
    measured = [c for c in left if not c.commanded and not holds_still(c) and not is_noise(c)]
    return rival_displacements(out, rivals_of(out, measured))


def _sensor_role(out: ColumnGuess, left: Sequence[ColumnGuess], table: FoundTable) -> Role:
    """The role of the voltage of a sensor beside a charge; it is sure where a line before the table says so."""
    if line := line_that_names(out, table):
        return Role("output", f"the voltage of a sensor; a line before the table says: {shown(line)}", LIKELY)
    charge = next(c for c in left if c.quantity == q.CHARGE)
    why = f"no line says whether {shown(out.name)} or {shown(charge.name)}, the integral of the current, is meant"
    return Role("output", why, UNSURE / 2)


def _sign(drive: ColumnGuess | None, out: ColumnGuess | None) -> tuple[float, str]:
    """The factor of the output, and a sentence on its sign."""
    if drive is None or out is None or out.quantity == q.HEAT_FLOW:
        return 1.0, ""
    u, y = drive.facts.values, out.facts.values
    known = np.isfinite(u) & np.isfinite(y)
    if known.sum() < 3 or np.ptp(u[known]) == 0 or np.ptp(y[known]) == 0:
        return 1.0, ""
    along = correlation(u[known], y[known])
    falls = along < -_LEAST_TURN
    if falls and out.quantity == q.FORCE and drive.quantity == q.TEMPERATURE:
        return -1.0, "turned: the force of a clamped wire rises with temperature, but the reading falls"
    if falls:
        as_strain = out.quantity in (q.STRAIN, q.DISPLACEMENT) and drive.quantity == q.TEMPERATURE
        return (
            1.0,
            f"as recorded: the output falls while the input rises{', as strain does' if as_strain else ''}",
        )
    if along < _LEAST_TURN:
        return 1.0, "as recorded: the output rises on a part of the input, and falls on another"
    return 1.0, "as recorded: the output rises with the input"
