#include "exchange.h"

static uint8_t decode(struct exchange *asked, uint8_t framing, uint8_t address, const uint8_t *request, uint16_t n)
{
    return framing == FRAMING_RTU ? rtu_decode(asked, address, request, n) : lines_decode(asked, request, n);
}

/* Refusal before effect: the whole request is decoded and checked before any part is executed. */
uint16_t exchange_answer(const struct served *served, void *device, uint8_t framing, uint8_t address,
                         const uint8_t *request, uint16_t n, uint8_t *reply, uint16_t room)
{
    struct exchange asked = {0};
    uint16_t words[READ_MOST];
    if (room < (framing == FRAMING_RTU ? RTU_REPLY_ROOM : LINES_REPLY_ROOM))
        return 0;
    uint8_t refusal = decode(&asked, framing, address, request, n);
    if (refusal == NOT_ANSWERED)
        return 0;
    if (refusal == ACCEPTED)
        refusal = served->check(device, &asked);
    if (refusal == ACCEPTED && asked.write_count)
        served->write(device, &asked);
    if (refusal == ACCEPTED && asked.read_count)
        served->read(device, asked.read_at, asked.read_count, words);
    return framing == FRAMING_RTU ? rtu_encode(&asked, address, refusal, words, reply)
                                  : lines_encode(&asked, refusal, words, reply);
}
