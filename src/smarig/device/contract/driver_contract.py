"""The contract of a driver in one of the roles of a bench; anybody's driver can be checked against it.

from smarig.device import ContractCase, check_contract

def test_contract(case: ContractCase):
    assert all(result.passed for result in check_contract("amplifier", case))
"""

from collections.abc import Iterator, Mapping
from typing import Literal, get_args

from smarig.core import UsageError
from smarig.device.contract import common_requirements as common
from smarig.device.contract import sensor_requirements, source_requirements
from smarig.device.contract.contract_case import Check, ContractCase, Requirement, results

Role = Literal["amplifier", "encoder_daq", "thermometer", "room_thermometer", "load_cell"]
ROLES: tuple[Role, ...] = get_args(Role)

_BY_ROLE: dict[Role, Mapping[str, Requirement]] = {
    "amplifier": source_requirements.REQUIREMENTS,
    "encoder_daq": sensor_requirements.POSITION_REQUIREMENTS,
    "thermometer": {"temperature": sensor_requirements.temperature},
    "room_thermometer": {"temperature": sensor_requirements.temperature},
    "load_cell": {"force": sensor_requirements.force},
}


def contract(role: Role) -> dict[str, Requirement]:
    """The requirements of a role by name, in order. Raises UsageError for an unknown role."""
    if role not in _BY_ROLE:
        raise UsageError(f"No role '{role}'. The roles are: {', '.join(ROLES)}.")
    return {
        "identity": common.identity,
        **_BY_ROLE[role],
        "closing": common.closing,
        "absence": common.absence,
    }


def check_contract(role: Role, case: ContractCase) -> Iterator[Check]:
    """Check an instrument against every requirement of a role, in order. Its output is at zero afterwards."""
    return results(case, contract(role))
