"""The rows of the fault table: what befalls which device, what the host does about it, what a person reads."""

from rig.bench.broken_rig import TIMEOUT_S
from rig.bench.fault_kinds import BOTH, NOISE, PORT, all_lost, anew, noise, on, restarted_message
from rig.bench.fault_table import AMPLIFIER, DONE, ENCODER, Fault, Outcome

GONE_S = 0.8  # of device time in real time: 0.2 s of the wall's
BROWN_S = 0.5
TRIP = "The amplifier at … has switched its output off: {}. … …"
LINES = (
    *(all_lost(f"dead line, {d}", "dead_line", d, "hears nothing, and is not heard") for d in BOTH),
    *(
        all_lost(f"unplugged, {d}", "unplugged", d, "goes on, unheard; its port is gone", maybe_done=late)
        for d, late in ((AMPLIFIER, ()), (ENCODER, ("zeroing", "end")))
    ),
    *(
        Fault(
            f"unplugged for 0.2 s, {d}",
            "goes on, unheard; its port is gone for a while",
            "looks for the port again after 0.1 s and 0.3 s, shakes hands, repeats the request",
            DONE,
            on("unplugged", d),
            real_time=True,
            lasts_s=GONE_S,
            phases={"opening": None},
        )
        for d in BOTH
    ),
    noise("late replies", "delayed", "answers after the host's patience", delay_s=1.5 * TIMEOUT_S),
    noise("garbled replies", "garbled", "one bit of a reply is another", by_bytes=True),
    noise("dropped replies", "dropped", "answers, unheard"),
    noise("dropped requests", "dropped", "does not hear", direction="request"),
    noise(
        "repeated replies",
        "repeated",
        "answers twice",
        host="takes the first, throws the other away",
        retries=False,
    ),
    noise(
        "foreign bytes",
        "foreign_bytes",
        "noise comes before a reply",
        host="finds the reply by its check word",
        retries=False,
        by_bytes=True,
    ),
    *(
        all_lost(
            f"everything garbled, {d}",
            "garbled",
            d,
            "hears and does; no reply arrives whole",
            NOISE,
            by_bytes=True,
        )
        for d in BOTH
    ),
)
POWER = (
    *(anew(f"reboot, {d}", "reboot", d, "begins anew, an amplifier at 0 A and off") for d in BOTH),
    *(
        anew(
            f"brown-out, {d}",
            "brown_out",
            d,
            "is without power for 0.1 s, then begins anew",
            real_time=True,
            lasts_s=BROWN_S,
            phases={"opening": None, "zeroing": restarted_message(d), "end": restarted_message(d)},
            maybe_done=("zeroing", "end") if d == AMPLIFIER else (),
        )
        for d in BOTH
    ),
    *(
        all_lost(f"power gone, {d}", "brown_out", d, "is without power; an amplifier's output is 0 A")
        for d in BOTH
    ),
)
UNSEEN = "goes on: no single sample shows it"
READINGS = (
    Fault(
        "stuck encoder",
        "reads the same position for ever",
        "has heated the wire through and seen no motion: sets 0 A",
        Outcome(
            3,
            "The wire was heated through and did not move: is the encoder stuck or off, or the wire broken? "
            "The current is at zero.",
        ),
        on("stuck_encoder", ENCODER),
        by_time=True,
        usual="just begun",
        phases=dict.fromkeys(("in a hold", "step change", "zeroing", "end"), DONE),
    ),
    Fault(
        "slipping encoder",
        "loses half of every movement",
        f"{UNSEEN}; loops that should repeat do not",
        DONE,
        on("slipping_encoder", ENCODER, share=0.5),
        by_time=True,
    ),
    Fault(
        "jumping encoder",
        "reads 500 counts too much at once",
        "sees a jump that no wire can make: sets 0 A",
        Outcome(
            3, "The encoder jumped by … counts in one tick: check cable and disc. The current is at zero."
        ),
        on("jumping_encoder", ENCODER, counts=500),
        by_time=True,
        phases={"opening": DONE, "zeroing": DONE},
    ),
    Fault(
        "open wire",
        "sees no current for three ticks: trips, 0 A, latched",
        "reads the trip in the next samples, closes the run",
        Outcome(3, TRIP.format("open")),
        on("open_wire", AMPLIFIER),
        by_time=True,
        phases={"zeroing": DONE},
        maybe_done=("end",),
    ),
    Fault(
        "drifting shunt",
        "measures too much, by 2 % more each second; trips where that is over the limit",
        "compares set-point and reading; the first of the two to notice sets 0 A",
        Outcome(3, "… check amplifier and shunt. …|" + TRIP.format("over_current")),
        on("drifting_shunt", AMPLIFIER, gain_per_s=0.02),
        by_time=True,
        phases={"zeroing": DONE, "end": DONE},
    ),
    Fault(
        "clock drift",
        "the encoder's clock is 1 % fast",
        "follows: ticks of both are joined by their times; the sample in which they part is marked as stale",
        DONE,
        on("clock_drift", ENCODER, ppm=10000),
        real_time=True,
    ),
)
NOT_OPENED = {"in a hold": None, "just begun": None, "step change": None, "zeroing": None, "end": None}
WIRING = (
    Fault(
        "lines exchanged",
        "each answers at the other's port",
        "reads what kind it is (on Modbus, another address: hears nothing), and does not begin",
        Outcome(
            3,
            "At … answers a device of kind …, not the amplifier (…): are the two lines exchanged in the rig file?|"
            f"The amplifier cannot be reached. … {PORT}",
        ),
        wiring="exchanged",
        usual="opening",
        phases=NOT_OPENED,
    ),
    Fault(
        "another register map",
        "has firmware of another version",
        "compares the maps' hashes, and does not begin",
        Outcome(
            3,
            "The amplifier at … has register map version 2, hash …; this smarig has version 1, "
            "hash …. Bring smarig up to date: firmware is built from firmware_protocol/.",
        ),
        wiring="other firmware",
        usual="opening",
        phases=NOT_OPENED,
    ),
)
CLOSED = "it is closed, the current is at zero. 'smarig resume' goes on with it."
STOPPED = "sets 0 A at the next tick and closes the run"
HOST = (
    Fault(
        "host stalled beyond the lease",
        "hears nothing for the lease: trips, 0 A, latched",
        "reads the trip in the samples it missed, closes the run",
        Outcome(3, TRIP.format("lease")),
        host="stall:0.8",
        real_time=True,
        loses_control=True,
        phases={"opening": DONE, "zeroing": DONE},
        maybe_done=("end",),
    ),
    Fault(
        "SIGTERM",
        "is told to switch off",
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
        "is told to switch off",
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
        "is told to switch off",
        "keeps 8 MB free for closing the run; sets 0 A once it comes near, or does not begin",
        Outcome(4, "Run … cannot be written: only … MB left on the disk. The current is at zero."),
        host="full_disk",
        phases={"opening": Outcome(4, "… has 0 MB free; this run needs about … MB.")},
        maybe_done=("step change", "zeroing", "end"),
    ),
    Fault(
        "a listener raises",
        "is told to switch off",
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
