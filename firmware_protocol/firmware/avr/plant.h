/*
 * The emulator's stand-in for ADC, encoder counter and current source: a struct in SRAM, which the simulator writes and
 * reads.
 */
#ifndef SMARIG_AVR_PLANT_H
#define SMARIG_AVR_PLANT_H

#include <stdint.h>

/* simavr/runner.c uses this layout: little-endian, without padding. */
struct plant {
    uint8_t tick;  /* incremented when `output_uA` of a new tick is available */
    uint8_t taken; /* 1 while the firmware copies the inputs: the simulator waits, so the copy is consistent */
    int32_t output_uA;
    int32_t first;  /* current in uA, or raw counts */
    int32_t second; /* voltage in uV; not used by the DAQ */
    int16_t temperature;
    uint16_t hardware;
};

extern volatile struct plant plant;

#endif
