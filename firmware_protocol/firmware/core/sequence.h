/*
 * Which commands are executed: those made for this boot, with one of the next numbers. Numbers do not wrap and boots are
 * counted, so each pair of both is executed once at most: no frame is new again. After the last number nothing is new
 * until the device is restarted (100 commands a second count for 497 days).
 */
#ifndef SMARIG_SEQUENCE_H
#define SMARIG_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>

#define SEQUENCE_AHEAD 256u /* commands that may have been lost on the line */

/* Where counting begins. A build for tests begins just below a wrap. */
#ifndef FIRST_SEQUENCE
#define FIRST_SEQUENCE 0ul
#endif
#ifndef FIRST_TICK
#define FIRST_TICK 0ul
#endif

static inline bool sequence_is_new(uint32_t last, uint32_t sequence)
{
    return sequence > last && sequence - last <= SEQUENCE_AHEAD;
}

#endif
