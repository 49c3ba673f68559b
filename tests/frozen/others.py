"""Questions about measurements by others (skipped without them) and about the hysteresis alone."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from frozen.asking import Answer, ask, digest, model, must, table, thinned

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
Questions = dict[str, Callable[[], Answer]]
_PIECE = {"early": slice(0, 1500), "late": slice(6000, 7500)}  # of the long record of cycles


def questions(work: Path) -> Questions:
    """All questions that can be answered here."""
    found: Questions = {"python/measure": measure, "python/table": fod_table, "python/surface": surface}
    found["python/run"] = lambda: in_python(work / "python")
    return found | (_of_data(work / "data") if DATA.is_dir() else {})


def _of_data(work: Path) -> Questions:
    found: Questions = {}
    for name, (file, words, surfaces) in FILES.items():
        found[f"data/{name}"] = lambda name=name, file=file, words=words, surfaces=surfaces: imported(
            DATA / file, words, surfaces, work / name
        )
    found["data/loops/diagnose"] = lambda: loops(work / "loops")
    found["data/cycles/diagnose"] = lambda: cycles(work / "cycles")
    for name in ("sma_heating_step", "sma_force_pulse_heating"):
        found[f"data/{name}/diagnose"] = lambda name=name: transient(name, work / "transient")
    return found


def _csv(mapping: str) -> tuple[str, ...]:
    return ("--format", "csv", "--map", mapping)


_FORC, _MAT = ("--format", "forc"), ("--format", "mat", "--map", "ferrite_nested")
_LOOPS, _POSITIVE = "ferroelectric_loops/RMN_TRAP_SLOW.dat", ("positive",)
FILES: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    "hchb_forc": ("forc_magnetic/hchb_forc", _FORC, ("table", "positive")),
    "MSM33": ("forc_magnetic/MSM33-55-1_d330.forc", _FORC, ("table", "positive")),
    "UB199BF": ("forc_magnetic/UB199BF", _FORC, ("table",)),
    "ferrite_H": ("ferrite_nested/H_MnZn_HP_ferrite.mat", _MAT, _POSITIVE),
    "ferrite_B": ("ferrite_nested/B_MnZn_HP_ferrite.mat", _MAT, ()),
    **{f"loops_{k}": (_LOOPS, _csv(f"ferroelectric_loops:{k}"), _POSITIVE) for k in (1, 2, 6)},
    **{
        f"flexinol_{p}": (
            f"flexinol_isobaric/filtered_data_{p}MPa.txt",
            _csv("flexinol_isobaric"),
            ("table",),
        )
        for p in (50, 100, 150)
    },
    "cycles": ("sma_cycles/cycles.txt", _csv("sma_cycles"), ()),
    "cycles_contraction": ("sma_cycles/cycles.txt", _csv("sma_cycles_contraction"), ()),
    **{f"force_{k}": (f"sma_force_pulse/AB{k}.csv", _csv("sma_force_pulse"), ()) for k in (0, 1, 2)},
    **{
        f"force_heating_{k}": (f"sma_force_pulse/AB{k}.csv", _csv("sma_force_pulse_heating"), ())
        for k in (0, 1, 2)
    },
    **{f"thin_{k}": (f"sma_force_runs/AB{k}_thin.csv", _csv("sma_force_pulse"), ()) for k in (5, 7)},
    "heating_step": ("sma_heating_step/step.csv", _csv("sma_heating_step"), ()),
    **{
        f"isobaric_1_{p}": (f"sma_isobaric/cal_sample_1/{p} MPa.txt", _csv("sma_isobaric_1"), ("best",))
        for p in (7, 50, 150, 200)
    },
    **{
        f"isobaric_2_{p}": (f"sma_isobaric/cal_sample_2/{p} MPa.txt", _csv("sma_isobaric_2"), ("positive",))
        for p in (7, 50, 100, 200, 300, 400)
    },
    **{
        f"bumps_{k}": (f"sma_nested_bumps/ele_hys_{k}.txt", _csv("sma_nested_bumps"), ()) for k in range(1, 6)
    },
    "staircase": ("sma_staircase/test.csv", _csv("sma_staircase"), ("best", "positive")),
}


def imported(file: Path, words: tuple[str, ...], surfaces: tuple[str, ...], folder: Path) -> Answer:
    """A file of others: its data, its warnings, and models of one half verified on the other."""
    run = folder / "imported.run.sqlite"
    folder.mkdir(parents=True, exist_ok=True)
    said = ask("import", file, *words, "-o", run, "--force")
    if not run.is_file():
        return {"said": _nameless(said)}
    models = {surface: _fitted(run, surface, folder / surface, words) for surface in surfaces}
    more = {"calibrate": ask("calibrate", run), "models": models}
    return {"said": _nameless(said), "table": table(run, whole=True)} | more


def _fitted(run: Path, surface: str, kept: Path, words: tuple[str, ...]) -> Answer:
    halves = words == _FORC and surface == "table"
    fit, judge = (("--select", f"curve%2=={k}") if halves else () for k in (0, 1))
    kept = kept.with_suffix(".model.json")
    said = ask("identify", run, "--surface", surface, *fit, "-o", kept, "--force")
    if not kept.is_file():
        return {"said": said}
    return {"said": said, "model": model(kept), "verify": ask("verify", kept, run, *judge)}


def _nameless(said: dict) -> dict:
    """Remove the paths of the data."""
    return {k: v.replace(f"{DATA}/", "") if isinstance(v, str) else v for k, v in said.items()}


def loops(folder: Path) -> Answer:
    """A model of fast loops, diagnosed on slow ones."""
    runs = [folder / f"{k}.run.sqlite" for k in (6, 1, 2)]
    folder.mkdir(parents=True, exist_ok=True)
    for run in runs:
        table_number = run.name.partition(".")[0]
        must("import", DATA / _LOOPS, *_csv(f"ferroelectric_loops:{table_number}"), "-o", run, "--force")
    kept = folder / "fast.model.json"
    must("identify", runs[0], "--surface", "positive", "-o", kept, "--force")
    return ask("diagnose", kept, "--train", *runs, "--nulls", 40)


def cycles(folder: Path) -> Answer:
    """The first cycles of a wire, and later ones as held-out data."""
    lines = (DATA / "sma_cycles" / "cycles.txt").read_text(encoding="utf-8").splitlines()
    folder.mkdir(parents=True, exist_ok=True)
    runs = []
    for name, rows in _PIECE.items():
        piece = folder / f"{name}.txt"
        piece.write_text("\n".join(lines[rows]) + "\n", encoding="utf-8")
        runs.append(folder / f"{name}.run.sqlite")
        must("import", piece, *_csv("sma_cycles_contraction"), "-o", runs[-1], "--force")
    kept = folder / "early.model.json"
    must("identify", runs[0], "--surface", "positive", "-o", kept, "--force")
    return ask("diagnose", kept, "--train", runs[0], "--held-out", runs[1], "--nulls", 40)


def transient(mapping: str, folder: Path) -> Answer:
    """Temperature under one heating."""
    file = {"sma_heating_step": "sma_heating_step/step.csv"}.get(mapping, "sma_force_pulse/AB0.csv")
    run = folder / f"{mapping}.run.sqlite"
    folder.mkdir(parents=True, exist_ok=True)
    must("import", DATA / file, *_csv(mapping), "-o", run, "--force")
    return ask("diagnose", "--transient", run, "--nulls", 40)


# --- the names of ``import smarig`` -------------------------------------------------------------------------


def _walk(low: float, high: float) -> np.ndarray:
    steps = np.random.default_rng(11).normal(0, (high - low) / 8, 3000)
    there = np.abs((np.cumsum(steps) - low) % (2 * (high - low)) - (high - low))
    return low + there


def _operator(wire, low: float, high: float) -> Answer:
    y = wire.simulate(_walk(low, high))
    after = [float(wire.step(u)) for u in np.linspace(low, high, 9)]
    back = [float(wire.step(low + 0.4 * (high - low)))]
    wanted = np.linspace(after[4], after[8], 7)  # what can be reached from below
    found = [float(wire.inverse(float(target))) for target in wanted]
    return {"walk": digest(y.tolist()), "some": thinned(y.tolist()), "steps": after + back, "inverse": found}


def measure() -> Answer:
    """Relays with signed mass."""
    import smarig

    rng = np.random.default_rng(12)
    ends = np.sort(rng.uniform(0, 100, (60, 2)), axis=1)
    return _operator(smarig.Preisach.from_measure(ends[:, 1], ends[:, 0], rng.uniform(0, 1, 60)), 0.0, 100.0)


def fod_table() -> Answer:
    """Reversal curves as measured."""
    import smarig

    nodes = np.linspace(0, 100, 9)
    y = np.array([[_sloped(a, b) if b <= a else np.nan for b in nodes] for a in nodes])
    return _operator(smarig.Preisach.from_table(nodes, nodes, y), 0.0, 100.0)


def _sloped(a: float, b: float) -> float:
    return float(np.tanh((a - 40) / 30) + np.tanh((b - 20) / 30) * (1.2 + a / 100))


def surface() -> Answer:
    """A surface of the thesis's family."""
    import smarig

    x = (0.0394, -43.0, 0.1034, 269.0, 0.0764, -23.6)
    one = smarig.FodSurface(
        form="exponential", x=x, lower=0.0, upper=174.1, y_lower=0.0, y_upper=12.54, unit="mm"
    )
    return _operator(smarig.Preisach.from_surface(one), 0.0, 174.1)


def in_python(folder: Path) -> Answer:
    """A notebook's way: run, load, identify, diagnose."""
    import smarig

    folder.mkdir(parents=True, exist_ok=True)
    out, judge, kept = (folder / n for n in ("a.run.sqlite", "b.run.sqlite", "a.model.json"))
    smarig.run("first_order_descending", rig="one_wire_twin", out=out, seed=9, force=True)
    smarig.run("validation", rig="one_wire_twin", out=judge, seed=9, force=True, points=3)
    run = smarig.load_run(out)
    made = smarig.identify(run, surface="exponential").model
    made.save(kept, force=True)
    found = smarig.diagnose(smarig.load_model(kept), [run], [smarig.load_run(judge)], nulls=40)
    return {"model": model(kept), "runs": [table(out), table(judge)], "text": found.text()}
