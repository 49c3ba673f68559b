"""Rows that are alike: lost devices, noisy lines, devices that start anew. Made for fault_rows.py."""

from rig.bench.fault_table import AMPLIFIER, DONE, ENCODER, Fault, Outcome

BOTH = (AMPLIFIER, ENCODER)
MODERATE = 0.05  # share of requests or replies
PORT = "Check its power, the cable and the port; is another program using it?"
NOISE = "Check baud rate and framing in the rig file, shielding and ground."
LEASE = "The amplifier at … did not confirm switching off: without a word it does so within … s, its lease."
WHOLE = f"{LEASE} What was recorded until then is whole."
REPEATS = "repeats the same request; what was done is not done twice; the sample is marked as retried"
GIVES_UP = "asks three times, opens the port anew, asks three times, then sets 0 A and closes the run"


def on(kind: str, *devices: str, **more) -> tuple[dict, ...]:
    """The same fault of the simulator's on each device."""
    return tuple({"kind": kind, "device": d, **more} for d in devices)


def lost(device: str, remedy: str = PORT) -> Outcome:
    """Nothing usable comes from a device any more."""
    more = f" {LEASE}" if device == AMPLIFIER else ""
    return Outcome(3, f"The {device} cannot be reached. … {remedy}{more}")


def lost_phases(device: str, remedy: str = PORT) -> dict[str, Outcome | None]:
    """A lost amplifier when nothing flows yet, and when all is done but for switching off."""
    if device == ENCODER:
        return {}
    return {
        "opening": Outcome(3, f"The amplifier cannot be reached. … {remedy}"),
        "zeroing": Outcome(3, WHOLE),
        "end": Outcome(3, WHOLE),
    }


def all_lost(name: str, kind: str, device: str, does: str, remedy: str = PORT, **more) -> Fault:
    """A fault after which a device is not to be reached."""
    phases = lost_phases(device, remedy) | more.pop("phases", {})
    host = GIVES_UP + ("; the lease has switched off meanwhile" if device == AMPLIFIER else "")
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
    """A fault of some replies or requests on both lines, which a run outlives."""
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
    """What a person reads of it."""
    said = f"The {device} at … has started anew (boot …): look for a brown-out or a watchdog reset."
    return Outcome(3, said)


def anew(name: str, kind: str, device: str, does: str, **more) -> Fault:
    """The amplifier may have started anew by the time it is switched off: it is off then."""
    said = restarted_message(device)
    phases = {"opening": DONE} | ({"zeroing": DONE, "end": DONE} if device == AMPLIFIER else {})
    host = "sees another boot count in the next reply, sets 0 A and closes the run"
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
