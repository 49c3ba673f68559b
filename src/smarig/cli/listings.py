"""What ``smarig list`` lists: the entries of each catalogue, one line each, and their settings.

Plug-ins are listed by the metadata of their distributions. Only those that the user names are imported.
"""

from collections.abc import Callable

from smarig.cli.output import show_message
from smarig.config import (
    ActuatorFile,
    CampaignFile,
    RigFile,
    file_keys,
    file_tables,
    load_actuator,
    load_campaign,
    load_rig,
    shipped_names,
)
from smarig.control import (
    SETPOINT_CONTROLLERS,
    TRACKING_CONTROLLERS,
    VELOCITY_CONTROLLERS,
    default_numbers,
    documented_numbers,
    optional_numbers,
)
from smarig.core import (
    PluginOffer,
    UsageError,
    catalogue_entry,
    catalogue_names,
    catalogue_summary,
    own_entries,
    plugin_offers,
    resolve_name,
    shipped_fault,
)
from smarig.exchange import MappingFile, load_mapping
from smarig.plant import EFFECTS, effect_types
from smarig.protocols import PROTOCOLS, setting_texts
from smarig.record import wire_histories


def _protocols() -> dict[str, str]:
    return {n: _summary(PROTOCOLS, n) for n in catalogue_names(PROTOCOLS)} | offered_entries("protocols")


def _summary(package: str, name: str) -> str:
    return catalogue_summary(package, name) + _origin(package, name)


def _origin(package: str, name: str) -> str:
    """The distribution of a plug-in in use, in brackets; "" for other entries."""
    file = own_entries(package).get(name)
    return f" ({file.offer.origin})" if file and file.offer else ""


def _rigs() -> dict[str, str]:
    rigs = {n: load_rig(n) for n in shipped_names("rigs")}
    return {n: f"{r.kind} of {r.actuator}, tick {r.period_s:g} s, wire {r.wire}" for n, r in rigs.items()}


def _actuators() -> dict[str, str]:
    return {
        n: f"{load_actuator(n).arrangement}; {load_actuator(n).source}" for n in shipped_names("actuators")
    }


def _campaigns() -> dict[str, str]:
    return {n: load_campaign(n).summary for n in shipped_names("campaigns")}


def _imports() -> dict[str, str]:
    return {n: load_mapping(n).summary for n in shipped_names("imports")}


def _effects() -> dict[str, str]:
    found = {k.name: k.summary + _origin(EFFECTS, k.name) for k in effect_types()}
    return found | offered_entries("effects")


def _controllers() -> dict[str, str]:
    listed_ = {
        n: f"{use}: {_summary(p, n)}" for use, p in _CONTROLLER_PACKAGES.items() for n in catalogue_names(p)
    }
    listed_ |= {
        shown_name: f"regulate: {catalogue_summary(SETPOINT_CONTROLLERS, n)}"
        for shown_name, n in _setpoint_controllers().items()
    }
    return listed_ | {n: text for n, text in offered_entries("controllers").items() if n not in listed_}


def _setpoint_controllers() -> dict[str, str]:
    """Names of set-point controllers by the names in the listing: tracking has another controller named pi."""
    taken = {n for p in _CONTROLLER_PACKAGES.values() for n in catalogue_names(p)}
    names = catalogue_names(SETPOINT_CONTROLLERS)
    return {f"{n} (regulate)" if n in taken else n: n for n in names}


def _wires() -> dict[str, str]:
    return {h.wire + " (twin)" * h.twin: f"{h.sentence()}; last used {h.last_use}" for h in wire_histories()}


def _keys() -> dict[str, str]:
    """Every key of a configuration file, after the kind of the file."""
    files = {"rig": RigFile, "actuator": ActuatorFile, "campaign": CampaignFile, "import": MappingFile}
    return {
        f"{kind}: {where.strip('[]')}{'.' * bool(where)}{key.name}": key.text
        for kind, model in files.items()
        for where, table in file_tables(model)
        for key in file_keys(table)
    }


def _plugins() -> dict[str, str]:
    """Every plug-in with its kind, its distribution, and the reason if it cannot be used."""
    offers, faults = plugin_offers()
    for sentence in faults:
        show_message(sentence)
    texts: dict[str, list[str]] = {}
    for offer in offers:
        reason = _fault(offer, offers)
        texts.setdefault(offer.name, []).append(
            f"{offer.kind} of {offer.origin}" + (f", cannot be used: {reason}" if reason else "")
        )
    return {name: "; ".join(lines) for name, lines in sorted(texts.items())}


def _fault(offer: PluginOffer, offers: list[PluginOffer]) -> str:
    """Why a plug-in cannot be used, as far as this is known without importing it; "" if nothing is known."""
    others = [o.origin for o in offers if (o.group, o.name) == (offer.group, offer.name) and o is not offer]
    return offer.fault() or shipped_fault(offer) or (f"also offered by {', '.join(others)}" if others else "")


_CONTROLLER_PACKAGES = {
    "track": TRACKING_CONTROLLERS,
    "track, certify": VELOCITY_CONTROLLERS,
}  # the commands that use them
LISTINGS: dict[str, Callable[[], dict[str, str]]] = {
    "effects": _effects,
    "rigs": _rigs,
    "actuators": _actuators,
    "protocols": _protocols,
    "controllers": _controllers,
    "campaigns": _campaigns,
    "imports": _imports,
    "wires": _wires,
    "plugins": _plugins,
    "keys": _keys,
}
_EXTENSIBLE = {"protocols": PROTOCOLS, "controllers": TRACKING_CONTROLLERS, "effects": EFFECTS}


def chosen_names(kind: str, files: tuple[str, ...]) -> set[str]:
    """The names that own files define, and those of plug-ins. Only these are then listed."""
    package, found = _EXTENSIBLE.get(kind), set()
    for file in files:
        name = resolve_name(package, file) if package else ""
        if package is None or name not in own_entries(package):
            raise UsageError(
                f"'{file}' cannot be listed. Give a file with a protocol, controller or effect of your own, such as "
                "./NAME.py, or the name of a plug-in."
            )
        found.add(name)
    return found


def offered_entries(kind: str) -> dict[str, str]:
    """The plug-ins of a kind that can be used and are not in use, by name, with their distribution."""
    package, (offers, _) = _EXTENSIBLE.get(kind, ""), plugin_offers()
    return {
        offer.name: f"plug-in of {offer.origin}"
        for offer in offers
        if package
        and offer.package == package
        and offer.name not in catalogue_names(package)
        and not _fault(offer, offers)
    }


def settings_of(group: str, name: str) -> list[str]:
    """The settings or parameters of an entry, one line each; none for a plug-in that is not in use."""
    if name in offered_entries(group):
        return []
    if group == "controllers":
        return _numbers(name)
    if group == "effects":
        kind = next(k for k in effect_types() if k.name == name)
        return [
            f"{p.name} = {p.typical:g} {p.unit} ({p.lower:g} to {p.upper:g}; {p.source})"
            for p in kind.parameters
        ]
    return [f"{key} = {default}" for key, default in setting_texts(name)] if group == "protocols" else []


def _numbers(name: str) -> list[str]:
    """The parameters of a controller, with unit and meaning where its docstring gives them."""
    texts, defaults = units_and_defaults(name)
    return [_line(key, default, *texts.get(key, ("", ""))) for key, default in defaults.items()]


def _line(key: str, default: float | None, unit: str, meaning: str) -> str:
    value = "set by the model," if default is None else f"{default:g}"
    meaning_text = f" ({meaning})" if meaning else ""
    return f"{key} = {value} {unit if unit != '1' else ''}".rstrip() + meaning_text


def units_and_defaults(name: str) -> tuple[dict[str, tuple[str, str]], dict[str, float | None]]:
    """Units, meanings and defaults of a controller's parameters. The default is None if the model sets it."""
    if name in (setpoint := _setpoint_controllers()):
        entry = setpoint[name]
        texts = documented_numbers(catalogue_entry(SETPOINT_CONTROLLERS, entry))
        return texts, optional_numbers(SETPOINT_CONTROLLERS, entry)
    package = next(p for p in _CONTROLLER_PACKAGES.values() if name in catalogue_names(p))
    return documented_numbers(catalogue_entry(package, name)), dict(default_numbers(package, name))
