#include "../program/chip.h"

#include "interrupts.h"
#include "lm3s6965.h"

enum { WATCHDOG_ON = 1 << 0, WATCHDOG_RESETS = 1 << 1 };

/* It counts to zero twice before it resets the chip: 240 ms. */
#define WATCHDOG_HALF_ms 120

void chip_run(void)
{
    WATCHDOG_LOAD = CLOCK_Hz / 1000 * WATCHDOG_HALF_ms;
    WATCHDOG_CTL = WATCHDOG_RESETS;
    WATCHDOG_CTL = WATCHDOG_RESETS | WATCHDOG_ON;
    WATCHDOG_LOCK = 1; /* no stray write stops it */
    interrupts_as(0);
}

void chip_feed_watchdog(void)
{
    WATCHDOG_LOCK = 0x1ACCE551;
    WATCHDOG_ICR = 1;
    WATCHDOG_LOCK = 1;
}

void chip_sleep(void)
{
    __asm__ volatile("wfi" : : : "memory");
}
