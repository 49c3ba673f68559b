/*
 * I2C at 400 kHz, by interrupts. Every millisecond a round reads the INA219 and the AS5600; at its end the current loop
 * takes a step. A device that does not answer is set up again and makes only its own readings invalid.
 */
#ifndef UNO_BUS_H
#define UNO_BUS_H

#include <stdbool.h>
#include <stdint.h>

void bus_start(void);

/* Every millisecond, from the interrupt. */
void bus_start_round(void);

/* Position since boot, in counts over all turns; a bad reading changes nothing. */
int32_t bus_position(void);

/* Whether the AS5600 answers and sees its magnet. */
bool bus_position_is_valid(void);

/* Whether the position jumped by more than a quarter of a turn since the last call: turns may have been lost. */
bool bus_position_jumped(void);

/* Whether the INA219 answers. */
bool bus_current_is_valid(void);

#endif
