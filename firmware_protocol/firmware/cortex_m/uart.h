/* Starts one of the UARTs: 115200 8N1 with its FIFOs. */
#ifndef SMARIG_CORTEX_M_UART_H
#define SMARIG_CORTEX_M_UART_H

#include "../program/serial.h"
#include "lm3s6965.h"

static inline void uart_start(volatile struct uart *uart, uint8_t interrupt)
{
    const uint32_t divisor_64 = (8 * CLOCK_Hz / BAUD + 1) / 2; /* in 64ths of 16 clocks, rounded */
    uart->CTL = 0;
    uart->IBRD = divisor_64 / 64;
    uart->FBRD = divisor_64 % 64;
    uart->LCRH = UART_LCRH_FIFO_8N1;
    uart->IFLS = UART_IFLS_EIGHTHS;
    uart->CTL = UART_CTL_ON;
    NVIC_PRIORITY(interrupt) = PRIORITY_BYTES;
    NVIC_ISER = 1ul << interrupt;
}

#endif
