/*
 * The emulator's stand-in for ADC, encoder counter, stop input and current source: lines of text on UART 1, which is a
 * line of QEMU's and none of a board's. A board leaves this folder out, with the --wrap options of the Makefile, and
 * provides the functions of program/hal.h.
 *
 * The program prints `out CURRENT_uA` when a tick starts, and `behind MS` when this time was skipped. It accepts, as
 * simavr/runner.c does,
 *     in CURRENT_uA VOLTAGE_uV TEMPERATURE HARDWARE     measurements of an amplifier from now on
 *     in RAW_COUNTS AMBIENT HARDWARE                    readings of a DAQ from now on
 *     reset                                             resets the chip
 *     hang                                              stops the program until the watchdog resets it
 * and, for exchanges whose ticks are given,
 *     hold                                              no tick by itself any more; says `held`
 *     boot COUNT                                        the device as after a start; says `done`
 *     tick CURRENT_uA VOLTAGE_uV TEMPERATURE HARDWARE   one tick of an amplifier; says `done`
 *     tick RAW_COUNTS AMBIENT HARDWARE                  one tick of a DAQ; says `done`
 *     now RAW_COUNTS                                    the counts between ticks; says `done`
 * While held it says `answered BYTES REPLIED` after each request that ended on its serial line.
 */
#ifndef SMARIG_EMULATOR_H
#define SMARIG_EMULATOR_H

#include <stdbool.h>
#include <stdint.h>

/* What the parent has said, and what the program is at. */
struct emulator {
    int32_t first, second, temperature, hardware; /* the last inputs */
    bool answered;                                /* an `in` has come since the last `out` */
    bool in_tick;                                 /* begun and not measured yet */
    bool hold_wanted, held;
};

extern struct emulator emulator;

/* Obeys all lines that have come. */
void emulator_obey(void);

/* --- plant_line.c --- */

void plant_line_start(void);

/* The next line, without its end; NULL while none is complete. */
const char *plant_line_read(void);

/* Sends a word and some numbers as one line. */
void plant_line_say(const char *word, uint8_t count, const int32_t *numbers);

/* --- held_time.c --- */

/* Device time stands still from now on. */
void time_hold(void);

/* The last milliseconds have not been. */
void time_forget(uint16_t ms);

#endif
