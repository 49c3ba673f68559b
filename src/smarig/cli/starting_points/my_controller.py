"""A controller of your own. Describe it here in one or two sentences.

    s = k (e + ∫ e dt / T),        e = reference − position

This example has proportional and integral action, in kelvin of steady temperature. Replace it with your law.

List it:  smarig list controllers ./my_controller.py --settings
Run it:   smarig track MODEL --reference ramps --controller ./my_controller.py --rig one_wire_twin -o mine.run.sqlite
"""

from smarig.control import Controller, ControllerModel, ReferenceFunction


def my_controller(
    controller_model: ControllerModel,  # the rig's setup, the model and its output range; never the rig itself
    reference: ReferenceFunction,  # reference(t_s): the wanted position at a time of the samples' clock
    *,  # parameters follow, set by --controller-set lead_s=0.5; each needs a default with a decimal point
    gain_share: float = 15.0,
    integral_s: float = 2.0,
    lead_s: float = 0.0,
) -> Controller:
    """PI control of the position. `smarig list controllers` shows this line, and the lines below with --settings.

    gain_share (1): gain, as a multiple of the temperature range divided by the position range
    integral_s (s): integral time T_i
    lead_s (s): preview time of the reference; 0: no preview
    """
    setup, (low, high) = controller_model.setup, controller_model.reach
    gain = gain_share * (setup.upper_K - setup.lower_K) / (high - low)  # kelvin per unit of position
    source_K = sum_K = 0.0
    while True:  # until the loop closes the generator; a controller that ends earlier is an error
        # In each tick, yield a current in A and receive the sample of that tick. The loop clips the current to the
        # rig's limits: ``sample.current_command_A`` is the clipped command, ``sample.current_A`` the reading.
        sample = yield setup.current_for(source_K)
        error = reference(sample.t_s + lead_s) - sample.position
        unlimited_K = sum_K + gain * error
        source_K = min(max(unlimited_K, setup.lower_K), setup.upper_K)
        if (unlimited_K - source_K) * error <= 0:  # anti-windup: do not integrate while the output is limited
            sum_K += gain * error * setup.period_s / integral_s
