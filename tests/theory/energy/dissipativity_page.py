"""Prints the tables of docs/explanation/dissipativity.md from code."""

from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.operator import Initial
from smarig.theory.butterfly import butterfly_relays, butterfly_table
from smarig.theory.energy import DissipativityCertificate, certify, confirm
from smarig.theory.energy.storage_function import recoverable_energy_is_storage


def models() -> dict[str, tuple[Everett, str, Initial]]:
    """Name → hysteresis, unit of work, initial state of the confirmation."""
    found: dict[str, tuple[Everett, str, Initial]] = {
        name: (
            thesis_surface(name),
            *(("mm·K", "negative") if name.startswith("one") else ("deg·K", "anhysteretic")),
        )
        for name in THESIS_SURFACES
    }
    found["butterfly table"] = (butterfly_table(), "1", "negative")
    found["butterfly relays"] = (butterfly_relays(), "1", "negative")
    return found


def rows() -> tuple[list[str], list[str]]:
    """Lines of the table of certificates, and of the table of confirmed violations."""
    certificates, violations = [], []
    for name, (hysteresis, unit, start) in models().items():
        c = certify(hysteresis)
        certificates.append(_certificate_row(name, hysteresis, unit, c))
        if not c.dissipative:
            v = confirm(hysteresis, c.at, start)
            violations.append(
                f"| {name} | {start} | {v.approach:.4g} {unit} | {v.per_cycle:.4g} | {v.cycles} | {v.balance:.2g} |"
            )
    return certificates, violations


def _certificate_row(name: str, hysteresis: Everett, unit: str, c: DissipativityCertificate) -> str:
    loop = "none" if c.dissipative else f"{c.at[1]:.4g} ↔ {c.at[0]:.4g}"
    storage = "–"
    if not isinstance(hysteresis, FodTable):
        storage = "proved" if recoverable_energy_is_storage(hysteresis) else "no"
    verdict = "yes" if c.dissipative else "no"
    return f"| {name} | {verdict} | {c.area:.4g} {unit} | {loop} | ≥ {c.lower_bound:.4g} | {storage} |"


if __name__ == "__main__":
    for table in rows():
        print("\n".join(table), end="\n\n")
