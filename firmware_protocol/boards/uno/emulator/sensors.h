/* INA219 and AS5600 on the I2C of a simavr MCU, and the voltages at its ADC. */
#ifndef UNO_SENSORS_H
#define UNO_SENSORS_H

#include <stdbool.h>
#include <stdint.h>

#include <simavr/sim_avr.h>

#include "power_stage.h"
#include "wire.h"

struct ina219 {
    bool unplugged;
    double gain, offset_V;
    uint16_t setup;
    uint8_t pointer, written; /* bytes of a write */
    uint16_t incoming;
    double time_s, shunt_sum, bus_sum; /* of the present conversion */
    bool bus_next;
    int16_t shunt_word;
    uint16_t bus_word;
};

struct as5600 {
    bool unplugged, no_magnet;
    uint8_t pointer;
    double counts; /* at present */
    long latched;  /* the angle whose high byte was read last */
};

struct sensors {
    struct ina219 ina219;
    struct as5600 as5600;
    const struct power_stage *power;
    const struct wire *wire;
    avr_t *avr;
    avr_irq_t *to_twi, *to_adc;
    bool addressed; /* the last byte on the bus was an address to write to */
    uint8_t selected, bytes; /* address on the bus; bytes since */
};

void sensors_connect(struct sensors *s, avr_t *avr, const struct power_stage *power, const struct wire *wire);

/* Lets the INA219 convert for `dt_s`, a fraction of its conversion time. */
void sensors_step(struct sensors *s, double dt_s);

#endif
