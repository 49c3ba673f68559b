/* The serial line: receives one request and sends one reply by interrupts. */
#ifndef SMARIG_LINK_H
#define SMARIG_LINK_H

#include <stdbool.h>
#include <stdint.h>

void link_start(void);

/* A complete request, or 0. Until link_reply it does not change and further bytes are dropped. */
uint16_t link_request(const uint8_t **request);

/* The buffer of the reply. */
uint8_t *link_room(void);

/* Sends `n` bytes from link_room (0: none), then receives again. */
void link_reply(uint16_t n);

/* --- for the interrupts of the serial port --- */

enum { LINK_IS_SENT = -1 };

/* A byte has come; `spoilt` if it, or one before it, was garbled or lost. */
void link_byte(uint8_t byte, bool spoilt);

/* The line has been silent for the time that ends a frame. */
void link_silence(void);

/* The next byte of the reply, or LINK_IS_SENT. */
int16_t link_next(void);

#endif
