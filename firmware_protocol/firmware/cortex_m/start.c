/* What happens from reset to main: the vector table, the variables, and the clock of 50 MHz. */
#include "interrupts.h"
#include "lm3s6965.h"

extern uint32_t data_in_flash[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[]; /* of lm3s6965.ld */

int main(void);
void reset(void);

enum {
    RCC_MAIN_OSCILLATOR_OFF = 1 << 0,
    RCC_SOURCE = 3 << 4,
    RCC_CRYSTAL = 15 << 6,
    RCC_CRYSTAL_8_MHz = 14 << 6,
    RCC_BYPASS = 1 << 11,
    RCC_PLL_OFF = 1 << 13,
    RCC_USE_DIVIDER = 1 << 22,
    RCC_DIVIDER = 15 << 23,
    RCC_DIVIDE_BY_4 = 3 << 23,
    RIS_PLL_LOCKED = 1 << 6
};

/* PLL of 200 MHz from a crystal of 8 MHz, divided by four; until it has locked, the crystal itself. */
static void start_clock(void)
{
    SYSCTL_RCC = (SYSCTL_RCC | RCC_BYPASS) & ~(uint32_t)(RCC_USE_DIVIDER | RCC_MAIN_OSCILLATOR_OFF);
    SYSCTL_RCC = (SYSCTL_RCC & ~(uint32_t)(RCC_SOURCE | RCC_CRYSTAL | RCC_PLL_OFF)) | RCC_CRYSTAL_8_MHz;
    SYSCTL_RCC = (SYSCTL_RCC & ~(uint32_t)RCC_DIVIDER) | RCC_DIVIDE_BY_4 | RCC_USE_DIVIDER;
    while (!(SYSCTL_RIS & RIS_PLL_LOCKED))
        ; /* without a clock there is nothing to do: the output is off after reset */
    SYSCTL_RCC &= ~(uint32_t)RCC_BYPASS;
}

/* Watchdog; UART 0 and 1, timer 0; ports A and D. */
static void start_peripherals(void)
{
    SYSCTL_RCGC0 |= 1ul << 3;
    SYSCTL_RCGC1 |= 1ul << 0 | 1ul << 1 | 1ul << 16;
    SYSCTL_RCGC2 |= 1ul << 0 | 1ul << 3;
    (void)SYSCTL_RCGC2; /* they answer some cycles later */
}

void reset(void)
{
    (void)interrupts_off(); /* until chip_run */
    const uint32_t *from = data_in_flash;
    for (uint32_t *to = data_begin; to < data_end;)
        *to++ = *from++;
    for (uint32_t *to = bss_begin; to < bss_end;)
        *to++ = 0;
    start_clock();
    start_peripherals();
    main();
}

/* The watchdog ends it. */
static void fault(void)
{
    for (;;)
        ;
}

struct vectors {
    uint32_t *stack;
    void (*exceptions[15])(void);
    void (*interrupts[INTERRUPT_TIMER0A + 1])(void);
};

const struct vectors vectors __attribute__((used, section(".vectors"))) = {
    stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, clock_interrupt},
    {
        [INTERRUPT_UART0] = serial_interrupt,
        [INTERRUPT_UART1] = plant_line_interrupt,
#ifdef FRAMING_rtu
        [INTERRUPT_TIMER0A] = silence_interrupt,
#endif
    },
};
