/*
 * Sends random and mutated requests to both devices; promises.h states the conditions that must hold.
 * Built with the sanitizers; one seed determines everything.   fuzz [REQUESTS [SEED]]
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../core/crc.h"
#include "../core/exchange.h"
#include "../core/words.h"
#include "promises.h"

enum { REQUEST_MOST = 1100 };

static uint64_t seed;
static struct devices pair;

/* Number of each reply: none, accepted, then the codes. A campaign without accepted requests tests nothing. */
static unsigned long answers[16], ticks_with_current, trips[AMP_FAULT_WIRE_TEMPERATURE + 1];

static uint32_t chance(uint32_t below)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (uint32_t)(seed >> 32) % below;
}

/* --- requests --- */

struct request {
    uint8_t bytes[REQUEST_MOST];
    uint16_t n;
};

/* What a request asks for, with as many words as a frame holds; a device keeps fewer. */
struct plan {
    uint16_t write_at, write_count, read_at, read_count;
    uint16_t words[WRITE_MOST];
};

static uint16_t random_word(void)
{
    static const uint16_t liked[] = {0, 0, 1, 2, 3, 16, 100, 0xFFFF, 0x8000, 0x000F, 0x4240};
    return chance(3) ? liked[chance(sizeof liked / sizeof liked[0])] : (uint16_t)chance(0x10000);
}

/* Often a block that can be written completely, with acceptable words. */
static void plan(struct plan *e, bool is_amp)
{
    static const uint16_t at[] = {AMP_COMMAND_FIRST, AMP_COMMAND_FIRST, AMP_SETTINGS_FIRST, AMP_STATUS_FIRST};
    static const uint16_t whole[] = {
        1, 4, 7, DAQ_COMMAND_WORDS, AMP_COMMAND_WORDS, AMP_COMMAND_WORDS, AMP_SETTINGS_WORDS,
    };
    enum { WHOLE = sizeof whole / sizeof whole[0] };
    memset(e, 0, sizeof *e);
    e->write_at = chance(8) ? at[chance(4)] : random_word();
    e->write_count = chance(8) ? whole[chance(WHOLE)] : (uint16_t)chance(130);
    e->read_at = chance(4) ? at[chance(4)] : (uint16_t)chance(0x70);
    e->read_count = chance(2) ? whole[chance(WHOLE)] : (uint16_t)chance(130);
    for (uint16_t i = 0; i < e->write_count && i < WRITE_MOST; i++)
        e->words[i] = i == AMP_ORDER - AMP_COMMAND_FIRST ? (uint16_t)chance(4) : random_word();
    if (e->write_at == AMP_COMMAND_FIRST && chance(16)) { /* else hardly any command would be new */
        words_put32(e->words, words_u32(is_amp ? pair.amp.command : pair.daq.command) + 1 + chance(2));
        memcpy(e->words + 2, (is_amp ? pair.amp.command : pair.daq.command) + 2, 2 * sizeof e->words[0]); /* its epoch */
    }
    if (is_amp && e->write_at == AMP_COMMAND_FIRST && chance(2))
        words_put32(e->words + AMP_CURRENT - AMP_COMMAND_FIRST, chance(10000) - 5000);
    if (is_amp && e->write_at == AMP_COMMAND_FIRST && chance(4)) /* else nothing would ever be armed */
        words_put32(e->words + AMP_NONCE - AMP_COMMAND_FIRST, words_u32(pair.amp.command + 2) << 16 | pair.amp.orders);
    if (is_amp && e->write_at == AMP_SETTINGS_FIRST && chance(2)) {
        e->words[0] = (uint16_t)(1 + chance(300));
        e->words[1] = (uint16_t)(500 + chance(1501));
        words_put32(e->words + 8, chance(100));
        words_put32(e->words + 2, (uint32_t) - (int32_t)chance(2100001));
        words_put32(e->words + 4, chance(2100001));
        words_put32(e->words + 6, 1 + chance(1000000));
        words_put32(e->words + 10, 1 + chance(1000000));
        words_put32(e->words + 12, chance(4) ? UINT32_MAX - chance(1000) : 1 + chance(1000));
        e->words[14] = (uint16_t)(100 + chance(1000));
        e->words[15] = chance(2) ? (uint16_t)AMP_WIRE_TEMPERATURE_MAX_NONE : (uint16_t)chance(20000);
    }
    if (chance(2)) /* few words of the ring, otherwise every write is refused */
        e->words[AMP_RING_WANT - AMP_COMMAND_FIRST] = e->words[DAQ_RING_WANT - DAQ_COMMAND_FIRST] = (uint16_t)chance(9);
}

static void put(struct request *r, uint16_t word)
{
    r->bytes[r->n++] = (uint8_t)(word >> 8);
    r->bytes[r->n++] = (uint8_t)word;
}

static void end_rtu(struct request *r)
{
    const uint16_t crc = crc_modbus(r->bytes, r->n);
    r->bytes[r->n++] = (uint8_t)crc;
    r->bytes[r->n++] = (uint8_t)(crc >> 8);
}

static void build_rtu(struct request *r, const struct plan *e, uint8_t address)
{
    static const uint8_t functions[] = {3, 16, 23, 23};
    const uint8_t function = chance(20) ? functions[chance(4)] : (uint8_t)chance(256);
    r->n = 0;
    r->bytes[r->n++] = chance(30) ? address : (uint8_t)chance(256);
    r->bytes[r->n++] = function;
    if (function != 16) {
        put(r, e->read_at);
        put(r, e->read_count);
    }
    if (function != 3) {
        put(r, e->write_at);
        put(r, e->write_count);
        r->bytes[r->n++] = (uint8_t)(2 * e->write_count);
        for (uint16_t i = 0; i < e->write_count && i < WRITE_MOST; i++)
            put(r, e->words[i]);
    }
    end_rtu(r);
}

static void print(struct request *r, const char *format, unsigned value)
{
    r->n = (uint16_t)(r->n + sprintf((char *)r->bytes + r->n, format, value));
}

static void end_line(struct request *r)
{
    if (chance(20))
        print(r, " *%04X", crc_modbus(r->bytes, r->n));
    print(r, chance(8) ? "\n" : "\r\n", 0);
}

static void build_line(struct request *r, const struct plan *e)
{
    const uint32_t parts = 1 + chance(3);
    r->n = 0;
    if (parts & 1) {
        print(r, "w %x", e->write_at);
        for (uint16_t i = 0; i < e->write_count && i < WRITE_MOST; i++)
            print(r, chance(2) ? " %04X" : " %x", e->words[i]);
    }
    if (parts == 3)
        print(r, " ", 0);
    if (parts & 2) {
        print(r, "r %X", e->read_at);
        print(r, " %x", e->read_count);
    }
    end_line(r);
}

static void mutate(struct request *r)
{
    static const char liked[] = "wr *\n\r0fF=!";
    for (uint32_t left = 1 + chance(4); left-- && r->n;) {
        uint8_t *at = r->bytes + chance(r->n);
        switch (chance(5)) {
        case 0: *at ^= (uint8_t)(1u << chance(8)); break;
        case 1: *at = (uint8_t)liked[chance(sizeof liked - 1)]; break;
        case 2: r->n = (uint16_t)(at - r->bytes); break;
        case 3: *at = (uint8_t)chance(256); break;
        default: /* repeat the rest from here */
            if (2u * r->n < REQUEST_MOST - 16) {
                const size_t rest = (size_t)(r->bytes + r->n - at);
                memcpy(r->bytes + r->n, at, rest);
                r->n = (uint16_t)(r->n + rest);
            }
        }
    }
}

static void noise(struct request *r)
{
    r->n = (uint16_t)chance(REQUEST_MOST);
    for (uint16_t i = 0; i < r->n; i++)
        r->bytes[i] = (uint8_t)chance(256);
}

static void make(struct request *r, bool is_amp, uint8_t framing, uint8_t address)
{
    struct plan e;
    plan(&e, is_amp);
    if (framing == FRAMING_RTU)
        build_rtu(r, &e, address);
    else
        build_line(r, &e);
    if (chance(40) == 0)
        noise(r);
    if (chance(3))
        return;
    mutate(r);
    if (chance(2) && r->n) { /* with a corrected CRC, so that it passes the first check */
        r->n = (uint16_t)(r->n > 7 ? r->n - 7 : r->n);
        if (framing == FRAMING_RTU)
            end_rtu(r);
        else
            end_line(r);
    }
}

static void ask(bool is_amp, uint8_t framing)
{
    struct request r;
    make(&r, is_amp, framing, is_amp ? AMP_DEVICE_DEFAULT_ADDRESS : DAQ_DEVICE_DEFAULT_ADDRESS);
    answers[promised_answer(&pair, is_amp, framing, r.bytes, r.n) + 1]++;
}

static void tick(void)
{
    static const int32_t extremes[] = {0, 60000, -60000, 5000000, INT32_MAX, INT32_MIN};
    const struct amplifier_inputs seen = {chance(2) ? pair.amp.output_uA : extremes[chance(6)], extremes[chance(6)],
                                          (int16_t)random_word(), (uint16_t)(chance(20) ? 0 : chance(4))};
    const struct encoder_daq_inputs counted = {extremes[chance(6)], (int16_t)random_word(), (uint16_t)chance(8)};
    for (uint32_t left = chance(8) ? 1 : 4; left--;) { /* some causes trip after three ticks in a row */
        ticks_with_current += pair.amp.output_uA != 0;
        promised_tick(&pair, &seen, &counted);
        trips[pair.amp.trip]++;
        encoder_daq_now(&pair.daq, extremes[chance(6)]);
    }
}

int main(int argc, char **argv)
{
    const unsigned long requests = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000000ul;
    seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    promise(seed != 0, "the seed must not be 0");
    amplifier_boot(&pair.amp, 1);
    encoder_daq_boot(&pair.daq, 1);
    for (unsigned long i = 0; i < requests; i++) {
        ask(chance(2), chance(2) ? FRAMING_RTU : FRAMING_LINES);
        if (chance(4) == 0)
            tick();
    }
    printf("%lu requests: %lu not answered, %lu accepted, refused", requests, answers[0], answers[1]);
    for (int code = 1; code < 10; code++)
        printf(" %d: %lu", code, answers[code + 1]);
    printf("\n%lu ticks with current, ticks by trip:", ticks_with_current);
    for (unsigned cause = 0; cause <= AMP_FAULT_WIRE_TEMPERATURE; cause++)
        printf(" %lu", trips[cause]);
    printf("\n");
    return 0;
}
