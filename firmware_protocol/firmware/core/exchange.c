#include "exchange.h"

static uint8_t decode(struct exchange *asked, uint8_t framing, uint8_t address, const uint8_t *request, uint16_t n)
{
    return framing == FRAMING_RTU ? rtu_decode(asked, address, request, n) : lines_decode(asked, request, n);
}

uint16_t reading_word(struct reading *reading, const struct exchange *asked, uint16_t i)
{
    const uint16_t left = (uint16_t)(asked->read_count - i);
    if (i % PIECE_WORDS == 0)
        reading->served->read(reading->device, (uint16_t)(asked->read_at + i), left < PIECE_WORDS ? left : PIECE_WORDS,
                              reading->words);
    return reading->words[i % PIECE_WORDS];
}

/* Refusal before effect: the whole request is decoded and checked before any part is executed. */
uint16_t exchange_answer(const struct served *served, void *device, uint8_t framing, uint8_t address,
                         const uint8_t *request, uint16_t n, uint8_t *reply, uint16_t room)
{
    struct exchange asked = {0};
    struct reading reading = {served, device, {0}};
    if (room < (framing == FRAMING_RTU ? RTU_REPLY_ROOM : LINES_REPLY_ROOM))
        return 0;
    uint8_t refusal = decode(&asked, framing, address, request, n);
    if (refusal == NOT_ANSWERED)
        return 0;
    if (refusal == ACCEPTED)
        refusal = served->check(device, &asked);
    if (refusal == ACCEPTED && asked.write_count)
        served->write(device, &asked);
    return framing == FRAMING_RTU ? rtu_encode(&asked, address, refusal, &reading, reply)
                                  : lines_encode(&asked, refusal, &reading, reply);
}
