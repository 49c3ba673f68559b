/* The order of commands. A word is new if it is one of the next after the last accepted one; all others are repetitions
 * or old frames that the line delivers late. 0, the value at boot, is before 1, and 1 follows 65535. */
#ifndef SMARIG_SEQUENCE_H
#define SMARIG_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>

#define SEQUENCE_AHEAD 256u /* commands that may have been lost on the line */

static inline bool sequence_is_new(uint16_t last, uint16_t word)
{
    return ((uint32_t)word + 65535u - last - 1u) % 65535u < SEQUENCE_AHEAD;
}

#endif
