/*
 * One exchange: write one block of words (or none), then read one (or none), in one request and one reply.
 * Handles both framings. A device is three functions in struct served.
 */
#ifndef SMARIG_EXCHANGE_H
#define SMARIG_EXCHANGE_H

#include <stdint.h>

#include "../smarig_registers.h"

enum framing { FRAMING_RTU = 0, FRAMING_LINES = 1 };

enum {
    WRITE_MOST = 121,       /* words in one request */
    WORDS_KEPT = AMP_SETTINGS_WORDS, /* of them; the largest block. A longer write is refused for its address */
    READ_MOST = 125,        /* words in one reply */
    PIECE_WORDS = 12,       /* of a reply, read at once */
    RTU_REQUEST_ROOM = 256, /* bytes */
    RTU_REPLY_ROOM = 256,
    LINE_MOST = 1000,       /* characters of a request without its end */
    LINES_REQUEST_ROOM = LINE_MOST + 2, /* and \r\n */
    LINES_REPLY_ROOM = 640
};

/* Why a request is refused: Modbus exceptions, then those that only lines have. */
enum refusal {
    ACCEPTED = 0,
    REFUSED_FUNCTION = 1,
    REFUSED_ADDRESS = 2,
    REFUSED_WORD = 3,
    REFUSED_NOW = 4,
    REFUSED_CRC = 8,
    REFUSED_LINE = 9,
    NOT_ANSWERED = 255
};

/* The request; a count of 0 means that this part is absent. */
struct exchange {
    uint8_t function; /* RTU only: the reply repeats it */
    uint16_t write_at, write_count;
    uint16_t read_at, read_count;
    uint16_t words[WORDS_KEPT];
};

/*
 * `check` must change nothing; `write` and `read` are called only for what `check` accepted. `read` gives any piece of
 * it.
 */
struct served {
    uint8_t (*check)(const void *device, const struct exchange *asked);
    void (*write)(void *device, const struct exchange *asked);
    void (*read)(const void *device, uint16_t at, uint16_t count, uint16_t *words);
};

/* The words of a reply, a piece at a time: they need no room of their own. */
struct reading {
    const struct served *served;
    const void *device;
    uint16_t words[PIECE_WORDS];
};

/* Word `i` of the block that is read, in order from 0 on. */
uint16_t reading_word(struct reading *reading, const struct exchange *asked, uint16_t i);

/*
 * Length of the reply, 0 for none. If `room` is too small for the longest reply: 0, and nothing is executed. `reply` may
 * be the buffer of the request, which is decoded before.
 */
uint16_t exchange_answer(const struct served *served, void *device, uint8_t framing, uint8_t address,
                         const uint8_t *request, uint16_t n, uint8_t *reply, uint16_t room);

uint8_t rtu_decode(struct exchange *asked, uint8_t address, const uint8_t *frame, uint16_t n);
uint16_t rtu_encode(const struct exchange *asked, uint8_t address, uint8_t refusal, struct reading *reading,
                    uint8_t *frame);

uint8_t lines_decode(struct exchange *asked, const uint8_t *line, uint16_t n);
uint16_t lines_encode(const struct exchange *asked, uint8_t refusal, struct reading *reading, uint8_t *line);

#endif
