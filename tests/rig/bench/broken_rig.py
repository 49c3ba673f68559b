"""A rig file for one cell of the fault table: link, faults with their start, and path of the trace."""

from pathlib import Path

from smarig.config import load_rig

LEASE_S = 0.5  # lock-step; little, so that a cell takes little time
TIMEOUT_S = 0.4  # of a reply: six in a row are longer than a busy machine keeps devices waiting
REAL_TIME = 4  # times real time, where time must pass by itself
REAL_LEASE_S = 2.0  # the longest there is: half a second of the wall's then
BASES = {
    "serial": "one_wire_serial",
    "modbus_tcp": "one_wire_modbus_tcp",
    "modbus_rtu": "one_wire_modbus_rtu",
    "socket": "one_wire_serial",
    "rfc2217": "one_wire_serial",
}
SHORT = ("settle.window_s=1", "settle.timeout_s={timeout_s}", "settle.approach_K=8", "settle.band_counts=4")
STEPS = ("step_currents", "currents_A=0.3,1.0,0.5", *SHORT)  # cold, heated through, half cooled
ZERO = ("initialise", *SHORT)


def protocol(phase: str, *, real_time: bool = False) -> tuple[str, ...]:
    """Name and settings of what runs: only ``initialise`` zeroes the encoder. Real time is dear: shorter holds."""
    timeout_s = 3 if real_time else 12
    return tuple(word.format(timeout_s=timeout_s) for word in (ZERO if phase == "zeroing" else STEPS))


def lease_s(real_time: bool) -> float:
    """The lease of the rig file, device seconds."""
    return REAL_LEASE_S if real_time else LEASE_S


def rig_file(folder: Path, link: str, faults: list[dict], *, real_time: bool = False) -> Path:
    """Write the rig file. The trace will be ``trace.csv`` in the same folder."""
    (folder / "faults.toml").write_text("".join(_table(fault) for fault in faults))
    framing = load_rig(BASES[link]).links.amplifier.framing
    slow = 5 if link == "rfc2217" else 1  # its port talks about itself before it carries a byte
    links = "".join(
        f'[links.{d}]\ndriver = "smarig_{d}"\nframing = "{framing}"\ntimeout_s = {slow * TIMEOUT_S}\n'
        for d in ("amplifier", "encoder_daq")
    )
    path = folder / "rig.toml"
    path.write_text(
        f'name = "broken"\nbase = "{BASES[link]}"\nwire = "{folder}"\nlease_s = {lease_s(real_time)}\n{links}'
        f"[simulator]\nspeed = {REAL_TIME if real_time else 0}\n"
        f'faults = "{folder / "faults.toml"}"\ntrace = "{folder / "trace.csv"}"\n'
    )
    return path


def _table(fault: dict) -> str:
    lines = [f'{key} = "{v}"' if isinstance(v, str) else f"{key} = {v}" for key, v in fault.items()]
    return "\n".join(["[[fault]]", *lines, ""])
