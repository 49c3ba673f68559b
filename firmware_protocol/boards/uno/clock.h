/* Milliseconds since boot, and the boot count. */
#ifndef UNO_CLOCK_H
#define UNO_CLOCK_H

#include <stdint.h>

void clock_start(void);
uint16_t clock_ms(void); /* wraps; use only differences */
uint32_t clock_count_boot(void);

#endif
