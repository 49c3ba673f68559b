#include "devices.h"

#include "../../firmware/core/amplifier.h"
#include "../../firmware/core/encoder_daq.h"
#include "../../firmware/core/exchange.h"
#include "../../firmware/core/words.h"
#include "analog.h"
#include "bus.h"
#include "current_loop.h"
#include "led.h"
#include "stop.h"

/* From the start of a tick to the end of its measurement: the current loop needs 20 ms. */
enum { SETTLE_ms = 25, MEASURE_ms = 8 };

/* What trips as over-current at the end of a tick, and twice its margin, closes the gate within a millisecond. */
enum { CUT_MARGIN = 10 };

static struct amplifier amp;
static struct encoder_daq daq;

static struct timing {
    uint16_t began_ms, period_ms;
} amp_timing, daq_timing;
static enum { WAITING, SETTLING, MEASURING } phase;

void devices_boot(uint32_t boot_count)
{
    amplifier_boot(&amp, boot_count);
    encoder_daq_boot(&daq, boot_count);
    encoder_daq_now(&daq, bus_position());
}

/* Whether a period has passed. A new period restarts the time; otherwise it causes a burst of ticks. */
static bool due(struct timing *timing, uint16_t period_ms, uint16_t now_ms)
{
    if (timing->period_ms != period_ms) {
        timing->period_ms = period_ms;
        timing->began_ms = now_ms;
    }
    if ((uint16_t)(now_ms - timing->began_ms) < period_ms)
        return false;
    timing->began_ms = (uint16_t)(timing->began_ms + period_ms);
    return true;
}

/* A new current flows from the next tick on; switching off is immediate. */
static void switch_off_at_once(void)
{
    if (amp.output_uA == 0)
        current_loop_drive(0, 0, 0, 0);
}

static void begin_amplifier_tick(void)
{
    const int32_t most_uA = words_i32(AMPLIFIER_SETTING(&amp, AMP_CURRENT_MAX));
    if (stop_is_open())
        current_loop_off();
    else
        current_loop_drive(amp.output_uA, words_u32(AMPLIFIER_SETTING(&amp, AMP_RESISTANCE_MIN)), analog_supply_mV(),
                           most_uA + most_uA / CUT_MARGIN);
}

static void end_amplifier_tick(void)
{
    const struct measurement found = current_loop_end_measurement();
    const bool saturated = amp.output_uA < 0 || (amp.output_uA > 0 && found.saturated);
    const struct amplifier_inputs in = {
        found.current_uA,
        found.voltage_uV,
        AMP_RING_TEMPERATURE_NONE,
        (uint16_t)((saturated ? AMPLIFIER_SATURATED : 0) | (stop_was_open() ? AMPLIFIER_STOP_OPEN : 0)),
    };
    amplifier_tick(&amp, &in);
    switch_off_at_once();
}

static bool tick_amplifier(uint16_t now_ms)
{
    if (phase == WAITING) {
        if (!due(&amp_timing, *AMPLIFIER_SETTING(&amp, AMP_PERIOD), now_ms))
            return false;
        begin_amplifier_tick();
        phase = SETTLING;
        return true;
    }
    const uint16_t since_ms = (uint16_t)(now_ms - amp_timing.began_ms);
    const uint16_t half_ms = amp_timing.period_ms / 2;
    const uint16_t settle_ms = half_ms < SETTLE_ms ? half_ms : SETTLE_ms;
    const uint16_t measure_ms = settle_ms / 2 < MEASURE_ms ? settle_ms / 2 : MEASURE_ms;
    if (phase == SETTLING && since_ms + measure_ms >= settle_ms) {
        current_loop_begin_measurement();
        phase = MEASURING;
        return true;
    }
    if (phase == SETTLING || since_ms < settle_ms)
        return false;
    end_amplifier_tick();
    phase = WAITING;
    return true;
}

static bool tick_daq(uint16_t now_ms)
{
    if (!due(&daq_timing, daq.settings[DAQ_PERIOD - DAQ_SETTINGS_FIRST], now_ms))
        return false;
    const struct encoder_daq_inputs in = {
        bus_position(),
        analog_ambient(),
        (uint16_t)((bus_position_jumped() ? ENCODER_DAQ_ILLEGAL_STEP : 0) |
                   (bus_position_is_valid() ? 0 : ENCODER_DAQ_NO_SUPPLY)),
    };
    encoder_daq_tick(&daq, &in);
    return true;
}

bool devices_tick(uint16_t now_ms)
{
    const bool amplifier = tick_amplifier(now_ms);
    const bool encoder = tick_daq(now_ms);
    return amplifier || encoder;
}

bool devices_are_measuring(void)
{
    return phase != WAITING;
}

uint16_t devices_answer(uint8_t *buffer, uint16_t n)
{
    uint16_t length =
        amplifier_answer(&amp, FRAMING_RTU, AMP_DEVICE_DEFAULT_ADDRESS, buffer, n, buffer, RTU_REPLY_ROOM);
    switch_off_at_once();
    if (length)
        return length;
    encoder_daq_now(&daq, bus_position());
    return encoder_daq_answer(&daq, FRAMING_RTU, DAQ_DEVICE_DEFAULT_ADDRESS, buffer, n, buffer, RTU_REPLY_ROOM);
}

void devices_show(uint16_t now_ms)
{
    const struct led_state now = {
        amp.state,
        amp.trip,
        amp.output_uA != 0,
        !bus_current_is_valid() || !bus_position_is_valid(),
    };
    led_show(now, now_ms);
}
