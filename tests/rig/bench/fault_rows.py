"""The rows of the fault table: the fault, what device and host do, and the message."""

from rig.bench.broken_rig import TIMEOUT_S
from rig.bench.fault_kinds import BOTH, NOISE, PORT, ZERO, all_lost, anew, noise, on, restarted_message
from rig.bench.fault_table import AMPLIFIER, DONE, ENCODER, PHASES, Fault, Outcome

GONE_S = 0.8  # device time: 0.2 s of the wall clock
BROWN_S = 0.5
TRIP = "The amplifier at … has switched its output off: {}. … …"
LINES = (
    *(
        all_lost(f"dead line, {d}", "dead_line", d, "receives nothing, and its replies are lost")
        for d in BOTH
    ),
    *(
        all_lost(f"unplugged, {d}", "unplugged", d, "keeps running without a port", maybe_done=late)
        for d, late in ((AMPLIFIER, ()), (ENCODER, ("zeroing", "end")))
    ),
    *(
        Fault(
            f"unplugged for 0.2 s, {d}",
            "keeps running; its port is missing for this time",
            "tries the port again after 0.1 s and 0.3 s, repeats handshake and request",
            DONE,
            on("unplugged", d),
            real_time=True,
            lasts_s=GONE_S,
            phases={"opening": None},
        )
        for d in BOTH
    ),
    noise("late replies", "delayed", "replies after the host's time-out", delay_s=1.5 * TIMEOUT_S),
    noise("garbled replies", "garbled", "one bit of a reply is inverted", by_bytes=True),
    noise("dropped replies", "dropped", "replies, but the reply is lost"),
    noise("dropped requests", "dropped", "does not receive the request", direction="request"),
    noise(
        "repeated replies",
        "repeated",
        "replies twice",
        host="takes the first reply and discards the other",
        retries=False,
    ),
    noise(
        "foreign bytes",
        "foreign_bytes",
        "noise precedes a reply",
        host="finds the reply by its check word",
        retries=False,
        by_bytes=True,
    ),
    *(
        all_lost(
            f"everything garbled, {d}",
            "garbled",
            d,
            "executes requests; no reply arrives intact",
            NOISE,
            by_bytes=True,
        )
        for d in BOTH
    ),
)
POWER = (
    *(anew(f"reboot, {d}", "reboot", d, "restarts; an amplifier is off at 0 A") for d in BOTH),
    *(
        anew(
            f"brown-out, {d}",
            "brown_out",
            d,
            "has no power for 0.1 s, then restarts",
            real_time=True,
            lasts_s=BROWN_S,
            phases={"opening": None, "zeroing": restarted_message(d), "end": restarted_message(d)},
            maybe_done=("zeroing", "end") if d == AMPLIFIER else (),
        )
        for d in BOTH
    ),
    *(
        all_lost(f"power gone, {d}", "brown_out", d, "has no power; an amplifier's output is 0 A")
        for d in BOTH
    ),
)
REMEDY = (
    "Check encoder, coupling, cable and wire, the unit of the driver, and encoder.resolution of the rig file."
)
SAME = f"The position stays the same to the last digit while the temperature of the wire changes. {REMEDY} {ZERO}"
STANDS = (
    "The resistance of the wire changed by … %, as by a transformation, and the position hardly moved: one of them is "
    f"wrong. {REMEDY[:-1]}; and clamps, voltage leads and shunt. {ZERO}"
)
AWAY = f"The position is … counts away from all that a wire within … can have here, … {REMEDY} … {ZERO}"
HOT = f"The measured wire temperature … °C is … K above ambient and exceeds the limit temperature_max_K = …. {ZERO}"
READINGS = (
    Fault(
        "stuck encoder",
        "reads the same position permanently",
        "marks samples that stay the same while the wire changes, or that contradict the heating; sets 0 A",
        Outcome(3, f"{SAME}|{AWAY}|{STANDS}"),
        on("stuck_encoder", ENCODER),
        by_time=True,
        usual="started",
        maybe_done=("in a hold", "step change", "zeroing", "end"),
    ),
    Fault(
        "slipping encoder",
        "loses half of every movement",
        "marks samples that contradict the heating and those before, at the latest when the wire returns; sets 0 A",
        Outcome(3, AWAY),
        on("slipping_encoder", ENCODER, share=0.5),
        by_time=True,
        maybe_done=PHASES,
    ),
    Fault(
        "jumping encoder",
        "reads 500 counts too much at once",
        "detects a jump that no wire can make, sets 0 A",
        Outcome(
            3,
            "The position jumped by … counts in one tick, faster than the wire can (its stroke is … counts). "
            f"{REMEDY} {ZERO}",
        ),
        on("jumping_encoder", ENCODER, counts=500),
        by_time=True,
        phases={"opening": DONE, "zeroing": DONE},
    ),
    Fault(
        "open wire",
        "measures no current for three ticks and trips at 0 A, latched",
        "reads the trip in the next samples and closes the run",
        Outcome(3, TRIP.format("open")),
        on("open_wire", AMPLIFIER),
        by_time=True,
        phases={"zeroing": DONE},
        maybe_done=("end",),
    ),
    Fault(
        "drifting shunt",
        "measures 2 % more each second; trips when that exceeds the limit",
        "compares set-point and reading; whichever detects the fault first sets 0 A",
        Outcome(3, "… Check amplifier and shunt. …|" + TRIP.format("over_current")),
        on("drifting_shunt", AMPLIFIER, gain_per_s=0.02),
        by_time=True,
        phases={"zeroing": DONE, "end": DONE},
    ),
    Fault(
        "low shunt",
        "regulates a reading that is too low, so half again the current flows; the resistance is too large",
        "compares voltage and current; whichever detects the fault first sets 0 A",
        Outcome(
            3,
            "… Check shunt, amplifier and clamps. …|… Check clamps, wire and shunt …|"
            "… Check clamps, voltage leads and shunt. …|" + TRIP.format("resistance"),
        ),
        on("low_shunt", AMPLIFIER, factor=1.5),
        by_time=True,
        phases={"zeroing": DONE, "end": DONE},
    ),
    Fault(
        "hot wire",
        "measures a wire that is 200 K too hot; trips in that tick at 0 A, latched",
        "has written ambient temperature plus temperature_max_K into the amplifier; reads the trip or the temperature, "
        "closes the run",
        Outcome(3, f"{TRIP.format('wire_temperature')}|{HOT}"),
        on("thermometer", AMPLIFIER, excess_K=200.0),
        by_time=True,
        phases={"zeroing": DONE},
        maybe_done=("end",),
    ),
    Fault(
        "lost thermometer",
        "gets no reading any more from its thermometer on the wire; trips in that tick at 0 A, latched",
        "reads the trip in the next samples and closes the run",
        Outcome(3, TRIP.format("wire_temperature")),
        on("thermometer", AMPLIFIER),
        by_time=True,
        phases={"opening": DONE, "zeroing": DONE, "end": DONE},
    ),
    Fault(
        "clock drift",
        "the encoder's clock is 1 % fast",
        "joins ticks by their times; marks the sample in which they diverge as stale",
        DONE,
        on("clock_drift", ENCODER, ppm=10000),
        real_time=True,
    ),
)
NOT_OPENED = {"in a hold": None, "started": None, "step change": None, "zeroing": None, "end": None}
WIRING = (
    Fault(
        "lines exchanged",
        "each device replies at the other's port",
        "reads the kind of device (gets no reply on Modbus, whose addresses differ) and does not start",
        Outcome(
            3,
            "The device at … is of kind …, not the amplifier (…). "
            "Check whether the two lines are exchanged in the rig file.|"
            f"The amplifier cannot be reached. … {PORT}",
        ),
        wiring="exchanged",
        usual="opening",
        phases=NOT_OPENED,
    ),
    Fault(
        "another register map",
        "has firmware of another version",
        "compares the hashes of the maps and does not start",
        Outcome(
            3,
            "The amplifier at … has register map version 99, hash …; this smarig has version 5, "
            "hash …. Update smarig; firmware is built from firmware_protocol/.",
        ),
        wiring="other firmware",
        usual="opening",
        phases=NOT_OPENED,
    ),
)
CLOSED = "it is closed, the current is at zero. smarig resume … continues it."
STOPPED = "sets 0 A at the next tick and closes the run"
HOST = (
    Fault(
        "host stalled beyond the lease",
        "receives nothing for the lease and trips at 0 A, latched",
        "reads the trip in the samples it missed and closes the run",
        Outcome(3, TRIP.format("lease")),
        host="stall:0.8",
        real_time=True,
        loses_control=True,
        phases={"opening": DONE, "zeroing": DONE},
        maybe_done=("end",),
    ),
    Fault(
        "SIGTERM",
        "receives the command to switch off",
        STOPPED,
        Outcome(
            130,
            f"Run terminated (SIGTERM): {CLOSED}",
        ),
        host="signal:SIGTERM",
        loses_control=True,
        phases={"zeroing": DONE},
    ),
    Fault(
        "SIGINT (Ctrl-C)",
        "receives the command to switch off",
        STOPPED,
        Outcome(
            130,
            f"Run interrupted by the keyboard (Ctrl-C): {CLOSED}",
        ),
        host="signal:SIGINT",
        loses_control=True,
        phases={"zeroing": DONE},
    ),
    Fault(
        "disk full",
        "receives the command to switch off",
        "keeps 8 MB free for closing the run; sets 0 A when less is left, or does not start",
        Outcome(4, "Run … cannot be written: only … MB left on the disk. The current is at zero."),
        host="full_disk",
        phases={"opening": Outcome(4, "… has 0 MB free; this run needs about … MB.")},
        maybe_done=("step change", "zeroing", "end"),
    ),
    Fault(
        "a listener raises",
        "receives the command to switch off",
        "sets 0 A and closes the run with the error as its cause",
        Outcome(
            1,
            "Internal error (RuntimeError: viewer bug). This is a bug in smarig; "
            "set SMARIG_DEBUG=1 to see the traceback.",
        ),
        host="listener",
        loses_control=True,
        phases={"opening": None},
    ),
)
ROWS = (*LINES, *POWER, *READINGS, *WIRING, *HOST)
REPRESENTATIVE = ("late replies", "dead line, amplifier", "reboot, amplifier")
