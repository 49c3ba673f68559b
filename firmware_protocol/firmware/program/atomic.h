/* ATOMICALLY { ... } : no interrupt meanwhile; afterwards as before. Not to be left by return, break or goto. */
#ifndef SMARIG_ATOMIC_H
#define SMARIG_ATOMIC_H

#ifdef __AVR__
#include <util/atomic.h>
#define ATOMICALLY ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
#else
#include "../cortex_m/interrupts.h"
#define ATOMICALLY for (uint32_t was = interrupts_off(), once = 1; once; once = interrupts_as(was))
#endif

#endif
