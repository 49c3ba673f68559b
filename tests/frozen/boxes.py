"""Questions about sealed boxes: the recorded data of each, and everything computed from them."""

from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from frozen.asking import Answer, ask, model, must, positions, table, thinned

SEED, BOXES, NULLS = 20261, 50, 60
DIAGNOSED = 6  # boxes whose diagnosis is kept; the success of the diagnosis is measured by benchmarks


def sealed(number: int, folder: Path) -> tuple[str, str]:
    """Write a box into a folder; returns what is left out of the catalogue, and the hash of its label.

    The only place here that imports anything but ``smarig`` itself: the generator of boxes has no command.
    """
    from benchmarks.boxes import draw_box, write_box

    box = draw_box(SEED, number)
    return box.left_out, write_box(box, folder).commitment


class Box:
    """One box, opened at its first question."""

    def __init__(self, number: int, folder: Path) -> None:
        self._number, self._folder = number, folder

    def questions(self) -> Mapping[str, Callable[[], Answer]]:
        """The questions by their names."""
        diagnosed = {"diagnose": self.diagnose} if self._number < DIAGNOSED else {}
        return diagnosed | {
            "runs": self.runs,
            "identify": self.identify,
            "best": self.best,
            "exponential": self.exponential,
            "verify": lambda: ask("verify", self._positive, *self._held_out),
            "certify": lambda: ask("certify", self._positive),
            "simulate": self.simulate,
        }

    def runs(self) -> Answer:
        """What was recorded, and the hash of what is hidden."""
        left_out, label = self._opened
        runs = {f"{run.parent.name}/{run.name}": table(run) for run in (*self._train, *self._held_out)}
        return {"left_out": left_out, "label": label, **runs}

    def identify(self) -> Answer:
        """The positive measure."""
        return {"said": self._identified, "model": model(self._positive)}

    def best(self) -> Answer:
        """The surface that predicts best."""
        return self._with_surface("best")

    def exponential(self) -> Answer:
        """The thesis's surface."""
        return self._with_surface("exponential")

    def simulate(self) -> Answer:
        """The model along a run that it has not seen."""
        out = self._folder / "simulated.run.sqlite"
        said = ask("simulate", self._positive, "--along", self._held_out[0], "-o", out, "--force")
        return {"said": said, "table": table(out), "positions": thinned(positions(out), 40)}

    def diagnose(self) -> Answer:
        """What the model gets wrong, and what the extended one does."""
        out, left_out = self._folder / "diagnosis", self._opened[0]
        words = [*("--without", left_out)] if left_out else []
        given = [*_each("--train", self._train), *_each("--held-out", self._held_out), *words]
        how = ("--nulls", NULLS, "--seed", self._number, "-o", out, "--force")
        said = ask("diagnose", self._positive, *given, *how)
        extended = out / "extended.model.json"
        if not extended.is_file():
            return {"said": said}
        return {"said": said, "model": model(extended), "verify": ask("verify", extended, *self._held_out)}

    def _with_surface(self, surface: str) -> Answer:
        out = self._folder / f"{surface}.model.json"
        said = ask("identify", *self._train, "--surface", surface, "-o", out, "--force")
        return {"said": said, "model": model(out)} if out.is_file() else {"said": said}

    @cached_property
    def _opened(self) -> tuple[str, str]:
        self._folder.mkdir(parents=True, exist_ok=True)
        return sealed(self._number, self._folder)

    @property
    def _train(self) -> list[Path]:
        return self._part("train")

    @property
    def _held_out(self) -> list[Path]:
        return self._part("held_out")

    def _part(self, name: str) -> list[Path]:
        assert self._opened
        return sorted((self._folder / name).glob("*.run.sqlite"))

    @cached_property
    def _identified(self) -> dict[str, Any]:
        out = self._folder / "positive.model.json"
        return must("identify", *self._train, "--surface", "positive", "-o", out, "--force")

    @property
    def _positive(self) -> Path:
        return self._folder / Path(self._identified["model"]).name


def _each(option: str, paths: list[Path]) -> list[object]:
    return [word for path in paths for word in (option, path)]


def questions(work: Path) -> dict[str, Callable[[], Answer]]:
    """Of all boxes."""
    boxes = {f"box/{k:02}": Box(k, work / f"box/{k:02}") for k in range(BOXES)}
    return {f"{name}/{what}": q for name, box in boxes.items() for what, q in box.questions().items()}
