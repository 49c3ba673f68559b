"""One run of each twin for all tests of the live view."""

import pytest

from live.made import recorded
from smarig.record import Run


@pytest.fixture(scope="session")
def one_wire(tmp_path_factory) -> Run:
    """Some holds of the one-wire twin."""
    return recorded("one_wire_twin", tmp_path_factory.mktemp("one_wire"))


@pytest.fixture(scope="session")
def two_wire(tmp_path_factory) -> Run:
    """Some holds of the two-wire twin."""
    return recorded("two_wire_twin", tmp_path_factory.mktemp("two_wire"))
