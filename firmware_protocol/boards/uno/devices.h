/* Both devices of the board: the amplifier at address 65 and the encoder DAQ at address 100. */
#ifndef UNO_DEVICES_H
#define UNO_DEVICES_H

#include <stdbool.h>
#include <stdint.h>

void devices_boot(uint32_t boot_count);

/* Advances both devices to this moment. Returns whether anything was done. */
bool devices_tick(uint16_t now_ms);

/* Whether the amplifier's measurement is under way: no exchange meanwhile, it belongs to the current that was set. */
bool devices_are_measuring(void);

/* The reply to a frame in `buffer`, in the same place; its length, 0 for none. */
uint16_t devices_answer(uint8_t *buffer, uint16_t n);

void devices_show(uint16_t now_ms);

#endif
