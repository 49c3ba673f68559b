"""Lets one wire cool before the other is heated, so that two wires that pull against each other are never both hot.

On a rig with ``limits.stress_max_MPa`` every protocol is run through here. A pause at zero current comes between two
currents of opposite sign. The input passes zero on its way anyway, so the memory of the hysteresis stays the same.
"""

from collections.abc import Iterator

from smarig.core import Command, Elapsed, Hold, Protocol, Settled, Waveform
from smarig.protocols._setup import Setup

PAUSE_TAUS = 3.0  # time constants, after which a wire has 5 % of its temperature left
BRANCH = "pause: one wire cools before the other"


def through_cold(protocol: Protocol, setup: Setup) -> Protocol:
    """The protocol with a pause before each change of wire. It receives only the results of its own commands."""
    pause_s = PAUSE_TAUS * setup.tau_s
    hot = 0  # sign of the last current, 0 once its wire has cooled
    reply = None
    try:
        while True:
            try:
                command = protocol.send(reply)
            except StopIteration:
                return
            for part in _parts(command):
                sign = _sign(part)
                if sign * hot < 0:
                    yield Hold(0.0, Elapsed(pause_s), branch=BRANCH)
                reply = yield part
                hot = sign or (0 if _cools(part, pause_s) else hot)
    finally:
        protocol.close()


def _parts(command: Command) -> Iterator[Command]:
    """A command in parts that each heat one wire only; only waveforms have several."""
    if not isinstance(command, Waveform):
        yield command
        return
    currents, begin, sign = command.currents_A, 0, 0
    for k, current_A in enumerate(currents):
        now = (current_A > 0) - (current_A < 0)
        if now * sign < 0:
            yield Waveform(currents[begin:k], command.period_s, command.branch)
            begin = k
        sign = now or sign
    yield Waveform(currents[begin:], command.period_s, command.branch)


def _sign(command: Command) -> int:
    """The sign of the current that a command heats with, 0 for none."""
    match command:
        case Hold(current_A):
            return (current_A > 0) - (current_A < 0)
        case Waveform(currents_A):
            return next(((i > 0) - (i < 0) for i in reversed(currents_A) if i), 0)
    return 0


def _cools(command: Command, pause_s: float) -> bool:
    """Whether a command at zero current lasts until the wire has cooled."""
    if not isinstance(command, Hold):
        return False
    return isinstance(command.until, Settled) or command.until.seconds >= pause_s
