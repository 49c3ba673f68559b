"""What there is by name: rigs, actuators, campaigns, protocols, drivers, formats, import mappings."""

import importlib
from collections.abc import Iterator

from generate.docstring import as_markdown
from generate.markdown import code, plain, table
from smarig.config import load_actuator, load_campaign, load_rig, shipped_names
from smarig.core import catalogue_entry, catalogue_names
from smarig.exchange import load_mapping
from smarig.protocols import setting_texts

PROTOCOLS = """# Protocols

Experiments by name, for `smarig run NAME --rig RIG -o FILE --set KEY=VALUE`. Shares refer to the range of inputs that
the rig's limits allow. An empty `partition_K` follows that range. Every protocol with `settle.…` holds each step
until the position has settled:

| setting | default | meaning |
|---|---|---|
| `settle.band_counts` | `1.0` | largest difference of block means, in counts |
| `settle.window_s` | `25.0` | length of the settling window |
| `settle.timeout_s` | `600.0` | a hold ends after this time and is marked |
| `settle.approach_K` | `0.01` | the window starts when the heating model is this close to its steady state |
"""
CATALOGUES = """# Rigs, actuators, campaigns, formats

The shipped entries, by name. A path works everywhere instead of a name.
"""


def pages() -> dict[str, str]:
    """Two pages."""
    return {
        "protocols": PROTOCOLS + "".join(map(_protocol, catalogue_names("smarig.protocols"))),
        "catalogues": _shipped(),
    }


def _protocol(name: str) -> str:
    function = catalogue_entry("smarig.protocols", name)
    rows = [(code(k), code(v)) for k, v in setting_texts(name) if not k.startswith("settle.")]
    settings = table(("setting", "default"), rows) if rows else ""
    return f"\n## {name}\n\n{as_markdown(function.__doc__ or '')}\n\n{settings}"


def _shipped() -> str:
    chapters = {
        "Rigs": (("rig", "kind", "actuator", "tick", "wire"), _rigs()),
        "Actuators": (("actuator", "arrangement", "source"), _actuators()),
        "Campaigns": (("campaign", "holds", "steps"), _campaigns()),
        "Drivers": (("driver", "instrument"), _modules("smarig.device.drivers")),
        "Formats to import": (("format", "reads"), _modules("smarig.exchange.readers")),
        "Formats to export": (("format", "writes"), _modules("smarig.exchange.writers")),
        "Import mappings": (("mapping", "reads", "source"), _mappings()),
    }
    return CATALOGUES + "".join(
        f"\n## {name}\n\n{table(*table_args)}" for name, table_args in chapters.items()
    )


def _rigs() -> Iterator[tuple[str, ...]]:
    for name in shipped_names("rigs"):
        rig = load_rig(name)
        yield code(name), rig.kind, code(rig.actuator), f"{rig.period_s:g} s", plain(rig.wire)


def _actuators() -> Iterator[tuple[str, ...]]:
    for name in shipped_names("actuators"):
        actuator = load_actuator(name)
        yield code(name), actuator.arrangement, plain(actuator.source)


def _campaigns() -> Iterator[tuple[str, ...]]:
    for name in shipped_names("campaigns"):
        campaign = load_campaign(name)
        yield code(name), plain(campaign.summary), ", ".join(code(step.label) for step in campaign.step)


def _mappings() -> Iterator[tuple[str, ...]]:
    for name in shipped_names("imports"):
        mapping = load_mapping(name)
        yield code(name), plain(mapping.summary), plain(mapping.source)


def _modules(package: str) -> Iterator[tuple[str, ...]]:
    for name in catalogue_names(package):
        docstring_text = importlib.import_module(f"{package}.{name}").__doc__ or ""
        yield code(name), plain(docstring_text.strip().split("\n\n")[0])
