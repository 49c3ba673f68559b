/* The samples that a host can read. Ticks count from 1 and wrap; sample t is at index t modulo the ring's size. */
#ifndef SMARIG_RING_H
#define SMARIG_RING_H

#include <stdint.h>

struct window {
    uint32_t first;
    uint8_t count; /* at most 24: the records of a reply */
};

/*
 * The window after tick `tick`, of whose samples the ring has `kept`, for a host that has read all samples before `next`
 * and reads at most `want`.
 */
struct window ring_window(uint32_t tick, uint16_t kept, uint32_t next, uint16_t want);

#endif
