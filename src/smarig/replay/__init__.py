"""Driving a model along a record: the timeline of runs, what a model predicts along it, its memory, the model file."""

from smarig.replay.measured_input import MeasuredInput, input_noise_sd
from smarig.replay.memory_history import (
    SATURATION_TOLERANCE,
    MemoryHistory,
    Start,
    continues_run,
    memory_histories,
    recorded_start,
)
from smarig.replay.model_file import Model, NoiseRecord, load_model
from smarig.replay.plant_model import PlantModel, actuator_for_run, plant_model_of
from smarig.replay.prediction import OUTPUT_DEPENDENT_KINDS, Prediction, numerics, predict, with_hysteresis
from smarig.replay.provenance import file_hash, missing_earlier_runs, model_metadata, provenance
from smarig.replay.sample_predictors import (
    HysteresisPredictor,
    NamedPredictor,
    PlantPredictor,
    PrecomputedPredictor,
    ZeroedPredictor,
)
from smarig.replay.simulation import (
    check_input,
    check_output,
    out_of_range,
    simulate,
    simulate_runs,
    simulate_samples,
)
from smarig.replay.timeline import ReadingSeries, Timeline
from smarig.replay.timeline_from_runs import build_timeline

__all__ = [
    "OUTPUT_DEPENDENT_KINDS",
    "SATURATION_TOLERANCE",
    "HysteresisPredictor",
    "MeasuredInput",
    "MemoryHistory",
    "Model",
    "NamedPredictor",
    "NoiseRecord",
    "PlantModel",
    "PlantPredictor",
    "PrecomputedPredictor",
    "Prediction",
    "ReadingSeries",
    "Start",
    "Timeline",
    "ZeroedPredictor",
    "actuator_for_run",
    "build_timeline",
    "check_input",
    "check_output",
    "continues_run",
    "file_hash",
    "input_noise_sd",
    "load_model",
    "memory_histories",
    "missing_earlier_runs",
    "model_metadata",
    "numerics",
    "out_of_range",
    "plant_model_of",
    "predict",
    "provenance",
    "recorded_start",
    "simulate",
    "simulate_runs",
    "simulate_samples",
    "with_hysteresis",
]
