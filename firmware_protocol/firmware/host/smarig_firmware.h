/* The firmware's two devices as a shared library, for tests and simulators on a PC. */
#ifndef SMARIG_FIRMWARE_H
#define SMARIG_FIRMWARE_H

#include <stddef.h>
#include <stdint.h>

/* The caller provides amp_size() or daq_size() bytes, aligned as by malloc.
 * `framing`: 0 an RTU frame, 1 a line with its \n. Returns the length of the reply, 0 for none. */
size_t amp_size(void);
void amp_boot(void *amp, uint32_t boot_count);
void amp_tick(void *amp, int32_t current_uA, int32_t voltage_uV, int16_t temperature, uint16_t hardware);
int32_t amp_output(const void *amp); /* uA that flows in the next tick */
uint16_t amp_answer(void *amp, int framing, uint8_t address, const uint8_t *request, uint16_t n, uint8_t *reply,
                    uint16_t room);

size_t daq_size(void);
void daq_boot(void *daq, uint32_t boot_count);
void daq_tick(void *daq, int32_t raw_counts, int16_t ambient, uint16_t hardware);
void daq_now(void *daq, int32_t raw_counts);
uint16_t daq_answer(void *daq, int framing, uint8_t address, const uint8_t *request, uint16_t n, uint8_t *reply,
                    uint16_t room);

#endif
