#include "encoder_daq.h"

#include <string.h>

#include "block.h"
#include "sequence.h"
#include "words.h"

static const struct value COMMAND[] IN_FLASH = {
    VALUE(DAQ_SEQUENCE, 2),
    VALUE(DAQ_EPOCH, 2),
    VALUE(DAQ_ORDER, 1),
    VALUE(DAQ_RING_NEXT, 2),
    VALUE(DAQ_RING_WANT, 1),
};

static const struct value SETTINGS[] IN_FLASH = {VALUE(DAQ_PERIOD, 1)};

/* A record of the ring: counts (2 words), ambient, marks. */
enum { RECORD_COUNTS = 0, RECORD_AMBIENT = 2, RECORD_MARKS = 3 };

/* Offsets in the command block. */
#define AT(name) ((name)-DAQ_COMMAND_FIRST)

static bool inside_value(uint16_t address)
{
    if (address >= DAQ_RING)
        return (address - DAQ_RING) % DAQ_RING_RECORD_WORDS == RECORD_COUNTS + 1;
    return address == DAQ_MAP_HASH + 1 || address == DAQ_BOOT_COUNT + 1 || address == DAQ_ECHO + 1 ||
           address == DAQ_TICK + 1 || address == DAQ_COUNTS + 1 || address == DAQ_RING_FIRST + 1;
}

static const struct map MAP = {BLOCK(COMMAND, DAQ_COMMAND), BLOCK(SETTINGS, DAQ_SETTINGS), DAQ_STATUS_FIRST, DAQ_STATUS_WORDS,
                                inside_value};

void encoder_daq_boot(struct encoder_daq *d, uint32_t boot_count)
{
    memset(d, 0, sizeof *d); /* no sequence received, counts as in the hardware */
    d->tick = FIRST_TICK;
    block_boot(&MAP.command, d->command);
    words_put32(d->command + AT(DAQ_SEQUENCE), FIRST_SEQUENCE);
    words_put32(d->command + AT(DAQ_EPOCH), boot_count);
    block_boot(&MAP.settings, d->settings);
}

void encoder_daq_now(struct encoder_daq *d, int32_t raw_counts)
{
    d->raw = (uint32_t)raw_counts;
}

static void keep_sample(struct encoder_daq *d, const struct encoder_daq_inputs *in)
{
    uint16_t *record = d->ring[(d->tick + 1) % ENCODER_DAQ_RING_SIZE];
    words_put32(record + RECORD_COUNTS, d->raw - d->zero);
    record[RECORD_AMBIENT] = (uint16_t)in->ambient;
    record[RECORD_MARKS] = (uint16_t)((in->hardware & ENCODER_DAQ_INDEX ? DAQ_RING_MARKS_INDEX : 0u) |
                                      (in->hardware & ENCODER_DAQ_ILLEGAL_STEP ? DAQ_RING_MARKS_ILLEGAL_STEP : 0u));
}

void encoder_daq_tick(struct encoder_daq *d, const struct encoder_daq_inputs *in)
{
    encoder_daq_now(d, in->raw_counts);
    d->fault = in->hardware & ENCODER_DAQ_NO_SUPPLY ? DAQ_FAULT_NO_SUPPLY : 0;
    if (in->hardware & ENCODER_DAQ_INDEX)
        d->index_count++;
    keep_sample(d, in);
    d->tick++;
    if (d->samples_kept < ENCODER_DAQ_RING_SIZE)
        d->samples_kept++;
}

static uint8_t check(const void *device, const struct exchange *asked)
{
    (void)device; /* no check depends on the device's state */
    return map_check(&MAP, asked);
}

static uint32_t boot_count(const struct encoder_daq *d)
{
    return words_u32(d->command + AT(DAQ_EPOCH));
}

static bool is_new(const struct encoder_daq *d, const struct exchange *asked)
{
    return asked->write_count > AT(DAQ_EPOCH) && words_u32(asked->words + AT(DAQ_EPOCH)) == boot_count(d) &&
           sequence_is_new(words_u32(d->command + AT(DAQ_SEQUENCE)), words_u32(asked->words + AT(DAQ_SEQUENCE)));
}

/* Copies the words from `at` on, as many as the exchange contains. */
static void take(struct encoder_daq *d, const struct exchange *asked, uint16_t at)
{
    if (asked->write_count > at)
        memcpy(d->command + at, asked->words + at, (asked->write_count - at) * sizeof d->command[0]);
}

static void carry_out(struct encoder_daq *d, const struct exchange *asked)
{
    take(d, asked, AT(DAQ_SEQUENCE));
    if (d->command[AT(DAQ_ORDER)] == DAQ_ORDER_ZERO)
        d->zero = d->raw;
    d->command[AT(DAQ_ORDER)] = DAQ_ORDER_NONE;
}

static void choose_window(struct encoder_daq *d)
{
    d->window = ring_window(d->tick, d->samples_kept, words_u32(d->command + AT(DAQ_RING_NEXT)),
                            d->command[AT(DAQ_RING_WANT)]);
    memset(d->window_words, 0, sizeof d->window_words);
    for (uint16_t i = 0; i < d->window.count; i++)
        memcpy(d->window_words[i], d->ring[(d->window.first + i) % ENCODER_DAQ_RING_SIZE], sizeof d->ring[0]);
}

static void write(void *device, const struct exchange *asked)
{
    struct encoder_daq *d = device;
    if (!block_is(&MAP.command, asked->write_at)) {
        memcpy(d->settings, asked->words, asked->write_count * sizeof d->settings[0]);
        return;
    }
    if (is_new(d, asked))
        carry_out(d, asked);
    else
        take(d, asked, AT(DAQ_RING_NEXT));
    choose_window(d);
}

/* The status block before its ring. */
static void status_head(const struct encoder_daq *d, uint16_t *words)
{
    words[DAQ_KIND] = DAQ_DEVICE_KIND;
    words[DAQ_VERSION] = DAQ_DEVICE_VERSION;
    words_put32(words + DAQ_MAP_HASH, DAQ_DEVICE_MAP_HASH);
    words_put32(words + DAQ_BOOT_COUNT, boot_count(d));
    memcpy(words + DAQ_ECHO, d->command + AT(DAQ_SEQUENCE), 2 * sizeof words[0]);
    words_put32(words + DAQ_TICK, d->tick);
    words[DAQ_FAULT] = d->fault;
    words_put32(words + DAQ_COUNTS, d->raw - d->zero);
    words[DAQ_INDEX_COUNT] = d->index_count;
    words_put32(words + DAQ_RING_FIRST, d->window.first);
    words[DAQ_RING_COUNT] = d->window.count;
}

static void read_status(const struct encoder_daq *d, uint16_t at, uint16_t count, uint16_t *words)
{
    uint16_t head[DAQ_RING];
    if (at < DAQ_RING)
        status_head(d, head);
    for (; count; count--, at++) {
        const uint16_t in_ring = (uint16_t)(at - DAQ_RING);
        *words++ = at < DAQ_RING ? head[at] : d->window_words[in_ring / DAQ_RING_RECORD_WORDS][in_ring % DAQ_RING_RECORD_WORDS];
    }
}

static void read(const void *device, uint16_t at, uint16_t count, uint16_t *words)
{
    const struct encoder_daq *d = device;
    if (at >= DAQ_SETTINGS_FIRST)
        memcpy(words, d->settings + (at - DAQ_SETTINGS_FIRST), count * sizeof words[0]);
    else if (at >= DAQ_COMMAND_FIRST)
        memcpy(words, d->command + AT(at), count * sizeof words[0]);
    else
        read_status(d, at, count, words);
}

uint16_t encoder_daq_answer(struct encoder_daq *d, uint8_t framing, uint8_t address, const uint8_t *request, uint16_t n,
                            uint8_t *reply, uint16_t room)
{
    static const struct served SERVED = {check, write, read};
    return exchange_answer(&SERVED, d, framing, address, request, n, reply, room);
}
