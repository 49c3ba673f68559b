#include "../../program/hal.h"

#include "../../program/chip.h"
#include "../../program/clock.h"
#include "emulator.h"

enum { ANSWER_MOST_ms = 200, BEHIND_MOST_ms = 50 }; /* as in simavr/runner.c */

void __real_chip_sleep(void);

static int32_t driven_uA;

void hal_start(void)
{
    plant_line_start();
}

void hal_drive(int32_t current_uA)
{
    driven_uA = current_uA;
}

/*
 * Real hardware is never late, but the parent may be: the tick waits for an `in`, ANSWER_MOST_ms at most. The watchdog is
 * fed meanwhile, since the program has not failed.
 */
static void await_answer(void)
{
    const uint16_t began_ms = clock_ms();
    uint16_t waited_ms = 0;
    while (!emulator.answered && waited_ms < ANSWER_MOST_ms) {
        chip_feed_watchdog();
        __real_chip_sleep();
        emulator_obey();
        waited_ms = (uint16_t)(clock_ms() - began_ms);
    }
    if (waited_ms > BEHIND_MOST_ms) {
        time_forget(waited_ms);
        plant_line_say("behind", 1, &(const int32_t){waited_ms});
    }
}

void hal_mark_tick(void)
{
    emulator.in_tick = true;
    if (emulator.held)
        return;
    emulator.answered = false;
    plant_line_say("out", 1, &driven_uA);
    await_answer();
}

void hal_measure(int32_t *first, int32_t *second, int16_t *temperature, uint16_t *hardware)
{
    *first = emulator.first;
    *second = emulator.second;
    *temperature = (int16_t)emulator.temperature;
    *hardware = (uint16_t)emulator.hardware;
    emulator.in_tick = false;
}

int32_t hal_counts(void)
{
    return emulator.first;
}
