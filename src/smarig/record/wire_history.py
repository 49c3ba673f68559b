"""The history of a wire: one small file per wire, rewritten at the end of each run and bring-up.

    cycles       times the predicted input rose above half of the rig's range after it was below a quarter
    hours hot    time with the input above half of the range
    thermal dose ∫ input dt over that time, in kelvin above ambient times hours

For two wires the input is |T₁ − T₂|: heating either wire wears the pair. All figures come from the heating model, none
is measured. Only wires that outlive a session have a history: those of hardware, and of simulated devices that were
started elsewhere (``twin``). A twin is a new wire in every session.

``heat`` is the heat of the wire at the end of the last of them, from which the next session starts. A process that is
killed writes none: only ``smarig resume`` knows the heat that it left.
"""

import json
import math
import os
import zlib
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime
from pathlib import Path

from smarig.core import DataError, atomic_file
from smarig.record.last_heat import LastHeat

HOT, COLD = 0.5, 0.25  # shares of the range


def history_folder() -> Path:
    """The folder of the histories: $SMARIG_HISTORY_DIR, or the user's data folder."""
    override = os.environ.get("SMARIG_HISTORY_DIR")
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(override) if override else Path(data) / "smarig" / "wires"


class Wear:
    """A listener that adds up the wear of a run. ``input_K`` is the input at its start: a hot wire begins no cycle."""

    def __init__(self, range_K: float, period_s: float, input_K: float = 0.0) -> None:
        self._hot_K, self._cold_K, self._tick_h = HOT * range_K, COLD * range_K, period_s / 3600
        self._cooled = math.fabs(input_K) < self._cold_K
        self.cycles, self.hours_hot, self.dose_K_h, self.largest_input_K = 0, 0.0, 0.0, 0.0
        self.last_tick = 0

    def add(self, tick: int, input_K: float) -> None:
        """Add a tick at a predicted input."""
        u = math.fabs(input_K)
        self.last_tick = tick
        if u > self.largest_input_K:
            self.largest_input_K = u
        if u > self._hot_K:
            self.cycles += self._cooled
            self._cooled = False
            self.hours_hot += self._tick_h
            self.dose_K_h += u * self._tick_h
        elif u < self._cold_K:
            self._cooled = True


@dataclass(frozen=True)
class WireHistory:
    """Figures of a wire. ``first_use`` and ``last_use`` are UTC, "" for a wire without runs."""

    wire: str
    twin: bool = False
    runs: int = 0
    cycles: int = 0
    hours_hot: float = 0.0
    dose_K_h: float = 0.0
    largest_input_K: float = 0.0
    first_use: str = ""
    last_use: str = ""
    heat: LastHeat | None = None

    def after(
        self,
        wear: Wear,
        *,
        new_run: bool,
        heat: LastHeat | None = None,
        now: Callable[[], datetime] | None = None,
    ) -> "WireHistory":
        """The history after a run; not ``new_run``: after the rest of a continued run, or a bring-up."""
        now_text = (now() if now else datetime.now(UTC)).strftime("%Y-%m-%dT%H:%M:%SZ")
        return replace(
            self,
            runs=self.runs + new_run,
            cycles=self.cycles + wear.cycles,
            hours_hot=self.hours_hot + wear.hours_hot,
            dose_K_h=self.dose_K_h + wear.dose_K_h,
            largest_input_K=max(self.largest_input_K, wear.largest_input_K),
            first_use=self.first_use or now_text,
            last_use=now_text,
            heat=heat,
        )

    def sentence(self) -> str:
        """The history in one line.

        >>> WireHistory("a", runs=2, cycles=20, hours_hot=1.25, dose_K_h=160.0, largest_input_K=174.0).sentence()
        '2 runs, 20 cycles, 1.25 h above half of the range (160 K h), at most 174.0 K above ambient'
        """
        runs = f"{self.runs} run{'s' if self.runs != 1 else ''}, {self.cycles} cycle{'s' if self.cycles != 1 else ''}"
        hot = f"{self.hours_hot:.2f} h above half of the range ({self.dose_K_h:.4g} K h)"
        return f"{runs}, {hot}, at most {self.largest_input_K:.1f} K above ambient"

    def save(self) -> None:
        """Write the file as a whole. Raises StorageError if it cannot be written."""
        with atomic_file(_path(self.wire, self.twin), force=True) as part:
            part.write_text(json.dumps(asdict(self), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def load_wire_history(wire: str, *, twin: bool) -> WireHistory:
    """The history of a wire, empty if it has none. Raises DataError if its file is damaged."""
    path = _path(wire, twin)
    return _read(path) if path.is_file() else WireHistory(wire, twin)


def wire_histories() -> list[WireHistory]:
    """The histories of all wires, by name."""
    found: Iterable[Path] = history_folder().glob("*.json")
    return sorted(map(_read, found), key=lambda h: (h.wire, h.twin))


def _path(wire: str, twin: bool) -> Path:
    readable = "".join(c if c.isalnum() or c in "-_" else "_" for c in wire)[:60]
    kind = ".twin" if twin else ""
    return history_folder() / f"{readable}-{zlib.crc32(wire.encode()):08x}{kind}.json"


def _read(path: Path) -> WireHistory:
    kinds = {f.name: f.type for f in fields(WireHistory) if f.name != "heat"}
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        heat = data.pop("heat", None)  # files of earlier versions have none
        if set(data) != set(kinds) or not all(_is(data[name], str(kind)) for name, kind in kinds.items()):
            raise ValueError("its keys are not those of a history")
        return WireHistory(**data, heat=None if heat is None else LastHeat.of(heat))
    except (OSError, ValueError, TypeError, AttributeError, KeyError) as error:
        raise DataError(
            f"Wire history {path} cannot be read: {error}. Repair it, or remove it to start a new history."
        ) from None


def _is(value: object, kind: str) -> bool:
    if "float" in kind:
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return type(value).__name__ in kind
