/*
 * Runs the firmware's ELF under simavr, its UART on a pty and its plant struct on stdin and stdout.
 *
 *     runner ELF PLANT_ADDRESS        the address printed by avr-nm
 *
 * Prints `pty PATH` once, `out CURRENT_uA` when a tick starts, and `behind MS` when the machine is too busy for real
 * time and this time is skipped. Accepts at any time:
 *     in CURRENT_uA VOLTAGE_uV TEMPERATURE HARDWARE     measurements of an amplifier from now on
 *     in RAW_COUNTS AMBIENT HARDWARE                    readings of a DAQ from now on
 *     reset                                             resets the MCU, as after a brown-out
 *     hang                                              stops the program until the watchdog resets it
 * Real hardware is never late, but the parent may be: the MCU stops until an `in` answers a tick's `out`, for
 * ANSWER_MOST_ms at most; after that the last inputs are kept. The program ends when stdin is closed.
 */
#define _XOPEN_SOURCE 700
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

enum { STEPS_PER_s = 1000, BEHIND_MOST_ns = 50000000, ANSWER_MOST_ms = 200 };

/* struct plant of avr/plant.h as bytes in SRAM; the host's int is 32 bits and little-endian like the MCU's words. */
#pragma pack(push, 1)
struct plant {
    uint8_t tick, taken;
    int32_t output_uA, first, second;
    int16_t temperature;
    uint16_t hardware;
};
#pragma pack(pop)

static avr_t *avr;
static avr_irq_t *uart_input;
static volatile struct plant *plant;
static struct plant inputs; /* last values from the parent */
static bool answered;
static int pty;
static bool uart_ready;

static void fail(const char *what)
{
    fprintf(stderr, "runner: %s%s%s\n", what, errno ? ": " : "", errno ? strerror(errno) : "");
    exit(1);
}

/* --- the pty --- */

static void make_raw(int fd)
{
    struct termios t;
    if (tcgetattr(fd, &t))
        fail("no terminal settings");
    t.c_iflag = t.c_oflag = t.c_lflag = 0;
    t.c_cflag = (t.c_cflag & ~(tcflag_t)(CSIZE | PARENB)) | CS8;
    if (tcsetattr(fd, TCSANOW, &t))
        fail("no raw terminal");
}

static void open_pty(void)
{
    pty = posix_openpt(O_RDWR | O_NOCTTY);
    if (pty < 0 || grantpt(pty) || unlockpt(pty))
        fail("no pty");
    const char *path = ptsname(pty);
    const int kept = open(path, O_RDWR | O_NOCTTY); /* stays open: reading would fail without a host */
    if (kept < 0)
        fail(path);
    make_raw(kept);
    fcntl(pty, F_SETFL, O_NONBLOCK);
    printf("pty %s\n", path);
    fflush(stdout);
}

/* --- the UART --- */

static void on_byte_sent(struct avr_irq_t *irq, uint32_t value, void *param)
{
    const uint8_t byte = (uint8_t)value;
    (void)irq, (void)param;
    if (write(pty, &byte, 1) != 1 && errno != EAGAIN) /* no reader: the byte is lost, as on a wire */
        fail("pty");
}

static void on_ready(struct avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)value;
    uart_ready = param != NULL;
}

static void connect_uart(void)
{
    static char yes;
    uint32_t flags = 0; /* no echo on the console, no sleep while the firmware polls */
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    uart_input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_byte_sent, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XON), on_ready, &yes);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XOFF), on_ready, NULL);
}

static void feed_uart(void)
{
    uint8_t byte;
    while (uart_ready && read(pty, &byte, 1) == 1)
        avr_raise_irq(uart_input, byte);
}

/* --- reset and hang of the MCU --- */

static const uint8_t RJMP_TO_ITSELF[2] = {0xFF, 0xCF};
static uint8_t replaced[2];
static avr_flashaddr_t hung_at; /* 0: not hung */

static void hang(void)
{
    if (hung_at)
        return;
    hung_at = avr->pc;
    memcpy(replaced, avr->flash + hung_at, sizeof replaced);
    memcpy(avr->flash + hung_at, RJMP_TO_ITSELF, sizeof replaced);
}

static void (*reset_core)(avr_t *);

static void on_reset(avr_t *mcu)
{
    if (hung_at)
        memcpy(mcu->flash + hung_at, replaced, sizeof replaced);
    hung_at = 0;
    if (reset_core)
        reset_core(mcu);
}

/* --- the plant --- */

static void obey(const char *line)
{
    long a, b, c, d;
    const int given = sscanf(line, "in %ld %ld %ld %ld", &a, &b, &c, &d);
    answered |= given >= 3;
    if (given == 4)
        inputs = (struct plant){0, 0, 0, (int32_t)a, (int32_t)b, (int16_t)c, (uint16_t)d};
    else if (given == 3)
        inputs = (struct plant){0, 0, 0, (int32_t)a, 0, (int16_t)b, (uint16_t)c};
    else if (strcmp(line, "reset") == 0)
        avr_reset(avr);
    else if (strcmp(line, "hang") == 0)
        hang();
    else
        fprintf(stderr, "runner: what is '%s'?\n", line);
}

/* Reads all input of the parent; exits when the parent has ended. */
static void listen_to_parent(void)
{
    static char line[128];
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
        obey(line);
    }
    if (n == 0)
        exit(0);
}

static void tell_parent(const char *what, long value)
{
    char line[32];
    const int n = snprintf(line, sizeof line, "%s %ld\n", what, value);
    if (write(STDOUT_FILENO, line, (size_t)n) < 0 && errno != EAGAIN) /* the parent does not read: it misses a tick */
        fail("stdout");
}

static void await_answer(void)
{
    struct pollfd parent = {STDIN_FILENO, POLLIN, 0};
    struct timespec now, began;
    clock_gettime(CLOCK_MONOTONIC, &began);
    for (long left_ms = ANSWER_MOST_ms; !answered && left_ms > 0;) {
        if (poll(&parent, 1, (int)left_ms) > 0)
            listen_to_parent();
        clock_gettime(CLOCK_MONOTONIC, &now);
        left_ms = ANSWER_MOST_ms - (now.tv_sec - began.tv_sec) * 1000 - (now.tv_nsec - began.tv_nsec) / 1000000;
    }
}

static void exchange_plant(void)
{
    static uint8_t told;
    if (told != plant->tick) {
        answered = false;
        tell_parent("out", (long)plant->output_uA);
        await_answer();
    }
    told = plant->tick;
    if (plant->taken)
        return;
    plant->first = inputs.first;
    plant->second = inputs.second;
    plant->temperature = inputs.temperature;
    plant->hardware = inputs.hardware;
}

/* --- time --- */

static void no_sleep(avr_t *ignored, avr_cycle_count_t cycles)
{
    (void)ignored, (void)cycles; /* run() keeps the time */
}

/* Waits until `due`. Skips time that is lost, so that the MCU does not run faster than real time for long. */
static void wait_until(struct timespec *due)
{
    struct timespec now;
    due->tv_nsec += 1000000000L / STEPS_PER_s;
    if (due->tv_nsec >= 1000000000L) {
        due->tv_nsec -= 1000000000L;
        due->tv_sec++;
    }
    clock_gettime(CLOCK_MONOTONIC, &now);
    const long behind_ns = (now.tv_sec - due->tv_sec) * 1000000000L + now.tv_nsec - due->tv_nsec;
    if (behind_ns > BEHIND_MOST_ns) {
        *due = now;
        tell_parent("behind", behind_ns / 1000000);
    }
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, due, NULL);
}

static void run_cycles(avr_cycle_count_t until)
{
    while (avr->cycle < until) {
        const int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            errno = 0;
            fail("the firmware crashed");
        }
    }
}

static void run(void)
{
    struct timespec due;
    avr_cycle_count_t until = avr->cycle;
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (;;) {
        run_cycles(until += F_CPU / STEPS_PER_s);
        exchange_plant();
        feed_uart();
        listen_to_parent();
        wait_until(&due);
    }
}

/* simavr prints to stdout, which belongs to the parent; it is silenced. A fault of the MCU shows as a crash. */
static void say_nothing(avr_t *ignored, const int level, const char *format, va_list ap)
{
    (void)ignored, (void)level, (void)format, (void)ap;
}

static void load(const char *elf)
{
    elf_firmware_t firmware;
    avr_global_logger_set(say_nothing);
    memset(&firmware, 0, sizeof firmware);
    avr = avr_make_mcu_by_name(MCU);
    if (!avr || elf_read_firmware(elf, &firmware))
        fail(elf);
    avr_init(avr);
    firmware.frequency = F_CPU;
    avr_load_firmware(avr, &firmware);
    avr->sleep = no_sleep;
    reset_core = avr->reset;
    avr->reset = on_reset;
}

int main(int argc, char **argv)
{
    if (argc != 3)
        fail("usage: runner ELF PLANT_ADDRESS");
    load(argv[1]);
    plant = (volatile struct plant *)(avr->data + (strtoul(argv[2], NULL, 16) & 0xFFFFu));
    open_pty();
    connect_uart();
    fcntl(STDIN_FILENO, F_SETFL, O_NONBLOCK);
    fcntl(STDOUT_FILENO, F_SETFL, O_NONBLOCK);
    run();
}
