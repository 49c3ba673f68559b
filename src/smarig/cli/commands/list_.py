"""``smarig list``: the entries of the catalogues, one line each."""

import click

from smarig.cli.output import emit, json_option

KINDS = (
    "effects",
    "rigs",
    "actuators",
    "protocols",
    "controllers",
    "campaigns",
    "imports",
    "wires",
    "plugins",
    "keys",
)
EPILOG = """\b
Examples:
  smarig list protocols
  smarig list protocols ./my_protocol.py --settings
  smarig list plugins
  smarig list keys
"""


@click.command("list", short_help="List rigs, protocols, controllers, effects, wires, …", epilog=EPILOG)
@click.argument("kind", type=click.Choice([*KINDS, "all"]), default="all")
@click.argument("files", nargs=-1, metavar="[FILE.py]...")
@click.option(
    "--settings",
    is_flag=True,
    help="Also list the settings of protocols and controllers and the parameters of effects.",
)
@json_option
def command(kind: str, files: tuple[str, ...], settings: bool) -> None:
    """List rigs, actuators, protocols, controllers, campaigns, import mappings, effects, the wires used so far,
    and the plug-ins of other distributions.

    With FILE.py, list only the protocols, controllers or effects of your own in these files. The name of a plug-in
    may be given in place of a file; only then is it imported. "unit" is the rig's unit, mm or deg.

    "keys", which "all" does not list, are those of rig, actuator, campaign and import files, with type, unit, default
    and meaning.
    """
    from smarig.cli.listings import (
        LISTINGS,
        chosen_names,
        offered_entries,
        settings_of,
        units_and_defaults,
    )
    from smarig.protocols import setting_texts

    own_names = chosen_names(kind, files)
    found: dict[str, dict] = {
        k: read() for k, read in LISTINGS.items() if k == kind or (kind == "all" and k != "keys")
    }
    if own_names:
        found[kind] = {name: text for name, text in found[kind].items() if name in own_names}
    lines = []
    for group, entries in found.items():
        lines.append(f"{group}:")
        width = max(map(len, entries), default=0)
        for name, text in entries.items():
            lines.append(f"  {name:<{width}}  {text}")
            if settings:
                lines += [f"  {'':<{width}}    {line}" for line in settings_of(group, name)]
    if settings:
        known = {group: entries.keys() - offered_entries(group).keys() for group, entries in found.items()}
        found["settings"] = {
            n: dict(setting_texts(n)) for n in found.get("protocols", {}) if n in known["protocols"]
        } | {n: units_and_defaults(n)[1] for n in found.get("controllers", {}) if n in known["controllers"]}
    emit(found, "\n".join(lines))
