/*
 * Interrupts only collect bytes and count milliseconds. Ticks and exchanges run one after the other in the main loop,
 * so no interrupt sees a partly changed device.
 */
#include <stdbool.h>

#include "chip.h"
#include "clock.h"
#include "device.h"
#include "hal.h"
#include "link.h"

/* Time between the start of a tick, when its current starts to flow, and its measurement. */
#define SETTLE_ms 5

static struct {
    uint16_t began_ms, period_ms;
    bool settling; /* no exchange meanwhile: the measurement belongs to the current that was set */
} running;

static bool exchange(void)
{
    const uint8_t *request;
    const uint16_t n = running.settling ? 0 : link_request(&request);
    if (n)
        link_reply(device_answer(request, n, link_room(), REPLY_ROOM));
    return n;
}

/* A new period restarts the time; otherwise a change from a long to a short period causes a burst of ticks. */
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
    hal_start();
    device_boot(clock_count_boot());
    clock_start();
    link_start();
    chip_run();
    for (;;) {
        chip_feed_watchdog(); /* the only place */
        if (!tick() && !exchange())
            chip_sleep();
    }
}
