#include "../program/clock.h"

#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

static volatile uint16_t now_ms;
static uint32_t EEMEM boots; /* all ones in an erased EEPROM, which wraps to 0 */

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

/* From the high byte down: whatever the supply leaves half written is more than every count before. */
uint32_t clock_count_boot(void)
{
    const uint32_t count = eeprom_read_dword(&boots) + 1;
    for (uint8_t i = sizeof count; i--;)
        eeprom_update_byte((uint8_t *)&boots + i, (uint8_t)(count >> 8 * i));
    return count;
}
