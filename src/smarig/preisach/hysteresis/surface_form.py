"""Forms of the analytic surface (5.5), by name: the shift f(α) with its properties for fits and pages.

Each form is an object in a file of ``forms/`` with the same name. The file contains everything specific to the form.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cache
from typing import Any, ClassVar

from smarig.core import Array, UsageError, catalogue_entry, catalogue_names, own_entries, plugin_hint, shown

Parameters = tuple[float, ...]
FORMS = "smarig.preisach.hysteresis.forms"
_COMMON_POWERS = {"x2": -1, "x3": 1, "x4": -1}


class SurfaceForm(ABC):
    """One f(α) of (5.5), α in kelvin above ambient; ``x`` are its own parameters x₅….

    f must be smooth. The verified bounds of the theory hold for every form that gives its turning points.
    """

    powers: ClassVar[
        Mapping[str, int]
    ]  # own parameters x5… in order, each with its power of the input's unit
    colour: ClassVar[str]  # used on every page
    place: ClassVar[int]  # order in lists among forms with the same number of parameters
    grows_from: ClassVar[str | None] = "constant"  # the form that is fitted first, for ``starts``

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of all parameters x: x₂, x₃, x₄, which every form has, and its own."""
        return (*_COMMON_POWERS, *self.powers)

    def units(self, input_unit: str) -> dict[str, str]:
        """Units of all parameters by name, for inputs in a given unit."""
        unit_of_power = {-1: f"1/{input_unit}", 0: "1", 1: input_unit}
        powers = {**_COMMON_POWERS, **self.powers}
        return {name: unit_of_power.get(power, f"{input_unit}^{power}") for name, power in powers.items()}

    @abstractmethod
    def value(self, x: Parameters, alpha: Array) -> Array:
        """f(α) in the shape of α."""

    @abstractmethod
    def slope(self, x: Parameters, alpha: Array) -> Array:
        """f′(α) in the shape of α."""

    @abstractmethod
    def jacobian(self, x: Parameters, alpha: Array) -> Array:
        """∂f/∂x at α (k,), shape (k, len(x))."""

    @staticmethod
    @abstractmethod
    def between(params: Any, alpha: float, beta: float) -> float:
        """F(α, β) for plain numbers. ``params`` are x₂, x₃, x₄, x… and a quarter of the amplitude.

        The operator's loop calls it for each sample and numba compiles it, so it may call nothing but math.
        """

    def value_turns(self, x: Parameters) -> tuple[float, ...]:
        """Inputs at which f can turn; f is monotone between them. Empty for a monotone f."""
        del x
        return ()

    def slope_turns(self, x: Parameters) -> tuple[float, ...]:
        """Inputs at which f′ can turn; f′ is monotone between them."""
        del x
        return ()

    @abstractmethod
    def starts(self, lower: float, upper: float, fitted: Parameters) -> list[Parameters]:
        """Starting values of all x for data over [u₋, u₊]; ``fitted`` are all x of the fitted form ``grows_from``."""

    def bounds(self, lower: float, upper: float) -> dict[str, tuple[float, float]]:
        """Smallest and largest values of own parameters in a fit over [u₋, u₊], for those that need limits."""
        del lower, upper
        return {}


def surface_form(name: str) -> SurfaceForm:
    """The form of that name. UsageError lists the known names."""
    shipped = _shipped_forms().get(name)
    if shipped is not None:
        return shipped
    known = surface_forms()
    if name not in known:
        hint = plugin_hint(FORMS, name)
        raise UsageError(hint or f"Surface form {shown(name)} must be one of {', '.join(known)}.")
    return known[name]


def surface_forms() -> dict[str, SurfaceForm]:
    """All forms by name, by rising number of parameters, including own files and plug-ins in use.

    >>> list(surface_forms())
    ['constant', 'parabolic', 'exponential']
    """
    found = _shipped_forms() | {name: file.found for name, file in own_entries(FORMS).items()}
    return dict(sorted(found.items(), key=lambda item: (len(item[1].parameters), item[1].place)))


@cache
def _shipped_forms() -> dict[str, SurfaceForm]:
    return {
        name: catalogue_entry(FORMS, name)
        for name in catalogue_names(FORMS)
        if name not in own_entries(FORMS)
    }
