"""The description of a run with types: the keys of the ``run`` table of its file."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from reprlib import repr as short
from typing import Any, Self, final

from smarig.core import named_where_text
from smarig.record.import_finding import ImportFinding
from smarig.record.metadata import KEY_TYPES, QUANTITY_KEYS, is_integer, is_table, is_text, is_timestamp
from smarig.record.stopped_by import StoppedBy

_ATTRIBUTES = {"begun_with": "launch_args", "from": "from_"}  # attributes of keys with another name here
Types = Mapping[str, Callable[[Any], bool]]


@dataclass(frozen=True, kw_only=True)
class StoredTable(ABC):
    """A table of JSON values with an attribute for each known key.

    ``keys`` are all keys of the table in their order. ``extra`` holds, by key, what has no attribute: unknown keys,
    nulls and values of a wrong type. An attribute without a value has its default.
    """

    keys: tuple[str, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    @abstractmethod
    def of(cls, table: Mapping[str, Any], /) -> Self:
        """Read a stored table with any content."""

    def has(self, key: str) -> bool:
        """Whether the table has a key, even with the value null."""
        return key in self.keys

    def __repr__(self) -> str:
        """Its values, each cut to a few words: texts of files are among them."""
        return f"{type(self).__name__}({', '.join(f'{k}={short(v)}' for k, v in self.to_json().items())})"

    def text_of(self, key: str, absent: str) -> str:
        """The value of a key as text, "None" for null; ``absent`` if the table does not have the key."""
        return str(self._value(key)) if self.has(key) else absent

    def to_json(self) -> dict[str, Any]:
        """The table as it was stored."""
        return {key: self._value(key) for key in self.keys}

    def _value(self, key: str) -> Any:
        if key in self.extra:
            return self.extra[key]
        value = getattr(self, _ATTRIBUTES.get(key, key))
        if isinstance(value, StoredTable):
            return value.to_json()
        return list(value) if isinstance(value, tuple) else value


@final
@dataclass(frozen=True, kw_only=True)
class SignalInfo(StoredTable):
    """A signal: quantity, unit, ``from_`` the source of its computation, ``per_count`` the unit per encoder count."""

    quantity: str | None = None
    unit: str = ""
    from_: str | None = None
    per_count: float | None = None

    @classmethod
    def of(cls, table: Mapping[str, Any], /) -> Self:
        """Read a stored table."""
        return cls(**_by_attribute(table, QUANTITY_KEYS))

    @property
    def resolution(self) -> float:
        """One encoder count in ``unit``; 0 if there is none or it is not known."""
        return float(self.per_count or 0.0)


@final
@dataclass(frozen=True, kw_only=True)
class EndInfo(StoredTable):
    """Cause and time (seconds since 1970) of the end of a run; who asked for it, if somebody did."""

    cause: str | None = None
    epoch: float | None = None
    stopped_by: StoppedBy | None = None

    @classmethod
    def of(cls, table: Mapping[str, Any], /) -> Self:
        """Read a stored table."""
        kept = _by_attribute(table, {"cause": is_text, "epoch": is_timestamp})
        return cls(**kept, stopped_by=StoppedBy.of(table.get("stopped_by")))


@final
@dataclass(frozen=True, kw_only=True)
class ImportInfo(StoredTable):
    """The file that a run was imported from: name, format, mapping file and hash.

    ``continues`` is the run file of the part of the record before it, ``continues_sha256`` the hash of its data.
    """

    file: str | None = None
    format: str | None = None
    mapping: str | None = None
    sha256: str | None = None
    continues: str | None = None
    continues_sha256: str | None = None

    @classmethod
    def of(cls, table: Mapping[str, Any], /) -> Self:
        """Read a stored table."""
        return cls(**_by_attribute(table, dict.fromkeys(_IMPORT_KEYS, is_text)))


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class RunInfo(StoredTable):
    """The description of a run; None or empty if not recorded.

    Experiment: ``protocol`` with its ``settings``, ``seed`` and injected ``effects`` of a twin; ``source`` is "bench",
    "twin", "simulation" or "import". Rig: names of ``rig``, ``wire`` and ``actuator``, texts of their files
    (``config``, ``actuator_text``), their values (``rig_values``, ``actuator_values``), the hashes of these
    (``rig_sha256``), ``instruments`` as they identify themselves, ``ambient_from`` (where an ambient temperature that
    nobody measured comes from), ``period_s`` of a tick, ``input`` and ``output``.
    Session: ``start_epoch`` (seconds since 1970), ``encoder_zero``, ``initial`` state of the wire. Resuming:
    ``device``, ``shift`` of its ticks and counts, ``launch_args``, ``own_files``, ``closed_loop``,
    ``history_until_tick``. Closing: ``end``, ``hashes``.
    ``salvaged``: what is known to be missing. ``conditions`` that runs are compared by; the ``load`` of a rig's wire.
    Imports: ``imported``, ``warnings``, ``findings`` (those of the warnings that have a kind), ``repairs``, ``t0_s``,
    ``header``, ``companions``, ``forc``. Simulations:
    ``model`` and the run it was simulated ``along``.
    """

    schema_version: int | None = None
    recorder_pid: int | None = None
    protocol: str | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    seed: int | None = None
    effects: tuple[str, ...] = ()
    source: str | None = None
    rig: str | None = None
    wire: str | None = None
    actuator: str | None = None
    config: str | None = None
    actuator_text: str | None = None
    rig_values: Mapping[str, Any] = field(default_factory=dict)
    actuator_values: Mapping[str, Any] = field(default_factory=dict)
    rig_sha256: Mapping[str, Any] = field(default_factory=dict)
    period_s: float | None = None
    input: SignalInfo = field(default_factory=SignalInfo)
    output: SignalInfo = field(default_factory=SignalInfo)
    start_epoch: float | None = None
    encoder_zero: str | None = None
    initial: str | None = None
    notes: str | None = None
    versions: Mapping[str, Any] = field(default_factory=dict)
    wire_history: str | None = None
    history_until_tick: int | None = None
    device: str | None = None
    instruments: tuple[str, ...] = ()
    ambient_from: str | None = None
    shift: Mapping[str, Any] = field(default_factory=dict)
    launch_args: Mapping[str, Any] | None = None
    own_files: tuple[Any, ...] = ()
    closed_loop: bool = False
    end: EndInfo | None = None
    hashes: Mapping[str, Any] = field(default_factory=dict)
    salvaged: Mapping[str, Any] = field(default_factory=dict)
    imported: ImportInfo | None = None
    conditions: Mapping[str, Any] = field(default_factory=dict)
    load: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    findings: tuple[Mapping[str, Any], ...] = ()
    repairs: Mapping[str, Any] = field(default_factory=dict)
    t0_s: float | None = None
    header: Mapping[str, Any] = field(default_factory=dict)
    companions: Mapping[str, Any] = field(default_factory=dict)
    forc: Mapping[str, Any] = field(default_factory=dict)
    model: str | None = None
    along: str | None = None

    @classmethod
    def of(cls, meta: Mapping[str, Any], where: str = "A run", /) -> Self:
        """Read stored keys with any values. What leads anywhere is marked as named inside the run ``where``."""
        found = _by_attribute(meta, _TYPES)
        found |= {key: named_where_text(found[key], f"run: {key}", where) for key in _NAMING if key in found}
        if "launch_args" in found:
            found["launch_args"] = _marked_launch_args(found["launch_args"], where)
        for key, table in _TABLES.items():
            if key in found:
                found[key] = table.of(found[key])
        for key in ("effects", "warnings", "findings", "own_files", "instruments"):
            if key in found:
                found[key] = tuple(found[key])
        found["closed_loop"] = bool(meta.get("closed_loop"))
        return cls(**found)

    @property
    def import_findings(self) -> tuple[ImportFinding, ...]:
        """The ``findings`` as values."""
        return tuple(ImportFinding.of(f) for f in self.findings if isinstance(f, Mapping))


_IMPORT_KEYS = ("file", "format", "mapping", "sha256", "continues", "continues_sha256")
_TABLES = {"input": SignalInfo, "output": SignalInfo, "end": EndInfo, "imported": ImportInfo}


_NAMING = ("rig", "actuator", "protocol")
_NAMING_AT_LAUNCH = ("rig", "load", "effects")


def _marked_launch_args(launch: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The arguments of a run with marks, also on each text of a list."""

    def marked(value: Any, key: str) -> Any:
        if isinstance(value, list):
            return [marked(part, key) for part in value]
        return named_where_text(value, f"run: begun_with.{key}", where)

    return {**launch, **{key: marked(launch[key], key) for key in _NAMING_AT_LAUNCH if key in launch}}


def _filled_table(value: Any) -> bool:
    return is_table(value) and bool(value)


_TYPES: Types = {
    **KEY_TYPES,
    **dict.fromkeys(("schema_version", "recorder_pid"), is_integer),
    **dict.fromkeys(("header", "companions", "forc"), is_table),
    "imported": _filled_table,
    "closed_loop": lambda value: isinstance(value, bool),
}


def _by_attribute(table: Mapping[str, Any], types: Types) -> dict[str, Any]:
    """Values of the known keys by attribute, with ``keys`` and ``extra``."""
    typed = {key for key, value in table.items() if key in types and types[key](value)}
    found: dict[str, Any] = {_ATTRIBUTES.get(key, key): table[key] for key in table if key in typed}
    extra = {key: value for key, value in table.items() if key not in typed}
    return found | {"keys": tuple(table), "extra": extra}
