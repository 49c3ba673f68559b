#include "ring.h"

struct window ring_window(uint32_t tick, uint16_t size, uint32_t next, uint16_t want)
{
    const uint32_t oldest = tick > size ? tick - size + 1 : 1;
    struct window window = {next, 0};
    if (next > tick || tick == 0)
        return window;
    if (next < oldest)
        window.first = oldest; /* the host sees the number of lost samples */
    const uint32_t there = tick - window.first + 1;
    window.count = there < want ? (uint16_t)there : want;
    return window;
}
