"""The properties of a hysteresis that chapter 8 requires, each computed once on first use."""

from dataclasses import dataclass, replace
from functools import cached_property

from smarig.certificate.certificate_units import Units
from smarig.core import UsageError
from smarig.preisach import Everett
from smarig.theory import DissipativityCertificate as Dissipativity
from smarig.theory import (
    MeasureClasses,
    Monotonicity,
    certify,
    classes,
    monotone,
    recoverable_energy_is_storage,
)


@dataclass(frozen=True, eq=False)
class HysteresisAnalysis:
    """A hysteresis with its units and its properties.

    >>> from smarig.preisach import thesis_surface
    >>> found = HysteresisAnalysis.of(thesis_surface("two_p"))
    >>> found.classes.M_P, found.dissipativity.dissipative, found.monotone.holds
    (False, False, False)
    """

    hysteresis: Everett
    units: Units

    @classmethod
    def of(cls, hysteresis: Everett, units: Units | None = None) -> "HysteresisAnalysis":
        """An operator is replaced by its hysteresis. ``units``: those of the hysteresis unless given."""
        hysteresis = getattr(hysteresis, "hysteresis", hysteresis)
        return cls(hysteresis, units or Units.of(hysteresis))

    @cached_property
    def classes(self) -> MeasureClasses:
        """Classes of μ and g (Def. 4.1)."""
        return classes(self.hysteresis)

    @cached_property
    def monotone(self) -> Monotonicity:
        """Whether the output follows the input (Assumption 2.1)."""
        return monotone(self.hysteresis)

    @property
    def dissipativity(self) -> Dissipativity | None:
        """Dissipativity by loop areas; None if it cannot be decided, with the reason in ``undecided``."""
        return self._decided[0]

    @property
    def undecided(self) -> str:
        """Why dissipativity cannot be decided, "" if it can."""
        return self._decided[1]

    @cached_property
    def recoverable_is_storage(self) -> bool:
        """Whether Q_r (7.1) is proved a storage function; False if that cannot be decided."""
        try:
            return recoverable_energy_is_storage(self.hysteresis)
        except UsageError:
            return False

    @cached_property
    def _decided(self) -> tuple[Dissipativity | None, str]:
        try:
            found = certify(self.hysteresis)
        except UsageError as error:
            return None, str(error)
        return replace(found, unit=self.units.energy, input_unit=self.units.input), ""
