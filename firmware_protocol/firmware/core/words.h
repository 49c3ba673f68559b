/* 32-bit values take two words, high word first, in memory and in frames. */
#ifndef SMARIG_WORDS_H
#define SMARIG_WORDS_H

#include <stdint.h>

static inline uint32_t words_u32(const uint16_t *words)
{
    return (uint32_t)words[0] << 16 | words[1];
}

static inline int32_t words_i32(const uint16_t *words)
{
    return (int32_t)words_u32(words);
}

static inline void words_put32(uint16_t *words, uint32_t value)
{
    words[0] = (uint16_t)(value >> 16);
    words[1] = (uint16_t)(value & 0xFFFFu);
}

#endif
