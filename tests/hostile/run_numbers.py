"""Runs whose structure is right and whose numbers are not: too large, missing, all the same, or hardly any."""

from hostile.run_structures import Maker, sql

_CHANNELS = ("t_s", "input", "current_A", "voltage_V", "temperature_degC", "position")
_VALUES = {
    "1e308": "1e308",
    "1e308 of both signs": "CASE rowid % 2 WHEN 0 THEN 1e308 ELSE -1e308 END",
    "inf": "9e999",
    "nothing": "NULL",
    "5e-324": "5e-324 * (rowid % 3)",
    "3": "3.0",
}


def _channel(name: str, value: str) -> Maker:
    """A channel of such values in all samples; for positions also in the steps."""
    statements = [f'UPDATE sample SET "{name}" = {value}']
    if name == "position":
        statements.append(f"UPDATE step SET position = {value}")
    return sql(*statements)


def _one(name: str, value: str) -> Maker:
    """One such value among honest ones, and in the step that it belongs to."""
    statements = [f'UPDATE sample SET "{name}" = {value} WHERE rowid = 300']
    if name == "position":
        statements.append(f"UPDATE step SET position = {value} WHERE rowid = 4")
    return sql(*statements)


NUMBERS: dict[str, Maker] = {
    **{f"{name} is {what}": _channel(name, v) for name in _CHANNELS for what, v in _VALUES.items()},
    **{
        f"one {name} is {v}": _one(name, v)
        for name in ("t_s", "current_A", "position")
        for v in ("1e308", "9e999", "NULL")
    },
    "no samples, but steps": sql("DELETE FROM sample"),
    "one sample": sql("DELETE FROM sample WHERE rowid > 1"),
    "two samples": sql("DELETE FROM sample WHERE rowid > 2"),
    "no steps": sql("DELETE FROM step"),
    "one step": sql("DELETE FROM step WHERE rowid > 1"),
    "two steps": sql("DELETE FROM step WHERE rowid > 2"),
    "targets of 1e308": sql("UPDATE step SET target = 1e308 * (rowid % 2)"),
    "targets of nothing": sql("UPDATE step SET target = NULL"),
    "every step void": sql("UPDATE step SET void = 1"),
    "steps that end before they start": sql("UPDATE step SET t_end_s = t_start_s - 1"),
    "steps at 1e308 s": sql("UPDATE step SET t_start_s = 1e308, t_end_s = 1e308"),
    "everything at 1e308": sql(
        "UPDATE sample SET current_A = 1e308, position = 1e308, t_s = 1e308, voltage_V = 1e308",
        "UPDATE step SET position = 1e308, target = 1e308",
    ),
    "time stands still": sql("UPDATE sample SET t_s = 1.0"),
    "time runs backwards": sql("UPDATE sample SET t_s = -t_s"),
}
