/*
 * An Arduino Uno as amplifier and encoder DAQ on one serial line. Interrupts collect bytes, read the sensors, and keep
 * the current; ticks and exchanges run one after the other in the main loop, so none sees a partly changed device.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdbool.h>

#include "analog.h"
#include "bus.h"
#include "clock.h"
#include "current_loop.h"
#include "devices.h"
#include "led.h"
#include "link.h"
#include "stop.h"

/* After a watchdog reset the watchdog keeps running with its shortest time: stop it first. */
void stop_watchdog(void) __attribute__((naked, used, section(".init3")));
void stop_watchdog(void)
{
    MCUSR = 0;
    wdt_disable();
}

static bool exchange(void)
{
    const uint16_t n = devices_are_measuring() ? 0 : link_request();
    if (n)
        link_reply(devices_answer(link_buffer(), n));
    return n;
}

int main(void)
{
    current_loop_start(); /* first: the gate is low from here on, and before by its resistor */
    stop_start();
    led_start();
    analog_start();
    bus_start();
    devices_boot(clock_count_boot());
    link_start();
    clock_start();
    wdt_enable(WDTO_120MS); /* much less than the shortest lease */
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
    for (;;) {
        wdt_reset(); /* the only place */
        const uint16_t now_ms = clock_ms();
        devices_show(now_ms);
        if (!devices_tick(now_ms) && !exchange())
            sleep_mode(); /* until the next interrupt, at most one millisecond */
    }
}
