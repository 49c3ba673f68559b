#include "interrupts.h"
#include "uart.h"

#include "../program/link.h"

/* As much as the FIFO takes. */
void serial_send(void)
{
    int16_t byte;
    while (!(UART0->FR & UART_FR_TXFF) && (byte = link_next()) != LINK_IS_SENT)
        UART0->DR = (uint32_t)byte;
}

void serial_interrupt(void)
{
    UART0->ICR = UART_RX | UART_RT | UART_TX;
    while (!(UART0->FR & UART_FR_RXFE)) {
        const uint32_t byte = UART0->DR;
        link_byte((uint8_t)byte, byte & UART_DR_SPOILT);
    }
    serial_send();
}

void serial_start(void)
{
    GPIOA_AFSEL |= 3;
    GPIOA_DEN |= 3;
    uart_start(UART0, INTERRUPT_UART0);
    UART0->IM = UART_RX | UART_RT | UART_TX;
}
