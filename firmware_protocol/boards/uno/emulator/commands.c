#define _XOPEN_SOURCE 700
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- calls of the firmware's functions, for exchanges whose ticks are given --- */

static uint16_t in_ram(struct bench *b, const char *name, uint16_t offset)
{
    return (uint16_t)(chip_symbol(&b->chip, name) + offset);
}

/* A 32-bit argument takes r20 to r23, its low word in the lower pair. */
static void boot(struct bench *b, const char *device, uint32_t count)
{
    char name[32];
    const bool amp = !strcmp(device, "amp");
    const uint16_t words[] = {in_ram(b, amp ? "amp" : "daq", 0), (uint16_t)(count >> 16), (uint16_t)count};
    snprintf(name, sizeof name, "%s_boot", amp ? "amplifier" : "encoder_daq");
    chip_call(&b->chip, name, words, 3);
    puts("done");
}

/* The inputs of a tick lie in the serial buffer, which is free. */
static void tick(struct bench *b, const char *device, const long *v)
{
    const bool amp = !strcmp(device, "amp");
    const uint16_t at = in_ram(b, "buffer", 0);
    uint8_t *bytes = b->chip.avr->data + at;
    const int32_t numbers[] = {(int32_t)v[0], (int32_t)v[1]};
    const int wide = amp ? 2 : 1;
    memcpy(bytes, numbers, 4 * (size_t)wide);
    const int16_t temperature = (int16_t)v[wide];
    const uint16_t hardware = (uint16_t)v[wide + 1];
    memcpy(bytes + 4 * wide, &temperature, 2);
    memcpy(bytes + 4 * wide + 2, &hardware, 2);
    const uint16_t words[] = {in_ram(b, amp ? "amp" : "daq", 0), at};
    chip_call(&b->chip, amp ? "amplifier_tick" : "encoder_daq_tick", words, 2);
    puts("done");
}

static void now(struct bench *b, long counts)
{
    const uint16_t words[] = {in_ram(b, "daq", 0), (uint16_t)((uint32_t)counts >> 16), (uint16_t)counts};
    chip_call(&b->chip, "encoder_daq_now", words, 3);
    puts("done");
}

/* Address of the device, then the frame as hexadecimal digits. */
static void answer(struct bench *b, const char *device, unsigned address, const char *hex)
{
    enum { ROOM = 256, LONGEST = 257 };
    const uint16_t at = in_ram(b, "buffer", 0);
    uint8_t *bytes = b->chip.avr->data + at;
    uint16_t n = 0;
    for (unsigned byte; n < LONGEST && sscanf(hex + 2 * n, "%2x", &byte) == 1; n++)
        bytes[n] = (uint8_t)byte;
    const bool amp = !strcmp(device, "amp");
    const uint16_t words[] = {in_ram(b, amp ? "amp" : "daq", 0), 0, (uint16_t)address, at, n, at, ROOM};
    const uint16_t length = chip_call(&b->chip, amp ? "amplifier_answer" : "encoder_daq_answer", words, 7);
    printf("reply ");
    for (uint16_t i = 0; i < length; i++)
        printf("%02x", bytes[i]);
    puts("");
}

static bool called(struct bench *b, const char *line)
{
    char device[8], hex[1024] = "";
    long v[4] = {0};
    unsigned number;
    if (sscanf(line, "boot %7s %u", device, &number) == 2)
        boot(b, device, number);
    else if (sscanf(line, "tick %7s %ld %ld %ld %ld", device, v, v + 1, v + 2, v + 3) >= 4)
        tick(b, device, v);
    else if (sscanf(line, "now %ld", v) == 1)
        now(b, v[0]);
    else if (sscanf(line, "answer %7s %u %1023s", device, &number, hex) >= 2)
        answer(b, device, number, hex);
    else
        return false;
    return true;
}

/* --- the bench --- */

static bool changed(struct bench *b, const char *line)
{
    const struct {
        const char *text;
        bool *what, value;
    } switches[] = {
        {"unplug ina219", &b->sensors.ina219.unplugged, true},
        {"plug ina219", &b->sensors.ina219.unplugged, false},
        {"unplug as5600", &b->sensors.as5600.unplugged, true},
        {"plug as5600", &b->sensors.as5600.unplugged, false},
        {"magnet off", &b->sensors.as5600.no_magnet, true},
        {"magnet on", &b->sensors.as5600.no_magnet, false},
    };
    for (size_t i = 0; i < sizeof switches / sizeof switches[0]; i++)
        if (!strcmp(line, switches[i].text)) {
            *switches[i].what = switches[i].value;
            return true;
        }
    return false;
}

static void obey(struct bench *b, const char *line)
{
    double ohm, counts, ambient;
    if (sscanf(line, "wire %lf %lf %lf", &ohm, &counts, &ambient) == 3) {
        b->wire.ohm = ohm;
        b->wire.counts = counts;
        b->wire.ambient_degC = ambient;
        b->answered = true;
    } else if (sscanf(line, "supply %lf", &ohm) == 1)
        b->power.supply_V = ohm;
    else if (sscanf(line, "turned %lf", &ohm) == 1)
        b->turned = ohm;
    else if (sscanf(line, "gain %lf", &ohm) == 1)
        b->sensors.ina219.gain = ohm;
    else if (!strcmp(line, "stop open") || !strcmp(line, "stop closed"))
        chip_open_stop(&b->chip, line[5] == 'o');
    else if (sscanf(line, "go %lf", &ohm) == 1)
        b->go_ms = (long)ohm;
    else if (!strcmp(line, "hold"))
        b->held = true;
    else if (!strcmp(line, "reset"))
        chip_reset(&b->chip);
    else if (!strcmp(line, "hang"))
        chip_hang(&b->chip);
    else if (!strcmp(line, "now"))
        printf("now %lu %.0f\n", (unsigned long)(b->chip.avr->cycle / (F_CPU / 1000)), 1e6 * b->power.wire_A);
    else if (!strcmp(line, "free"))
        printf("free %u\n", chip_free_ram(&b->chip));
    else if (!changed(b, line) && !called(b, line))
        fprintf(stderr, "uno_emulator: what is '%s'?\n", line);
    fflush(stdout);
}

void commands_listen(struct bench *b)
{
    static char line[2048];
    static size_t length;
    char c;
    ssize_t n;
    while ((n = read(STDIN_FILENO, &c, 1)) == 1) {
        if (c != '\n') {
            if (length < sizeof line - 1)
                line[length++] = c;
            continue;
        }
        line[length] = 0;
        length = 0;
        obey(b, line);
    }
    if (n == 0)
        exit(0);
}
