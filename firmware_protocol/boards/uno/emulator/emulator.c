/*
 * An Uno on its bench, on this machine: the firmware's ELF under simavr, INA219, AS5600 and ADC, the power stage and a
 * wire, the serial line as a pty.
 *
 *     uno_emulator ELF [--link PATH] [--speed X] [--wait MS] [--couple MS] [--trace FILE] [--seconds S]
 *
 * --link PATH  also a symbolic link to the pty, so that a rig file can name it
 * --speed X    device seconds per second; 1 without it, 0: as fast as this machine can
 * --wait MS    device time stops so long after the host's last byte until its next one, for 5 s at most: a busy machine
 *              then never makes a host late. A host that is silent for longer has ended, and time goes on
 * --couple MS  the parent is the wire: see below
 * --trace FILE one line per device millisecond: time, mean, least and largest current of the wire in uA, state of the
 *              LED, time of the host's last byte (all times in ms)
 * --seconds S  ends after so much device time
 *
 * Prints `pty PATH` once. Accepts on stdin, a line each:
 *     stop open | stop closed | unplug ina219 | plug ina219 | unplug as5600 | plug as5600 | magnet off | magnet on
 *     supply V | gain X            of the INA219
 *     turned COUNTS                the magnet, by hand
 *     reset | hang                 only the watchdog ends it
 *     hold                         from now on device time passes only by go
 *     go MS                        device time passes whatever the host does; then prints `went`
 *     now                          prints the device time in ms and the current of the wire in uA
 *     free                         prints the bytes of RAM that neither variables nor the stack have used so far
 * and calls of the firmware's functions, with DEVICE amp or daq:
 *     boot DEVICE COUNT | tick DEVICE INPUTS | now COUNTS | answer DEVICE ADDRESS HEX
 * With --couple, prints `flowed MEAN_SQUARE_A2` after each interval and waits for `wire OHM COUNTS AMBIENT_degC`.
 * The program ends when stdin is closed.
 */
#define _XOPEN_SOURCE 700
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"
#include "pace.h"
#include "serial_port.h"

enum { STEP_CYCLES = 16, CHUNK_CYCLES = 512, ms_CYCLES = F_CPU / 1000 };
enum { LAG_CYCLES = 3 }; /* gate driver and MOSFET turn off 0.2 us late */

static struct {
    struct pace pace;
    double seconds;
    long couple_ms;
    FILE *trace;
    const char *link;
} options = {.pace = {.speed = 1.0}};

static struct bench bench;
static struct serial_port port;

/* Sums over the present millisecond and over the present interval of the coupling. */
static struct {
    double current, least, largest, square, cycles, interval_square, interval_cycles;
} seen;

static void fail(const char *what)
{
    fprintf(stderr, "uno_emulator: %s\n", what);
    exit(1);
}

/* --- the bench: the power stage and the INA219 in steps of a microsecond --- */

static void note_current(double cycles)
{
    const double i = bench.power.wire_A;
    seen.current += i * cycles;
    seen.square += i * i * cycles;
    seen.least = seen.cycles ? fmin(seen.least, i) : i;
    seen.largest = seen.cycles ? fmax(seen.largest, i) : i;
    seen.cycles += cycles;
}

static void pass(bool gate, double cycles)
{
    while (cycles > 0) {
        const double step = fmin(cycles, STEP_CYCLES);
        power_stage_step(&bench.power, gate, step / F_CPU);
        sensors_step(&bench.sensors, step / F_CPU);
        note_current(step);
        cycles -= step;
    }
}

/* One period of the PWM. */
static avr_cycle_count_t chunk(avr_t *avr, avr_cycle_count_t when, void *param)
{
    const double share = chip_gate(&bench.chip);
    const double on = share > 0 ? fmin(share * CHUNK_CYCLES + LAG_CYCLES, CHUNK_CYCLES) : 0;
    (void)avr, (void)param;
    bench.power.wire_ohm = bench.wire.ohm;
    bench.sensors.as5600.counts = bench.wire.counts + bench.turned;
    pass(true, on);
    pass(false, CHUNK_CYCLES - on);
    return when + CHUNK_CYCLES;
}

static void run_bench(void)
{
    avr_cycle_timer_register(bench.chip.avr, CHUNK_CYCLES, chunk, NULL);
    serial_port_run(&port);
}

/* --- the parent --- */

static void couple(void)
{
    struct pollfd parent = {STDIN_FILENO, POLLIN, 0};
    printf("flowed %.9g\n", seen.interval_square / seen.interval_cycles);
    fflush(stdout);
    seen.interval_square = 0;
    seen.interval_cycles = 0;
    for (bench.answered = false; !bench.answered; commands_listen(&bench))
        poll(&parent, 1, 100);
}

/* --- every millisecond --- */

static void write_trace(long ms)
{
    if (options.trace)
        fprintf(options.trace, "%ld %.1f %.1f %.1f %d %.3f\n", ms, 1e6 * seen.current / seen.cycles,
                1e6 * seen.least, 1e6 * seen.largest, chip_led(&bench.chip),
                port.bytes ? (double)port.last_byte / ms_CYCLES : -1.0);
}

static void millisecond(long ms)
{
    write_trace(ms);
    seen.interval_square += seen.square;
    seen.interval_cycles += seen.cycles;
    if (options.couple_ms && ms % options.couple_ms == 0)
        couple();
    else if (!options.couple_ms)
        wire_heat(&bench.wire, seen.square / seen.cycles, 1e-3);
    seen.current = seen.square = seen.cycles = 0;
    commands_listen(&bench);
    pace_millisecond(options.pace, &bench, &port);
}

static void take_options(int argc, char **argv)
{
    for (int i = 2; i + 1 < argc; i += 2) {
        if (!strcmp(argv[i], "--speed"))
            options.pace.speed = atof(argv[i + 1]);
        else if (!strcmp(argv[i], "--seconds"))
            options.seconds = atof(argv[i + 1]);
        else if (!strcmp(argv[i], "--wait"))
            options.pace.wait_ms = atol(argv[i + 1]);
        else if (!strcmp(argv[i], "--link"))
            options.link = argv[i + 1];
        else if (!strcmp(argv[i], "--couple"))
            options.couple_ms = atol(argv[i + 1]);
        else if (!strcmp(argv[i], "--trace"))
            options.trace = fopen(argv[i + 1], "w");
        else
            fail("unknown option; its source begins with all options");
    }
}

/* Only a link of an earlier emulator is replaced, never a file. */
static void make_link(const char *pty)
{
    char there[1];
    if (readlink(options.link, there, sizeof there) > 0)
        unlink(options.link);
    if (symlink(pty, options.link))
        fail("the link cannot be made");
}

int main(int argc, char **argv)
{
    if (argc < 2 || argc % 2)
        fail("usage: uno_emulator ELF [OPTION VALUE]...; its source begins with all options");
    take_options(argc, argv);
    power_stage_start(&bench.power);
    wire_start(&bench.wire);
    if (!chip_load(&bench.chip, argv[1]))
        fail("the ELF cannot be read");
    sensors_connect(&bench.sensors, bench.chip.avr, &bench.power, &bench.wire);
    const char *path = serial_port_open(&port, bench.chip.avr);
    if (!path)
        fail("no pty");
    if (options.link)
        make_link(path);
    printf("pty %s\n", path);
    fflush(stdout);
    fcntl(STDIN_FILENO, F_SETFL, O_NONBLOCK);
    bench.chip.after_reset = run_bench;
    run_bench();
    for (long ms = 1; !options.seconds || (double)ms <= 1e3 * options.seconds; ms++) {
        if (!chip_run(&bench.chip, (avr_cycle_count_t)ms * ms_CYCLES))
            fail("the firmware crashed");
        millisecond(ms);
    }
    return 0;
}
