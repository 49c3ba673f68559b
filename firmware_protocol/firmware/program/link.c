#include "link.h"

#include "atomic.h"
#include "device.h"
#include "serial.h"

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

/* The silence is measured from the last byte. */
static void after_byte(uint8_t byte)
{
    (void)byte;
    silence_restart();
}

/* A silence with nothing before it ends nothing: as a request of no bytes it would never be answered. */
void link_silence(void)
{
    whole = received != 0;
}

#else

static void after_byte(uint8_t byte)
{
    whole = byte == '\n';
}

#endif

void link_byte(uint8_t byte, bool spoilt)
{
    if (spoilt && byte != '\n')
        byte = 0xFF; /* a lost or garbled byte must not look like a byte that was sent */
    if (whole)
        return;
    keep(byte);
    after_byte(byte);
}

int16_t link_next(void)
{
    return sent == to_send ? LINK_IS_SENT : reply_bytes[sent++];
}

void link_start(void)
{
    serial_start();
#if defined(FRAMING_rtu)
    silence_start();
#endif
}

/* One consistent copy of the variables that the interrupts share. */
uint16_t link_request(const uint8_t **request)
{
    uint16_t n = 0;
    ATOMICALLY
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
    ATOMICALLY
    {
        received = 0;
        whole = false;
        sent = 0;
        to_send = n;
        if (n)
            serial_send();
    }
}
