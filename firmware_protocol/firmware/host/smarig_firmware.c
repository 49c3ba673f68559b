#include "smarig_firmware.h"

#include "../core/amplifier.h"
#include "../core/encoder_daq.h"

size_t amp_size(void)
{
    return sizeof(struct amplifier);
}

void amp_boot(void *amp, uint32_t boot_count)
{
    amplifier_boot(amp, boot_count);
}

void amp_tick(void *amp, int32_t current_uA, int32_t voltage_uV, int16_t temperature, uint16_t hardware)
{
    const struct amplifier_inputs in = {current_uA, voltage_uV, temperature, hardware};
    amplifier_tick(amp, &in);
}

int32_t amp_output(const void *amp)
{
    return ((const struct amplifier *)amp)->output_uA;
}

uint16_t amp_answer(void *amp, int framing, uint8_t address, const uint8_t *request, uint16_t n, uint8_t *reply,
                    uint16_t room)
{
    return amplifier_answer(amp, (uint8_t)framing, address, request, n, reply, room);
}

size_t daq_size(void)
{
    return sizeof(struct encoder_daq);
}

void daq_boot(void *daq, uint32_t boot_count)
{
    encoder_daq_boot(daq, boot_count);
}

void daq_tick(void *daq, int32_t raw_counts, int16_t ambient, uint16_t hardware)
{
    const struct encoder_daq_inputs in = {raw_counts, ambient, hardware};
    encoder_daq_tick(daq, &in);
}

void daq_now(void *daq, int32_t raw_counts)
{
    encoder_daq_now(daq, raw_counts);
}

uint16_t daq_answer(void *daq, int framing, uint8_t address, const uint8_t *request, uint16_t n, uint8_t *reply,
                    uint16_t room)
{
    return encoder_daq_answer(daq, (uint8_t)framing, address, request, n, reply, room);
}
