#define _XOPEN_SOURCE 700
#include "pace.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { ms_CYCLES = F_CPU / 1000, HOST_WAIT_s = 5, BEHIND_MOST_ms = 50 };

static double clock_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void sleep_s(double seconds)
{
    const struct timespec t = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&t, NULL);
}

/* Time that this machine has lost is skipped, so that the device never runs faster for long. */
static void keep_pace(double speed)
{
    static double due_s;
    if (speed <= 0)
        return;
    const double now_s = clock_s();
    due_s = due_s ? due_s + 1e-3 / speed : now_s;
    if (now_s > due_s + BEHIND_MOST_ms * 1e-3)
        due_s = now_s;
    else if (due_s > now_s)
        sleep_s(due_s - now_s);
}

static void wait_for_host(long wait_ms, struct bench *bench, const struct serial_port *port)
{
    static unsigned long ended_after; /* so many bytes, no more came */
    static avr_cycle_count_t from;
    if (bench->go_ms) {
        from = bench->chip.avr->cycle;
        if (!--bench->go_ms) {
            puts("went");
            fflush(stdout);
        }
        return;
    }
    from = port->last_byte > from ? port->last_byte : from;
    const avr_cycle_count_t silent = bench->chip.avr->cycle - from;
    if (!wait_ms || port->bytes == ended_after || silent < (avr_cycle_count_t)wait_ms * ms_CYCLES)
        return;
    struct pollfd host = {port->pty, POLLIN, 0};
    const double end_s = clock_s() + HOST_WAIT_s;
    while (poll(&host, 1, 10) == 0 && !bench->go_ms) {
        commands_listen(bench);
        if (clock_s() < end_s)
            continue;
        ended_after = port->bytes;
        return;
    }
}

static void wait_while_held(struct bench *bench)
{
    struct pollfd parent = {STDIN_FILENO, POLLIN, 0};
    while (bench->held && !bench->go_ms) {
        poll(&parent, 1, 100);
        commands_listen(bench);
    }
}

void pace_millisecond(struct pace pace, struct bench *bench, const struct serial_port *port)
{
    wait_while_held(bench);
    wait_for_host(pace.wait_ms, bench, port);
    keep_pace(pace.speed);
}
