/* Milliseconds since boot, and the boot count. */
#ifndef SMARIG_CLOCK_H
#define SMARIG_CLOCK_H

#include <stdint.h>

void clock_start(void);
uint16_t clock_ms(void); /* wraps; use only differences */
uint16_t clock_count_boot(void);

#endif
