#include "ring.h"

#define HALF 0x80000000ul /* of all ticks: what is less than this ago is the past */

struct window ring_window(uint32_t tick, uint16_t kept, uint32_t next, uint16_t want)
{
    const uint32_t ago = tick - next; /* also right when `tick` has wrapped since `next` */
    struct window window = {next, 0};
    if (kept == 0 || ago >= HALF)
        return window;
    if (ago >= kept)
        window.first = tick - kept + 1; /* the host sees the number of lost samples */
    const uint32_t there = tick - window.first + 1;
    window.count = (uint8_t)(there < want ? there : want);
    return window;
}
