/* The serial line: receives one frame and sends one reply by interrupts, in one buffer. */
#ifndef UNO_LINK_H
#define UNO_LINK_H

#include <stdint.h>

void link_start(void);

/* The length of a complete frame in the buffer, or 0. Until link_reply it does not change; further bytes are dropped. */
uint16_t link_request(void);

/* The buffer of frame and reply, of RTU_REPLY_ROOM bytes at least. */
uint8_t *link_buffer(void);

/* Sends `n` bytes of the buffer (0: none), then receives again. */
void link_reply(uint16_t n);

#endif
