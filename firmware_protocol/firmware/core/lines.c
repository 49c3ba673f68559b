/* Lines of text: w ADDRESS WORD ... r ADDRESS COUNT *CRC */
#include <stdbool.h>

#include "crc.h"
#include "exchange.h"

enum { NO_DIGIT = 16, DIGITS_MOST = 4, MARK_LENGTH = 6 };

/* The unread rest of a line. */
struct text {
    const uint8_t *next, *end;
};

static uint8_t digit(uint8_t c)
{
    if (c >= '0' && c <= '9')
        return (uint8_t)(c - '0');
    c |= 0x20u; /* upper or lower case */
    return c >= 'a' && c <= 'f' ? (uint8_t)(c - 'a' + 10) : NO_DIGIT;
}

/* Reads at most four digits; returns their number. */
static uint8_t digits(struct text *text, uint16_t *value)
{
    uint8_t count = 0;
    *value = 0;
    while (count < DIGITS_MOST && text->next < text->end && digit(*text->next) != NO_DIGIT) {
        *value = (uint16_t)(*value << 4 | digit(*text->next++));
        count++;
    }
    return count;
}

static bool at_gap(const struct text *text)
{
    return text->next == text->end || *text->next == ' ';
}

/* Reads one blank and a number; reads nothing if there is none. */
static bool number(struct text *text, uint16_t *value)
{
    struct text ahead = *text;
    if (ahead.next == ahead.end || *ahead.next++ != ' ' || !digits(&ahead, value) || !at_gap(&ahead))
        return false;
    *text = ahead;
    return true;
}

static bool letter(struct text *text, char wanted)
{
    if (text->next == text->end || *text->next != (uint8_t)wanted)
        return false;
    text->next++;
    return true;
}

/* Words beyond the size of an exchange are counted but not stored, and the request is refused. */
static bool take_write(struct exchange *asked, struct text *text)
{
    uint16_t word;
    if (!number(text, &asked->write_at))
        return false;
    for (; number(text, &word); asked->write_count++)
        if (asked->write_count < WORDS_KEPT)
            asked->words[asked->write_count] = word;
    return asked->write_count > 0;
}

static bool take_read(struct exchange *asked, struct text *text)
{
    return number(text, &asked->read_at) && number(text, &asked->read_count);
}

static bool take(struct exchange *asked, struct text text, bool *reads)
{
    const bool writes = letter(&text, 'w');
    if (writes && !take_write(asked, &text))
        return false;
    if (writes && text.next == text.end)
        return true;
    if (writes && !letter(&text, ' '))
        return false;
    *reads = letter(&text, 'r');
    return *reads && take_read(asked, &text) && text.next == text.end;
}

/* Removes " *" and four digits from the end and returns their value; false and no change if they are missing. */
static bool cut_crc(struct text *text, uint16_t *said)
{
    if (text->end - text->next < MARK_LENGTH)
        return false;
    const uint8_t *mark = text->end - MARK_LENGTH;
    struct text rest = {mark + 2, text->end};
    if (mark[0] != ' ' || mark[1] != '*' || digits(&rest, said) != DIGITS_MOST)
        return false;
    text->end = mark;
    return true;
}

static uint8_t decode_text(struct exchange *asked, struct text text)
{
    bool reads = false;
    uint16_t said;
    const bool has_crc = cut_crc(&text, &said);
    if (has_crc && said != crc_modbus(text.next, (uint16_t)(text.end - text.next)))
        return REFUSED_CRC;
    if (!take(asked, text, &reads))
        return REFUSED_LINE;
    if (asked->write_count && !has_crc)
        return REFUSED_CRC;
    if (asked->write_count > WRITE_MOST || asked->read_count > READ_MOST || (reads && !asked->read_count))
        return REFUSED_WORD;
    return ACCEPTED;
}

uint8_t lines_decode(struct exchange *asked, const uint8_t *line, uint16_t n)
{
    if (!n || line[--n] != '\n')
        return NOT_ANSWERED; /* not a complete line */
    if (n && line[n - 1] == '\r')
        n--;
    if (!n)
        return NOT_ANSWERED;
    const struct text text = {line, line + n};
    return n > LINE_MOST ? REFUSED_LINE : decode_text(asked, text);
}

static uint8_t *put(uint8_t *at, uint16_t word)
{
    for (int8_t shift = 12; shift >= 0; shift = (int8_t)(shift - 4))
        *at++ = (uint8_t)"0123456789ABCDEF"[word >> shift & 0xFu];
    return at;
}

static uint8_t *put_end(uint8_t *at, const uint8_t *line)
{
    const uint16_t crc = crc_modbus(line, (uint16_t)(at - line));
    *at++ = ' ';
    *at++ = '*';
    at = put(at, crc);
    *at++ = '\n';
    return at;
}

uint16_t lines_encode(const struct exchange *asked, uint8_t refusal, struct reading *reading, uint8_t *line)
{
    uint8_t *at = line;
    *at++ = refusal ? '!' : '=';
    if (refusal) {
        *at++ = ' ';
        *at++ = (uint8_t)('0' + refusal);
    }
    for (uint16_t i = 0; !refusal && i < asked->read_count; i++) {
        *at++ = ' ';
        at = put(at, reading_word(reading, asked, i));
    }
    return (uint16_t)(put_end(at, line) - line);
}
