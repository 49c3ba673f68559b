/*
 * The current loop: timer 1 switches the MOSFET at 31 kHz, the INA219 measures, and once per millisecond an integral
 * controller changes the duty. A step of the current goes by estimate first: most of the way from the least resistance,
 * then the rest in proportion to what flows. Functions marked ISR run in interrupts.
 */
#ifndef UNO_CURRENT_LOOP_H
#define UNO_CURRENT_LOOP_H

#include <stdbool.h>
#include <stdint.h>

/* The mean of a stretch of measurements. */
struct measurement {
    int32_t current_uA, voltage_uV;
    bool saturated; /* the full duty did not suffice */
};

void current_loop_start(void);

/*
 * Drives this current from now on. `least_mohm` is a resistance that the wire never falls below and `supply_mV` the
 * supply: together they say how much duty a step needs at least. Above `cut_uA` the gate closes at once.
 */
void current_loop_drive(int32_t current_uA, uint32_t least_mohm, uint16_t supply_mV, int32_t cut_uA);

/* Closes the gate at once, until current_loop_drive is called. ISR or main. */
void current_loop_off(void);

/* ISR: one step with the words of the INA219. */
void current_loop_step(int16_t shunt, int16_t bus);

/* ISR: every millisecond; without measurements the gate closes. */
void current_loop_watch(void);

void current_loop_begin_measurement(void);
struct measurement current_loop_end_measurement(void);

#endif
