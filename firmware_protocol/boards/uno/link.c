#include "link.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdbool.h>
#include <util/atomic.h>

#include "../../firmware/core/exchange.h"

#define BAUD 115200ul
#define SILENCE_us 1750ul /* 3.5 characters, fixed by Modbus above 19200 baud */

static uint8_t buffer[RTU_REQUEST_ROOM + 1]; /* one more, so that a request that is too long is detected */
static volatile uint16_t received;           /* bytes of the request so far */
static volatile bool whole;                  /* the request is complete: the main loop owns the buffer */
static volatile uint16_t sent, to_send;

static void keep(uint8_t byte)
{
    if (received == sizeof buffer)
        received--;
    buffer[received++] = byte;
}

/* The silence is measured from the last byte: each byte restarts timer 2. */
ISR(USART_RX_vect)
{
    const uint8_t spoilt = UCSR0A & (1 << FE0 | 1 << DOR0);
    const uint8_t byte = UDR0;
    if (whole || sent != to_send)
        return;
    keep(spoilt ? (uint8_t)~byte : byte); /* a garbled byte must not look like a byte that was sent */
    TCNT2 = 0;
    TIFR2 = 1 << OCF2A;
    TCCR2B = 1 << CS22 | 1 << CS20;
}

ISR(TIMER2_COMPA_vect)
{
    TCCR2B = 0;
    whole = received != 0; /* a request of no bytes would never be answered */
}

ISR(USART_UDRE_vect)
{
    UDR0 = buffer[sent++];
    if (sent == to_send)
        UCSR0B &= (uint8_t) ~(1 << UDRIE0);
}

/* Double speed: 117647 baud, 2.1 % fast like every Uno at 16 MHz, whose USB side has the same divider. */
void link_start(void)
{
    UBRR0 = (uint16_t)((F_CPU + 4 * BAUD) / (8 * BAUD) - 1);
    UCSR0A = 1 << U2X0;
    UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
    UCSR0B = 1 << RXCIE0 | 1 << RXEN0 | 1 << TXEN0;
    OCR2A = (uint8_t)(SILENCE_us * (F_CPU / 1000000) / 128);
    TIMSK2 = 1 << OCIE2A;
}

uint16_t link_request(void)
{
    uint16_t n = 0;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if (whole && sent == to_send)
            n = received;
    }
    return n;
}

uint8_t *link_buffer(void)
{
    return buffer;
}

void link_reply(uint16_t n)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        received = 0;
        whole = false;
        sent = 0;
        to_send = n;
        if (n)
            UCSR0B |= 1 << UDRIE0;
    }
}
