/* Timer 0 counts down once from the last byte. */
#ifdef FRAMING_rtu
#include "../program/atomic.h"
#include "../program/link.h"
#include "../program/serial.h"
#include "interrupts.h"
#include "lm3s6965.h"

enum { TIMER_A = 1 << 0, ONE_SHOT = 1 };

/* In one piece: a byte in between would restart the timer of a silence that is over. And only what was seen is
 * acknowledged: a silence that ends meanwhile is the next one. */
void silence_interrupt(void)
{
    ATOMICALLY
    {
        if (TIMER0_MIS) { /* not if a byte came at the last moment, whose interrupt was served first */
            TIMER0_ICR = TIMER_A;
            link_silence();
        }
    }
}

void silence_start(void)
{
    TIMER0_CFG = 0; /* 32 bits */
    TIMER0_TAMR = ONE_SHOT;
    TIMER0_IMR = TIMER_A;
    NVIC_PRIORITY(INTERRUPT_TIMER0A) = PRIORITY_SILENCE;
    NVIC_ISER = 1ul << INTERRUPT_TIMER0A;
}

void silence_restart(void)
{
    TIMER0_CTL = 0;
    TIMER0_ICR = TIMER_A;
    TIMER0_TAILR = CLOCK_Hz / 1000000 * SILENCE_us;
    TIMER0_CTL = TIMER_A;
}

#else
typedef int lines_end_without_a_silence; /* ISO C requires a declaration in every file */
#endif
