"""Installs distributions for tests without an installer: modules and a dist-info in a folder for sys.path."""

import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path

from smarig.cli.plugin_package import PLUGIN_KINDS

KINDS = [word for kind in PLUGIN_KINDS for word in ("--kind", kind)]
RIG = ("--rig", "one_wire_twin")
RUN = (
    "run",
    "acme_protocol",
    *RIG,
    "--set",
    "loops=1",
    "--set",
    "points=2",
    "--effect",
    "acme_effect=20",
    "--quiet",
)
BENCH = """
name = "one_wire_serial"
base = "one_wire_serial"
[links.amplifier]
driver = "acme_driver"
"""


def install(
    site: Path,
    distribution: str,
    version: str,
    points: Mapping[str, Mapping[str, str]],
    modules: Mapping[str, str] | None = None,
) -> Path:
    """The metadata of a distribution with entry points by group, and modules by their path in ``site``."""
    info = site / f"{distribution.replace('-', '_')}-{version}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n")
    lines = [
        line
        for group, names in points.items()
        for line in (f"[{group}]", *(f"{name} = {target}" for name, target in names.items()))
    ]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    for path, text in (modules or {}).items():
        (site / path).parent.mkdir(parents=True, exist_ok=True)
        (site / path).write_text(text)
    return info


def install_project(site: Path, project: Path) -> None:
    """The metadata of a project in the src layout, as an editable installation would leave them."""
    table = tomllib.loads((project / "pyproject.toml").read_text())["project"]
    install(site, table["name"], table["version"], table["entry-points"])


def imported() -> list[str]:
    """The modules of the package ``acme`` that this process has imported."""
    return [name for name in sys.modules if name.partition(".")[0] == "acme"]
