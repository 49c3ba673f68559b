#include "crc.h"

/* Bit by bit: a table would cost an AVR 512 bytes; without it the longest line takes a few milliseconds. */
uint16_t crc_modbus(const uint8_t *bytes, uint16_t count)
{
    uint16_t crc = 0xFFFFu;
    while (count--) {
        crc ^= *bytes++;
        for (uint8_t bit = 0; bit < 8; bit++)
            crc = crc & 1u ? (uint16_t)(crc >> 1 ^ 0xA001u) : (uint16_t)(crc >> 1);
    }
    return crc;
}
