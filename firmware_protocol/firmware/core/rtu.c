/* Modbus RTU: address, function, data, CRC with its low byte first. */
#include <stdbool.h>

#include "crc.h"
#include "exchange.h"

enum { FUNCTION_READ = 3, FUNCTION_WRITE = 16, FUNCTION_BOTH = 23 };

static uint16_t word(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] << 8 | bytes[1]);
}

static bool fits(uint16_t count, uint16_t most)
{
    return count >= 1 && count <= most;
}

/* The words of a writing request: their number, the number of bytes, and the bytes up to the CRC. */
static uint8_t take_words(struct exchange *asked, const uint8_t *bytes, uint16_t n)
{
    asked->write_count = word(bytes);
    if (!fits(asked->write_count, WRITE_MOST) || bytes[2] != 2 * asked->write_count || n != 3u + bytes[2])
        return REFUSED_WORD;
    for (uint16_t i = 0; i < asked->write_count && i < WORDS_KEPT; i++)
        asked->words[i] = word(bytes + 3 + 2 * i);
    return ACCEPTED;
}

/* `data`: the bytes between function and CRC. */
static uint8_t take_read(struct exchange *asked, const uint8_t *data, uint16_t n)
{
    if (n < 4)
        return REFUSED_WORD;
    asked->read_at = word(data);
    asked->read_count = word(data + 2);
    return fits(asked->read_count, READ_MOST) ? ACCEPTED : REFUSED_WORD;
}

static uint8_t take_write(struct exchange *asked, const uint8_t *data, uint16_t n)
{
    if (n < 5)
        return REFUSED_WORD;
    asked->write_at = word(data);
    return take_words(asked, data + 2, (uint16_t)(n - 2));
}

static uint8_t take(struct exchange *asked, const uint8_t *data, uint16_t n)
{
    uint8_t refusal;
    switch (asked->function) {
    case FUNCTION_READ:
        return n == 4 ? take_read(asked, data, n) : REFUSED_WORD;
    case FUNCTION_WRITE:
        return take_write(asked, data, n);
    case FUNCTION_BOTH:
        refusal = take_read(asked, data, n);
        return refusal ? refusal : take_write(asked, data + 4, (uint16_t)(n - 4));
    default:
        return REFUSED_FUNCTION;
    }
}

uint8_t rtu_decode(struct exchange *asked, uint8_t address, const uint8_t *frame, uint16_t n)
{
    if (n < 4 || n > RTU_REQUEST_ROOM || frame[0] != address)
        return NOT_ANSWERED; /* for other devices, or (address 0) a broadcast */
    n = (uint16_t)(n - 2);
    if (crc_modbus(frame, n) != (frame[n] | (uint16_t)(frame[n + 1] << 8)))
        return NOT_ANSWERED;
    asked->function = frame[1];
    return take(asked, frame + 2, (uint16_t)(n - 2));
}

static uint8_t *put(uint8_t *at, uint16_t value)
{
    *at++ = (uint8_t)(value >> 8);
    *at++ = (uint8_t)(value & 0xFFu);
    return at;
}

static uint8_t *put_accepted(uint8_t *at, const struct exchange *asked, struct reading *reading)
{
    *at++ = asked->function;
    if (asked->function == FUNCTION_WRITE)
        return put(put(at, asked->write_at), asked->write_count);
    *at++ = (uint8_t)(2 * asked->read_count);
    for (uint16_t i = 0; i < asked->read_count; i++)
        at = put(at, reading_word(reading, asked, i));
    return at;
}

static uint8_t *put_refused(uint8_t *at, uint8_t function, uint8_t refusal)
{
    *at++ = function | 0x80u;
    *at++ = refusal;
    return at;
}

uint16_t rtu_encode(const struct exchange *asked, uint8_t address, uint8_t refusal, struct reading *reading,
                    uint8_t *frame)
{
    uint8_t *at = frame;
    *at++ = address;
    at = refusal ? put_refused(at, asked->function, refusal) : put_accepted(at, asked, reading);
    const uint16_t crc = crc_modbus(frame, (uint16_t)(at - frame));
    *at++ = (uint8_t)(crc & 0xFFu);
    *at++ = (uint8_t)(crc >> 8);
    return (uint16_t)(at - frame);
}
