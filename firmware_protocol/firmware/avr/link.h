/* The serial line: collects one request by interrupts, sends one reply by interrupts. */
#ifndef SMARIG_AVR_LINK_H
#define SMARIG_AVR_LINK_H

#include <stdbool.h>
#include <stdint.h>

void link_start(void);

/* A whole request, or 0. It stays as it is, and further bytes are dropped, until link_reply. */
uint16_t link_request(const uint8_t **request);

/* Where the reply goes. */
uint8_t *link_room(void);

/* Sends `n` bytes from link_room (0: none) and listens again. */
void link_reply(uint16_t n);

#endif
