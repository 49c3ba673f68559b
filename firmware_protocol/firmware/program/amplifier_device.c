#ifdef DEVICE_amplifier
#include "../core/amplifier.h"
#include "device.h"
#include "hal.h"

static struct amplifier amp;

void device_boot(uint32_t boot_count)
{
    amplifier_boot(&amp, boot_count);
    hal_drive(0);
}

uint16_t device_period_ms(void)
{
    return *AMPLIFIER_SETTING(&amp, AMP_PERIOD);
}

void device_begin_tick(void)
{
    hal_drive(amp.output_uA);
    hal_mark_tick();
}

/* A new current is applied at the next tick; switching off is immediate. */
static void switch_off_at_once(void)
{
    if (amp.output_uA == 0)
        hal_drive(0);
}

void device_end_tick(void)
{
    struct amplifier_inputs in;
    hal_measure(&in.current_uA, &in.voltage_uV, &in.temperature, &in.hardware);
    amplifier_tick(&amp, &in);
    switch_off_at_once();
}

uint16_t device_answer(const uint8_t *request, uint16_t n, uint8_t *reply, uint16_t room)
{
    const uint16_t length =
        amplifier_answer(&amp, FRAMING, AMP_DEVICE_DEFAULT_ADDRESS, request, n, reply, room);
    switch_off_at_once();
    return length;
}

#else
typedef int amplifier_is_not_built; /* ISO C requires a declaration in every file */
#endif
