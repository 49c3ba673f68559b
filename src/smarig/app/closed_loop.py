"""Closed loops in one call for notebooks: the loop is run and recorded, and the run is returned."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from smarig.app.loop_model import AnyModel, ClosedLoop, ModelSource, check_path, timing_of
from smarig.app.regulation_loop import regulation
from smarig.app.tracking_loop import tracking
from smarig.certificate import ModelCertificate, Units, certificate
from smarig.config import load_rig
from smarig.control import Reference
from smarig.record import Run, load_run
from smarig.runner import Session


def run_loop(
    loop: ClosedLoop, rig: str, out: str | Path, *, seed: int = 0, wire: str = "", force: bool = False
) -> Run:
    """Run a closed loop on a rig, record it, and return the run."""
    check_path("The run", out)
    with Session(rig, seed=seed, wire=wire) as session:
        return load_run(
            session.run(
                loop.protocol,
                loop.settings,
                out,
                force=force,
                expected=loop.preview(session.file),
                protocol_factory=loop.make,
            )
        )


def track(
    model: AnyModel,
    wanted: str | ArrayLike | Reference,
    *,
    rig: str,
    out: str | Path,
    controller: str = "inverse",
    numbers: Mapping[str, Any] | None = None,
    offset_K: float | None = None,
    seed: int = 0,
    wire: str = "",
    force: bool = False,
    **settings: Any,
) -> Run:
    """Track a reference on a rig and return the run.

    ``wanted``: steps, ramps or multisine; a CSV file; or times in s from 0 and positions in the rig's unit, as two
    rows (2, n), linear in between. ``model``: a model, the result of ``identify``, or a path. ``controller`` is a name
    (``smarig list controllers``) or the path of an own file. ``numbers`` are the controller's parameters. ``offset_K``
    is u_o of a velocity controller.
    """
    loop = tracking(
        source=ModelSource.of(model),
        rig=load_rig(rig),
        wanted=wanted,
        settings=settings,
        controller=controller,
        numbers=numbers,
        offset_K=offset_K,
    )
    return run_loop(loop, rig, out, seed=seed, wire=wire, force=force)


def regulate(
    model: AnyModel,
    setpoint: float,
    *,
    rig: str,
    out: str | Path,
    seed: int = 0,
    wire: str = "",
    force: bool = False,
    **settings: Any,
) -> Run:
    """Bring a wire to a state of the given output, hold it there, and return the run.

    ``model``: a model, the result of ``identify``, or a path. Settings as in ``regulation``.
    """
    loop = regulation(ModelSource.of(model), load_rig(rig), setpoint, **settings)
    return run_loop(loop, rig, out, seed=seed, wire=wire, force=force)


def certify(model: AnyModel, controllers: Mapping[str, Mapping[str, Any]] | None = None) -> ModelCertificate:
    """What is proved about a model before a loop is closed around it; ``text`` states it.

    ``model``: a model, the result of ``identify``, or a path. ``controllers``: velocity controllers with the parameters
    that differ from their defaults; None: all of them.
    """
    known = ModelSource.of(model).model
    return certificate(known.hysteresis, controllers, Units(known.unit, known.input.unit), timing_of(known))
