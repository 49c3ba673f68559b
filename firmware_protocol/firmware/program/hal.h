/* The hardware of the device, the only functions that know it. A board provides them; emulators stand in for it. */
#ifndef SMARIG_HAL_H
#define SMARIG_HAL_H

#include <stdint.h>

void hal_start(void);
void hal_drive(int32_t current_uA);

/* A tick has begun: what was last driven flows. */
void hal_mark_tick(void);

/* Current in uA and voltage in uV of the amplifier, or raw counts of the DAQ, whose second value is not used. */
void hal_measure(int32_t *first, int32_t *second, int16_t *temperature, uint16_t *hardware);
int32_t hal_counts(void);

#endif
