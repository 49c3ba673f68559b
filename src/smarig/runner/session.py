"""A sitting at one rig: opened and locked once, protocols run and recorded one after the other.

The wire's memory, the device's ticks and the encoder's zero go on from run to run. Every run file is
closed with its cause, whatever that was. Knows rigs, protocols and records; refuses to know analyses.
"""

import platform
import shutil
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from importlib.metadata import version
from pathlib import Path
from typing import Any, Self

from smarig.config import RigFile, load_rig, locate
from smarig.errors import Interrupted, SmarigError, StorageError
from smarig.model.actuator import Actuator
from smarig.protocols._settings import build
from smarig.protocols._setup import Setup
from smarig.protocols.adaptive_fod import Chooser
from smarig.record import CONTINUED, Recorder, Run, load_run
from smarig.rig.guard import Guard
from smarig.rig.pace import Paced
from smarig.rig.twin import Twin, TwinSettings
from smarig.runner.control import Control
from smarig.runner.endings import safe_endings
from smarig.runner.listener import Listener, Watch
from smarig.runner.lock import wire_lock
from smarig.runner.preview import Preview, preview
from smarig.runner.runner import Runner

_ONE_WIRE_INPUT = "wire temperature above ambient"


class Session:
    """``with Session("one_wire_twin", seed=1) as s: s.run("validation", {}, Path("v.run.sqlite"))``."""

    def __init__(
        self,
        rig: str,
        *,
        seed: int = 0,
        twin: TwinSettings | None = None,
        speed: float | None = None,
        wire: str = "",
        control: Control | None = None,
    ) -> None:
        self.file: RigFile = load_rig(rig)
        self._config_text = locate("rigs", rig).read_text(encoding="utf-8")
        self.actuator = Actuator.named(self.file.actuator)
        self.wire = wire or self.file.wire
        settings = twin or TwinSettings(seed=seed)
        self.seed = settings.seed
        self.control = control or Control()
        self.setup = Setup(self.actuator, self.file.limits, self.file.period_s)
        self.twin = Twin(self.file, self.actuator, settings)
        self._guard = Guard(
            Paced(self.twin, speed, while_waiting=self.control.raise_if_stopped) if speed else self.twin,
            self.file.limits,
            self.actuator,
        )
        self._zero = "power-up"
        self._epoch = time.time()
        self._open = ExitStack()

    def __enter__(self) -> Self:
        self._open.enter_context(wire_lock(self.wire))
        self._open.enter_context(safe_endings(self.control))
        return self

    def __exit__(self, *error: object) -> None:
        self._guard.safe()
        self._open.close()

    def run(
        self,
        protocol: str,
        settings: Mapping[str, Any],
        out: str | Path,
        *,
        listeners: Sequence[Listener] = (),
        force: bool = False,
        notes: str = "",
        expected: Preview | None = None,
        chooser: Chooser | None = None,
    ) -> Path:
        """Run one protocol into one run file; returns its path. Raises what ended it, after closing it.

        ``expected``: its preview, if that has been made already. ``chooser``: for protocols that take one.
        """
        out = Path(out)
        generator = build(protocol, self.setup, settings, chooser)
        cost = expected or preview(protocol, self.file, settings, self.control, chooser)
        _check_free_space(out, cost.bytes)
        recorder = Recorder(out, self._describe(protocol, settings, notes), force=force)
        runner = Runner(
            self._guard,
            self.twin.position_per_count,
            [recorder, *listeners, Watch(on_event=self._note)],
            self.control,
        )
        runner.t_s = self.twin.tick * self.file.period_s
        cause = "done"
        recorder.event(runner.t_s, "start", f"Run of {protocol} started.", epoch=time.time())
        try:
            runner.run(generator)
        except BaseException as error:
            cause = _cause(error)
            raise
        finally:
            recorder.describe("encoder_zero", self._zero)
            recorder.close(cause, t_s=runner.t_s)
        return out

    def _note(self, kind: str, t_s: float) -> None:
        if kind == "zero":
            self._zero = f"zeroed at {t_s:g} s"

    def _describe(self, protocol: str, settings: Mapping[str, Any], notes: str) -> dict[str, Any]:
        unit = self.actuator.unit
        return {
            "protocol": protocol,
            "settings": {k: str(v) for k, v in settings.items()},
            "rig": self.file.name,
            "wire": self.wire,
            "actuator": self.actuator.name,
            "source": "simulation" if self.twin.settings.hysteresis else "twin",
            "seed": self.seed,
            "effects": [repr(e) for e in self.twin.settings.effects],
            "start_epoch": self._epoch,
            "period_s": self.file.period_s,
            "input": {
                "quantity": "wire temperature difference T₁ − T₂"
                if self.actuator.two_wire
                else _ONE_WIRE_INPUT,
                "unit": "K",
                "from": "heating model along the measured current",
            },
            "output": {
                "quantity": "shaft angle" if unit == "deg" else "displacement",
                "unit": unit,
                "per_count": self.twin.position_per_count,
            },
            "initial": self.actuator.file.hysteresis.initial if self.twin.tick == 0 else CONTINUED,
            "encoder_zero": self._zero,
            "config": self._config_text,
            "versions": {name: version(name) for name in ("smarig", "numpy", "scipy")}
            | {"python": platform.python_version()},
            "notes": notes,
        }


def _cause(error: BaseException) -> str:
    if isinstance(error, Interrupted):
        return str(error)
    if isinstance(error, KeyboardInterrupt):
        return "interrupted by the keyboard (Ctrl-C, twice)"
    if isinstance(error, SmarigError):
        return f"stopped: {error}"
    return f"failed: {type(error).__name__}: {error}"


def _check_free_space(out: Path, needed: int) -> None:
    folder = next(p for p in (out.resolve().parent, *out.resolve().parent.parents) if p.exists())
    free = shutil.disk_usage(folder).free
    # Twice the data (the write-ahead log holds it once more) and a margin to close the run.
    if free < 2 * needed + 16_000_000:
        raise StorageError(
            f"{folder} has {free / 1e6:.0f} MB free; this run needs about {2 * needed / 1e6 + 16:.0f} MB."
        )


def run(
    protocol: str,
    *,
    rig: str,
    out: str | Path,
    seed: int = 0,
    force: bool = False,
    wire: str = "",
    chooser: Chooser | None = None,
    **settings: Any,
) -> Run:
    """Run a protocol on a rig, record it, and return the run: a notebook's way in.

    ``settings`` are the protocol's own (``smarig list protocols --settings``); ``chooser`` is for protocols
    that take one (``smarig.identification.adaptive.informed``).
    """
    with Session(rig, seed=seed, wire=wire) as session:
        return load_run(session.run(protocol, settings, out, force=force, chooser=chooser))
