"""Questions about old files: do they open, report, export, resume, verify and simulate with the same
numbers?

The files are in ``old_files``, most of them compressed. Each question works on a copy.
"""

import json
import lzma
import os
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

from frozen.asking import Answer, ask, digest, model, must, table

FILES = Path(__file__).with_name("old_files")
Questions = dict[str, Callable[[], Answer]]
FAST = ("--speed", 1e6)  # some were begun at a speed that a person can watch
ALONG = {"one_wire": "open_loop", "two_wire": "two_wire"}


def names(folder: str, ending: str) -> list[str]:
    """Of the files in a folder, packed or not."""
    found = {path.name.removesuffix(".xz") for path in (FILES / folder).iterdir()}
    return sorted(name.removesuffix(ending) for name in found if name.endswith(ending))


def unpacked(folder: str, to: Path) -> Path:
    """A folder of old files as it was: a copy, whose files may be written on."""
    for path in sorted((FILES / folder).rglob("*")):
        target = to / path.relative_to(FILES / folder)
        if path.is_file():
            target.parent.mkdir(parents=True, exist_ok=True)
            data = path.read_bytes()
            target.with_name(target.name.removesuffix(".xz")).write_bytes(
                lzma.decompress(data) if path.suffix == ".xz" else data
            )
    return to


def questions(work: Path) -> Questions:
    """All of them."""
    copy = cache(lambda folder: unpacked(folder, work / f"old/{folder}"))

    def run(name: str) -> Path:
        return copy("runs") / f"{name}.run.sqlite"

    found: Questions = {}
    for name in names("runs", ".run.sqlite"):
        found[f"old/run/{name}"] = lambda name=name: opened(run(name))
        found[f"old/resume/{name}"] = lambda name=name: resumed(run(name), copy("own"))
    for name in names("models", ".model.json"):
        found[f"old/model/{name}"] = lambda name=name: used(copy("models") / f"{name}.model.json", run)
    found["old/report"] = lambda: _reported(copy("models"), run)
    found["old/box"] = lambda: box(copy("box"))
    found["old/wires"] = lambda: wires(work / "old/histories")
    found["old/campaign"] = lambda: campaign(copy("campaign"))
    found["old/imports"] = lambda: imports(copy("imports"))
    found["old/own/rig"] = lambda: own_rig(copy("own"))
    for what in ("protocol", "controller", "effect"):
        found[f"old/own/{what}"] = lambda what=what: own(what, copy("own"), copy("models"))
    return found


def opened(run: Path) -> Answer:
    """What is in a run, its page, its sheet."""
    sheet, page = run.with_suffix(".csv"), run.with_suffix(".html")
    exported = ask("export", run, "--to", "csv", "-o", sheet, "--force")
    reported = ask("report", run, "-o", page, "--force")
    answer = {"table": table(run, whole=True), "export": exported, "report": reported}
    return answer | {"sheet": digest(list(sheet.read_bytes())), "page": page.stat().st_size > 10_000}


def resumed(run: Path, own_files: Path) -> Answer:
    """Resume an interrupted run; a finished run or a closed loop gives its error message."""
    copy = run.with_name(f"resumed_{run.name}")
    for suffix in ("", "-wal"):  # of a process that was killed
        if Path(f"{run}{suffix}").is_file():
            shutil.copy(f"{run}{suffix}", f"{copy}{suffix}")
    before = table(copy, whole=True)["meta"]
    words = [*FAST] if before.get("begun_with", {}).get("speed") else []
    if run.name.startswith("own_stopped"):
        words += ["--protocol", own_files / "my_protocol.py", "--effect", own_files / "my_effect.py"]
    return {"said": ask("resume", copy, *words), "table": table(copy, whole=True)}


def used(kept: Path, run: Callable[[str], Path]) -> Answer:
    """Read, certify, verify and simulate a model file."""
    data = json.loads(kept.read_text(encoding="utf-8"))
    along = ALONG.get(data["arrangement"], "forc") if data["rig"] else "forc"
    out = kept.with_suffix(".run.sqlite")
    simulated = ask("simulate", kept, "--along", run(along), "-o", out, "--force")
    answer = {
        "model": model(kept),
        "certify": ask("certify", kept),
        "verify": ask("verify", kept, run(along)),
        "simulate": simulated,
    }
    return answer | ({"table": table(out)} if out.is_file() else {})


def _reported(models: Path, run: Callable[[str], Path]) -> Answer:
    pair = [
        word
        for kind in ("exponential", "positive")
        for word in ("--model", models / f"one_wire_{kind}.model.json")
    ]
    page = models / "compared.html"
    answer = {"compared": ask("report", *pair, run("open_loop"), "-o", page, "--force")}
    for name in ("regulated", "tracked"):
        words = ("--model", models / "one_wire_exponential.model.json", run(name))
        answer[name] = ask("report", *words, "-o", models / f"{name}.html", "--force")
    return answer


def box(folder: Path) -> Answer:
    """A box that was diagnosed, and the extended model that came of it."""
    held_out = sorted((folder / "held_out").glob("*.run.sqlite"))
    train = sorted((folder / "train").glob("*.run.sqlite"))
    given, kept = folder / "positive.model.json", folder / "again.model.json"
    extended, out = folder / "diagnosis/extended.model.json", folder / "simulated.run.sqlite"
    return {
        "given": ask("verify", given, *held_out),
        "extended": ask("verify", extended, *held_out),
        "model": model(extended),
        "again": ask("identify", *train, "--surface", "positive", "-o", kept, "--force"),
        "simulate": ask("simulate", extended, "--along", held_out[0], "-o", out, "--force"),
        "table": table(out),
        "diagnosis": json.loads((folder / "diagnosis/diagnosis.json").read_text(encoding="utf-8")),
    }


def wires(folder: Path) -> Answer:
    """Histories are listed, and a run adds to its wire's."""
    unpacked("wires", folder)
    before = os.environ["SMARIG_HISTORY_DIR"]
    os.environ["SMARIG_HISTORY_DIR"] = str(folder)
    try:
        words = ("--set", "points=2", "--rig", "one_wire_twin", "-o", folder.with_name("worn.run.sqlite"))
        before_it = _worn()
        return {"before": before_it, "run": must("run", "validation", *words, "--force"), "after": _worn()}
    finally:
        os.environ["SMARIG_HISTORY_DIR"] = before


def _worn() -> dict[str, str]:
    """What is listed of each wire, but for when."""
    return {name: said.partition("; last used")[0] for name, said in ask("list", "wires")["wires"].items()}


def campaign(folder: Path) -> Answer:
    """Continue an interrupted campaign: finished runs are kept, the next is resumed, the rest is run."""
    words = ("--rig", "one_wire_twin", "--seed", 11, "--speed", 1e6, "--continue", "-o", folder / "runs")
    said = ask("run", folder / "two.toml", *words)
    runs = sorted((folder / "runs").glob("*.run.sqlite"))
    return {"said": said, "runs": {run.name: table(run, whole=True) for run in runs}}


def imports(folder: Path) -> Answer:
    """Tables and mappings that were written for smarig."""
    words = {
        "made.forc": ("--format", "forc"),
        "loop.csv": ("--format", "csv", "--map", folder / "my_map.toml", "--t0", 100, "--wire", "wire B"),
        "H_made.mat": ("--format", "mat", "--map", "ferrite_nested"),
        "open_loop.csv": ("--format", "csv", "--rig", "one_wire_twin"),
    }
    answer = {}
    for name, how in words.items():
        out = folder / f"{name}.run.sqlite"
        answer[name] = {"said": ask("import", folder / name, *how, "-o", out, "--force")}
        answer[name] |= {"table": table(out, whole=True)} if out.is_file() else {}
    return answer


def own_rig(folder: Path) -> Answer:
    """Rig, actuator and campaign files as ``smarig new`` wrote them, and an actuator as ``calibrate`` did."""
    out = folder / "rig.run.sqlite"
    wire = folder / "rig_of_calibrated.toml"
    text = (folder / "my_rig.toml").read_text(encoding="utf-8")
    wire.write_text(
        text.replace('actuator = "gorbet_one_wire"', 'actuator = "./calibrated.toml"'), encoding="utf-8"
    )
    answer = {
        "campaign": ask("run", folder / "my_campaign.toml", "--rig", folder / "my_rig.toml", "--dry-run")
    }
    for name, rig in (("new", folder / "my_rig.toml"), ("calibrated", wire)):
        said = ask("run", "validation", "--set", "points=2", "--rig", rig, "-o", out, "--force")
        answer[name] = {"said": said, "check": ask("check", rig)}
        answer[name] |= {"table": table(out)} if out.is_file() else {}
    return answer


def own(what: str, folder: Path, models: Path) -> Answer:
    """Python files of a person's own, as ``smarig new`` wrote them; they import from the package."""
    out, rig = folder / f"{what}.run.sqlite", ("--rig", "one_wire_twin", "--seed", 15)
    short = ("--set", "settle.window_s=1", "--set", "settle.timeout_s=6", "--set", "settle.approach_K=8")
    words = {
        "protocol": ("run", folder / "my_protocol.py", *short),
        "effect": ("run", "step_currents", "--set", "points=4", *short, "--effect", folder / "my_effect.py"),
        "controller": (
            *("track", models / "one_wire_exponential.model.json", "--reference", "ramps"),
            *("--set", "seconds=10", "--controller", folder / "my_controller.py"),
        ),
    }[what]
    said = ask(*words, *rig, "-o", out, "--force")
    return {"said": said, "table": table(out, whole=True)} if out.is_file() else {"said": said}


__all__ = ["FILES", "names", "questions", "unpacked"]
