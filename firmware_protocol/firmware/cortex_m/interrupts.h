/* Interrupts off and on again, and the functions that interrupts call. */
#ifndef SMARIG_CORTEX_M_INTERRUPTS_H
#define SMARIG_CORTEX_M_INTERRUPTS_H

#include <stdint.h>

/* Returns how it was, for interrupts_as. */
static inline uint32_t interrupts_off(void)
{
    uint32_t was;
    __asm__ volatile("mrs %0, primask\n\tcpsid i" : "=r"(was) : : "memory");
    return was;
}

/* Returns 0. */
static inline uint32_t interrupts_as(uint32_t was)
{
    __asm__ volatile("msr primask, %0" : : "r"(was) : "memory");
    return 0;
}

void clock_interrupt(void);
void serial_interrupt(void);
void silence_interrupt(void);
void plant_line_interrupt(void);

#endif
