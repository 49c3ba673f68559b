#include <stddef.h>

#include "../../program/chip.h"
#include "../../program/device.h"
#include "../../program/link.h"
#include "../lm3s6965.h"
#include "emulator.h"

enum { NUMBERS_MOST = 4 };
static const int32_t NONE[1];

void __real_chip_sleep(void);
void __wrap_chip_sleep(void);
void __real_link_reply(uint16_t n);
void __wrap_link_reply(uint16_t n);

struct emulator emulator;

/* What follows `word` on the line, or NULL if it is another word. */
static const char *after(const char *line, const char *word)
{
    while (*word)
        if (*line++ != *word++)
            return NULL;
    return *line == ' ' || *line == 0 ? line : NULL;
}

/* Reads decimal numbers, each after one blank; returns how many. */
static uint8_t read_numbers(const char *text, int32_t *numbers)
{
    uint8_t count = 0;
    while (*text == ' ' && count < NUMBERS_MOST) {
        uint32_t value = 0;
        const bool negative = text[1] == '-';
        for (text += negative ? 2 : 1; *text >= '0' && *text <= '9'; text++)
            value = 10 * value + (uint32_t)(*text - '0');
        numbers[count++] = (int32_t)(negative ? 0u - value : value);
    }
    return count;
}

/* Four of an amplifier, three of a DAQ; fewer change nothing. */
static void take_inputs(const char *text)
{
    int32_t v[NUMBERS_MOST];
    const uint8_t count = read_numbers(text, v);
    if (count < 3)
        return;
    emulator.first = v[0];
    emulator.second = count == 4 ? v[1] : 0;
    emulator.temperature = v[count - 2];
    emulator.hardware = v[count - 1];
}

static void hang(void)
{
    for (;;)
        ; /* with interrupts still running: only the watchdog helps */
}

static void reset_chip(void)
{
    SCB_AIRCR = 0x05FA0004;
    hang();
}

/* Commands for exchanges whose ticks are given. */
static void obey_held(const char *line)
{
    int32_t number[NUMBERS_MOST];
    const char *rest;
    if ((rest = after(line, "tick"))) {
        take_inputs(rest);
        device_begin_tick();
        device_end_tick();
    } else if ((rest = after(line, "now")) && read_numbers(rest, number) == 1)
        emulator.first = number[0];
    else if ((rest = after(line, "boot")) && read_numbers(rest, number) == 1) {
        emulator.first = 0;
        device_boot((uint32_t)number[0]);
    } else {
        plant_line_say("what?", 0, NONE);
        return;
    }
    plant_line_say("done", 0, NONE);
}

static void obey(const char *line)
{
    const char *rest;
    if ((rest = after(line, "in"))) {
        take_inputs(rest);
        emulator.answered = true;
    } else if (after(line, "hang"))
        hang();
    else if (after(line, "reset"))
        reset_chip();
    else if (after(line, "hold"))
        emulator.hold_wanted = true;
    else
        obey_held(line);
}

/* Not within a tick, in which no request is answered. */
static void hold_if_wanted(void)
{
    if (!emulator.hold_wanted || emulator.held || emulator.in_tick)
        return;
    time_hold();
    emulator.held = true;
    plant_line_say("held", 0, NONE);
}

void emulator_obey(void)
{
    const char *line;
    while ((line = plant_line_read()))
        obey(line);
    hold_if_wanted();
}

/* The linker puts these two in place of what the main loop calls. */

void __wrap_chip_sleep(void)
{
    emulator_obey();
    __real_chip_sleep();
}

/* It is said when the next request may come. */
void __wrap_link_reply(uint16_t n)
{
    const uint8_t *request;
    const int32_t lengths[] = {link_request(&request), n};
    __real_link_reply(n);
    if (emulator.held)
        plant_line_say("answered", 2, lengths);
}
