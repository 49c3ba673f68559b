#include "../program/clock.h"

#include "interrupts.h"
#include "lm3s6965.h"

static volatile uint16_t now_ms;

void clock_interrupt(void)
{
    now_ms++;
}

/* SysTick counts the clock down from one millisecond. */
void clock_start(void)
{
    SCB_PRIORITY_SYSTICK = PRIORITY_CLOCK;
    SYSTICK_LOAD = CLOCK_Hz / 1000 - 1;
    SYSTICK_VAL = 0;
    SYSTICK_CTRL = 1 << 0 | 1 << 1 | 1 << 2;
}

uint16_t clock_ms(void)
{
    return now_ms;
}

/*
 * The count is kept in SRAM that no start clears: it outlives a reset by the watchdog, but no loss of supply, after which
 * it is 1 again. A board keeps it in flash or in an EEPROM; QEMU models no writing of flash.
 */
static struct {
    uint32_t boots, inverted;
} kept __attribute__((section(".kept")));

uint32_t clock_count_boot(void)
{
    if (kept.boots != ~kept.inverted)
        kept.boots = 0;
    kept.boots++;
    kept.inverted = ~kept.boots;
    return kept.boots;
}
