#include "link.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "device.h"

#define BAUD 115200ul
#define SILENCE_us 1750ul /* 3.5 characters, fixed by Modbus above 19200 baud */
#define TIMER1_PER_us (F_CPU / 8 / 1000)

static volatile uint16_t received; /* bytes of the request so far */
static volatile bool whole;        /* the request is complete: the main loop owns the buffer */
static uint8_t request_bytes[REQUEST_ROOM + 1]; /* one more, so that a request that is too long is detected */
static uint8_t reply_bytes[REPLY_ROOM];
static volatile uint16_t sent, to_send;

static void keep(uint8_t byte)
{
    if (received == sizeof request_bytes)
        received--;
    request_bytes[received++] = byte;
}

#if defined(FRAMING_rtu)

/* The silence is measured from the last byte: each byte restarts timer 1. */
static void after_byte(uint8_t byte)
{
    (void)byte;
    TCNT1 = 0;
    TIFR1 = 1 << OCF1A;
    TCCR1B = 1 << CS11;
}

ISR(TIMER1_COMPA_vect)
{
    TCCR1B = 0;
    whole = true;
}

static void start_silence(void)
{
    OCR1A = (uint16_t)(SILENCE_us * TIMER1_PER_us / 1000);
    TIMSK1 = 1 << OCIE1A;
}

#else

static void after_byte(uint8_t byte)
{
    whole = byte == '\n';
}

static void start_silence(void)
{
}

#endif

ISR(USART0_RX_vect)
{
    const uint8_t spoilt = UCSR0A & (1 << FE0 | 1 << DOR0);
    uint8_t byte = UDR0;
    if (spoilt && byte != '\n')
        byte = 0xFF; /* a lost or garbled byte must not look like a byte that was sent */
    if (whole)
        return;
    keep(byte);
    after_byte(byte);
}

ISR(USART0_UDRE_vect)
{
    UDR0 = reply_bytes[sent++];
    if (sent == to_send)
        UCSR0B &= (uint8_t) ~(1 << UDRIE0);
}

void link_start(void)
{
    UBRR0 = (uint16_t)(F_CPU / 16 / BAUD - 1);
    UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
    UCSR0B = 1 << RXCIE0 | 1 << RXEN0 | 1 << TXEN0;
    start_silence();
}

/* One consistent copy of the variables that the interrupts share. */
uint16_t link_request(const uint8_t **request)
{
    uint16_t n = 0;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if (whole && sent == to_send)
            n = received;
    }
    *request = request_bytes;
    return n;
}

uint8_t *link_room(void)
{
    return reply_bytes;
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
