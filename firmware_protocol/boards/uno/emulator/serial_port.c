#define _XOPEN_SOURCE 700
#include "serial_port.h"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <simavr/avr_uart.h>

enum { BITS_PER_BYTE = 10, BAUD = 115200 };

static void on_byte_sent(struct avr_irq_t *irq, uint32_t value, void *param)
{
    const struct serial_port *s = param;
    const uint8_t byte = (uint8_t)value;
    (void)irq;
    if (write(s->pty, &byte, 1) != 1) /* no reader: the byte is lost, as on a wire */
        return;
}

static void on_xon(struct avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)value;
    ((struct serial_port *)param)->ready = true;
}

static void on_xoff(struct avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq, (void)value;
    ((struct serial_port *)param)->ready = false;
}

/* One byte per time of a byte. */
static avr_cycle_count_t take_byte(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct serial_port *s = param;
    uint8_t byte;
    if (s->ready && read(s->pty, &byte, 1) == 1) {
        s->last_byte = avr->cycle;
        s->bytes++;
        avr_raise_irq(s->input, byte);
    }
    return when + F_CPU * BITS_PER_BYTE / BAUD;
}

static const char *open_pty(struct serial_port *s)
{
    struct termios t;
    s->pty = posix_openpt(O_RDWR | O_NOCTTY);
    if (s->pty < 0 || grantpt(s->pty) || unlockpt(s->pty))
        return NULL;
    const char *path = ptsname(s->pty);
    const int kept = open(path, O_RDWR | O_NOCTTY); /* stays open: reading would fail without a host */
    if (kept < 0 || tcgetattr(kept, &t))
        return NULL;
    t.c_iflag = t.c_oflag = t.c_lflag = 0;
    t.c_cflag = (t.c_cflag & ~(tcflag_t)(CSIZE | PARENB)) | CS8;
    if (tcsetattr(kept, TCSANOW, &t))
        return NULL;
    fcntl(s->pty, F_SETFL, O_NONBLOCK);
    return path;
}

void serial_port_run(struct serial_port *s)
{
    avr_cycle_timer_register(s->avr, F_CPU * BITS_PER_BYTE / BAUD, take_byte, s);
}

const char *serial_port_open(struct serial_port *s, avr_t *avr)
{
    uint32_t flags = 0; /* no echo on the console, no sleep while the firmware polls */
    *s = (struct serial_port){.avr = avr};
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    s->input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_byte_sent, s);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XON), on_xon, s);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XOFF), on_xoff, s);
    return open_pty(s);
}
