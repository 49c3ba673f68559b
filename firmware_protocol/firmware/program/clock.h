/* Milliseconds since boot, and the boot count. */
#ifndef SMARIG_CLOCK_H
#define SMARIG_CLOCK_H

#include <stdint.h>

void clock_start(void);
uint16_t clock_ms(void); /* wraps; use only differences */

/* One more than at the last boot, whatever ended it: no two boots have the same count. */
uint32_t clock_count_boot(void);

#endif
