"""The plant that is simulated along a timeline: wire, hysteresis, initial state and effects."""

from dataclasses import dataclass

from smarig.config import ActuatorFile
from smarig.core import DataError, check_table
from smarig.plant import Actuator, Effect, PassThroughActuator, SupportsHooks, effects_from_json
from smarig.preisach import Everett, Initial
from smarig.record import Run
from smarig.replay.measured_input import driven_by_input
from smarig.replay.memory_history import recorded_start
from smarig.replay.model_file import Model


@dataclass(frozen=True, eq=False)
class PlantModel:
    """Constants, hysteresis, initial state of a timeline, known effects, and output units per count (0 if unknown)."""

    actuator: Actuator
    hysteresis: Everett
    initial: Initial
    effects: tuple[SupportsHooks, ...] = ()
    per_count: float = 0.0

    @property
    def catalogue_effects(self) -> tuple[Effect, ...]:
        """Its effects from the catalogue."""
        return tuple(e for e in self.effects if isinstance(e, Effect))

    @property
    def stroke(self) -> float:
        """Output between both saturations; negative if the output falls while the input rises."""
        h = self.hysteresis
        return h.everett(h.upper, h.lower) or 1.0


def plant_model_of(model: Model, first: Run) -> PlantModel:
    """The plant that a model describes, in the state that the first run records."""
    model.check_classical("A simulation in time with effects and heating")
    actuator = actuator_for_run(model, first)
    start = recorded_start(first) or ("anhysteretic" if actuator.two_wire else "negative")
    return PlantModel(
        actuator, model.hysteresis, start, effects_from_json(model.effects), first.info.output.resolution
    )


def actuator_of(model: Model) -> Actuator:
    """The wire's constants in the model file. Raises DataError if there are none."""
    record = model.actuator
    if not record.parameters:
        raise DataError(
            f"Model '{model.name}' does not contain its wire's constants, through which effects of heating act. Import "
            "the runs with --rig RIG and identify the model again, or use `smarig diagnose`, which needs no constants "
            "for runs with a measured input."
        )
    return Actuator(
        check_table(
            ActuatorFile,
            {
                "name": record.name,
                "arrangement": model.arrangement,
                "source": "model file",
                "hysteresis": {"surface": "one_e", "initial": "negative"},  # not used: the model has its own
                **record.parameters,
            },
            f"model '{model.name}'",
        )
    )


def actuator_for_run(model: Model, run: Run) -> Actuator:
    """The actuator that drives a model's hysteresis along a run: the wire, or the measured input."""
    return PassThroughActuator() if driven_by_input([run]) else actuator_of(model)
