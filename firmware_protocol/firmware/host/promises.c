#include "promises.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../core/crc.h"
#include "../core/exchange.h"
#include "../core/words.h"

void promise(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "broken promise: %s\n", what);
    abort();
}

/* The code of a refusal; 0: accepted; -1: no reply. */
static int outcome(uint8_t framing, const uint8_t *reply, uint16_t n)
{
    if (!n)
        return -1;
    if (framing == FRAMING_RTU) {
        const uint16_t crc = (uint16_t)(reply[n - 2] | reply[n - 1] << 8);
        promise(n >= 5 && crc == crc_modbus(reply, (uint16_t)(n - 2)), "an RTU reply is not whole");
        return reply[1] & 0x80u ? reply[2] : 0;
    }
    char crc[8];
    promise(n >= 8 && reply[n - 1] == '\n', "a line is not whole");
    snprintf(crc, sizeof crc, " *%04X", crc_modbus(reply, (uint16_t)(n - 7)));
    promise(memcmp(reply + n - 7, crc, 6) == 0, "the CRC of a line is wrong");
    return reply[0] == '!' ? reply[2] - '0' : 0;
}

/* The settings as they are, and a CRC that is theirs. */
static void promised_settings(const struct amplifier *amp)
{
    uint8_t bytes[2 * AMP_SETTINGS_WORDS];
    const bool limited = (int16_t)*AMPLIFIER_SETTING(amp, AMP_WIRE_TEMPERATURE_MAX) != AMP_WIRE_TEMPERATURE_MAX_NONE;
    const unsigned count = AMP_SETTINGS_WORDS - !limited;
    for (unsigned i = 0; i < count; i++) {
        bytes[2 * i] = (uint8_t)(amp->settings[i] >> 8);
        bytes[2 * i + 1] = (uint8_t)(amp->settings[i] & 0xFFu);
    }
    promise(amp->settings_crc == crc_modbus(bytes, (uint16_t)(2 * count)), "the CRC of the settings is not theirs");
    promise(2ul * *AMPLIFIER_SETTING(amp, AMP_PERIOD) <= *AMPLIFIER_SETTING(amp, AMP_LEASE), "a tick is too long");
}

/* Between two moments: whoever was armed meanwhile was so by one order, which carried the nonce of before. */
static void promised_arming(const struct amplifier *was, const struct amplifier *is, const uint8_t *rtu, uint16_t size)
{
    if (was->state == AMP_STATE_ARMED || is->state == AMP_STATE_OFF || (is->state == was->state && is->trip == was->trip))
        return;
    promise(is->orders == (uint16_t)(was->orders + 1), "an exchange is one order at most");
    if (!rtu)
        return;
    promise(size > 6, "an order that arms is longer");
    const uint8_t *nonce = rtu + size - 6; /* the last words before the check word */
    promise((nonce[0] << 8 | nonce[1]) == was->command[AMP_EPOCH + 1 - AMP_COMMAND_FIRST] && (nonce[2] << 8 | nonce[3]) == was->orders,
            "armed without the nonce");
}

/* Numbers go up, and only a number that was never there before feeds the lease. */
static void promised_sequence(const struct amplifier *was, const struct amplifier *is)
{
    const uint32_t before = words_u32(was->command), after = words_u32(is->command);
    promise(after >= before && after - before <= 256, "the sequence jumps, or goes back");
    promise(after > before || is->ticks_unfed == was->ticks_unfed, "the lease is fed without a new number");
}

void promised_safe(const struct devices *pair)
{
    const struct amplifier *amp = &pair->amp;
    const struct encoder_daq *daq = &pair->daq;
    const bool armed = amp->state == AMP_STATE_ARMED;
    const int32_t least = words_i32(AMPLIFIER_SETTING(amp, AMP_CURRENT_MIN));
    const int32_t most = words_i32(AMPLIFIER_SETTING(amp, AMP_CURRENT_MAX));
    promise(armed || amp->output_uA == 0, "current flows though not armed");
    promise(amp->output_uA >= least && amp->output_uA <= most, "the output is outside its limits");
    promise(most <= AMPLIFIER_BOARD_MAX_uA && least >= -AMPLIFIER_BOARD_MAX_uA, "the settings exceed the board");
    promised_settings(amp);
    promise((amp->trip != 0) == (amp->state == AMP_STATE_TRIPPED), "trip and state disagree");
    promise(amp->window.count <= AMP_RING_RECORDS && daq->window.count <= DAQ_RING_RECORDS, "a window is too large");
}

void promised_tick(struct devices *pair, const struct amplifier_inputs *seen, const struct encoder_daq_inputs *counted)
{
    const int32_t driven_uA = pair->amp.output_uA;
    amplifier_tick(&pair->amp, seen);
    encoder_daq_tick(&pair->daq, counted);
    const uint16_t *record = pair->amp.ring[pair->amp.tick % AMPLIFIER_RING_SIZE];
    promise(words_i32(record + 4) == driven_uA, "the ring has another output than the one that was ordered");
    promised_safe(pair);
}

int promised_answer(struct devices *pair, bool is_amp, uint8_t framing, const uint8_t *bytes, uint16_t size)
{
    const uint8_t address = is_amp ? AMP_DEVICE_DEFAULT_ADDRESS : DAQ_DEVICE_DEFAULT_ADDRESS;
    const uint16_t room = framing == FRAMING_RTU ? RTU_REPLY_ROOM : LINES_REPLY_ROOM;
    /* both of exactly the declared size, so that the sanitizer detects the first byte beyond it */
    uint8_t *request = malloc(size ? size : 1), *reply = malloc(room);
    promise(request && reply, "no memory");
    if (size)
        memcpy(request, bytes, size);
    static struct devices before;
    memcpy(&before, pair, sizeof before);
    const uint16_t n = is_amp ? amplifier_answer(&pair->amp, framing, address, request, size, reply, room)
                              : encoder_daq_answer(&pair->daq, framing, address, request, size, reply, room);
    promise(n <= room, "a reply is too long");
    const int code = outcome(framing, reply, n);
    promise(!code || !memcmp(pair, &before, sizeof before), "a request that was not accepted changed something");
    promised_sequence(&before.amp, &pair->amp);
    if (is_amp)
        promised_arming(&before.amp, &pair->amp, framing == FRAMING_RTU ? request : NULL, size);
    promised_safe(pair);
    free(request);
    free(reply);
    return code;
}
