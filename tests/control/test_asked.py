"""A controller yields a current, or gives one error message with file and line; the current is then zero."""

import math

import numpy as np
import pytest

from benchmarks.tracking import controller_model
from smarig.control.tracking import Reference, track
from smarig.control.tracking.checked_controller import CheckedController
from smarig.core.errors import LimitExceeded, UsageError
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner

SECONDS = 5.0
HERE = rf"Controller 'mine', {__file__.replace(chr(92), '.')}, line \d+: "


def yielding(*what):
    """A controller that yields these, one after the other, and ends."""

    def controller(assumed_model, reference_at):
        for value in what:  # noqa: UP028 - a tuple cannot be sent anything
            yield value

    return controller


def raising(error):
    def controller(assumed_model, reference_at):
        yield 0.1
        raise error

    return controller


def no_generator(assumed_model, reference_at):
    return [0.1, 0.2]


def stopped_before(assumed_model, reference_at):
    return next(iter(()))


def followed(make):
    """(samples seen, what ended it) of a loop on a twin."""
    twin, samples, ended = Twin.named("one_wire_twin", seed=1), [], None
    protocol = track(
        controller_model(), make, Reference("r", (0.0, SECONDS), (1.0, 2.0)), name="mine", prepare=False
    )
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator),
        twin.position_per_count,
        [CallbackListener(on_sample=lambda s, *_: samples.append(s))],
    )
    try:
        runner.run(protocol)
    except Exception as error:
        ended = error
    assert twin.output_A == 0.0
    return samples, ended


FAULTS = {
    "it ends early": (yielding(0.1, 0.2, 0.3), UsageError, HERE + r"the generator ended\..*while True", 4),
    "it yields nothing": (yielding(), UsageError, HERE + r"the generator ended\.", 1),
    "no generator": (no_generator, UsageError, r"'mine' yields nothing. It must be a generator", 1),
    "None": (yielding(0.1, None), UsageError, HERE + "it must yield currents in A as numbers, got None", 2),
    "a text": (yielding(0.1, "0.2"), UsageError, HERE + ".*got '0.2'", 2),
    "a truth": (yielding(True), UsageError, HERE + ".*got True", 1),
    "an array": (yielding(np.array([0.1, 0.2])), UsageError, HERE + ".*got array", 1),
    "NaN": (yielding(0.1, math.nan), LimitExceeded, HERE + "it commanded nan A", 2),
    "infinity": (yielding(0.1, -math.inf), LimitExceeded, HERE + "it commanded -inf A", 2),
    "beyond all floats": (yielding(10**400), LimitExceeded, HERE + "it commanded inf A", 1),
    "StopIteration": (raising(StopIteration()), UsageError, HERE + "it raised StopIteration", 2),
    "an exit": (raising(SystemExit(3)), UsageError, HERE + "it raised SystemExit", 2),
    "StopIteration at once": (stopped_before, UsageError, "'mine': it raised StopIteration", 1),
    "an error of its own": (raising(ZeroDivisionError("x")), ZeroDivisionError, "^x$", 2),
    "a sentence of its own": (raising(UsageError("Too hot.")), UsageError, r"^Too hot\.$", 2),
}


@pytest.mark.parametrize(("make", "kind", "says", "ticks"), FAULTS.values(), ids=FAULTS)
def test_a_fault_of_a_controller_is_one_sentence_and_the_current_zero(make, kind, says, ticks):
    samples, ended = followed(make)
    assert type(ended) is kind
    with pytest.raises(kind, match=says):
        raise ended
    assert "\n" not in str(ended)
    assert len(samples) == ticks, "what was measured is kept"


def test_numbers_of_any_kind_are_numbers():
    checked_controller = CheckedController(
        yielding(np.float32(0.5), np.int64(1), 1), controller_model(), lambda t_s: 0.0
    )
    assert [checked_controller.first(), checked_controller.after(None), checked_controller.after(None)] == [
        0.5,
        1.0,
        1.0,
    ]


def test_a_controller_that_refuses_to_close_does_not_spoil_the_end():
    def clinging(assumed_model, reference_at):
        while True:
            try:
                yield 0.1
            except GeneratorExit:
                yield 0.1

    samples, ended = followed(clinging)
    assert ended is None
    assert len(samples) >= SECONDS / controller_model().setup.period_s


def test_an_interrupt_in_a_controller_ends_the_loop():
    """One that does not come back gets KeyboardInterrupt from outside, and must not turn it into a sentence."""
    checked_controller = CheckedController(raising(KeyboardInterrupt()), controller_model(), lambda t_s: 0.0)
    checked_controller.first()
    with pytest.raises(KeyboardInterrupt):
        checked_controller.after(None)
