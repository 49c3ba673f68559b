/* Registers and interrupts of the Texas Instruments LM3S6965 (Cortex-M3), as far as they are used. */
#ifndef SMARIG_LM3S6965_H
#define SMARIG_LM3S6965_H

#include <stdint.h>

#define CLOCK_Hz 50000000ul

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))

/* system control */
#define SYSCTL_RIS REGISTER(0x400FE050)
#define SYSCTL_RCC REGISTER(0x400FE060)
#define SYSCTL_RCGC0 REGISTER(0x400FE100)
#define SYSCTL_RCGC1 REGISTER(0x400FE104)
#define SYSCTL_RCGC2 REGISTER(0x400FE108)

/* watchdog */
#define WATCHDOG_LOAD REGISTER(0x40000000)
#define WATCHDOG_CTL REGISTER(0x40000008)
#define WATCHDOG_ICR REGISTER(0x4000000C)
#define WATCHDOG_LOCK REGISTER(0x40000C00)

/* general-purpose timer 0 */
#define TIMER0_CFG REGISTER(0x40030000)
#define TIMER0_TAMR REGISTER(0x40030004)
#define TIMER0_CTL REGISTER(0x4003000C)
#define TIMER0_IMR REGISTER(0x40030018)
#define TIMER0_MIS REGISTER(0x40030020)
#define TIMER0_ICR REGISTER(0x40030024)
#define TIMER0_TAILR REGISTER(0x40030028)

/* pins of the UARTs: PA0, PA1; PD2, PD3 */
#define GPIOA_AFSEL REGISTER(0x40004420)
#define GPIOA_DEN REGISTER(0x4000451C)
#define GPIOD_AFSEL REGISTER(0x40007420)
#define GPIOD_DEN REGISTER(0x4000751C)

/* both UARTs */
struct uart {
    uint32_t DR, RSR, unused0[4], FR, unused1[2], IBRD, FBRD, LCRH, CTL, IFLS, IM, RIS, MIS, ICR;
};
#define UART0 ((volatile struct uart *)(uintptr_t)0x4000C000)
#define UART1 ((volatile struct uart *)(uintptr_t)0x4000D000)
enum {
    UART_DR_SPOILT = 0xF << 8, /* overrun, break, parity, framing */
    UART_FR_RXFE = 1 << 4,
    UART_FR_TXFF = 1 << 5,
    UART_LCRH_FIFO_8N1 = 1 << 4 | 3 << 5,
    UART_CTL_ON = 1 << 0 | 1 << 8 | 1 << 9,
    UART_IFLS_EIGHTHS = 0, /* receive interrupt from two bytes on, or after a pause; send interrupt down to two bytes */
    UART_RX = 1 << 4,
    UART_TX = 1 << 5,
    UART_RT = 1 << 6
};

/* core peripherals of the Cortex-M3 */
#define SYSTICK_CTRL REGISTER(0xE000E010)
#define SYSTICK_LOAD REGISTER(0xE000E014)
#define SYSTICK_VAL REGISTER(0xE000E018)
#define NVIC_ISER REGISTER(0xE000E100)
#define NVIC_PRIORITY(interrupt) (*(volatile uint8_t *)(uintptr_t)(0xE000E400 + (interrupt)))
#define SCB_AIRCR REGISTER(0xE000ED0C)
#define SCB_PRIORITY_SYSTICK (*(volatile uint8_t *)(uintptr_t)0xE000ED23)

enum { INTERRUPT_UART0 = 5, INTERRUPT_UART1 = 6, INTERRUPT_TIMER0A = 19 };

/* A byte that has come is dealt with before the end of the silence, which it may have prevented. */
enum { PRIORITY_BYTES = 0x00, PRIORITY_SILENCE = 0x20, PRIORITY_CLOCK = 0x40 };

#endif
