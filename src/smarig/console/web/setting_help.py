"""What the settings of the protocols mean, one sentence each, for people who fill in a form."""

_SETTLE = {
    "settle.band_counts": "Settled: the position stays within this many encoder counts, peak to peak, over the window.",
    "settle.window_s": "For how long the position has to stay within the band.",
    "settle.timeout_s": "A step that has not settled by then is marked as timed out, and the run continues.",
    "settle.approach_K": "The window starts when the predicted temperature is this close to its final value.",
}
_INPUTS = {
    "partition_K": "Temperatures above ambient at which the curves begin and are measured.",
    "points": "More points resolve the loop more finely and take longer.",
    "points_per_branch": "Steps on each rising and each falling branch.",
    "temperatures_K": "Temperatures above ambient to hold one after the other, in place of the profile.",
    "currents_A": "Currents to hold one after the other, in place of the profile.",
    "file": "A CSV file with a column temperature_K or current_A, in place of the profile.",
    "temperature": "A formula in t, in K above ambient, such as 87+60*sin(2*pi*t/600), in place of the profile.",
    "profile": "Shape of the temperature over the range of the rig.",
    "duration_s": "How long the formula or the change of load lasts.",
    "input_K": "Temperature above ambient that is held; without a value, half of the rig's range.",
    "lower_K": "Lower end of the cycles above ambient; without a value, that of the rig's range.",
    "upper_K": "Upper end of the cycles above ambient; without a value, that of the rig's range.",
    "reversals_K": "Temperatures above ambient at which a rise ends, in place of evenly spaced ones.",
    "rates_K_per_s": "Rates of the wire's temperature, in turn. With one rate only, the time constant stays unknown.",
}
_OTHERS = {
    "seed": "Chooses the random inputs: the same number gives the same inputs.",
    "curves": "Number of evenly spaced temperatures at which a rise ends.",
    "cycles": "Number of heating and cooling cycles.",
    "method": "planned: the wire's temperature decays as prescribed. thesis: the published currents.",
    "low": "Lower end of the minor loops, as a share of the range (0 to 1).",
    "high": "Upper end of the minor loops, as a share of the range (0 to 1).",
    "peak": "Upper end of the outer loop, as a share of the range (0 to 1).",
    "low_A": "Lower current of the minor loops; without a value, half of the largest that the limits allow.",
    "high_A": "Upper current of the minor loops; without a value, three quarters of the largest that the limits allow.",
    "loops": "Number of minor loops.",
    "loop_s": "Period of one loop. If it is short, the temperature lags behind the current and the loops drift.",
    "lead_s": "Time at the first load, in which the wire reaches its temperature.",
    "longest_h": "The run ends after this much rig time at the latest.",
    "target_share": "The run ends when the predicted error is below this share of the output range.",
}
SETTING_HELP = {**_SETTLE, **_INPUTS, **_OTHERS}
