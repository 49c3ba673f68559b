"""From a rig file to a rig: the twin in process, or a bench on the instruments that its links name.

A ``[simulator]`` table makes this start the simulated devices, in a process of their own that ends with ours.
"""

import contextlib
import json
import os
import selectors
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from smarig.catalogue import chosen, find, names
from smarig.config import LinkFile, LinksFile, RigFile, SimulatorFile
from smarig.drivers._roles import CurrentSource, PositionSensor, lacks
from smarig.errors import ConfigError, Interrupted, RigFault, SmarigError, UsageError
from smarig.model.actuator import Actuator
from smarig.model.effect import Planted
from smarig.model.planted import PACKAGE, to_words
from smarig.rig.bench import Bench
from smarig.rig.pace import Paced
from smarig.rig.rig import Rig
from smarig.rig.sound import DRIVERS
from smarig.rig.twin import Twin, TwinSettings

AT_ZERO = " The current is at zero."  # what a trip says, unless it is not so
READY_S = 20.0  # for simulated devices to start
LEAVE_S = 10.0  # to end


@contextmanager
def opened(
    rig: str,
    file: RigFile,
    actuator: Actuator,
    settings: TwinSettings,
    *,
    speed: float | None = None,
    while_waiting: Callable[[], None] = lambda: None,
) -> Iterator[Rig]:
    """A rig that is safe and closed afterwards. ``settings`` are a twin's, in process or behind a simulator's bytes.

    With a model's hysteresis among them it is a twin in process, whatever the rig.
    """
    with contextlib.ExitStack() as open_:
        if file.kind == "twin" or settings.hysteresis is not None:  # a model moves no hardware
            twin = Twin(file, actuator, settings)
            found: Rig = Paced(twin, speed, while_waiting=while_waiting) if speed else twin
        else:
            links, pace = _links(file), 1.0
            if file.simulator is not None:
                pace = file.simulator.speed if speed is None else speed
            if file.simulator is not None and file.simulator.start:
                links = open_.enter_context(_simulated(rig, file.simulator, links, settings, pace))
            found = _bench(file, actuator, links, pace, open_)
        open_.callback(found.close)
        with _told(found):
            yield found


@contextmanager
def _told(rig: Rig) -> Iterator[None]:
    """Current to zero on every way out; that the device could not be told is part of what the person reads."""
    try:
        yield
    except BaseException as error:
        rig.safe()
        if not rig.untold:
            raise
        if isinstance(error, Interrupted):
            raise RigFault(f"Run {error}: it is closed. {rig.untold}") from None
        if isinstance(error, SmarigError):
            error.args = (f"{str(error).removesuffix(AT_ZERO)} {rig.untold}",)
        raise
    rig.safe()
    if rig.untold:
        raise RigFault(f"{rig.untold} What was recorded until then is whole.")


def _links(file: RigFile) -> LinksFile:
    if file.links is None:
        raise UsageError(f"Rig '{file.name}' has no [links].")
    return file.links


def _bench(
    file: RigFile, actuator: Actuator, links: LinksFile, speed: float, open_: contextlib.ExitStack
) -> Bench:
    source = _driven(links.amplifier, file, CurrentSource, "a current source")
    open_.callback(source.close)
    sensor = _driven(links.encoder_daq, file, PositionSensor, "a position sensor")
    open_.callback(sensor.close)
    return Bench(file, actuator, source, sensor, speed=speed)


def _driven(link: LinkFile, file: RigFile, role: type, called: str) -> Any:
    """An instrument by its driver, which may be the rig file's own; it can all that a bench will ask."""
    instrument = find(DRIVERS, chosen(DRIVERS, link.driver))(link, file)
    lacking = lacks(instrument, role)
    if lacking:
        raise ConfigError(f"Driver {link.driver}: it gives no {', '.join(lacking)}, which {called} needs.")
    return instrument


@contextmanager
def _simulated(
    rig: str, how: SimulatorFile, links: LinksFile, settings: TwinSettings, speed: float
) -> Iterator[LinksFile]:
    """The devices' links, while they live; they notice by their input's end that we are gone."""
    if settings.initial is not None or not settings.noise:
        raise UsageError(
            "Simulated devices follow the rig file; another state or no noise is for the twin in process."
        )
    planted = [effect for effect in settings.effects if isinstance(effect, Planted)]
    if len(planted) < len(settings.effects) or any(e.kind.name not in names(PACKAGE) for e in planted):
        raise UsageError("Simulated devices know effects of the catalogue only.")
    if links.amplifier.framing != links.encoder_daq.framing:
        raise UsageError("Simulated devices speak one framing; give both links the same.")
    pace = ["--speed", str(speed)] if speed else ["--lock-step"]
    effects = [word for pair in to_words(planted) for word in ("--effect", pair)]
    files = {"--faults": how.faults, "--device-library": how.library, "--trace": how.trace}
    extra = [word for option, path in files.items() if path for word in (option, path)]
    command = [sys.executable, "-m", "simulators", "--rig", rig, "--framing", links.amplifier.framing]
    folder = tempfile.TemporaryDirectory(prefix="smarig-", ignore_cleanup_errors=True)
    process = subprocess.Popen(
        [*command, "--folder", folder.name, "--seed", str(settings.seed), *pace, *effects, *extra],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=os.name != "nt",  # Ctrl-C is ours to handle
    )
    try:
        urls = _ready(process)
        yield LinksFile(
            amplifier=_at(links.amplifier, urls["amplifier"]["url"]),
            encoder_daq=_at(links.encoder_daq, urls["encoder_daq"]["url"]),
        )
    finally:
        _ended(process, at_leisure=bool(how.trace))
        folder.cleanup()


def _at(link: LinkFile, url: str) -> LinkFile:
    return link.model_copy(update={"url": url})


def _ready(process: subprocess.Popen) -> dict:
    """The line in which the devices say where they are."""
    assert process.stdout is not None  # noqa: S101 - it was asked for
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        line = process.stdout.readline() if selector.select(READY_S) else ""
    if not line:
        with contextlib.suppress(subprocess.TimeoutExpired):
            status = process.wait(1)
            kind = ConfigError if status == ConfigError.exit_status else RigFault
            raise kind(f"The simulated devices ended at once (status {status}): see what they say above.")
        raise RigFault(f"The simulated devices did not start within {READY_S:g} s.")
    return json.loads(line)


def _ended(process: subprocess.Popen, *, at_leisure: bool) -> None:
    """Their input ends; who keeps a trace is left to show how the lease ends what flows."""
    if not at_leisure:
        with contextlib.suppress(OSError):
            process.terminate()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            with contextlib.suppress(OSError):
                pipe.close()
    try:
        process.wait(LEAVE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
