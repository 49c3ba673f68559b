"""A model as a value and as a file: ``*.model.json``, human-readable, versioned, checked on load."""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BaseModel, ConfigDict, ValidationError

from smarig.control import SelfSensing
from smarig.core import (
    MODEL,
    Array,
    DataError,
    NotebookDisplay,
    Origin,
    Source,
    UsageError,
    atomic_file,
    check_file,
    marked_as,
    problem_text,
    shown,
    spaced,
    swapped_file,
)
from smarig.measurement import MeasurementPart
from smarig.plant import effects_from_json
from smarig.preisach import Everett, Initial, Preisach, dump_hysteresis, load_hysteresis
from smarig.record import Run
from smarig.replay.extended_model import Operator, extended_operator
from smarig.replay.model_numbers import (
    check_constants,
    check_covariance,
    check_fit,
    check_intervals,
    check_run,
    check_sizes,
    not_negative,
)

VERSION = 1
FORMAT = "smarig model"
LARGEST_BYTES = 64_000_000


class _FrozenSchema(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class SignalDescription(_FrozenSchema):
    """Quantity and unit of a signal."""

    quantity: str  # in words
    unit: str  # of its values


class ActuatorRecord(_FrozenSchema):
    """The wire: name of its parameter set, and the set itself (value, unit, source by key)."""

    name: str  # of the parameter set
    parameters: dict[str, Any]  # the set: value, unit, source by key


class NoiseRecord(_FrozenSchema):
    """Standard deviation of a settled output (None without repetitions), its source, and what repeats show besides."""

    value: float | None  # standard deviation of a settled output
    unit: str  # of the value
    source: str  # of the value
    drift_per_cycle: float | None = None  # trend of repeats, as a share of the travel, left out of the value
    over_readings: float | None = None  # scatter of repeats over the noise of a reading, if larger than usual


class ConditionRecord(_FrozenSchema):
    """A condition of a run, such as its stress."""

    value: float | str  # its mean, or a text
    unit: str  # of the value


class Provenance(_FrozenSchema):
    """One run that the model was made from; ``start_epoch`` and ``encoder_zero`` identify its session."""

    run: str  # its file
    sha256: str  # of that file
    protocol: str  # of the run
    source: str  # bench, twin or import
    rows: int  # number of samples
    start_epoch: float | None = None  # identifies the session
    encoder_zero: str | None = None  # identifies the session
    wire: str = ""  # identity of the wire
    conditions: dict[str, ConditionRecord] = {}  # of the run, by name


class _ModelFileSchema(_FrozenSchema):
    format: Literal["smarig model"]  # identifies a model file
    schema_version: int  # of these keys
    name: str  # of the model
    created: str  # date and time
    twin: bool  # whether the data are from a twin
    rig: Annotated[str, marked_as("model: rig")]  # of the measurements
    actuator: ActuatorRecord  # the wire
    arrangement: str  # one_wire or two_wire
    input: SignalDescription  # of the hysteresis
    output: SignalDescription  # of the hysteresis
    mirrored: bool  # whether it is the mirror image of the fitted hysteresis
    hysteresis: dict[str, Any]  # kind and values
    effects: list[dict[str, Any]]  # name and parameters of each, after a diagnosis
    extension: dict[
        str, Any
    ] = {}  # kind and values of an extended model (§3.5); left out for a classical model
    measurement: dict[str, Any] = {}  # measurement effects of a measured input; left out if there are none
    self_sensing: dict[
        str, Any
    ] = {}  # resistance of each wire by position, and its errors; left out if there is none
    parameters: list[str]  # names of the covariance's rows
    covariance: list[list[float | None]]  # of the parameters
    intervals: dict[str, tuple[float | None, float | None]]  # 95 %, by name
    fit: dict[str, Any]  # figures of the fit, as in identify --json
    noise_floor: NoiseRecord  # lower limit of the error of any model
    provenance: list[Provenance]  # the runs it was made from
    warnings: list[str]  # limitations of the model


@dataclass(frozen=True, eq=False)
class Model(NotebookDisplay):
    """A hysteresis with its wire, units, uncertainty and origin.

    ``parameters`` (p,) names the rows of ``covariance`` (p, p); ``intervals`` are 95 %; both are empty for
    tables. ``mirrored``: the hysteresis is the mirror image of the fitted one. ``effects`` are plain values
    {name, parameters}, empty for the pure hysteresis. ``extension``: kind and values of an extended model (§3.5),
    empty for a classical one; ``hysteresis`` is the classical one in both cases. ``measurement``: effects between a
    recorded input or output and those of the hysteresis, empty if there are none (``measured_prediction``).
    ``self_sensing``: resistance as a function of position, from which an observer finds the position; empty if it was
    not identified.
    """

    name: str
    hysteresis: Everett
    rig: str
    actuator: ActuatorRecord
    arrangement: str
    input: SignalDescription
    output: SignalDescription
    mirrored: bool
    fit: dict[str, Any]
    noise_floor: NoiseRecord
    provenance: tuple[Provenance, ...]
    twin: bool
    created: str
    parameters: tuple[str, ...] = ()
    covariance: Array = field(default_factory=lambda: np.empty((0, 0)))
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)
    effects: tuple[dict[str, Any], ...] = ()
    warnings: tuple[str, ...] = ()
    extension: dict[str, Any] = field(default_factory=dict)
    measurement: dict[str, Any] = field(default_factory=dict)
    self_sensing: dict[str, Any] = field(default_factory=dict)

    @property
    def temperature(self) -> str | None:
        """Source of the input of a model of loads of a rig (``wire_temperature``); None for other models."""
        source = self.measurement.get("temperature")
        return source if isinstance(source, str) else None

    @property
    def unit(self) -> str:
        """Unit of the output."""
        return self.output.unit

    def preisach(self, initial: Initial = "negative") -> Preisach:
        """The classical operator of the hysteresis, in an initial state."""
        return Preisach(self.hysteresis, initial)

    def operator(self, initial: Initial = "negative") -> Operator:
        """The predicting operator: the extended one if the model has an extension, else the classical one."""
        if not self.extension:
            return self.preisach(initial)
        return extended_operator(self.extension, self.hysteresis, initial)

    def check_classical(self, purpose: str) -> None:
        """Raise UsageError if the model is extended and ``purpose`` requires a classical one."""
        if self.extension:
            raise UsageError(
                f"{purpose} requires a classical model. '{self.name}' has the extension '{self.extension['kind']}' "
                "(§3.5), which only verify and predictions along runs support. Identify it with --extension none."
            )

    def predict(self, u: ArrayLike, initial: Initial = "negative") -> Array:
        """Outputs for inputs u (n,), or (n_inputs, n_samples), in the model's units, each from an initial state."""
        if isinstance(u, Run | str | Path):
            raise UsageError(
                "predict takes inputs of the hysteresis. Along a run, call smarig.simulate(model, run); for the errors "
                "there, smarig.verify(model, run)."
            )
        return self.operator().simulate(u, initial)

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the file as a whole. Raises UsageError if it exists and ``force`` is not given."""
        target = Path(path)
        with atomic_file(target, force=force) as part:
            part.write_text(self.file_text, encoding="utf-8")
        return target

    @property
    def file_text(self) -> str:
        """The content of its file."""
        data = _to_file(self).model_dump(mode="json")
        for key in ("extension", "measurement", "self_sensing"):
            if not data[key]:
                del data[key]
        return _pretty(data)

    def __repr__(self) -> str:
        h = self.hysteresis
        kind = f"{getattr(h, 'form', '')} {type(h).__name__}".strip()
        rms = self.fit.get("rms")
        fitted = f", rms {rms:.3g}{spaced(self.unit)}" if isinstance(rms, float) else ""
        made = "twin data" if self.twin else "measured data"
        return (
            f"Model({self.name}: {kind}, {self.input.quantity} [{h.lower:g}, {h.upper:g}] {self.input.unit} "
            f"→ {self.output.quantity} in {self.unit}{fitted}; {made}, {len(self.provenance)} run(s))"
        )


def load_model(path: str | Path) -> Model:
    """Read and check a model file. Raises UsageError if there is none, DataError for another kind of file."""
    file = Path(path)
    check_file(file, "model file")
    if file.stat().st_size > LARGEST_BYTES:
        raise DataError(f"{file} is larger than {LARGEST_BYTES // 10**6} MB, too large for a model file.")
    try:
        raw = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        swapped = swapped_file(file, MODEL)
        raise DataError(swapped or f"{file} is not a model file: it is not JSON ({error}).") from None
    if not isinstance(raw, dict) or raw.get("format") != FORMAT:
        raise DataError(f'{file} is not a model file: it lacks "format": "{FORMAT}".')
    if raw.get("schema_version") != VERSION:
        raise DataError(
            f"{file} has model schema version {shown(raw.get('schema_version'))}; this smarig reads {VERSION}."
        )
    try:
        return _from_file(_ModelFileSchema.model_validate(raw, context=Source(file.name, Origin.INSIDE)))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        what = (
            "is an unknown key" if first["type"] == "extra_forbidden" else f"is wrong: {problem_text(first)}"
        )
        raise DataError(f"{file}: '{where:.200}' {what:.300}.") from None
    except (DataError, UsageError) as error:
        raise DataError(f"{file}: {str(error).rstrip('.')}.") from None
    except (TypeError, ValueError, ArithmeticError, KeyError) as error:
        raise DataError(f"{file} contains no usable hysteresis: {error!s:.300}.") from None


def _to_file(model: Model) -> _ModelFileSchema:
    return _ModelFileSchema(
        format=FORMAT,
        schema_version=VERSION,
        hysteresis=dump_hysteresis(model.hysteresis),
        effects=list(model.effects),
        parameters=list(model.parameters),
        covariance=[[_number(v) for v in row] for row in model.covariance.tolist()],
        intervals={name: (_number(low), _number(high)) for name, (low, high) in model.intervals.items()},
        provenance=list(model.provenance),
        warnings=list(model.warnings),
        **{
            name: getattr(model, name)
            for name in (
                *("name", "created", "twin", "rig", "actuator", "arrangement"),
                *(
                    "input",
                    "output",
                    "mirrored",
                    "fit",
                    "noise_floor",
                    "extension",
                    "measurement",
                    "self_sensing",
                ),
            )
        },
    )


def _from_file(file: _ModelFileSchema) -> Model:
    rest = {
        name: getattr(file, name)
        for name in _ModelFileSchema.model_fields
        if name not in ("format", "schema_version")
    }
    _check_numbers(file)
    size = len(file.parameters)
    effects_from_json(file.effects)  # raises if invalid
    covariance = np.array(file.covariance, dtype=float).reshape(size, size)
    rest |= {
        "hysteresis": load_hysteresis(file.hysteresis),
        "covariance": covariance,
        "intervals": {name: (_float(a), _float(b)) for name, (a, b) in file.intervals.items()},
        **{name: tuple(rest[name]) for name in ("parameters", "provenance", "warnings", "effects")},
    }
    if file.measurement:
        MeasurementPart.from_json(file.measurement)  # raises if invalid
        if file.effects:
            raise DataError("a model has effects of the wire or of a measured input, not both")
    if file.self_sensing:
        SelfSensing.from_json(file.self_sensing)  # raises if invalid
    if file.extension:
        extended_operator(file.extension, rest["hysteresis"])  # raises if invalid
    return Model(**rest)


def _check_numbers(file: _ModelFileSchema) -> None:
    """Raise DataError for a number that cannot be."""
    check_sizes(file)
    check_covariance(file.parameters, file.covariance)
    check_intervals(file.intervals)
    not_negative(file.noise_floor.value, "'noise_floor.value'")
    not_negative(file.noise_floor.over_readings, "'noise_floor.over_readings'")
    check_fit(file.fit)
    check_constants(file.actuator.parameters)
    for run in file.provenance:
        check_run(run)


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _float(value: float | None) -> float:
    return float("nan") if value is None else value


def _pretty(data: dict[str, Any]) -> str:
    """Indented JSON with every innermost list on one line."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)
    flat = re.compile(r'\[\n\s+([^\[\]{}"]*?)\n\s+\]')
    return flat.sub(lambda m: "[" + re.sub(r",\s+", ", ", m.group(1)) + "]", text) + "\n"
