/* Selects the device of this chip with -DDEVICE_amplifier or -DDEVICE_encoder_daq. */
#ifndef SMARIG_DEVICE_H
#define SMARIG_DEVICE_H

#include <stdint.h>

#include "../core/exchange.h"

#if defined(FRAMING_rtu)
#define FRAMING FRAMING_RTU
#define REQUEST_ROOM RTU_REQUEST_ROOM
#define REPLY_ROOM RTU_REPLY_ROOM
#elif defined(FRAMING_lines)
#define FRAMING FRAMING_LINES
#define REQUEST_ROOM LINES_REQUEST_ROOM
#define REPLY_ROOM LINES_REPLY_ROOM
#else
#error "give -DFRAMING_rtu or -DFRAMING_lines"
#endif

void device_boot(uint32_t boot_count);
uint16_t device_period_ms(void);

/* Starts a tick: the last accepted command takes effect. */
void device_begin_tick(void);

/* Called when the tick's inputs have settled: measures, checks and stores them. */
void device_end_tick(void);

uint16_t device_answer(const uint8_t *request, uint16_t n, uint8_t *reply, uint16_t room);

#endif
