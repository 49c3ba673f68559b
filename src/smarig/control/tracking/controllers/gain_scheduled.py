"""The baseline with gains by place and direction: PI whose gain is the inverse slope of the branch the wire is on."""

import numpy as np

from smarig.control.tracking.feedback import feedback
from smarig.control.tracking.known import Controller, Known, Wanted
from smarig.preisach.operator import Preisach

RANGES = {
    "gain_share": (0.05, 100.0),
    "integral_s": (0.1, 200.0),
    "cooling_share": (0.1, 10.0),
}
PLACES = 200
STEEPEST = 10.0  # times the mean inverse slope: at the ends of the range branches are flat


def gain_scheduled(
    known: Known,
    wanted: Wanted,
    *,
    gain_share: float = 55.0,
    integral_s: float = 0.75,
    cooling_share: float = 1.7,
    lead_s: float = 0.0,
) -> Controller:
    """PI with scheduled gains: du/dy of the model's major loop at the present position, its rising or falling branch.

    The thesis cites constant gains switched by the error (Grant & Hayward 1997); here the switch is the error's
    sign, with ``cooling_share`` between the two gains, and the model's own slope on top. Integration as in ``pi``.

        gain_share (1): gain, as a multiple of the model's inverse slope du/dy where the wire is
        integral_s (s): integral time T_i: in it a steady error is answered once more
        cooling_share (1): gain when the wire must cool, as a multiple of that when it must heat
        lead_s (s): how far ahead what is wanted is looked at; 0 looks at now
    """
    places, heating, cooling = _inverse_slopes(known)

    def gain(error: float, position: float) -> float:
        slopes, share = (heating, 1.0) if error > 0 else (cooling, cooling_share)
        return gain_share * share * float(np.interp(position, places, slopes))

    return feedback(known, wanted, gain, integral_s=integral_s, lead_s=lead_s)


def _inverse_slopes(known: Known) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (n,), and du/dy (n,) of the rising and of the falling branch there, K per unit."""
    u = np.linspace(known.setup.lower_K, known.setup.upper_K, PLACES)
    operator = Preisach(known.hysteresis, "negative")
    rising, falling = operator.simulate(u), operator.follow(u[::-1])[::-1]
    low, high = known.reach
    places = np.linspace(low, high, PLACES)[1:-1]
    most = STEEPEST * (u[-1] - u[0]) / (high - low)
    found = []
    for branch in (rising, falling):
        back = np.interp(places + known.origin, np.maximum.accumulate(branch), u)
        found.append(np.clip(np.gradient(back, places), 0.0, most))
    return places, found[0], found[1]
