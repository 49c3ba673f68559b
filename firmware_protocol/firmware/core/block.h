/*
 * The common part of both devices' maps: a status block that is read, a command and a settings block that are also
 * written. Addresses and limits come only from smarig_registers.h, through VALUE.
 */
#ifndef SMARIG_BLOCK_H
#define SMARIG_BLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include <stdbool.h>

#include "exchange.h"
#include "flash.h"

/* A writable value; `negative`: its words are signed, and so are its limits. */
struct value {
    uint16_t address;
    uint8_t words;
    bool negative;
    uint32_t least, most, safe;
};
#define VALUE(name, words) \
    {name, words, name##_LEAST < 0, (uint32_t)name##_LEAST, (uint32_t)name##_MOST, (uint32_t)name##_SAFE}

/* Consecutive values in flash, in order of address. */
struct block {
    const struct value *values;
    uint8_t count;
    uint16_t first, size; /* address of the first word; words */
};
#define BLOCK(values, name) {values, sizeof(values) / sizeof((values)[0]), name##_FIRST, name##_WORDS}

struct map {
    struct block command, settings;
    uint16_t status_at, status_words;
    bool (*inside_value)(uint16_t address); /* of the status block: whether this is the low word of a 32-bit value */
};

/* Sets every value to its safe value. */
void block_boot(const struct block *block, uint16_t *words);

static inline bool block_is(const struct block *block, uint16_t address)
{
    return block->first == address;
}

/* All checks of an exchange that do not depend on the device's state. */
uint8_t map_check(const struct map *map, const struct exchange *asked);

#endif
