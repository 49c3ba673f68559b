"""A controller of your own: what it does goes here, in one or two sentences.

    s = k (e + ∫ e dt / T),        e = wanted − position

Here: proportional and integral action, in kelvin of steady temperature. Replace it by your law.

Look at it:  smarig list controllers ./my_controller.py --settings
Run it:      smarig track MODEL --reference ramps --controller ./my_controller.py --rig one_wire_twin -o mine.run.sqlite
"""

from smarig.control import Controller, ControllerModel, ReferenceFunction


def my_controller(
    controller_model: ControllerModel,  # what it may know: the rig's setup, the model, its reach; never the rig itself
    reference: ReferenceFunction,  # wanted(t_s): the position that is wanted at a time of the samples' clock
    *,  # what follows are numbers: --controller-set lead_s=0.5; each with a default that has a point
    gain_share: float = 15.0,
    integral_s: float = 2.0,
    lead_s: float = 0.0,
) -> Controller:
    """PI on the position error: the first line is what `smarig list controllers` shows, and these with --settings.

    gain_share (1): gain, as a multiple of the range of temperatures over that of positions
    integral_s (s): integral time T_i: in it a steady error is answered once more
    lead_s (s): how far ahead what is wanted is looked at; 0 looks at now
    """
    setup, (low, high) = controller_model.setup, controller_model.reach
    gain = gain_share * (setup.upper_K - setup.lower_K) / (high - low)  # kelvin per unit of position
    source_K = sum_K = 0.0
    while True:  # until the loop closes it: a controller that ends early is a fault
        # A tick: a current goes out, A, and the sample of that tick comes back. The loop clips what the rig's limits
        # forbid; ``sample.current_command_A`` is what was left of it, ``sample.current_A`` what was measured.
        sample = yield setup.current_for(source_K)
        error = reference(sample.t_s + lead_s) - sample.position
        unlimited_K = sum_K + gain * error
        source_K = min(max(unlimited_K, setup.lower_K), setup.upper_K)
        if (unlimited_K - source_K) * error <= 0:  # no summing up of what cannot be had
            sum_K += gain * error * setup.period_s / integral_s
