"""A rig as an ophyd-async device and a run as a bluesky flyer, so that a plan of a beamline can step the wire.

    rig = OphydRig("bench_one_wire", "scan.run.sqlite", name="wire")
    RE(scan([rig], rig.input, 20, 80, 7))

Requires the extra ``bluesky``. Safety does not depend on the plan: the rig is a ``SteppedRun`` with its own thread,
limits and record, and its current is at zero when the plan ends, fails or is halted.
"""

import asyncio
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from itertools import chain, count
from pathlib import Path
from typing import Any

import numpy as np

from smarig.app.stepped_run import SteppedRun
from smarig.core import MissingExtra, StepResult, StepVerdict
from smarig.record import Run, load_run
from smarig.runner import RunControl
from smarig.runner import run as run_protocol

try:
    from bluesky.protocols import Collectable, Flyable, Location, Movable, Stageable, Stoppable
    from event_model import DataKey, PartialEvent
    from ophyd_async.core import (
        AsyncStatus,
        StandardReadable,
        StandardReadableFormat,
        soft_signal_r_and_setter,
    )
except ImportError:
    raise MissingExtra("A rig as an ophyd device", "bluesky") from None

_NAN = float("nan")
_Hold = Callable[[SteppedRun, float], "Future[StepResult]"]


class _Execution:
    """The present run of a rig, and the result of its last hold; another run is made when the last one is over."""

    last: StepResult | None

    def __init__(self, rig: str, out: str | Path, options: dict[str, Any]) -> None:
        self._make = lambda: SteppedRun(rig, _free(Path(out)), **options)
        self.run, self.last = self._make(), None
        self._lock = asyncio.Lock()  # a move waits for a rig that is being opened

    async def start(self) -> None:
        """Open the rig, unless it is open."""
        async with self._lock:
            if not self.run.running:
                self.run, self.last = self._make(), None
                await asyncio.to_thread(self.run.start)

    async def end(self) -> None:
        """End the run: at once if the plan does not wait for a hold that it began, because it was aborted or failed."""
        if self.run.running:
            await asyncio.to_thread(self.run.stop, "the plan ended during a hold" if self.run.busy else "")

    async def held(self, hold: _Hold, value: float) -> None:
        """Execute one hold to its end."""
        async with self._lock:
            pass
        self.last = await asyncio.wrap_future(hold(self.run, value))

    def sample(self, name: str) -> float:
        """A value of the latest sample; NaN before the first."""
        return float(getattr(self.run.latest, name)) if self.run.latest is not None else _NAN


class OphydRig(StandardReadable):
    """Readable: ``position`` (mm or deg), ``settled_position``, ``is_settled``, ``voltage`` (V).

    Movable: ``current`` (A) and ``input`` (K above ambient, of the heating model). A move is done when the wire has
    settled.

    Staging opens the rig and begins the run file ``out``, or ``out`` with a number if it exists; ``run_file`` tells its
    name. Unstaging ends the run. ``options``: those of ``SteppedRun``.
    """

    def __init__(self, rig: str, out: str | Path, name: str = "", **options: Any) -> None:
        self._execution = now = _Execution(rig, out, options)
        unit = now.run.session.actuator.unit
        with self.add_children_as_readables(StandardReadableFormat.HINTED_UNCACHED_SIGNAL):
            self.position = _readable(lambda: now.sample("position"), unit)
        with self.add_children_as_readables(StandardReadableFormat.UNCACHED_SIGNAL):
            self.settled_position = _readable(lambda: now.last.position if now.last else _NAN, unit)
            self.is_settled = _readable(
                lambda: float(now.last is not None and now.last.verdict is StepVerdict.SETTLED)
            )
            self.voltage = _readable(lambda: now.sample("voltage_V"), "V")
        with self.add_children_as_readables(StandardReadableFormat.CONFIG_SIGNAL):
            self.run_file, _ = soft_signal_r_and_setter(str, "", getter=lambda: str(now.run.out))
        with self.add_children_as_readables():
            self.current = HeldQuantity(now, "A", SteppedRun.hold, lambda: now.sample("current_A"))
            self.input = HeldQuantity(now, "K", SteppedRun.hold_input, lambda: now.run.input_K)
        super().__init__(name=name)

    @AsyncStatus.wrap
    async def stage(self) -> None:
        """Open the rig and begin its run."""
        await self._execution.start()

    @AsyncStatus.wrap
    async def unstage(self) -> None:
        """End the run; the current is at zero."""
        await self._execution.end()


class HeldQuantity(StandardReadable, Movable[float], Stoppable):
    """Current or input of a rig as something that a plan moves."""

    def __init__(self, execution: _Execution, unit: str, hold: _Hold, now: Callable[[], float]) -> None:
        self._execution, self._hold, self._now = execution, hold, now
        self._setpoint = 0.0
        with self.add_children_as_readables(StandardReadableFormat.HINTED_UNCACHED_SIGNAL):
            self.readback = _readable(now, unit)
        with self.add_children_as_readables(StandardReadableFormat.UNCACHED_SIGNAL):
            self.setpoint = _readable(lambda: self._setpoint, unit)
        super().__init__()

    @AsyncStatus.wrap
    async def set(self, value: float) -> None:
        """Hold the value until the wire has settled. Fails if the limits forbid it or the run ends."""
        self._setpoint = float(value)
        await self._execution.held(self._hold, float(value))

    async def stop(self, success: bool = True) -> None:
        """A move that failed ends the run; the current is at zero. After a pause of the plan, the wire stays held."""
        if not success:
            await self._execution.end()

    async def locate(self) -> Location[float]:
        """Where it was told to be, and where it is."""
        return Location(setpoint=self._setpoint, readback=self._now())


class RunFlyer(Flyable, Collectable, Stageable):
    """A protocol of smarig as one step of a plan: kicked off, completed, and collected as stream ``NAME_steps``.

    Stage it in the plan: a plan that fails or is aborted unstages it, which ends the run at once, at zero current.
    ``settings``: those of the protocol. The run file ``out`` has every sample; ``documents`` of ``smarig export``
    brings them to the catalogue.
    """

    parent = None

    def __init__(self, name: str, protocol: str, rig: str, out: str | Path, **settings: Any) -> None:
        self._name = name
        self._control = RunControl()
        self._start = lambda: run_protocol(protocol, rig=rig, out=out, control=self._control, **settings)
        self.out = Path(out)
        self._running: asyncio.Task[Run] | None = None

    @property
    def name(self) -> str:
        """Prefix of its columns."""
        return self._name

    @AsyncStatus.wrap
    async def stage(self) -> None:
        """Nothing has to be prepared."""

    @AsyncStatus.wrap
    async def unstage(self) -> None:
        """End a run that is still going on."""
        self._control.stop("the plan ended during the run")

    @AsyncStatus.wrap
    async def kickoff(self) -> None:
        """Start the run in a thread of its own."""
        self._control = RunControl()
        self._running = asyncio.create_task(asyncio.to_thread(self._start))

    @AsyncStatus.wrap
    async def complete(self) -> None:
        """Wait for its end."""
        if self._running is None:
            raise RuntimeError(f"{self.name} was not kicked off.")
        await self._running

    def describe_collect(self) -> dict[str, dict[str, DataKey]]:
        """The columns of its steps, by stream."""
        unit = load_run(self.out).unit
        source = f"smarig:{self.out.name}"
        keys = {
            f"{self.name}_position": DataKey(source=source, dtype="number", shape=[], units=unit),
            f"{self.name}_target": DataKey(source=source, dtype="number", shape=[], units="K"),
            f"{self.name}_settled": DataKey(source=source, dtype="boolean", shape=[]),
        }
        return {f"{self.name}_steps": keys}

    def collect(self) -> Iterator[PartialEvent]:
        """One event per step, with its settled position."""
        run = load_run(self.out)
        start_s = run.meta.get("start_epoch") or time.time()
        for step in run.steps:
            values = {
                f"{self.name}_position": _NAN if step.position is None else float(step.position),
                f"{self.name}_target": _NAN if step.target is None else float(step.target),
                f"{self.name}_settled": step.verdict == "settled",
            }
            at_s = start_s + (step.t_end_s or 0.0)
            yield PartialEvent(data=values, timestamps=dict.fromkeys(values, at_s), time=at_s)


def _free(out: Path) -> Path:
    """The path, or the next one with a number that does not exist."""
    name, end = (out.name.removesuffix(".run.sqlite"), ".run.sqlite")
    numbered = (out.with_name(f"{name}_{k}{end}") for k in count(2))
    return next(path for path in chain([out], numbered) if not path.exists())


def _readable(getter: Callable[[], float], units: str | None = None) -> Any:
    """A signal that is read from the rig whenever it is asked for."""
    signal, _ = soft_signal_r_and_setter(float, np.nan, units=units, getter=getter)
    return signal
