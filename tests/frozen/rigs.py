"""Questions about rigs: twins, benches over bytes, protocols, injected effects, closed loops."""

from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path

from frozen.asking import Answer, ask, digest, model, must, private, table

TWINS = ("one_wire", "two_wire")
BENCHES = ("one_wire_serial", "one_wire_modbus_tcp", "one_wire_modbus_rtu", "two_wire_serial")
PROTOCOLS = {
    "congruency": ("points_per_branch=2",),
    "first_order_ascending": ("partition_K=20,60,120",),
    "first_order_descending": ("partition_K=20,50,80,120,150",),
    "initialise": ("method=thesis", "cycles=3"),
    "minor_loops": ("loops=2",),
    "second_order_transition": ("partition_K=20,60,120",),
    "step_currents": ("profile=sine", "points=6"),
    "validation": ("points=4",),
    "wiping_out": ("points_per_branch=1",),
}
EFFECTS = (
    *("settling", "ambient_drift", "resistance_phase", "stress_coupling", "accommodation", "noncongruency"),
    *("temperature_memory", "fatigue", "walking", "training", "creep", "backlash", "slip", "eccentricity"),
    *("slack", "saturation", "cross_talk", "wire_lag", "latent_heat", "convection", "end_conduction"),
    *("r_phase", "amplifier_gain", "dead_zone", "sensor_lag", "coulomb_friction", "thermal_expansion"),
)
Questions = dict[str, Callable[[], Answer]]


def questions(work: Path) -> Questions:
    """All of them."""
    found: Questions = {f"twin/{t}": lambda t=t: characterised(t, work / f"twin/{t}") for t in TWINS}
    for rig in (*BENCHES, *(f"{t}_twin" for t in TWINS)):
        found[f"rig/{rig}"] = lambda rig=rig: over_bytes(rig, work / f"rig/{rig}.run.sqlite")
    for name in PROTOCOLS:
        for twin in TWINS:
            found[f"protocol/{twin}/{name}"] = lambda twin=twin, name=name: protocol(twin, name, work)
    for name in EFFECTS:
        for twin in TWINS:
            found[f"effect/{twin}/{name}"] = lambda twin=twin, name=name: effect(twin, name, work)
    for twin in TWINS:
        found |= dict(Loops(twin, work / f"loop/{twin}").questions())
    found["list"] = lambda: {
        what: ask("list", what) for what in ("rigs", "actuators", "protocols", "effects", "controllers")
    }
    found["rig/mystery"] = lambda: _run(
        "mystery", "validation", work / "mystery.run.sqlite", ("points=3",), 42
    )
    return found


def characterised(twin: str, folder: Path) -> Answer:
    """The main job."""
    said = must("characterise", "--rig", f"{twin}_twin", "--out", folder, "--force")
    runs = {run.name: table(run, whole=True) for run in sorted((folder / "runs").glob("*.run.sqlite"))}
    return {"said": said, "model": model(folder / "model.json"), "runs": runs}


def over_bytes(rig: str, out: Path) -> Answer:
    """What is measured is the twin's to the last bit, over whatever link; marks of a busy line are left out."""
    said = must("run", "validation", "--rig", rig, "--set", "points=3", "--seed", 1, "-o", out, "--force")
    return {"steps": said["runs"][0]["steps"], "table": table(out)}


def protocol(twin: str, name: str, work: Path) -> Answer:
    """One protocol, made small; descending curves have what else can be done with a run."""
    out = work / f"protocol/{twin}/{name}.run.sqlite"
    answer = _run(f"{twin}_twin", name, out, PROTOCOLS[name], 3)
    if name == "first_order_descending":
        for surface in ("table", "constant", "parabolic"):
            kept = out.with_name(f"{surface}.model.json")
            answer[surface] = ask("identify", out, "--surface", surface, "-o", kept, "--force")
    if name == "step_currents":
        sheet, again = out.with_name("sheet.csv"), out.with_name("again.run.sqlite")
        must("export", out, "--to", "csv", "-o", sheet, "--force")
        answer["sheet"] = digest(list(sheet.read_bytes()))
        must("import", sheet, "--format", "csv", "--rig", f"{twin}_twin", "-o", again, "--force")
        answer["again"] = table(again, whole=True)
        answer["calibrate"] = ask("calibrate", out)
    return answer


def effect(twin: str, name: str, work: Path) -> Answer:
    """A wire with an injected effect."""
    out = work / f"effect/{twin}/{name}.run.sqlite"
    return _run(f"{twin}_twin", "step_currents", out, ("profile=decaying", "points=4"), 5, "--effect", name)


def _run(rig: str, name: str, out: Path, settings: tuple[str, ...], seed: int, *more: str) -> Answer:
    pairs = [word for pair in settings for word in ("--set", pair)]
    said = ask("run", name, "--rig", rig, "-o", out, "--seed", seed, *pairs, *more, "--force")
    return {"said": said, "table": table(out, whole=True)} if out.is_file() else {"said": said}


class Loops:
    """Closed loops around a twin, by a model of its reversal curves."""

    def __init__(self, twin: str, folder: Path) -> None:
        self._twin, self._folder = twin, folder

    def questions(self) -> Iterator[tuple[str, Callable[[], Answer]]]:
        """By name."""
        yield f"loop/{self._twin}/certify", lambda: ask("certify", self._model)
        yield (
            f"loop/{self._twin}/regulate",
            lambda: self._closed("regulate", "--setpoint", 6, "--hold-s", 150, "--disturbance-K", 2),
        )
        for name in ("inverse", "pi", "gain_scheduled"):
            for reference in ("steps", "ramps", "multisine"):
                yield (
                    f"loop/{self._twin}/track/{name}/{reference}",
                    lambda name=name, reference=reference: self._closed(
                        *("track", "--controller", name, "--reference", reference, "--set", "seconds=30")
                    ),
                )
        yield f"loop/{self._twin}/simulate", self._simulated

    def _closed(self, command: str, *words: object, link: str = "twin") -> Answer:
        out = self._folder / "loop.run.sqlite"
        out.unlink(missing_ok=True)
        said = ask(command, self._model, *words, "--rig", f"{self._twin}_{link}", "-o", out, "--seed", 7)
        return {"said": said, "table": table(out, whole=True)} if out.is_file() else {"said": said}

    def _simulated(self) -> Answer:
        out = self._folder / "simulated.run.sqlite"
        said = must("simulate", self._model, "--protocol", "wiping_out", "-o", out, "--force")
        return {"said": said, "table": table(out)}

    @cached_property
    def _model(self) -> Path:
        curves, kept = self._folder / "curves.run.sqlite", self._folder / "wire.model.json"
        # Otherwise the wire's history would depend on the order of the questions.
        with private(self._folder / "before"):
            must("run", "first_order_descending", "--rig", f"{self._twin}_twin", "-o", curves, "--force")
        must("identify", curves, "--surface", "exponential", "-o", kept, "--force")
        return kept
