#include "stop.h"

#include <stdint.h>
#include <util/atomic.h>

#include "board.h"
#include "current_loop.h"

enum { BOUNCE_ms = 2 };

static volatile uint8_t open_ms; /* how long, at most BOUNCE_ms */
static volatile bool seen;

void stop_start(void)
{
    PORTD |= 1 << STOP_PIN; /* pull-up */
}

void stop_watch(void)
{
    if (!(PIND & 1 << STOP_PIN))
        open_ms = 0;
    else if (open_ms < BOUNCE_ms)
        open_ms++;
    if (!stop_is_open())
        return;
    seen = true;
    current_loop_off();
}

bool stop_is_open(void)
{
    return open_ms == BOUNCE_ms;
}

bool stop_was_open(void)
{
    bool was;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        was = seen;
        seen = stop_is_open();
    }
    return was;
}
