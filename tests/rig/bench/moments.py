"""Times of the phases of a protocol, as requests on each device's line and as ticks, taken from a run
without faults.

In lock-step a run is the same every time, so the n-th request is always the same request.
"""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import pytest

from rig.bench.broken_rig import rig_file
from smarig.cli import run as cli
from smarig.device.drivers._conversation import Conversation
from smarig.record import Run, load_run


class LoggedRequest(NamedTuple):
    """A request: the how manieth on its line, what it writes to the command block, the last tick before it."""

    device: str
    number: int
    values: dict[str, int]
    tick: int


class Moment(NamedTuple):
    """The first request of a phase on either line."""

    amplifier: LoggedRequest
    encoder_daq: LoggedRequest


@cache
def sound(protocol: tuple[str, ...]) -> tuple[dict[str, Moment], Run]:
    """Phases of a run without faults, and the run."""
    log: list[LoggedRequest] = []
    with pytest.MonkeyPatch.context() as patch, TemporaryDirectory() as folder:
        _log_requests(patch, log)
        out = Path(folder) / "sound.run.sqlite"
        rig = rig_file(Path(folder), "serial", [])
        rig.write_text(
            "".join(x for x in rig.read_text().splitlines(True) if not x.startswith("trace"))
        )  # nothing to watch
        pairs = [word for pair in protocol[1:] for word in ("--set", pair)]
        assert cli(["run", protocol[0], "--rig", str(rig), "-o", str(out), "--quiet", *pairs]) == 0
        run = load_run(out)
    return _phases(log, run, protocol), run


def _log_requests(patch: pytest.MonkeyPatch, log: list[LoggedRequest]) -> None:
    send = Conversation._send

    def logged_exchange(self, e):
        device = self.map.device.name
        commands = e.words and e.write_at == self.map.start("command")
        values = self.map.decode("command", e.words) if commands else {}
        before = [s for s in log if s.values.get("ring_want") and s.device == "encoder_daq"]
        tick = before[-1].values["ring_next"] - 1 + before[-1].values["ring_want"] if before else 0
        log.append(LoggedRequest(device, 1 + sum(s.device == device for s in log), values, tick))
        return send(self, e)

    patch.setattr(Conversation, "_send", logged_exchange)


def _phases(log: list[LoggedRequest], run: Run, protocol: tuple[str, ...]) -> dict[str, Moment]:
    reads = [k for k, s in enumerate(log) if s.device == "encoder_daq" and s.values.get("ring_want")]
    found = {"opening": _moment(log, 0), "started": _moment(log, reads[1])}
    if protocol[0] == "initialise":
        zero = next(k for k, s in enumerate(log) if s.device == "encoder_daq" and s.values.get("order"))
        return found | {"zeroing": _moment(log, zero)}
    second, third = run.steps[1], run.steps[2]
    middle = round((second.t_start_s + second.t_end_s) / 2 / run.meta["period_s"])
    change = round(third.t_start_s / run.meta["period_s"])
    return found | {
        "in a hold": _moment(log, next(k for k in reads if log[k].tick >= middle)),
        "step change": _moment(log, next(k for k in reads if log[k].tick >= change) - 1),
        "end": Moment(next(s for s in log[reads[-1] :] if s.values.get("order")), log[reads[-1]]),
    }


def _moment(log: list[LoggedRequest], at: int) -> Moment:
    """The next request on either line from there on; the last one where there is none."""

    def of(device: str) -> LoggedRequest:
        mine = [s for s in log if s.device == device]
        return next((s for s in log[at:] if s.device == device), mine[-1])

    return Moment(of("amplifier"), of("encoder_daq"))
