/*
 * Interrupts only collect bytes and count milliseconds. Ticks and exchanges both run in the main loop, one after the
 * other, so that no interrupt ever sees the device half changed.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdbool.h>

#include "clock.h"
#include "device.h"
#include "link.h"

/* After a watchdog reset the watchdog goes on with its shortest time: stop it before anything else. */
void stop_watchdog(void) __attribute__((naked, used, section(".init3")));
void stop_watchdog(void)
{
    MCUSR = 0;
    wdt_disable();
}

/* Between the beginning of a tick, when its current begins to flow, and its measurement. */
#define SETTLE_ms 5

static struct {
    uint16_t began_ms, period_ms;
    bool settling; /* no exchange meanwhile: what is measured belongs to the current that was set */
} running;

static bool exchange(void)
{
    const uint8_t *request;
    const uint16_t n = running.settling ? 0 : link_request(&request);
    if (n)
        link_reply(device_answer(request, n, link_room(), REPLY_ROOM));
    return n;
}

/* With a new period time begins anew, or a change from a long to a short one would be a burst of ticks. */
static void follow_period(void)
{
    if (running.period_ms == device_period_ms())
        return;
    running.period_ms = device_period_ms();
    running.began_ms = clock_ms();
}

static bool tick(void)
{
    follow_period();
    const uint16_t since_ms = (uint16_t)(clock_ms() - running.began_ms);
    const uint16_t settle_ms = running.period_ms / 2 < SETTLE_ms ? running.period_ms / 2 : SETTLE_ms;
    if (running.settling && since_ms >= settle_ms) {
        running.settling = false;
        device_end_tick();
        return true;
    }
    if (running.settling || since_ms < running.period_ms)
        return false;
    running.began_ms = (uint16_t)(running.began_ms + running.period_ms);
    running.settling = true;
    device_begin_tick();
    return true;
}

int main(void)
{
    device_boot(clock_count_boot());
    clock_start();
    link_start();
    wdt_enable(WDTO_120MS); /* far below the shortest lease */
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
    for (;;) {
        wdt_reset(); /* here and nowhere else */
        if (!tick() && !exchange())
            sleep_mode(); /* until the next interrupt: at most a millisecond */
    }
}
