#ifdef DEVICE_encoder_daq
#include "../core/encoder_daq.h"
#include "device.h"
#include "hal.h"

static struct encoder_daq daq;

void device_boot(uint32_t boot_count)
{
    encoder_daq_boot(&daq, boot_count);
    encoder_daq_now(&daq, hal_counts());
}

uint16_t device_period_ms(void)
{
    return daq.settings[DAQ_PERIOD - DAQ_SETTINGS_FIRST];
}

void device_begin_tick(void)
{
    hal_mark_tick();
}

void device_end_tick(void)
{
    struct encoder_daq_inputs in;
    int32_t unused;
    hal_measure(&in.raw_counts, &unused, &in.ambient, &in.hardware);
    encoder_daq_tick(&daq, &in);
}

uint16_t device_answer(const uint8_t *request, uint16_t n, uint8_t *reply, uint16_t room)
{
    encoder_daq_now(&daq, hal_counts());
    return encoder_daq_answer(&daq, FRAMING, DAQ_DEVICE_DEFAULT_ADDRESS, request, n, reply, room);
}

#else
typedef int encoder_daq_is_not_built; /* ISO C requires a declaration in every file */
#endif
