/* The samples that a host can read. Ticks count from 1; sample t is at index t modulo the ring's size. */
#ifndef SMARIG_RING_H
#define SMARIG_RING_H

#include <stdint.h>

struct window {
    uint32_t first;
    uint16_t count;
};

/* The window after tick `tick` for a host that has read all samples before `next` and reads at most `want`. */
struct window ring_window(uint32_t tick, uint16_t size, uint32_t next, uint16_t want);

#endif
