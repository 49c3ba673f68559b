"""Rigs that execute commands: the twin, the bench, their limits and their bring-up checks."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.rig.bench import Bench as Bench
    from smarig.rig.bring_up import bring_up as bring_up
    from smarig.rig.channel_checks import RigReadings as RigReadings
    from smarig.rig.consistency import DRIVERS as DRIVERS
    from smarig.rig.consistency import inconsistencies as inconsistencies
    from smarig.rig.driver_check import check_driver as check_driver
    from smarig.rig.driver_check import rig_for_check as rig_for_check
    from smarig.rig.force_statistics import ForceStatistics as ForceStatistics
    from smarig.rig.guard import Guard as Guard
    from smarig.rig.guard import outside_limits_text as outside_limits_text
    from smarig.rig.limits_without_lease import limits_in_force as limits_in_force
    from smarig.rig.limits_without_lease import without_lease_text as without_lease_text
    from smarig.rig.open_rig import open_rig as open_rig
    from smarig.rig.plausibility import Plausibility as Plausibility
    from smarig.rig.rig import Rig as Rig
    from smarig.rig.room_temperature import RoomTemperature as RoomTemperature
    from smarig.rig.shutdown import after_shutdown as after_shutdown
    from smarig.rig.shutdown import switch_off as switch_off
    from smarig.rig.specimen import RawReading as RawReading
    from smarig.rig.specimen import Specimen as Specimen
    from smarig.rig.specimen import TwinSettings as TwinSettings
    from smarig.rig.specimen import plant_of as plant_of
    from smarig.rig.stoppable_bench import StoppableBench as StoppableBench
    from smarig.rig.stress_limit import stress_limit as stress_limit
    from smarig.rig.twin import Twin as Twin
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
