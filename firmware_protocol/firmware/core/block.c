#include "block.h"

#include "words.h"

static struct value value_at(const struct block *block, uint8_t i)
{
    struct value value;
    copy_from_flash(&value, &block->values[i], sizeof value);
    return value;
}

static uint16_t offset(const struct block *block, const struct value *value)
{
    return (uint16_t)(value->address - block->first);
}

static bool within(const struct value *value, const uint16_t *words)
{
    const uint32_t one_word = value->negative ? (uint32_t)(int16_t)words[0] : words[0];
    const uint32_t raw = value->words == 1 ? one_word : words_u32(words);
    if (value->negative)
        return (int32_t)raw >= (int32_t)value->least && (int32_t)raw <= (int32_t)value->most;
    return raw >= value->least && raw <= value->most;
}

void block_boot(const struct block *block, uint16_t *words)
{
    for (uint8_t i = 0; i < block->count; i++) {
        const struct value value = value_at(block, i);
        uint16_t *at = words + offset(block, &value);
        if (value.words == 2)
            words_put32(at, value.safe);
        else
            *at = (uint16_t)value.safe;
    }
}

/* Whether a border before word `at` of the block cuts a value in two. */
static bool cuts(const struct block *block, uint32_t at)
{
    for (uint8_t i = 0; i < block->count; i++) {
        const struct value value = value_at(block, i);
        if (value.words == 2 && at == offset(block, &value) + 1u)
            return true;
    }
    return false;
}

/* A write starts at the block's first register and ends with a complete value. */
static bool writable(const struct block *block, const struct exchange *asked)
{
    return block_is(block, asked->write_at) && asked->write_count <= block->size && !cuts(block, asked->write_count);
}

static bool in_range(const struct block *block, const struct exchange *asked)
{
    for (uint8_t i = 0; i < block->count; i++) {
        const struct value value = value_at(block, i);
        const uint16_t at = offset(block, &value);
        if (at >= asked->write_count)
            break;
        if (!within(&value, asked->words + at))
            return false;
    }
    return true;
}

static bool readable_block(const struct block *block, uint16_t at, uint16_t count)
{
    const uint16_t first = block->first;
    const uint32_t end = (uint32_t)at + count;
    return at >= first && end <= (uint32_t)first + block->size && !cuts(block, (uint32_t)at - first) &&
           !cuts(block, end - first);
}

static bool readable_status(const struct map *map, uint16_t at, uint16_t count)
{
    const uint32_t end = (uint32_t)at + count;
    const uint32_t after = (uint32_t)map->status_at + map->status_words;
    return at >= map->status_at && end <= after && !map->inside_value(at) &&
           (end == after || !map->inside_value((uint16_t)end));
}

static bool readable(const struct map *map, uint16_t at, uint16_t count)
{
    return readable_status(map, at, count) || readable_block(&map->command, at, count) ||
           readable_block(&map->settings, at, count);
}

uint8_t map_check(const struct map *map, const struct exchange *asked)
{
    const struct block *block = block_is(&map->command, asked->write_at) ? &map->command : &map->settings;
    if (asked->write_count && !writable(block, asked))
        return REFUSED_ADDRESS;
    if (asked->read_count && !readable(map, asked->read_at, asked->read_count))
        return REFUSED_ADDRESS;
    return asked->write_count && !in_range(block, asked) ? REFUSED_WORD : ACCEPTED;
}
