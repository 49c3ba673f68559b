"""The steps that an interruption left unfinished, and the numbers of the attempts that repeat them."""

from smarig.core import Hold, StepResult, Waveform
from smarig.record import Recorder, Run
from smarig.runner.resume.resume_plan import RE_ESTABLISH, ResumePlan


def interrupted_rows(run: Run, plan: ResumePlan) -> list[tuple]:
    """Rows of steps that have samples but no row because the process was killed. They have no settled position."""
    recorded_indices = {s.index for s in run.steps}
    pending = plan.replayed.pending
    rows = []
    for index, where in run.step_rows.items():
        if index < 0 or index in recorded_indices:
            continue
        t_s = run["t_s"][where]
        begin_s, end_s = float(t_s[0]) - float(run.info.period_s or 0.0), float(t_s[-1])
        in_restore_path = _in_restore_path(run, index)
        branch = (
            RE_ESTABLISH
            if in_restore_path
            else pending.branch
            if isinstance(pending, Hold | Waveform)
            else ""
        )
        target = pending.target if isinstance(pending, Hold) and not in_restore_path else None
        attempt = 0 if in_restore_path else _next_attempt(run)
        rows.append((index, attempt, 1, branch, target, begin_s, end_s, "interrupted", None, t_s.size))
    return rows


def _in_restore_path(run: Run, index: int) -> bool:
    """Whether a step belonged to an earlier path back."""
    restores = [(int(e.data["first_step"]), int(e.data["holds"])) for e in run.events if e.kind == "resumed"]
    return any(first <= index < first + holds for first, holds in restores)


def _next_attempt(run: Run) -> int:
    """Number of attempts of the step after the last valid one."""
    last = max((s.index for s in run.steps if not s.void), default=-1)
    after = [s for s in run.steps if s.index > last and s.branch != RE_ESTABLISH]
    return 1 + max((s.attempt for s in after), default=-1)


def attempts(run: Run, plan: ResumePlan, interrupted: list[tuple]) -> dict[int, int]:
    """The next attempt by number of the step in its protocol, if it is not the first."""
    valid = [s for s in run.steps if not s.void]
    attempt_number = _next_attempt(run) + any(row[3] != RE_ESTABLISH for row in interrupted)
    before = {k: s.attempt + 1 for k, s in enumerate(valid)} if plan.start_over else {}
    return {**before, len(valid): attempt_number} if plan.start_over else {0: attempt_number}


class AttemptRecorder:
    """The recorder of a resumed run: numbers attempts and marks the path back as void."""

    def __init__(self, recorder: Recorder, attempts: dict[int, int]) -> None:
        self.sample, self.event, self.suspect = recorder.sample, recorder.event, recorder.suspect
        self._recorder, self._attempts, self._done = recorder, attempts, 0

    def step(self, result: StepResult, *, branch: str, target: float | None) -> None:
        """Record a finished step."""
        if branch == RE_ESTABLISH:
            self._recorder.step(result, branch=branch, target=None, void=True)
            return
        attempt = self._attempts.get(self._done, 0)
        self._done += 1
        self._recorder.step(result, branch=branch, target=target, attempt=attempt)
