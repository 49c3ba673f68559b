/* The encoder DAQ's logic, without its hardware. The caller provides the struct. */
#ifndef SMARIG_ENCODER_DAQ_H
#define SMARIG_ENCODER_DAQ_H

#include <stdint.h>

#include "../smarig_registers.h"
#include "ring.h"

#ifndef ENCODER_DAQ_RING_SIZE
#define ENCODER_DAQ_RING_SIZE 1024u /* a power of two, so that the index stays valid when the tick wraps */
#endif

enum { ENCODER_DAQ_INDEX = 1, ENCODER_DAQ_ILLEGAL_STEP = 2, ENCODER_DAQ_NO_SUPPLY = 4 }; /* bits of `hardware` */

struct encoder_daq {
    uint16_t command[DAQ_COMMAND_WORDS]; /* as last accepted; `order` reads 0, `epoch` the boot count */
    uint16_t settings[DAQ_SETTINGS_WORDS];
    uint8_t fault;
    uint16_t index_count;
    uint32_t tick;
    uint16_t samples_kept; /* in the ring */
    uint32_t raw, zero; /* counts of the hardware now and at the last zero; they may wrap */
    struct window window;
    uint16_t window_words[DAQ_RING_RECORDS][DAQ_RING_RECORD_WORDS]; /* a copy: later ticks do not change it */
    uint16_t ring[ENCODER_DAQ_RING_SIZE][DAQ_RING_RECORD_WORDS];
};

/* Readings of the hardware in one tick. */
struct encoder_daq_inputs {
    int32_t raw_counts;
    int16_t ambient; /* 0.01 degC, or DAQ_RING_AMBIENT_NONE */
    uint16_t hardware;
};

void encoder_daq_boot(struct encoder_daq *d, uint32_t boot_count);
void encoder_daq_tick(struct encoder_daq *d, const struct encoder_daq_inputs *in);

/* The present counts of the hardware, between ticks. */
void encoder_daq_now(struct encoder_daq *d, int32_t raw_counts);

uint16_t encoder_daq_answer(struct encoder_daq *d, uint8_t framing, uint8_t address, const uint8_t *request, uint16_t n,
                            uint8_t *reply, uint16_t room);

#endif
