#include <stddef.h>

#include "../interrupts.h"
#include "../uart.h"
#include "emulator.h"

static char line[64];
static uint8_t length;

/* The interrupt only ends the sleep: what is not read yet stays with QEMU, whose line waits. */
void plant_line_interrupt(void)
{
    UART1->IM = 0;
}

void plant_line_start(void)
{
    GPIOD_AFSEL |= 3 << 2;
    GPIOD_DEN |= 3 << 2;
    uart_start(UART1, INTERRUPT_UART1);
    UART1->IM = UART_RX | UART_RT;
}

const char *plant_line_read(void)
{
    while (!(UART1->FR & UART_FR_RXFE)) {
        const char c = (char)UART1->DR;
        if (c == '\n') {
            line[length] = 0;
            length = 0;
            return line;
        }
        if (length < sizeof line - 1)
            line[length++] = c;
    }
    UART1->ICR = UART_RX | UART_RT;
    UART1->IM = UART_RX | UART_RT;
    return NULL;
}

static void put(char c)
{
    while (UART1->FR & UART_FR_TXFF)
        ;
    UART1->DR = (uint8_t)c;
}

static void put_number(int32_t number)
{
    char digits[10];
    uint8_t n = 0;
    uint32_t rest = number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
    do
        digits[n++] = (char)('0' + rest % 10);
    while (rest /= 10);
    put(' ');
    if (number < 0)
        put('-');
    while (n)
        put(digits[--n]);
}

void plant_line_say(const char *word, uint8_t count, const int32_t *numbers)
{
    while (*word)
        put(*word++);
    while (count--)
        put_number(*numbers++);
    put('\n');
}
