/* The current amplifier's logic, without its hardware. The caller provides the struct. */
#ifndef SMARIG_AMPLIFIER_H
#define SMARIG_AMPLIFIER_H

#include <stdbool.h>
#include <stdint.h>

#include "../smarig_registers.h"
#include "ring.h"

#ifndef AMPLIFIER_RING_SIZE
#define AMPLIFIER_RING_SIZE 256u /* a power of two, so that the index stays valid when the tick wraps */
#endif

#ifndef AMPLIFIER_BOARD_MAX_uA
#define AMPLIFIER_BOARD_MAX_uA 2000000l /* no file of a host may ask for more; set it to what wire and supply bear */
#endif

enum { AMPLIFIER_SATURATED = 1, AMPLIFIER_STOP_OPEN = 2 }; /* bits of `hardware` */

/* Consecutive bad ticks of the checks that trip after three. */
struct amplifier_spells {
    uint8_t open, short_circuit, resistance;
};

struct amplifier {
    uint16_t command[AMP_COMMAND_WORDS]; /* as last accepted; `order` and `nonce` read 0, `epoch` the boot count */
    uint16_t settings[AMP_SETTINGS_WORDS];
    uint16_t settings_crc;
    uint16_t orders; /* executed since boot, for the nonce */
    uint8_t state, trip;
    bool thermometer; /* has read the wire temperature since boot */
    uint16_t ticks_unfed; /* since the lease was renewed or the amplifier armed */
    struct amplifier_spells spells;
    uint32_t tick;
    uint16_t samples_kept; /* in the ring */
    int32_t output_uA;
    uint32_t heat; /* 1e-6 A^2 s */
    struct window window;
    uint16_t window_words[AMP_RING_RECORDS][AMP_RING_RECORD_WORDS]; /* a copy: later ticks do not change it */
    uint16_t ring[AMPLIFIER_RING_SIZE][AMP_RING_RECORD_WORDS];
};

/* Measurements of the hardware in one tick. */
struct amplifier_inputs {
    int32_t current_uA, voltage_uV;
    int16_t temperature; /* 0.01 degC, or AMP_RING_TEMPERATURE_NONE */
    uint16_t hardware;
};

void amplifier_boot(struct amplifier *a, uint32_t boot_count);

/* Ends one tick, with the measurements taken while `output_uA` flowed. */
void amplifier_tick(struct amplifier *a, const struct amplifier_inputs *in);

uint16_t amplifier_answer(struct amplifier *a, uint8_t framing, uint8_t address, const uint8_t *request, uint16_t n,
                          uint8_t *reply, uint16_t room);

#define AMPLIFIER_SETTING(a, name) (&(a)->settings[(name)-AMP_SETTINGS_FIRST])

/* amplifier_guard.c: the checks of a tick */

/* The lease in ticks. */
uint16_t guard_lease_ticks(const struct amplifier *a);

/* The words of the settings that their CRC covers: the limit of a later map version only if it is set. */
uint16_t guard_settings_words(const struct amplifier *a);

/* Adds one tick of the measured current to the heat. */
void guard_warm(struct amplifier *a, int32_t current_uA);

/* Checks one tick while armed; returns the fault that trips, 0 for none. */
uint16_t guard_tick(struct amplifier *a, const struct amplifier_inputs *in);

/* Whether a step from the present output exceeds the slew limit. */
bool guard_slews(const struct amplifier *a, int32_t next_uA);

#endif
