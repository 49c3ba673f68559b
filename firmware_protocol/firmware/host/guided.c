/*
 * Coverage-guided fuzzing of both devices with libFuzzer. The input is a script of requests, ticks and moments. Check
 * words are corrected in half of the requests, because otherwise no input passes. promises.h states what must hold.
 */
#include <stddef.h>
#include <string.h>

#include "../core/crc.h"
#include "../core/exchange.h"
#include "promises.h"

enum { REQUEST_MOST = 600, CRC_ROOM = 8, BOOT = 7 /* of the golden exchanges, whose nonces then arm */ };

struct script {
    const uint8_t *at, *end;
};

static uint8_t next(struct script *s)
{
    return s->at < s->end ? *s->at++ : 0;
}

static int32_t next_word(struct script *s)
{
    const uint32_t high = next(s);
    return (int32_t)(high << 24 | (uint32_t)next(s) << 16 | (uint32_t)next(s) << 8 | next(s));
}

static uint16_t sealed(uint8_t *request, uint16_t n, uint8_t framing)
{
    static const char digits[] = "0123456789ABCDEF";
    const uint16_t crc = crc_modbus(request, n);
    if (framing == FRAMING_RTU) {
        request[n++] = (uint8_t)crc;
        request[n++] = (uint8_t)(crc >> 8);
        return n;
    }
    request[n++] = ' ';
    request[n++] = '*';
    for (int shift = 12; shift >= 0; shift -= 4)
        request[n++] = (uint8_t)digits[crc >> shift & 15];
    request[n++] = '\n';
    return n;
}

static void ask(struct devices *pair, struct script *s, uint8_t how)
{
    uint8_t request[REQUEST_MOST + CRC_ROOM];
    const uint8_t framing = how & 4 ? FRAMING_LINES : FRAMING_RTU;
    const uint16_t asked = (uint16_t)(next(s) * 2u + (how >> 7));
    const uint16_t left = (uint16_t)(s->end - s->at);
    uint16_t n = asked < left ? asked : left;
    memcpy(request, s->at, n);
    s->at += n;
    if (how & 8)
        n = sealed(request, n, framing);
    promised_answer(pair, how & 2, framing, request, n);
}

static void tick(struct devices *pair, struct script *s, uint8_t how)
{
    const int32_t current_uA = how & 8 ? pair->amp.output_uA : next_word(s);
    const struct amplifier_inputs seen = {current_uA, next_word(s), (int16_t)next_word(s), how >> 6};
    const struct encoder_daq_inputs counted = {next_word(s), 2100, (uint16_t)(how >> 5)};
    for (int n = 1 + (how >> 4 & 1) * next(s); n--;) {
        promised_tick(pair, &seen, &counted);
    }
    encoder_daq_now(&pair->daq, next_word(s));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct devices pair; /* compared byte by byte, including padding */
    struct script s = {data, data + (size < 4096 ? size : 4096)};
    amplifier_boot(&pair.amp, BOOT);
    encoder_daq_boot(&pair.daq, BOOT);
    while (s.at < s.end) {
        const uint8_t how = next(&s);
        if (how & 1)
            ask(&pair, &s, how);
        else
            tick(&pair, &s, how);
    }
    return 0;
}
