#include "chip.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>

/* Addresses of registers in data space, from the data sheet of the ATmega328P. */
enum { DDRB = 0x24, PORTB = 0x25, TCCR1A = 0x80, TCCR1B = 0x81, ICR1 = 0x86 };
enum { UNUSED = 0xA5 }; /* fills the RAM that no variable has */
enum { COM1A1 = 1 << 7, CLOCKED = 7, GATE = 1 << 1, LED = 1 << 5, STOP_BIT = 2 };

/* simavr prints to stdout, which belongs to the parent. A fault of the MCU shows as a crash. */
static void say_nothing(avr_t *ignored, const int level, const char *format, va_list ap)
{
    (void)ignored, (void)level, (void)format, (void)ap;
}

static void no_sleep(avr_t *ignored, avr_cycle_count_t cycles)
{
    (void)ignored, (void)cycles; /* the caller keeps the time */
}

static struct chip *only; /* simavr's reset hook has no parameter for it */
static void (*reset_core)(avr_t *);

static void on_reset(avr_t *avr)
{
    if (only->hung_at)
        memcpy(avr->flash + only->hung_at, only->replaced, sizeof only->replaced);
    only->hung_at = 0;
    if (reset_core)
        reset_core(avr);
    if (only->after_reset)
        only->after_reset();
}

/* The low byte, written last, makes a compare value take effect: between its two bytes there is none. */
static void on_compare(struct avr_irq_t *irq, uint32_t value, void *c)
{
    (void)irq;
    ((struct chip *)c)->compare = (uint16_t)value;
}

bool chip_load(struct chip *c, const char *elf)
{
    memset(c, 0, sizeof *c);
    only = c;
    avr_global_logger_set(say_nothing);
    c->avr = avr_make_mcu_by_name(MCU);
    if (!c->avr || elf_read_firmware(elf, &c->firmware))
        return false;
    avr_init(c->avr);
    c->firmware.frequency = F_CPU;
    avr_load_firmware(c->avr, &c->firmware);
    c->avr->sleep = no_sleep;
    c->avr->vcc = c->avr->avcc = c->avr->aref = 5000;
    avr_irq_register_notify(avr_io_getirq(c->avr, AVR_IOCTL_TIMER_GETIRQ('1'), TIMER_IRQ_OUT_PWM0), on_compare, c);
    reset_core = c->avr->reset;
    c->avr->reset = on_reset;
    for (uint32_t at = chip_symbol(c, "__bss_end"); at <= c->avr->ramend; at++)
        c->avr->data[at] = UNUSED;
    chip_open_stop(c, false);
    return true;
}

static uint16_t stack_pointer(const struct chip *c)
{
    return (uint16_t)(c->avr->data[R_SPL] | c->avr->data[R_SPH] << 8);
}

bool chip_run(struct chip *c, avr_cycle_count_t until)
{
    while (c->avr->cycle < until) {
        const int state = avr_run(c->avr);
        if (state == cpu_Done || state == cpu_Crashed)
            return false;
    }
    return true;
}

static uint16_t word_at(const struct chip *c, uint16_t address)
{
    return (uint16_t)(c->avr->data[address] | c->avr->data[address + 1] << 8);
}

/* simavr 1.6 does not draw fast PWM at its pin, so it is derived from the registers. */
double chip_gate(const struct chip *c)
{
    const uint8_t *data = c->avr->data;
    if (!(data[DDRB] & GATE))
        return 0; /* the resistor at the gate keeps it low */
    if (!(data[TCCR1A] & COM1A1) || !(data[TCCR1B] & CLOCKED))
        return data[PORTB] & GATE ? 1 : 0;
    return (c->compare + 1.0) / (word_at(c, ICR1) + 1.0);
}

unsigned chip_free_ram(const struct chip *c)
{
    uint32_t at = chip_symbol(c, "__bss_end");
    const uint32_t first = at;
    while (at <= c->avr->ramend && c->avr->data[at] == UNUSED)
        at++;
    return at - first;
}

bool chip_led(const struct chip *c)
{
    return c->avr->data[PORTB] & LED;
}

void chip_open_stop(struct chip *c, bool open)
{
    /* the contact pulls to ground against the pull-up of the pin */
    avr_ioport_external_t contact = {.name = 'D', .mask = open ? 0 : 1 << STOP_BIT, .value = 0};
    avr_ioctl(c->avr, AVR_IOCTL_IOPORT_SET_EXTERNAL('D'), &contact);
    avr_raise_irq(avr_io_getirq(c->avr, AVR_IOCTL_IOPORT_GETIRQ('D'), STOP_BIT), open);
}

void chip_reset(struct chip *c)
{
    avr_reset(c->avr);
}

void chip_hang(struct chip *c)
{
    static const uint8_t rjmp_to_itself[2] = {0xFF, 0xCF};
    if (c->hung_at)
        return;
    c->hung_at = c->avr->pc;
    memcpy(c->replaced, c->avr->flash + c->hung_at, sizeof c->replaced);
    memcpy(c->avr->flash + c->hung_at, rjmp_to_itself, sizeof rjmp_to_itself);
}

uint32_t chip_symbol(const struct chip *c, const char *name)
{
    for (uint32_t i = 0; i < c->firmware.symbolcount; i++)
        if (!strcmp(c->firmware.symbol[i]->symbol, name))
            return c->firmware.symbol[i]->addr & 0xFFFFu;
    return 0;
}

static void push(struct chip *c, uint8_t byte)
{
    uint16_t stack = stack_pointer(c);
    c->avr->data[stack--] = byte;
    c->avr->data[R_SPL] = (uint8_t)stack;
    c->avr->data[R_SPH] = (uint8_t)(stack >> 8);
}

/* Feeds the watchdog as the main loop does: runs one `wdr` of the program. */
static void feed_watchdog(struct chip *c)
{
    const avr_flashaddr_t pc = c->avr->pc;
    for (avr_flashaddr_t at = 0; at < c->avr->codeend; at += 2)
        if (c->avr->flash[at] == 0xA8 && c->avr->flash[at + 1] == 0x95) {
            c->avr->pc = at;
            avr_run(c->avr);
            break;
        }
    c->avr->pc = pc;
}

uint16_t chip_call(struct chip *c, const char *name, const uint16_t *words, int count)
{
    avr_t *avr = c->avr;
    uint8_t registers[32], interrupts = avr->sreg[S_I];
    const avr_flashaddr_t pc = avr->pc;
    const uint16_t stack = stack_pointer(c);
    avr->sreg[S_I] = 0;
    avr->state = cpu_Running;
    feed_watchdog(c);
    memcpy(registers, avr->data, sizeof registers);
    for (int i = 0; i < count; i++) {
        avr->data[24 - 2 * i] = (uint8_t)words[i];
        avr->data[25 - 2 * i] = (uint8_t)(words[i] >> 8);
    }
    push(c, (uint8_t)(pc >> 1));
    push(c, (uint8_t)(pc >> 9));
    avr->pc = chip_symbol(c, name);
    while (stack_pointer(c) != stack || avr->pc != pc)
        if (avr_run(avr) == cpu_Crashed)
            return 0xFFFF;
    const uint16_t result = word_at(c, 24);
    memcpy(avr->data, registers, sizeof registers);
    avr->sreg[S_I] = interrupts;
    return result;
}
