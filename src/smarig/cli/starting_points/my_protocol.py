"""A protocol of your own: what it does goes here, in one or two sentences.

Look at it:  smarig check one_wire_twin --protocol ./my_protocol.py
Run it:      smarig run ./my_protocol.py --rig one_wire_twin -o my_protocol.run.sqlite

The function has the file's name. It never touches a rig: it yields commands, and is sent what became of them. The
same generator is previewed on a twin, run on a twin, and run on hardware.
"""

from smarig.core import Hold, Mark, Protocol, Settled, StepVerdict
from smarig.protocols import Setup, checked_count, evenly_spaced, saturate


def my_protocol(
    setup: Setup,  # what it may know of the rig: ranges, heating law, time constant
    *,  # what follows are settings: --set loops=3; each with a type and a default
    loops: int = 2,
    points: int = 4,
    high_share: float = 0.8,
    settle: Settled | None = None,  # --set settle.window_s=10, settle.band_counts=2, …
) -> Protocol:
    """Heat to a share of the range and cool again, a few times: the first line is what `smarig list` shows."""
    checked_count("loops", loops, 1, 100)  # refuses with a sentence; better here than in the night
    checked_count("points", points, 1, 1000)
    settle = settle or Settled()
    low, high = setup.lower_K, setup.at(high_share)  # kelvin above ambient
    yield Mark("loops", {"low_K": low, "high_K": high})  # a remark in the record
    yield from saturate(
        setup, settle
    )  # one known state to begin with: whatever the wire remembers is wiped out
    for k in range(loops):
        for input_K in [*evenly_spaced(low, high, points), *evenly_spaced(high, low, points)]:
            current_A = setup.current_for(input_K)
            # One step of the record: a constant current until the wire stands still. ``target`` is what identification
            # reads the step as; ``branch`` is a word of yours for its part of the experiment.
            result = yield Hold(current_A, settle, target=input_K, branch=f"loop {k}")
            # ``result`` is a StepResult: mean position, verdict, times. A protocol may decide by it what to do next.
            if result.verdict is StepVerdict.TIMED_OUT:
                yield Mark("late", {"input_K": input_K})
