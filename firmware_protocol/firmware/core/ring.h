/* Which samples a host is shown. Ticks count from 1; sample t stands at t modulo the ring's size. */
#ifndef SMARIG_RING_H
#define SMARIG_RING_H

#include <stdint.h>

struct window {
    uint32_t first;
    uint16_t count;
};

/* The window for a host that has seen everything before `next` and takes at most `want`, after tick `tick`. */
struct window ring_window(uint32_t tick, uint16_t size, uint32_t next, uint16_t want);

#endif
