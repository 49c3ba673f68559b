#include "amplifier.h"

#include <string.h>

#include "block.h"
#include "crc.h"
#include "sequence.h"
#include "words.h"

static const struct value COMMAND[] IN_FLASH = {
    VALUE(AMP_SEQUENCE, 2),  VALUE(AMP_EPOCH, 2),     VALUE(AMP_ORDER, 1), VALUE(AMP_CURRENT, 2),
    VALUE(AMP_RING_NEXT, 2), VALUE(AMP_RING_WANT, 1), VALUE(AMP_NONCE, 2),
};

static const struct value SETTINGS[] IN_FLASH = {
    VALUE(AMP_PERIOD, 1),         VALUE(AMP_LEASE, 1),          VALUE(AMP_CURRENT_MIN, 2),
    VALUE(AMP_CURRENT_MAX, 2),    VALUE(AMP_SLEW_MAX, 2),       VALUE(AMP_RESISTANCE_MIN, 2),
    VALUE(AMP_RESISTANCE_MAX, 2), VALUE(AMP_HEAT_MAX, 2),       VALUE(AMP_HEAT_SETTLE, 1),
    VALUE(AMP_WIRE_TEMPERATURE_MAX, 1),
};

/* A record of the ring: current (2 words), voltage (2), output (2), temperature, marks. */
enum { RECORD_CURRENT = 0, RECORD_VOLTAGE = 2, RECORD_OUTPUT = 4, RECORD_TEMPERATURE = 6, RECORD_MARKS = 7 };

/* Offsets in the command block. */
#define AT(name) ((name)-AMP_COMMAND_FIRST)

static bool inside_value(uint16_t address)
{
    if (address >= AMP_RING) {
        const uint16_t at = (uint16_t)((address - AMP_RING) % AMP_RING_RECORD_WORDS);
        return at == RECORD_CURRENT + 1 || at == RECORD_VOLTAGE + 1 || at == RECORD_OUTPUT + 1;
    }
    return address == AMP_MAP_HASH + 1 || address == AMP_BOOT_COUNT + 1 || address == AMP_ECHO + 1 ||
           address == AMP_TICK + 1 || address == AMP_OUTPUT + 1 || address == AMP_HEAT + 1 ||
           address == AMP_RING_FIRST + 1 || address == AMP_ARM_NONCE + 1 || address == AMP_BOARD_MAX + 1;
}

static const struct map MAP = {BLOCK(COMMAND, AMP_COMMAND), BLOCK(SETTINGS, AMP_SETTINGS), AMP_STATUS_FIRST, AMP_STATUS_WORDS,
                                inside_value};

/* The settings as bytes on the line, which is what the host can repeat. */
static void update_settings_crc(struct amplifier *a)
{
    uint8_t bytes[2 * AMP_SETTINGS_WORDS];
    const uint16_t count = guard_settings_words(a);
    for (uint16_t i = 0; i < count; i++) {
        bytes[2 * i] = (uint8_t)(a->settings[i] >> 8);
        bytes[2 * i + 1] = (uint8_t)a->settings[i];
    }
    a->settings_crc = crc_modbus(bytes, (uint16_t)(2 * count));
}

void amplifier_boot(struct amplifier *a, uint32_t boot_count)
{
    memset(a, 0, sizeof *a); /* off, output 0, no sequence received */
    a->tick = FIRST_TICK;
    block_boot(&MAP.command, a->command);
    words_put32(a->command + AT(AMP_SEQUENCE), FIRST_SEQUENCE);
    words_put32(a->command + AT(AMP_EPOCH), boot_count);
    block_boot(&MAP.settings, a->settings);
    update_settings_crc(a);
}

static void trip(struct amplifier *a, uint16_t cause)
{
    a->output_uA = 0;
    a->state = AMP_STATE_TRIPPED;
    a->trip = (uint8_t)cause;
}

/* --- ticks --- */

static void keep_sample(struct amplifier *a, const struct amplifier_inputs *in, int32_t driven_uA)
{
    uint16_t *record = a->ring[(a->tick + 1) % AMPLIFIER_RING_SIZE];
    words_put32(record + RECORD_CURRENT, (uint32_t)in->current_uA);
    words_put32(record + RECORD_VOLTAGE, (uint32_t)in->voltage_uV);
    words_put32(record + RECORD_OUTPUT, (uint32_t)driven_uA);
    record[RECORD_TEMPERATURE] = (uint16_t)in->temperature;
    record[RECORD_MARKS] = (uint16_t)((in->hardware & AMPLIFIER_SATURATED ? AMP_RING_MARKS_SATURATED : 0u) |
                                      (a->state == AMP_STATE_TRIPPED ? AMP_RING_MARKS_TRIPPED : 0u));
}

void amplifier_tick(struct amplifier *a, const struct amplifier_inputs *in)
{
    const int32_t driven_uA = a->output_uA; /* during this tick, also if it ends with a trip */
    guard_warm(a, in->current_uA);
    a->thermometer = a->thermometer || in->temperature != AMP_RING_TEMPERATURE_NONE;
    const uint16_t cause = a->state == AMP_STATE_ARMED ? guard_tick(a, in) : 0;
    if (cause)
        trip(a, cause);
    keep_sample(a, in, driven_uA);
    a->tick++;
    if (a->samples_kept < AMPLIFIER_RING_SIZE)
        a->samples_kept++;
}

/* --- checking an exchange --- */

static uint32_t boot_count(const struct amplifier *a)
{
    return words_u32(a->command + AT(AMP_EPOCH));
}

static bool is_new(const struct amplifier *a, const struct exchange *asked)
{
    return asked->write_count > AT(AMP_EPOCH) && words_u32(asked->words + AT(AMP_EPOCH)) == boot_count(a) &&
           sequence_is_new(words_u32(a->command + AT(AMP_SEQUENCE)), words_u32(asked->words + AT(AMP_SEQUENCE)));
}

static uint16_t order_of(const struct exchange *asked)
{
    return asked->write_count > AT(AMP_ORDER) ? asked->words[AT(AMP_ORDER)] : AMP_ORDER_NONE;
}

static bool arms(uint16_t order)
{
    return order == AMP_ORDER_ARM || order == AMP_ORDER_REARM;
}

static bool order_fits(uint16_t order, uint16_t state)
{
    if (order == AMP_ORDER_ARM)
        return state == AMP_STATE_OFF;
    return order != AMP_ORDER_REARM || state != AMP_STATE_ARMED;
}

/* The boot, then the number of orders since: another one after every order, the same only after 65,536 of them. */
static uint32_t arm_nonce(const struct amplifier *a)
{
    return boot_count(a) << 16 | a->orders;
}

static bool nonce_fits(const struct amplifier *a, const struct exchange *asked)
{
    return asked->write_count > AT(AMP_NONCE) && words_u32(asked->words + AT(AMP_NONCE)) == arm_nonce(a);
}

static bool current_fits(const struct amplifier *a, int32_t current_uA)
{
    return current_uA >= words_i32(AMPLIFIER_SETTING(a, AMP_CURRENT_MIN)) &&
           current_uA <= words_i32(AMPLIFIER_SETTING(a, AMP_CURRENT_MAX));
}

static uint8_t check_command(const struct amplifier *a, const struct exchange *asked)
{
    const uint16_t order = order_of(asked);
    const bool drives = asked->write_count > AT(AMP_CURRENT) && words_i32(asked->words + AT(AMP_CURRENT)) != 0;
    if (!is_new(a, asked))
        return ACCEPTED; /* a repetition is not executed, so its content cannot conflict with the state */
    if (!order_fits(order, a->state) || (drives && a->state != AMP_STATE_ARMED && !arms(order)))
        return REFUSED_NOW;
    if (arms(order) && !nonce_fits(a, asked))
        return REFUSED_NOW;
    return drives && !current_fits(a, words_i32(asked->words + AT(AMP_CURRENT))) ? REFUSED_WORD : ACCEPTED;
}

/* Settings that this board accepts: its largest current, and a period that fits the lease. */
static uint8_t check_settings(const struct amplifier *a, const struct exchange *asked)
{
    uint16_t next[AMP_SETTINGS_WORDS];
    memcpy(next, a->settings, sizeof next);
    memcpy(next, asked->words, asked->write_count * sizeof next[0]);
#define NEXT(name) (next + (name)-AMP_SETTINGS_FIRST)
    if (words_i32(NEXT(AMP_CURRENT_MAX)) > AMPLIFIER_BOARD_MAX_uA ||
        words_i32(NEXT(AMP_CURRENT_MIN)) < -AMPLIFIER_BOARD_MAX_uA)
        return REFUSED_WORD;
    return 2ul * *NEXT(AMP_PERIOD) > *NEXT(AMP_LEASE) ? REFUSED_WORD : ACCEPTED;
#undef NEXT
}

static uint8_t check(const void *device, const struct exchange *asked)
{
    const struct amplifier *a = device;
    const uint8_t refusal = map_check(&MAP, asked);
    if (refusal || !asked->write_count)
        return refusal;
    if (block_is(&MAP.command, asked->write_at))
        return check_command(a, asked);
    return a->state == AMP_STATE_ARMED ? REFUSED_NOW : check_settings(a, asked);
}

/* --- executing an exchange --- */

static void obey(struct amplifier *a, uint16_t order)
{
    if (order == AMP_ORDER_NONE)
        return;
    a->orders++;
    a->state = arms(order) ? AMP_STATE_ARMED : AMP_STATE_OFF;
    a->trip = 0;
    a->output_uA = 0;
    memset(&a->spells, 0, sizeof a->spells);
}

static void drive(struct amplifier *a, int32_t current_uA)
{
    if (a->state != AMP_STATE_ARMED)
        return;
    if (guard_slews(a, current_uA))
        trip(a, AMP_FAULT_SLEW);
    else
        a->output_uA = current_uA;
}

/* Copies the words from `at` on, as many as the exchange contains, but not the nonce. */
static void take(struct amplifier *a, const struct exchange *asked, uint16_t at)
{
    const uint16_t end = asked->write_count < AT(AMP_NONCE) ? asked->write_count : AT(AMP_NONCE);
    if (end > at)
        memcpy(a->command + at, asked->words + at, (end - at) * sizeof a->command[0]);
}

static void carry_out(struct amplifier *a, const struct exchange *asked)
{
    take(a, asked, AT(AMP_SEQUENCE));
    a->command[AT(AMP_ORDER)] = AMP_ORDER_NONE;
    obey(a, order_of(asked));
    if (asked->write_count > AT(AMP_CURRENT))
        drive(a, words_i32(a->command + AT(AMP_CURRENT)));
}

static void choose_window(struct amplifier *a)
{
    a->window = ring_window(a->tick, a->samples_kept, words_u32(a->command + AT(AMP_RING_NEXT)),
                            a->command[AT(AMP_RING_WANT)]);
    memset(a->window_words, 0, sizeof a->window_words);
    for (uint16_t i = 0; i < a->window.count; i++)
        memcpy(a->window_words[i], a->ring[(a->window.first + i) % AMPLIFIER_RING_SIZE], sizeof a->ring[0]);
}

static void write(void *device, const struct exchange *asked)
{
    struct amplifier *a = device;
    if (!block_is(&MAP.command, asked->write_at)) {
        memcpy(a->settings, asked->words, asked->write_count * sizeof a->settings[0]);
        update_settings_crc(a);
        return;
    }
    if (is_new(a, asked)) {
        a->ticks_unfed = 0; /* only a new command proves that the host lives */
        carry_out(a, asked);
    } else
        take(a, asked, AT(AMP_RING_NEXT));
    choose_window(a);
}

/* --- reading registers --- */

static uint16_t lease_left_ms(const struct amplifier *a)
{
    if (a->state != AMP_STATE_ARMED)
        return 0;
    return (uint16_t)((guard_lease_ticks(a) - a->ticks_unfed) * *AMPLIFIER_SETTING(a, AMP_PERIOD));
}

/* The status block before its ring. */
static void status_head(const struct amplifier *a, uint16_t *words)
{
    words[AMP_KIND] = AMP_DEVICE_KIND;
    words[AMP_VERSION] = AMP_DEVICE_VERSION;
    words_put32(words + AMP_MAP_HASH, AMP_DEVICE_MAP_HASH);
    words_put32(words + AMP_BOOT_COUNT, boot_count(a));
    memcpy(words + AMP_ECHO, a->command + AT(AMP_SEQUENCE), 2 * sizeof words[0]);
    words_put32(words + AMP_TICK, a->tick);
    words[AMP_STATE] = a->state;
    words[AMP_TRIP] = a->trip;
    words_put32(words + AMP_OUTPUT, (uint32_t)a->output_uA);
    words[AMP_LEASE_LEFT] = lease_left_ms(a);
    words_put32(words + AMP_HEAT, a->heat);
    words_put32(words + AMP_RING_FIRST, a->window.first);
    words[AMP_RING_COUNT] = a->window.count;
    words[AMP_SETTINGS_CRC] = a->settings_crc;
    words_put32(words + AMP_ARM_NONCE, arm_nonce(a));
    words_put32(words + AMP_BOARD_MAX, AMPLIFIER_BOARD_MAX_uA);
}

static void read_status(const struct amplifier *a, uint16_t at, uint16_t count, uint16_t *words)
{
    uint16_t head[AMP_RING];
    if (at < AMP_RING)
        status_head(a, head);
    for (; count; count--, at++) {
        const uint16_t in_ring = (uint16_t)(at - AMP_RING);
        *words++ = at < AMP_RING ? head[at] : a->window_words[in_ring / AMP_RING_RECORD_WORDS][in_ring % AMP_RING_RECORD_WORDS];
    }
}

static void read(const void *device, uint16_t at, uint16_t count, uint16_t *words)
{
    const struct amplifier *a = device;
    if (at >= AMP_SETTINGS_FIRST)
        memcpy(words, a->settings + (at - AMP_SETTINGS_FIRST), count * sizeof words[0]);
    else if (at >= AMP_COMMAND_FIRST)
        memcpy(words, a->command + AT(at), count * sizeof words[0]);
    else
        read_status(a, at, count, words);
}

uint16_t amplifier_answer(struct amplifier *a, uint8_t framing, uint8_t address, const uint8_t *request, uint16_t n,
                          uint8_t *reply, uint16_t room)
{
    static const struct served SERVED = {check, write, read};
    return exchange_answer(&SERVED, a, framing, address, request, n, reply, room);
}
