"""Model files: numbers that cannot be, absurd structures, and names of files that are not theirs."""

import json
from collections.abc import Callable
from typing import Any

from hostile.material import Material, model_data
from hostile.run_structures import Maker, later
from hostile.tables import text


def model(change: Callable[[dict[str, Any], Material], object]) -> Maker:
    """The honest model after a change of its values."""

    def make(m: Material, path) -> None:
        data = model_data(m)
        change(data, m)
        path.write_text(json.dumps(data), encoding="utf-8")

    return make


def put(*where: Any, value: Any) -> Maker:
    """The honest model with one other value."""

    def change(data: dict[str, Any], _: Material) -> None:
        for key in where[:-1]:
            data = data[key]
        data[where[-1]] = value

    return model(change)


def _deep(levels: int) -> dict[str, Any]:
    found: dict[str, Any] = {"kind": "fod_table", "unit": "mm", "nodes": [0, 1], "rows": [[0], [0, 1]]}
    for _ in range(levels):
        found = {"kind": "mirrored", "image": found}
    return found


def _from_runs(data: dict[str, Any], place: str) -> None:
    data["provenance"][0] |= {"run": place, "sha256": "0" * 64}


_TABLE = {"kind": "fod_table", "unit": "mm", "nodes": [0, 100, 170], "rows": [[0], [0, 1], [0, 1, 2]]}
IMPOSSIBLE: dict[str, Maker] = {
    "noise below zero": put("noise_floor", "value", value=-5.0),
    "endless noise": put("noise_floor", "value", value=float("inf")),
    "huge noise": put("noise_floor", "value", value=1e300),
    "negative variance": put("covariance", 0, 0, value=-1e-6),
    "covariance is not symmetric": put("covariance", 0, 1, value=1.0),
    "covariance is not positive": put("covariance", 0, 1, value=1e-3),
    "endless covariance": put("covariance", 0, 0, value=float("inf")),
    "interval the wrong way round": put("intervals", "x2", value=[1.0, -1.0]),
    "endless interval": put("intervals", "x2", value=[float("-inf"), float("inf")]),
    "half a row": put("provenance", 0, "rows", value=-3),
    "negative error": put("fit", "rms", value=-1.0),
    "half a point": put("fit", "points", value=2.5),
    "fewer points than none": put("fit", "points", value=-9),
    "error in words": put("fit", "rms", value="small"),
    "negative diameter": put("actuator", "parameters", "wire", "diameter", "value", value=-0.3),
    "endless resistance": put(
        "actuator", "parameters", "heating", "resistance_martensite", "value", value=float("nan")
    ),
    "negative radius": put("actuator", "parameters", "transmission", "radius", "value", value=-15.0),
    "repeated parameter": put("parameters", 1, value="x2"),
    "a time before all": put("provenance", 0, "start_epoch", value=-1e300),
    "a condition without end": put(
        "provenance", 0, "conditions", value={"s": {"value": 1e999, "unit": "MPa"}}
    ),
    "an effect without end": put(
        "effects", value=[{"name": "creep", "parameters": {"percent_per_decade": 1e999}}]
    ),
    "a range of 1e12": put("hysteresis", "upper", value=1e12),
}
MODELS: dict[str, Maker] = {
    **IMPOSSIBLE,
    "deep JSON": later(lambda: text("[" * 100_000)),
    "deep mirrors": model(lambda d, _: d.update(hysteresis=_deep(400))),
    "very deep mirrors": text(
        '{"format": "smarig model", "schema_version": 1, "hysteresis": ' + '{"image":' * 50_000
    ),
    "endless integer": put("covariance", 0, 0, value=10**400),
    "endless digits": later(
        lambda: text('{"format": "smarig model", "schema_version": ' + "9" * 100_000 + "}")
    ),
    "not a number": put("hysteresis", "x", "x2", value=float("nan")),
    "steep": put("hysteresis", "x", "x2", value=1e12),
    "flat": put("hysteresis", "x", "x4", value=0.0),
    "table of nothing": put("hysteresis", value={**_TABLE, "nodes": [], "rows": []}),
    "table of words": put("hysteresis", value={**_TABLE, "rows": [["a"], ["b", "c"], [1, 2, 3]]}),
    "table of empty rows": put("hysteresis", value={**_TABLE, "rows": [[], [], []]}),
    "nodes that fall": put("hysteresis", value={**_TABLE, "nodes": [170, 100, 0]}),
    "large table": later(
        lambda: put(
            "hysteresis",
            value={**_TABLE, "nodes": list(range(1500)), "rows": [[0.0] * (k + 1) for k in range(1500)]},
        )
    ),
    "wide table": later(
        lambda: put("hysteresis", value={**_TABLE, "nodes": [float(k) for k in range(200_000)], "rows": []})
    ),
    "measure of nothing": put("hysteresis", value={"kind": "forc_table"}),
    "forms of no kind": put("hysteresis", "form", value={"a": 1}),
    "form of a path": put("hysteresis", "form", value="../../evil"),
    "own effect": model(lambda d, m: d.update(effects=[{"name": str(m.evil), "parameters": {}}])),
    "effect of a path": put("effects", value=[{"name": "../evil", "parameters": {}}]),
    "effects of no kind": put("effects", value=[{"name": [], "parameters": 7}]),
    "learned of nothing": put("effects", value=[{"name": "learned", "parameters": {}, "shape": {}}]),
    "extension of no kind": put("extension", value={"kind": []}),
    "moving without end": put("extension", value={"kind": "moving", "hysteresis": _TABLE, "feedback": 1e308}),
    "accommodating too much": put("extension", value={"kind": "accommodating", "amount": -5, "path": -1}),
    "measurement of no kind": put("measurement", value={"effects": 7}),
    "measurement of words": put("measurement", value={"effects": [], "amplitudes": ["x"]}),
    "falling conditions": put(
        "measurement",
        value={
            "effects": [],
            "amplitudes": [],
            "table": {"condition": "stress", "values": [2, 1], "gains": [1, 1], "zeros": [0, 0]},
        },
    ),
    "secret as rig": model(lambda d, m: d.update(rig=str(m.secret))),
    "secret as actuator": model(lambda d, m: d["actuator"].update(name=str(m.secret))),
    "secret as run": model(lambda d, m: _from_runs(d, str(m.secret))),
    "device as run": model(lambda d, _: _from_runs(d, "/dev/zero")),
    "name of 5 MB": later(lambda: put("name", value="n" * 5_000_000)),
    "100 000 warnings": later(lambda: put("warnings", value=["w" * 100] * 100_000)),
    "100 000 runs": later(lambda: model(lambda d, _: d.update(provenance=d["provenance"] * 100_000))),
    "markup": put("name", value="</script><script>alert(1)</script>"),
    "formula as unit": put("output", "unit", value="\n=cmd|calc!A0"),
    "escape sequences": put("name", value="\x1b[2J\x1b]0;x\x07"),
    "unit of another rig": later(lambda: put("output", "unit", value="m" * 100_000)),
    "empty": text(""),
    "bytes of no text": lambda _, path: path.write_bytes(b"\xff\xfe{"),
    "a run": lambda m, path: path.write_bytes(m.whole.read_bytes()),
    "endless device": lambda _, path: path.symlink_to("/dev/zero"),
}
