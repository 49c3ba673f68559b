/*
 * Conditions that hold for every request: a refused or unanswered request changes nothing, replies are complete and
 * fit, current flows only when armed and within its limits, arming needs the nonce, and a tick records what was ordered.
 * A broken condition ends the program.
 */
#ifndef PROMISES_H
#define PROMISES_H

#include <stdbool.h>
#include <stdint.h>

#include "../core/amplifier.h"
#include "../core/encoder_daq.h"

struct devices {
    struct amplifier amp;
    struct encoder_daq daq;
};

void promise(bool holds, const char *what);
void promised_safe(const struct devices *pair);

/* One tick of both. */
void promised_tick(struct devices *pair, const struct amplifier_inputs *seen, const struct encoder_daq_inputs *counted);

/* The code of a refusal; 0: accepted; -1: no reply. */
int promised_answer(struct devices *pair, bool is_amp, uint8_t framing, const uint8_t *bytes, uint16_t size);

#endif
