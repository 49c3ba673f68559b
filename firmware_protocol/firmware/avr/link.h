/* The serial line: receives one request and sends one reply by interrupts. */
#ifndef SMARIG_AVR_LINK_H
#define SMARIG_AVR_LINK_H

#include <stdbool.h>
#include <stdint.h>

void link_start(void);

/* A complete request, or 0. Until link_reply it does not change and further bytes are dropped. */
uint16_t link_request(const uint8_t **request);

/* The buffer of the reply. */
uint8_t *link_room(void);

/* Sends `n` bytes from link_room (0: none), then receives again. */
void link_reply(uint16_t n);

#endif
