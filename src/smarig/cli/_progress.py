"""Progress with time left while a protocol runs; quiet when nobody looks (stderr is not a terminal)."""

import sys

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from smarig.command import StepResult
from smarig.runner.preview import Preview
from smarig.sample import Sample


class ProgressLine:
    """A listener that draws one line; ``with ProgressLine(preview) as p`` and hand p to the runner."""

    _EVERY = 50  # samples between redraws: the tick must not wait for a terminal

    def __init__(self, expected: Preview, quiet: bool = False) -> None:
        self._expected = max(expected.duration_s, 1e-9)
        self._steps = expected.steps
        self._start_s: float | None = None
        self._count = 0
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("{task.fields[note]}"),
            TimeRemainingColumn(),
            console=Console(stderr=True),
            disable=quiet or not sys.stderr.isatty(),
            transient=True,
        )
        self._task = self._progress.add_task(expected.protocol, total=self._expected, note="")

    def __enter__(self) -> "ProgressLine":
        self._progress.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._progress.stop()

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Move the bar now and then."""
        if self._start_s is None:
            self._start_s = s.t_s
        self._count += 1
        if self._count % self._EVERY == 0 and not self._progress.disable:
            note = f"{s.current_A:+.3f} A  {input_value:+.1f} K  {s.counts} counts  {(step or 0) + 1}/{self._steps}"
            self._progress.update(self._task, completed=s.t_s - self._start_s, note=note)

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Nothing to draw."""

    def event(self, t_s: float, kind: str, text: str, *, level: str = "info", **data) -> None:
        """Nothing to draw."""
