#ifdef FRAMING_rtu
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../program/link.h"
#include "../program/serial.h"

#define TIMER1_PER_ms (F_CPU / 8 / 1000)

ISR(TIMER1_COMPA_vect)
{
    TCCR1B = 0;
    link_silence();
}

void silence_start(void)
{
    OCR1A = (uint16_t)(SILENCE_us * TIMER1_PER_ms / 1000);
    TIMSK1 = 1 << OCIE1A;
}

void silence_restart(void)
{
    TCNT1 = 0;
    TIFR1 = 1 << OCF1A;
    TCCR1B = 1 << CS11;
}

#else
typedef int lines_end_without_a_silence; /* ISO C requires a declaration in every file */
#endif
