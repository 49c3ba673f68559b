#include "../program/serial.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../program/link.h"

ISR(USART0_RX_vect)
{
    const uint8_t spoilt = UCSR0A & (1 << FE0 | 1 << DOR0);
    link_byte(UDR0, spoilt);
}

ISR(USART0_UDRE_vect)
{
    const int16_t byte = link_next();
    if (byte == LINK_IS_SENT)
        UCSR0B &= (uint8_t) ~(1 << UDRIE0);
    else
        UDR0 = (uint8_t)byte;
}

void serial_start(void)
{
    UBRR0 = (uint16_t)(F_CPU / 16 / BAUD - 1);
    UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
    UCSR0B = 1 << RXCIE0 | 1 << RXEN0 | 1 << TXEN0;
}

void serial_send(void)
{
    UCSR0B |= 1 << UDRIE0;
}
