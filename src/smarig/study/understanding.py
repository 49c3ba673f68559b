"""Understands all tables of a study together: one meaning for tables of one layout, questions, and mapping drafts."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from smarig.core import DataError, UsageError, shown
from smarig.exchange import FoundTable, find_tables
from smarig.study.column_guess import LIKELY, ColumnGuess, is_rate_of_output
from smarig.study.column_pairs import tables_of_pairs
from smarig.study.held_loads import tables_of_loads
from smarig.study.joined_blocks import joined_blocks
from smarig.study.joined_channels import joined_channels
from smarig.study.questions import StudyCommand, answering, question
from smarig.study.result_rows import refuse_result_rows
from smarig.study.run_conditions import with_run_conditions
from smarig.study.study_options import StudyOptions
from smarig.study.table_guess import Role, TableGuess, guess_table
from smarig.study.typed_names import listed_names, own_name, typed_name

Ask = Callable[[str, Sequence[str]], str]  # question and choices → answer
_FORC = "forc"


@dataclass(frozen=True, eq=False)
class Understanding:
    """The tables of a study with their meaning; ``left_out`` are tables and files not used, each with a reason.

    ``joined``: a sentence on files that are channels of one record, "" for none.
    """

    guesses: tuple[TableGuess, ...]
    left_out: dict[str, str]
    questions: int
    joined: str = ""

    @property
    def forc(self) -> bool:
        """Whether these are reversal curves, which describe themselves."""
        return self.guesses[0].table.format == _FORC


def understand(
    files: Sequence[Path], options: StudyOptions, ask: Ask | None = None, *, out: Path | None = None
) -> Understanding:
    """The meaning of the tables of these files.

    ``ask`` puts a question to the user, None where nobody answers; ``out`` is the folder that the commands which answer
    it name. Raises UsageError if a guess is not sure, nobody
    answers and the options do not accept it; DataError if no file holds a table.
    """
    tables, left_out = _tables(files)
    channels = joined_channels(tables, out if options.mapping is None else None)
    tables = channels.tables
    tables = tables if options.mapping else _by_loads(_by_pairs(tables, options), options)
    tables, unlike = _of_one_layout(tables)
    left_out |= unlike
    options = _with_own_names(max(tables, key=len), options)
    names = [file.name for file in files]
    common = set.intersection(*(set(t.names) for t in tables))
    tables = [_with_columns(t, common) if _usable(t, common) else t for t in tables]
    lead = guess_table(
        max(tables, key=len), input=options.input, output=options.output, units=options.units, files=names
    )
    lead, options, questions = _answered(lead, StudyCommand(tuple(files), options, out), ask, names)
    guesses = _guesses(tables, lead, options, names)
    return Understanding(tuple(guesses), left_out, questions, channels.sentence)


def _with_own_names(table: FoundTable, options: StudyOptions) -> StudyOptions:
    """The options with the names of columns that were given by their numbers."""
    drive, out = (name and own_name(table, name) for name in (options.input, options.output))
    units = {own_name(table, name): unit for name, unit in options.units.items()}
    return replace(options, input=drive, output=out, units=units)


def _tables(files: Sequence[Path]) -> tuple[list[FoundTable], dict[str, str]]:
    """The tables of all files, and the files without one; DataError if there is none at all."""
    tables: list[FoundTable] = []
    left_out: dict[str, str] = {}
    taken: set[Path] = set()
    for file in files:
        if file.resolve() in taken:
            continue
        try:
            found = find_tables(file, files)
        except DataError as error:
            if len(files) == 1:
                raise
            left_out[file.name] = str(error)
            continue
        for table in found:
            taken |= {path.resolve() for path in table.with_files}
            left_out |= {f"{file.name} {part}": reason for part, reason in table.left_out.items()}
        tables += joined_blocks(found)
    if not tables:
        raise DataError("None of these files holds a table: " + " ".join(left_out.values()))
    return tables, left_out


def _by_pairs(tables: Sequence[FoundTable], options: StudyOptions) -> list[FoundTable]:
    """The tables, with one for each pair of columns where pairs stand side by side."""
    named = (options.input, options.output, *options.units)
    return [pair for table in tables for pair in tables_of_pairs(table, named)]


def _by_loads(tables: Sequence[FoundTable], options: StudyOptions) -> list[FoundTable]:
    """The tables, with one for each load where a record was taken at several."""
    own = [_with_own_names(table, options) for table in tables]
    named = [(one.input, one.output) for one in own]
    known = [tuple(n if n in t.names else None for n in pair) for t, pair in zip(tables, named)]
    return [part for table, pair in zip(tables, known) for part in tables_of_loads(table, *pair)]


def _of_one_layout(tables: Sequence[FoundTable]) -> tuple[list[FoundTable], dict[str, str]]:
    """The tables that belong together: of the format and the columns with most rows in total."""
    rows: Counter[tuple] = Counter()
    for table in tables:
        rows[_kind(table)] += len(table)
    main = max(rows, key=lambda kind: rows[kind])
    shared = set(main[1])
    records = [t for t in tables if _kind(t) == main]
    able = [t for t in tables if t.format == main[0] and (t in records or _usable(t, shared & set(t.names)))]
    kept = [t for t in able if t in records or not any(_evaluates(t, record) for record in records)]
    out = {}
    for table in tables:
        if table not in kept:
            title = f"{table.path.name} {table.name}".strip()
            why = f"its columns ({', '.join(table.names)[:100]}) differ from those of the other tables"
            why = "it has no clock, and evaluates readings of another table" if table in able else why
            out[title] = f"{why}; its {len(table)} rows are not used"
    return kept, out


def _kind(table: FoundTable) -> tuple[str, tuple[str, ...]]:
    return table.format, table.names


def _usable(table: FoundTable, common: set[str]) -> bool:
    """Whether the columns that tables share suffice for an input and an output."""
    if table.format == _FORC or len(common) < 2:
        return False
    if len(common) == len(table.names):
        return True
    guess = guess_table(_with_columns(table, common))
    return guess.first("input") is not None and guess.first("output") is not None and not guess.doubts


def _evaluates(table: FoundTable, record: FoundTable) -> bool:
    """Whether a shorter table in the file of a record lists some of its readings again, as a report does: it has no
    clock, which the record has, and its inputs lie within those of the record.
    """
    if table.path != record.path or len(table) >= len(record):
        return False
    clock, drive = (guess_table(record).first(role) for role in ("time", "input"))
    if clock is None or drive is None or clock.name in table.names or drive.name not in table.names:
        return False
    known = table.columns[table.names.index(drive.name)].values
    return bool((known >= drive.facts.low).all() and (known <= drive.facts.high).all())


def _with_columns(table: FoundTable, names: set[str]) -> FoundTable:
    """The table whose other columns are texts, so that they are not used."""
    columns = tuple(c if c.name in names else replace(c, kind="text") for c in table.columns)
    return replace(table, columns=columns)


def _answered(
    guess: TableGuess, command: StudyCommand, ask: Ask | None, files: Sequence[str]
) -> tuple[TableGuess, StudyOptions, int]:
    """The guess after the user has answered what is not clear, the options with the answers, and their number."""
    count, options = 0, command.options
    if guess.table.format == _FORC or options.mapping is not None:
        return guess, options, 0  # these data, or the given mapping, say it themselves
    _check_no_rate(guess, options)
    if options.input is None and options.output is None:
        refuse_result_rows(guess)
    given: dict[str, Any] = {"input": options.input, "output": options.output}
    units = dict(options.units)
    while ask is not None and not options.accept and guess.doubts:
        doubt = guess.doubts[0]
        count += 1
        if doubt.startswith("unit "):
            name = doubt.removeprefix("unit ")
            units[name] = ask(f"Unit of {shown(typed_name(guess.table, name))}", ())
        else:
            choices = [typed_name(guess.table, c.name) for c in guess.columns]
            given[doubt] = own_name(guess.table, ask(f"Which column is the {doubt}", choices))
        guess = guess_table(guess.table, **given, units=units, files=files)
        if count > 3 * len(guess.columns):
            break
    if guess.doubts and not options.accept:
        raise UnsureError(question(guess, command), guess)
    if guess.first("input") is None:
        raise UnsureError(
            f"{guess.table.path}: no column looks like an input. Name one with --input NAME."
            f"{answering(guess, command)}",
            guess,
        )
    if guess.first("output") is None and not guess.heating_only:
        names = listed_names(guess.table)
        raise UnsureError(
            f"{guess.table.path}: no column looks like an output (columns: {names}). Name input and output with "
            f"--input NAME --output NAME.{answering(guess, command)}",
            guess,
        )
    return guess, replace(options, **given, units=units), count


def _check_no_rate(guess: TableGuess, options: StudyOptions) -> None:
    """Raise UnsureError for a table whose only output is a rate, unless the user has named one."""
    if options.output is not None or guess.heating_only or (guess.first("output") and guess.first("input")):
        return
    rate = next((c for c in guess.columns if is_rate_of_output(c)), None)
    if rate is not None:
        raise UnsureError(
            f"{guess.table.path}: {shown(rate.name)} is a rate, not the output of a hysteresis; its integral over time "
            "would be the output. Integrate it first, or name another column with --output NAME.",
            guess,
        )


class UnsureError(UsageError):
    """A guess that is not sure enough to go on without the user; ``guess`` is the draft."""

    def __init__(self, sentence: str, guess: TableGuess) -> None:
        super().__init__(sentence)
        self.guess = guess


def _guesses(
    tables: Sequence[FoundTable], lead: TableGuess, options: StudyOptions, files: Sequence[str]
) -> list[TableGuess]:
    """The guesses of all tables, with the roles of the leading one and one unit for each column."""
    if lead.table.format == _FORC:
        return [replace(lead, table=table) for table in tables]
    if options.mapping is not None:  # it describes one table of each file
        by_file = {table.path: table for table in reversed(tables)}
        return [replace(lead, table=table) for table in reversed(by_file.values())]
    drive, out = lead.first("input"), lead.first("output")
    named = {"input": drive.name if drive else None, "output": out.name if out else None}
    own = [guess_table(table, files=files) for table in tables]
    units = dict(options.units)
    for name in filter(None, named.values()):
        similar = [c for guess in own for c in guess.columns if c.name == name and c.unit]
        if similar and name not in units:
            widest = max(similar, key=lambda c: max(abs(c.facts.low), abs(c.facts.high)))
            units[name] = widest.unit
    found = []
    for guess, table in zip(own, tables):
        wanted = {role: name for role, name in named.items() if name in table.names}
        same = {name: unit for name, unit in units.items() if name in table.names}
        again = guess_table(table, **wanted, units=same, files=files)
        reasons = _given_reasons(again, guess, lead, options)
        found.append(
            replace(
                again,
                roles=reasons,
                columns=_with_meaning(lead, _as_found(again, guess, options)),
                scale=lead.scale,
                sign=lead.sign,
                by_loop=lead.by_loop,
            )
        )
    return with_run_conditions([_unblamed(g) for g in found] if options.input is not None else found)


def _unblamed(guess: TableGuess) -> TableGuess:
    """The guess in which no other thermometer takes readings from an input that the user named."""
    other = Role("elsewhere", "you named the input, so no other thermometer takes readings from it", LIKELY)
    roles = {name: other if role.role == "compare" else role for name, role in guess.roles.items()}
    return replace(guess, roles=roles)


def _with_meaning(lead: TableGuess, columns: Sequence[ColumnGuess]) -> tuple[ColumnGuess, ...]:
    """Columns with the quantities of the leading table, whose loop may have said what numbers alone did not."""
    known = {c.name: c for c in (*lead.of_role("input"), *lead.of_role("output"))} if lead.by_loop else {}
    return tuple(
        replace(known[c.name], facts=c.facts)
        if c.name in known and c.quantity != known[c.name].quantity
        else c
        for c in columns
    )


def _given_reasons(again: TableGuess, own: TableGuess, lead: TableGuess, options: StudyOptions) -> dict:
    """The roles with the reasons of the guess, not with that of a correction that nobody made."""
    roles = dict(again.roles)
    answered = options.input is not None or options.output is not None  # the own guess is of another pair
    for name, role in again.roles.items():
        if role.reason == "given by you" and name not in (options.input, options.output):
            own_role = own.roles[name].role == role.role and name not in options.units
            source = own.roles[name] if own_role and not answered else lead.roles.get(name, role)
            roles[name] = source if source.role == role.role else role
    return roles


def _as_found(again: TableGuess, own: TableGuess, options: StudyOptions) -> tuple:
    """The columns with the reasons of their units, where these are the same as the table's own guess."""
    before = {c.name: c for c in own.columns}
    out = []
    for c in again.columns:
        if c.unit_reason != "given by you" or c.name in options.units:
            out.append(c)
        elif before[c.name].unit == c.unit:
            out.append(before[c.name])
        else:
            out.append(
                replace(
                    c,
                    unit_reason="as in the other tables",
                    unit_confidence=before[c.name].unit_confidence,
                    unit_by_numbers=before[c.name].unit_by_numbers,
                )
            )
    return tuple(out)
