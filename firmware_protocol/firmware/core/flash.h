/* Tables that stay in flash: an AVR otherwise copies every constant to its RAM. */
#ifndef SMARIG_FLASH_H
#define SMARIG_FLASH_H

#ifdef __AVR__
#include <avr/pgmspace.h>
#define IN_FLASH PROGMEM
#define copy_from_flash memcpy_P
#else
#include <string.h>
#define IN_FLASH
#define copy_from_flash memcpy
#endif

#endif
