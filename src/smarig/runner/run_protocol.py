"""One protocol on one rig in one call: the entry point for notebooks."""

from pathlib import Path
from typing import Any

from smarig.protocols import Chooser
from smarig.record import Run, load_run
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session


def run(
    protocol: str,
    *,
    rig: str,
    out: str | Path,
    seed: int = 0,
    force: bool = False,
    wire: str = "",
    chooser: Chooser | None = None,
    control: RunControl | None = None,
    **settings: Any,
) -> Run:
    """Run a protocol on a rig, record it, and return the run; the entry point for notebooks.

    ``settings`` are the protocol's own (``smarig list protocols --settings``); ``chooser`` is for protocols
    that take one (``smarig.identification.adaptive.informed``). ``control`` pauses or stops it from another thread.
    """
    with Session(rig, seed=seed, wire=wire, control=control) as session:
        return load_run(session.run(protocol, settings, out, force=force, chooser=chooser))
