"""A protocol of your own. Describe it here in one or two sentences.

Preview it:  smarig check one_wire_twin --protocol ./my_protocol.py
Run it:      smarig run ./my_protocol.py --rig one_wire_twin -o my_protocol.run.sqlite

The function has the name of the file. It has no access to the rig: it yields commands and receives their results. The
same generator is previewed on a twin, run on a twin, and run on hardware.
"""

from smarig.core import Hold, Mark, Protocol, Settled, StepVerdict
from smarig.protocols import Setup, checked_count, evenly_spaced, saturate


def my_protocol(
    setup: Setup,  # what a protocol may use of the rig: ranges, heating law, time constant
    *,  # settings follow, such as --set loops=3; each needs a type and a default
    loops: int = 2,
    points: int = 4,
    high_share: float = 0.8,
    settle: Settled | None = None,  # --set settle.window_s=10, settle.band_counts=2, …
) -> Protocol:
    """Heat to a share of the range and cool again, several times. `smarig list` shows this line."""
    checked_count("loops", loops, 1, 100)  # raises an error before the run starts
    checked_count("points", points, 1, 1000)
    settle = settle or Settled()
    low, high = setup.lower_K, setup.at(high_share)  # kelvin above ambient
    yield Mark("loops", {"low_K": low, "high_K": high})  # a remark in the record
    yield from saturate(setup, settle)  # start from a known state: saturation erases the wire's memory
    for k in range(loops):
        for input_K in [*evenly_spaced(low, high, points), *evenly_spaced(high, low, points)]:
            current_A = setup.current_for(input_K)
            # One step of the record: a constant current until the position has settled. ``target`` is the hysteresis
            # input for identification; ``branch`` is your name for this part of the protocol.
            result = yield Hold(current_A, settle, target=input_K, branch=f"loop {k}")
            # ``result`` is a StepResult with mean position, verdict and times. A protocol may use it to decide how
            # to continue.
            if result.verdict is StepVerdict.TIMED_OUT:
                yield Mark("late", {"input_K": input_K})
