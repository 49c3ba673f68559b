#include "../program/clock.h"

#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

static volatile uint16_t now_ms;
static uint16_t EEMEM boots; /* 65535 in an erased EEPROM, which wraps to 0 */

ISR(TIMER0_COMPA_vect)
{
    now_ms++;
}

/* Timer 0 counts F_CPU/256 up to one millisecond. */
void clock_start(void)
{
    OCR0A = (uint8_t)(F_CPU / 256 / 1000 - 1);
    TCCR0A = 1 << WGM01;
    TCCR0B = 1 << CS02;
    TIMSK0 = 1 << OCIE0A;
}

uint16_t clock_ms(void)
{
    uint16_t ms;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        ms = now_ms;
    }
    return ms;
}

uint16_t clock_count_boot(void)
{
    const uint16_t count = (uint16_t)(eeprom_read_word(&boots) + 1);
    eeprom_update_word(&boots, count);
    return count;
}
