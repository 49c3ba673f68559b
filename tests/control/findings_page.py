"""Prints the tables of docs/explanation/control_findings.md from code."""

import numpy as np

from control.driven import drive
from smarig.certificate.position_assumptions import indistinguishable_states
from smarig.certificate.position_supply_rate import PositionController, SupplyRate
from smarig.certificate.velocity import k_e, velocity_loop
from smarig.control.position_feedback import SwitchedGain, position_loop
from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.control.velocity.velocity_protocol import velocity_feedback
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.protocols._setup import Setup
from smarig.rig.twin import Twin

RAMPS = np.concatenate([np.full(400, 0.1), np.zeros(100), np.full(400, -0.1)])  # mm/s
SINE = 0.6 * np.sin(np.arange(800) / 60)  # deg/s
VELOCITY = (
    ("one-wire", "one_e", "negative", RAMPS, (300.0, 10000.0)),
    ("one-wire, ṙ / 100", "one_e", "negative", RAMPS / 100, (3000.0,)),
    ("two-wire", "two_e", "anhysteretic", SINE, (30.0, 3000.0)),
)
CLASSES = {
    "proportional": ([10.0], [1.0]),
    "proportional + derivative": ([10.0, 20.0], [1.0]),
    "lead 10 (1 + 2s)/(1 + 0.5s)": ([10.0, 20.0], [1.0, 0.5]),
    "lag 10 (1 + 0.5s)/(1 + 2s)": ([10.0, 5.0], [1.0, 2.0]),
    "leaky integral 10 + 3/(s + 0.05)": ([3.5, 10.0], [0.05, 1.0]),
    "integral 10 + 3/s": ([3.0, 10.0], [0.0, 1.0]),
    "resonance 10/(1 + 0.8s + s²)": ([10.0], [1.0, 0.8, 1.0]),
    "filtered velocity 10s/(1 + 0.5s)": ([0.0, 10.0], [1.0, 0.5]),
    "filtered acceleration 10s²/(1 + 0.8s + s²)": ([0.0, 0.0, 10.0], [1.0, 0.8, 1.0]),
}
STRICT = SupplyRate(a=0.01, c=0.01)


def velocity_rows() -> list[str]:
    """Error ratios by constant gain: on the operator, with its lag, on the twin without and with noise."""
    rows = []
    for rig, model, start, rate, gains in VELOCITY:
        name = f"{rig[:8].replace('-', '_')}_twin"
        setup = Setup.of(name)
        for gain in gains:
            control = constant_gain(gain)
            alone = velocity_loop(thesis_surface(model), control, rate, initial=start)
            lagging = velocity_loop(thesis_surface(model), control, rate, initial=start, lag_s=setup.tau_s)
            twins = [
                drive(velocity_feedback(setup, control, rate.tolist()), Twin.named(name, seed=1, noise=n))
                for n in (False, True)
            ]
            ratios = [alone.final_ratio, lagging.final_ratio, *(t.ratio for t in twins)]
            numbers = " | ".join(f"{r:.2f}" for r in ratios)
            rows.append(
                f"| {rig} | {gain:g} | {k_e(control):g} | {numbers} | {100 * twins[1].clipped_share:.0f} % |"
            )
    return rows


def class_rows() -> list[str]:
    """Which controllers match the supply rate."""
    rows = []
    for name, (numerator, denominator) in CLASSES.items():
        k = PositionController.of(numerator, denominator)
        a = k.largest_a()
        rows.append(
            f"| {name} | {_yes(k.matches(SupplyRate()))} | {a:.3g} | {k.largest_a(b=1.0):.3g} | "
            f"{_yes(k.matches(STRICT))} |"
        )
    return rows


def position_rows() -> list[str]:
    """Position loops on two_e with its lag, held at 4° from B*: what V does, and whether the wire comes to rest."""
    plain, size = SwitchedGain(60.0, 60.0, 0.5), SwitchedGain(20.0, 60.0, 0.5)
    falling = SwitchedGain(60.0, 20.0, 0.5)
    hard = SwitchedGain(6000.0, 6000.0, 0.5)
    cases = (
        ("60, constant", plain, plain, False),
        ("20, beyond 0.5° 60", size, size, False),
        ("60, beyond 0.5° 20", falling, falling, False),
        ("20 and 60 by turns, 5 s each", _by_turns, plain, False),
        ("6000, constant", hard, hard, False),
        ("6000, constant, a tick late", hard, hard, True),
    )
    rows = []
    for name, law, potential, delayed in cases:
        loop = position_loop(thesis_surface("two_e"), law, np.full(400, 4.0), lag_s=5.3, delayed=delayed)
        v = np.array(
            [
                q + (law(k, e) * e / 2 if law is _by_turns else potential.potential(e))
                for k, (q, e) in enumerate(zip(loop.stored, loop.error, strict=True))
            ]
        )
        rise = max(0.0, float(np.diff(v).max()))
        rise = 0.0 if rise < 1e-9 * abs(v).max() else rise
        rows.append(f"| {name} | {rise:.3g} | {loop.late_travel():.2f} | {loop.error[-1]:.2f} |")
    return rows


def indistinguishable_row() -> str:
    """The pair of states at zero input with one output."""
    pair = indistinguishable_states(thesis_surface("two_e"))
    path = " → ".join(f"{u:.4g}" for u in (*pair.second.extrema, pair.second.u))
    return f"| two_e | {path} | {pair.first.y:.4f}° | {pair.second.y:.4f}° | {100 * pair.distance / pair.most:.1f} % |"


def _by_turns(sample: int, error: float) -> float:
    return (60.0 if sample // 50 % 2 else 20.0) * error


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"


if __name__ == "__main__":
    for table in (velocity_rows(), class_rows(), position_rows(), [indistinguishable_row()]):
        print("\n".join(table), end="\n\n")
