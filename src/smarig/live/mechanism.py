"""The rig in three dimensions, in millimetres: wire, pulley and load, or two wires and a shaft, moved as
measured.

x runs along the wire, y up, z along the shaft. Wire and load are drawn shortened.
"""

import math
from collections.abc import Sequence

import numpy as np

from smarig.live.colours import AMBER, FAINT, GREY, INK, Colour, temperature_colour
from smarig.live.plot_axes import nice_step
from smarig.live.primitives import (
    Array,
    ColourChanges,
    Points,
    Polylines,
    Primitive,
    SolidBody,
    Transform,
    point,
)
from smarig.plant import Actuator

PATH = "rig"
# In radii of the pulley: the load below the shaft, its size, the pulley's thickness.
DROP, LOAD, THICK = 2.8, (1.6, 1.3, 1.6), 0.6
DRAWN = (7.3, 4.6)  # radii: drawn length of one wire, and of each of two
DIAL = 1.75  # radii
WIRE_PX = 4.0
Point3D = tuple[float, float, float]
ARC = 9  # points per quarter turn


def camera_of(actuator: Actuator) -> tuple[Point3D, Point3D]:
    """Position of the camera and the point that it looks at."""
    r = float(actuator.file.transmission.radius.value)
    if actuator.two_wire:
        return (0.0, 1.2 * r, 9.0 * r), (0.0, 0.7 * r, 0.0)
    return (-2.3 * r, 0.2 * r, 9.0 * r), (-2.3 * r, -1.5 * r, 0.0)


class Mechanism:
    """Primitives of the rig's fixed body and of its motion."""

    def __init__(self, actuator: Actuator, label: str) -> None:
        self._two = actuator.two_wire
        self._r = float(actuator.file.transmission.radius.value)
        self._drop, self._thick, self._drawn = DROP * self._r, THICK * self._r, DRAWN[self._two] * self._r
        self._front = 0.52 * self._thick  # just in front of the pulley
        self._load = (LOAD[0] * self._r, LOAD[1] * self._r, LOAD[2] * self._r)
        self._deg, self._label = actuator.unit == "deg", label
        self._hottest_K = max(
            actuator.gain_K_per_A2 * float(actuator.file.heating.reference_current.value) ** 2, 1.0
        )

    def body(self) -> list[Primitive]:
        """The primitives that never change by themselves."""
        r = self._r
        spoke = np.array(
            [[0.0, 0.0, self._front], [0.0, r * (DIAL - 0.1) if self._two else 0.94 * r, self._front]]
        )
        primitives: list[Primitive] = [
            SolidBody(f"{PATH}/pulley/disc", "cylinder", (0.94 * r, 0.94 * r, self._thick), (0, 0, 0), GREY),
            Polylines(f"{PATH}/pulley/mark", None, [spoke], [AMBER], 4.0),
            *[
                SolidBody(f"{PATH}/anchor_{k}", "box", (0.5 * r, 1.4 * r, 1.4 * r), (x, r, 0), FAINT)
                for k, x in enumerate((-self._drawn, self._drawn)[: 1 + self._two])
            ],
        ]
        for k, side in enumerate((-1.0, 1.0)[: 1 + self._two], start=1):
            primitives.append(Polylines(f"{PATH}/wire_{k}", None, [self._along(side)], [], WIRE_PX))
        if self._two:
            primitives += self._dial()
        else:
            primitives.append(
                SolidBody(
                    f"{PATH}/load/block", "box", self._load, (r, -self._drop - self._load[1] / 2, 0), GREY
                )
            )
            primitives += self._ruler()
        if self._label:
            at = point((-0.6 if self._two else -0.8) * self._drawn, -1.3 * r if self._two else -1.5 * r, 0.0)
            primitives.append(
                Points(f"{PATH}/source", None, at, AMBER, texts=(f"{self._label}: not hardware",))
            )
        return primitives

    def moved(self, times_s: Array, positions: Array, inputs_K: Array) -> list[Primitive]:
        """Wires, pulley and load at positions (n,) in the rig's unit. A wire has the colour of its estimated
        temperature."""
        turn = np.radians(positions) if self._deg else positions / self._r
        still = np.zeros((len(times_s), 3))
        primitives: list[Primitive] = [Transform(f"{PATH}/pulley", times_s, still, turn)]
        hues = self._temperature_colours(inputs_K)
        primitives.append(ColourChanges(f"{PATH}/wire_1", times_s, hues))
        if self._two:
            return [
                *primitives,
                ColourChanges(f"{PATH}/wire_2", times_s, self._temperature_colours(-inputs_K)),
            ]
        lifted = np.zeros_like(still)
        lifted[:, 1] = positions
        top = [self._r, 0.0, -0.1 * self._r]
        hanging = [np.array([top, [self._r, p - self._drop, -0.1 * self._r]]) for p in positions.tolist()]
        return [
            *primitives,
            Transform(f"{PATH}/load", times_s, lifted),
            Polylines(f"{PATH}/wire_1_hanging", times_s, hanging, hues, WIRE_PX),
        ]

    def _along(self, side: float) -> Array:
        """A wire from its anchor to the top of the pulley, and a quarter turn down the other side."""
        angles = np.linspace(math.pi / 2, 0.0, ARC)
        arc = np.c_[
            -side * self._r * np.cos(angles), self._r * np.sin(angles), np.full(ARC, side * 0.1 * self._r)
        ]
        return np.vstack([[[side * self._drawn, self._r, side * 0.1 * self._r]], arc])

    def _temperature_colours(self, inputs_K: Array) -> Sequence[Colour]:
        return [temperature_colour(u / self._hottest_K) for u in inputs_K.tolist()]

    def _ruler(self) -> list[Primitive]:
        """A ruler next to the load: its lift in millimetres."""
        x, y0 = self._r + self._load[0] / 2 + 10, -self._drop
        every = nice_step(self._r / 5)
        steps = [k * every for k in range(5)]
        lines = [np.array([[x, y0, 0.0], [x, y0 + steps[-1], 0.0]])]
        lines += [np.array([[x, y0 + p, 0.0], [x + 5, y0 + p, 0.0]]) for p in steps]
        ends = np.array([[x + 2 * self._r, y0 + p, 0.0] for p in (steps[0], steps[-1])])
        pointer = np.array([[self._r + self._load[0] / 2, y0, 0.0], [x - 1, y0, 0.0]])
        return [
            Polylines(f"{PATH}/ruler/lines", None, lines, [INK] * len(lines), 1.2),
            Points(f"{PATH}/ruler/labels", None, ends, INK, texts=("0 mm", f"{steps[-1]:g} mm")),
            Polylines(f"{PATH}/load/pointer", None, [pointer], [AMBER], 2.0),
        ]

    def _dial(self) -> list[Primitive]:
        """A dial around the shaft: the angle in degrees from the encoder's zero."""
        R, z = DIAL * self._r, self._front
        degrees = np.arange(-90, 91, 15)
        a = np.radians(degrees + 90.0)
        ring = np.c_[
            R * np.cos(np.linspace(0, np.pi, 61)), R * np.sin(np.linspace(0, np.pi, 61)), np.full(61, z)
        ]
        ticks = [
            np.array([[R * np.cos(t), R * np.sin(t), z], [1.08 * R * np.cos(t), 1.08 * R * np.sin(t), z]])
            for t in a
        ]
        shown = np.isin(degrees, (-90, -45, 0, 45, 90))
        at = np.c_[
            1.32 * R * np.cos(a[shown]), 1.32 * R * np.sin(a[shown]) + 0.15 * R, np.full(int(shown.sum()), z)
        ]
        return [
            Polylines(f"{PATH}/dial/lines", None, [ring, *ticks], [INK] * (1 + len(ticks)), 1.2),
            Points(
                f"{PATH}/dial/labels", None, at, INK, texts=tuple(f"{d}°" for d in degrees[shown].tolist())
            ),
        ]
