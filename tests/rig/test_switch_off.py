"""A source without a lease that ignores zero is asked again, and the run says so."""

import pytest

from smarig.core import RigFault
from smarig.device import OFF_PAUSE_S
from smarig.rig.shutdown import AT_ZERO_LATE, OFF_ATTEMPTS, OFF_S, after_shutdown, switch_off

FLOWS = "0.3 A is still measured: switch it off by hand now."
STILL_ON = "The supply did not confirm that it is off. It has no lease: switch it off by hand now."


class IgnoresZero:
    """Confirms only from the how manieth order on."""

    def __init__(self, confirms_at, *, has_lease=False):
        self.confirms_at, self.has_lease, self.orders = confirms_at, has_lease, 0

    def safe(self):
        self.orders += 1

    @property
    def shutdown_unconfirmed(self):
        return "" if self.orders >= self.confirms_at else STILL_ON


@pytest.mark.parametrize(
    ("rig", "orders", "text"),
    [
        (IgnoresZero(1), 1, ""),
        (IgnoresZero(3), 3, ""),
        (IgnoresZero(15), 15, ""),
        (IgnoresZero(99), 1 + round(OFF_S / OFF_PAUSE_S), STILL_ON),
        (IgnoresZero(99, has_lease=True), 1, STILL_ON),
    ],
    ids=["at once", "later", "after three seconds", "never", "has a lease"],
)
def test_zero_is_ordered_until_it_is_confirmed(rig, orders, text):
    pauses, told = [], []
    switch_off(rig, pauses.append, lambda said: told.append((rig.orders, said)), lambda: sum(pauses))
    assert (rig.orders, rig.shutdown_unconfirmed) == (orders, text)
    assert len(pauses) == orders - 1
    assert told == ([(1, STILL_ON)] if orders > 1 or text else []), "at once, and once"


def test_a_line_that_answers_slowly_is_asked_as_often():
    """Each attempt takes longer than all of them should."""
    rig, clock = IgnoresZero(99), iter(range(0, 1000, 10))
    switch_off(rig, lambda _: None, clock=lambda: next(clock))
    assert rig.orders == 1 + OFF_ATTEMPTS


def test_a_current_that_is_measured_after_all_is_told():
    class Flows(IgnoresZero):
        flows = ""

        @property
        def shutdown_unconfirmed(self):
            return super().shutdown_unconfirmed or self.flows

        def confirm_zero(self):
            self.flows = FLOWS

    told = []
    switch_off(Flows(3), lambda _: None, told.append)
    assert told == [STILL_ON, FLOWS]


def test_a_listener_that_fails_keeps_no_zero_back():
    def full(_):
        raise OSError("No space left on device")

    rig = IgnoresZero(3)
    with pytest.raises(OSError, match="No space"):
        switch_off(rig, lambda _: None, full)
    assert (rig.orders, rig.shutdown_unconfirmed) == (3, "")


def test_a_confirmation_that_came_late_is_said_with_what_may_have_flowed():
    """The error had told it before, and the record of the run still does."""
    rig, error = IgnoresZero(2), RigFault("It does not answer.")
    rig.safe()
    assert str(after_shutdown(error, rig)).endswith(STILL_ON)
    rig.safe()
    assert str(after_shutdown(error, rig)).endswith(AT_ZERO_LATE)
    assert (
        str(after_shutdown(RigFault("It does not answer."), rig))
        == "It does not answer. The current is at zero."
    )
