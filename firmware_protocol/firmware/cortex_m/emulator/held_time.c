/* The clock of the program as the main loop sees it: the linker puts __wrap_clock_ms in place of clock_ms. */
#include "../../program/clock.h"
#include "emulator.h"

uint16_t __real_clock_ms(void);
uint16_t __wrap_clock_ms(void);

static bool standing;
static uint16_t stood_at_ms, forgotten_ms;

uint16_t __wrap_clock_ms(void)
{
    return standing ? stood_at_ms : (uint16_t)(__real_clock_ms() - forgotten_ms);
}

void time_hold(void)
{
    stood_at_ms = clock_ms();
    standing = true;
}

void time_forget(uint16_t ms)
{
    forgotten_ms = (uint16_t)(forgotten_ms + ms);
}
