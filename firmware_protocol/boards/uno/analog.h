/* The ADC: the supply of the wire, and the ambient temperature from a thermistor. */
#ifndef UNO_ANALOG_H
#define UNO_ANALOG_H

#include <stdint.h>

void analog_start(void);

/* Every millisecond, from the interrupt: takes a conversion and starts the next one. */
void analog_step(void);

uint16_t analog_supply_mV(void);

/* In 0.01 degC; NO_AMBIENT if no thermistor is connected. */
int16_t analog_ambient(void);

#endif
