"""What a controller yields is a current, or one sentence with file and line; the current is then zero."""

import math

import numpy as np
import pytest

from smarig.benchmark.tracking import known
from smarig.control.tracking import Reference, track
from smarig.control.tracking.asked import Asked
from smarig.errors import LimitExceeded, UsageError
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import Watch
from smarig.runner.runner import Runner

SECONDS = 5.0
HERE = rf"Controller 'mine', {__file__.replace(chr(92), '.')}, line \d+: "


def yielding(*what):
    """A controller that yields these, one after the other, and ends."""

    def mine(known_, wanted):
        for value in what:  # noqa: UP028 - a tuple cannot be sent anything
            yield value

    return mine


def raising(error):
    def mine(known_, wanted):
        yield 0.1
        raise error

    return mine


def no_generator(known_, wanted):
    return [0.1, 0.2]


def stopped_before(known_, wanted):
    return next(iter(()))


def followed(make):
    """(samples seen, what ended it) of a loop on a twin."""
    twin, seen, ended = Twin.named("one_wire_twin", seed=1), [], None
    protocol = track(known(), make, Reference("r", (0.0, SECONDS), (1.0, 2.0)), name="mine", prepare=False)
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator),
        twin.position_per_count,
        [Watch(on_sample=lambda s, *_: seen.append(s))],
    )
    try:
        runner.run(protocol)
    except Exception as error:
        ended = error
    assert twin.output_A == 0.0
    return seen, ended


FAULTS = {
    "it ends early": (yielding(0.1, 0.2, 0.3), UsageError, HERE + r"it ended\..*while True", 4),
    "it yields nothing": (yielding(), UsageError, HERE + r"it ended\.", 1),
    "no generator": (no_generator, UsageError, r"'mine' yields nothing: it must be a generator", 1),
    "None": (yielding(0.1, None), UsageError, HERE + "it yields currents, A, as numbers, not None", 2),
    "a text": (yielding(0.1, "0.2"), UsageError, HERE + ".*not '0.2'", 2),
    "a truth": (yielding(True), UsageError, HERE + ".*not True", 1),
    "an array": (yielding(np.array([0.1, 0.2])), UsageError, HERE + ".*not array", 1),
    "NaN": (yielding(0.1, math.nan), LimitExceeded, HERE + "it asked for nan A", 2),
    "infinity": (yielding(0.1, -math.inf), LimitExceeded, HERE + "it asked for -inf A", 2),
    "beyond all floats": (yielding(10**400), LimitExceeded, HERE + "it asked for inf A", 1),
    "StopIteration": (raising(StopIteration()), UsageError, HERE + "it raised StopIteration", 2),
    "an exit": (raising(SystemExit(3)), UsageError, HERE + "it raised SystemExit", 2),
    "StopIteration at once": (stopped_before, UsageError, "'mine': it raised StopIteration", 1),
    "an error of its own": (raising(ZeroDivisionError("x")), ZeroDivisionError, "^x$", 2),
    "a sentence of its own": (raising(UsageError("Too hot.")), UsageError, r"^Too hot\.$", 2),
}


@pytest.mark.parametrize(("make", "kind", "says", "ticks"), FAULTS.values(), ids=FAULTS)
def test_a_fault_of_a_controller_is_one_sentence_and_the_current_zero(make, kind, says, ticks):
    seen, ended = followed(make)
    assert type(ended) is kind
    with pytest.raises(kind, match=says):
        raise ended
    assert "\n" not in str(ended)
    assert len(seen) == ticks, "what was measured is kept"


def test_numbers_of_any_kind_are_numbers():
    asked = Asked(yielding(np.float32(0.5), np.int64(1), 1), known(), lambda t_s: 0.0)
    assert [asked.first(), asked.after(None), asked.after(None)] == [0.5, 1.0, 1.0]


def test_a_controller_that_will_not_go_does_not_spoil_the_end():
    def clinging(known_, wanted):
        while True:
            try:
                yield 0.1
            except GeneratorExit:
                yield 0.1

    seen, ended = followed(clinging)
    assert ended is None
    assert len(seen) >= SECONDS / known().setup.period_s


def test_a_controller_can_be_torn_out_by_an_interrupt():
    """One that does not come back gets KeyboardInterrupt from outside, and must not turn it into a sentence."""
    asked = Asked(raising(KeyboardInterrupt()), known(), lambda t_s: 0.0)
    asked.first()
    with pytest.raises(KeyboardInterrupt):
        asked.after(None)
