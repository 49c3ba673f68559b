"""An unconfirmed shutdown is reported to the user on every ending."""

import signal

import pytest

from smarig.core.errors import Interrupted, LimitExceeded, RigFault, StorageError, UsageError
from smarig.core.held_signals import HeldSignals
from smarig.device.encoding.link_faults import Silent
from smarig.rig.open_rig import _confirmed_shutdown

SHUTDOWN_UNCONFIRMED = "The amplifier could not be told."


@pytest.fixture(autouse=True)
def keyboard():
    """Ctrl-C as at a terminal: workers of pytest-xdist ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


class Deaf:
    """A rig that does not accept the command to switch off."""

    shutdown_unconfirmed = ""

    def safe(self):
        self.shutdown_unconfirmed = SHUTDOWN_UNCONFIRMED


@pytest.mark.parametrize(
    ("ending", "kind", "says"),
    [
        (
            Interrupted("interrupted by the keyboard (Ctrl-C)"),
            RigFault,
            f"Run interrupted by .* Its file is closed. {SHUTDOWN_UNCONFIRMED}",
        ),
        (
            LimitExceeded("Too hot.").at_zero(),
            LimitExceeded,
            rf"^Too hot\. {SHUTDOWN_UNCONFIRMED}$",
        ),
        (
            KeyboardInterrupt(),
            RigFault,
            rf"^Run interrupted by the keyboard \(Ctrl-C\)\. Its file is closed\. {SHUTDOWN_UNCONFIRMED}$",
        ),
        (Silent("No answer."), Silent, rf"^No answer\. {SHUTDOWN_UNCONFIRMED}$"),
    ],
)
def test_an_unconfirmed_shutdown_does_not_claim_zero_current(ending, kind, says):
    with pytest.raises(kind, match=says), _confirmed_shutdown(Deaf(), HeldSignals()):
        raise ending


def test_nor_does_the_end_of_a_run():
    with (
        pytest.raises(RigFault, match=f"{SHUTDOWN_UNCONFIRMED} The recorded data are complete."),
        _confirmed_shutdown(Deaf(), HeldSignals()),
    ):
        pass


def test_where_nothing_was_recorded_no_data_are_named():
    with (
        pytest.raises(RigFault, match=rf"^{SHUTDOWN_UNCONFIRMED}$"),
        _confirmed_shutdown(Deaf(), HeldSignals(), recorded=False),
    ):
        pass


class Confirming:
    """A rig that confirms that it is off."""

    shutdown_unconfirmed = ""

    def safe(self):
        """It is off."""


@pytest.mark.parametrize(
    ("ending", "says"),
    [
        (Silent("No answer."), "No answer. The current is at zero."),
        (StorageError("The disk is full."), "The disk is full. The current is at zero."),
        (LimitExceeded("Too hot.").at_zero(), "Too hot. The current is at zero."),
        (UsageError("There is no step 9."), "There is no step 9."),
    ],
)
def test_a_fault_says_that_the_current_is_at_zero(ending, says):
    """An error that is none of the rig says nothing of its current."""
    with pytest.raises(type(ending)) as raised, _confirmed_shutdown(Confirming(), HeldSignals()):
        raise ending
    assert str(raised.value) == says


class Slow(Deaf):
    """The same, while somebody presses Ctrl-C."""

    def safe(self):
        signal.raise_signal(signal.SIGINT)
        super().safe()


@pytest.mark.parametrize("ending", [Interrupted("terminated (SIGTERM)"), KeyboardInterrupt()])
def test_a_further_ctrl_c_neither_cuts_the_end_off_nor_takes_its_words_away(ending):
    with (
        pytest.raises(RigFault, match=f"Its file is closed. {SHUTDOWN_UNCONFIRMED}"),
        HeldSignals() as signals,
        _confirmed_shutdown(Slow(), signals),
    ):
        raise ending


def test_a_ctrl_c_while_a_current_ends_counts_after_it():
    class Heard(Slow):
        def safe(self):
            super().safe()
            self.shutdown_unconfirmed = ""

    rig = Heard()
    with pytest.raises(KeyboardInterrupt), HeldSignals() as signals, _confirmed_shutdown(rig, signals):
        pass
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
