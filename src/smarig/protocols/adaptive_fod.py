"""First-order descending data at inputs that are chosen from the results so far (§3.4, §9.2).

A chooser, given by the code that runs the protocol, decides what to measure. The protocol enforces range and time.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol as Interface

from smarig.core import Hold, Mark, Protocol, Settled, StepResult, StepVerdict, UsageError
from smarig.protocols._setup import Setup


@dataclass(frozen=True, slots=True)
class HoldResult:
    """A finished hold: the requested input and the mean counts of its window.

    ``settled`` is False for a hold that timed out. Its reading is not a settled one.
    """

    input_K: float
    counts: float
    counts_sd: float
    n: int
    settled: bool


@dataclass(frozen=True, slots=True)
class NextInputs:
    """The inputs to hold next, in order. No inputs mean that the chooser has finished.

    ``predicted_share`` is the predicted rms error of y(α, β) over the triangle from the present data, as a share of
    the output range. It is NaN if the chooser gives no prediction.
    """

    inputs_K: tuple[float, ...]
    predicted_share: float = math.nan


class Chooser(Interface):
    """A function that chooses the next inputs from all results so far. It keeps no state of its own."""

    def __call__(self, setup: Setup, results: Sequence[HoldResult], settle: Settled, /) -> NextInputs:
        """Return the next inputs. ``results`` starts with a hold in negative saturation."""
        ...


def adaptive_fod(
    setup: Setup,
    chooser: Chooser | None = None,
    *,
    target_share: float = 0.003,
    longest_h: float = 2.0,
    settle: Settled | None = None,
) -> Protocol:
    """First-order descending (FOD) data at inputs chosen during the run, until the predicted error is small enough.

    The run starts with both saturations and continues with the inputs of the chooser. It ends when the predicted rms
    error of y(α, β) is below ``target_share`` of the output range, after ``longest_h`` of rig time, or when the
    chooser has finished. A hold that does not settle is marked, and the run continues. ``smarig run`` supplies a
    chooser. Without one, the protocol repeatedly halves the segments of a partition.
    """
    if not 0 < target_share < 1:
        raise UsageError(
            f"target_share must lie between 0 and 1 (share of the output range), got {target_share:g}."
        )
    if not 0 < longest_h <= 1000:
        raise UsageError(f"longest_h must lie between 0 and 1000 hours, got {longest_h:g}.")
    return _adaptive(setup, chooser or halving, target_share, 3600 * longest_h, settle or Settled())


def halving(setup: Setup, results: Sequence[HoldResult], _settle: Settled) -> NextInputs:
    """A chooser that ignores the results: FOD curves over even partitions of 4, 8 and 16 segments in turn."""
    hold_count = 2  # both saturations
    for segments in (4, 8, 16):
        levels = [setup.at(k / segments) for k in range(segments + 1)]
        for k in range(1, segments + 1):
            if hold_count >= len(results):
                return NextInputs((levels[k], *reversed(levels[:k])))
            hold_count += k + 1
    return NextInputs(())


def _adaptive(
    setup: Setup, chooser: Chooser, target_share: float, longest_s: float, settle: Settled
) -> Protocol:
    yield Mark("adaptive first-order descending", {"chooser": getattr(chooser, "__name__", repr(chooser))})
    results: list[HoldResult] = []
    start_s = math.nan
    choice = NextInputs((setup.lower_K, setup.upper_K))
    while choice.inputs_K:
        for input_K in choice.inputs_K:
            _check(setup, input_K)
            result = yield Hold(
                setup.current_for(input_K), settle, target=input_K, branch=_branch(results, input_K)
            )
            results.append(_hold_result(input_K, result))
            start_s = result.t_start_s if math.isnan(start_s) else start_s
            if result.t_end_s - start_s >= longest_s:
                yield Mark("time is up", {"holds": len(results), "longest_h": longest_s / 3600})
                return
        choice = chooser(setup, tuple(results), settle)
        share = choice.predicted_share
        mark_data = {"holds": len(results), "inputs_K": list(choice.inputs_K)}
        yield Mark("chosen", mark_data if math.isnan(share) else mark_data | {"predicted_share": share})
        if share <= target_share:
            yield Mark("target reached", {"holds": len(results), "predicted_share": share})
            return


def _branch(results: Sequence[HoldResult], input_K: float) -> str:
    """The branch of a hold, relative to the one before it, as stored in the record of its step."""
    if len(results) < 2:
        return "saturate"
    return "rise" if input_K > results[-1].input_K else "fall"


def _check(setup: Setup, input_K: float) -> None:
    if not setup.lower_K - 1e-6 <= input_K <= setup.upper_K + 1e-6:
        raise UsageError(
            f"The chooser of adaptive_fod requested {input_K:g} K, which is outside the rig's range "
            f"{setup.lower_K:g}…{setup.upper_K:g} K above ambient."
        )


def _hold_result(input_K: float, result: StepResult | None) -> HoldResult:
    if not isinstance(result, StepResult):
        raise UsageError(
            "adaptive_fod chooses its inputs from results. Run it on a rig or a twin; its commands cannot be listed "
            "in advance."
        )
    return HoldResult(
        input_K, result.counts, result.counts_sd, result.n, result.verdict is StepVerdict.SETTLED
    )
