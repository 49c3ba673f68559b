"""Groups of similar rows for fault_rows.py: lost devices, noisy lines, restarted devices."""

from rig.bench.fault_table import AMPLIFIER, DONE, ENCODER, Fault, Outcome

BOTH = (AMPLIFIER, ENCODER)
MODERATE = 0.05  # share of requests or replies
PORT = "Check its power, the cable and the port, and whether another program uses it."
NOISE = "Check baud rate and framing in the rig file, the shielding and the ground."
LEASE = (
    "The amplifier at … did not confirm that it switched off. "
    "Without further commands its lease switches it off within … s."
)
ZERO = "The current is at zero."
WHOLE = f"{LEASE} The recorded data are complete."
REPEATS = "repeats the request, which the device does not execute twice; marks the sample as retried"
GIVES_UP = (
    "sends the request three times, reopens the port, sends it three times, then sets 0 A and closes the run"
)


def on(kind: str, *devices: str, **more) -> tuple[dict, ...]:
    """The same fault of the simulator on each device."""
    return tuple({"kind": kind, "device": d, **more} for d in devices)


def lost(device: str, remedy: str = PORT) -> Outcome:
    """The device returns nothing usable any more."""
    of_current = LEASE if device == AMPLIFIER else ZERO
    return Outcome(3, f"The {device} cannot be reached. … {remedy} {of_current}")


def lost_phases(device: str, remedy: str = PORT) -> dict[str, Outcome | None]:
    """The phases in which a loss ends otherwise: before any current; that of an amplifier at switching off, too."""
    opening: dict[str, Outcome | None] = {
        "opening": Outcome(3, f"The {device} cannot be reached. … {remedy}")
    }
    if device == ENCODER:
        return opening
    return opening | {
        "zeroing": Outcome(3, WHOLE),
        "end": Outcome(3, WHOLE),
    }


def all_lost(name: str, kind: str, device: str, does: str, remedy: str = PORT, **more) -> Fault:
    """A fault after which a device cannot be reached."""
    phases = lost_phases(device, remedy) | more.pop("phases", {})
    host = GIVES_UP + ("; meanwhile the lease has switched the current off" if device == AMPLIFIER else "")
    return Fault(
        name, does, host, lost(device, remedy), on(kind, device), phases=phases, loses_control=True, **more
    )


def noise(
    name: str,
    kind: str,
    does: str,
    *,
    host: str = REPEATS,
    retries: bool = True,
    by_bytes: bool = False,
    **more,
) -> Fault:
    """A fault of some replies or requests on both lines that does not end a run."""
    return Fault(
        name,
        does,
        host,
        DONE,
        tuple({**f, "seed": n} for n, f in enumerate(on(kind, *BOTH, share=MODERATE, **more))),
        same_data=True,
        retries=retries,
        by_bytes=by_bytes,
    )


def restarted_message(device: str) -> Outcome:
    """The message about a restarted device."""
    said = f"The {device} at … has restarted (boot …). Check for a brown-out or a watchdog reset. {ZERO}"
    return Outcome(3, said)


def anew(name: str, kind: str, device: str, does: str, **more) -> Fault:
    """A fault that restarts a device. An amplifier that restarts before it is switched off is off."""
    said = restarted_message(device)
    phases = {"opening": DONE} | ({"zeroing": DONE, "end": DONE} if device == AMPLIFIER else {})
    host = "detects another boot count in the next reply, sets 0 A and closes the run"
    return Fault(
        name,
        does,
        host,
        said,
        on(kind, device),
        phases=phases | more.pop("phases", {}),
        loses_control=True,
        **more,
    )
