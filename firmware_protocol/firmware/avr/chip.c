#include "../program/chip.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

/* After a watchdog reset the watchdog keeps running with its shortest time: stop it first. */
void stop_watchdog(void) __attribute__((naked, used, section(".init3")));
void stop_watchdog(void)
{
    MCUSR = 0;
    wdt_disable();
}

void chip_run(void)
{
    wdt_enable(WDTO_120MS);
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
}

void chip_feed_watchdog(void)
{
    wdt_reset();
}

void chip_sleep(void)
{
    sleep_mode();
}
