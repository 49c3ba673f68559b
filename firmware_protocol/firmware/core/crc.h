/* CRC-16/MODBUS, for both framings. */
#ifndef SMARIG_CRC_H
#define SMARIG_CRC_H

#include <stdint.h>

uint16_t crc_modbus(const uint8_t *bytes, uint16_t count);

#endif
