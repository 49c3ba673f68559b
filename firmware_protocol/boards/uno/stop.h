/* The stop contact: it takes the current away within two milliseconds, and stays known until a tick has reported it. */
#ifndef UNO_STOP_H
#define UNO_STOP_H

#include <stdbool.h>

void stop_start(void);

/* Every millisecond, from the interrupt. */
void stop_watch(void);

/* Whether the contact is open. */
bool stop_is_open(void);

/* Whether it was open at any time since the last call. */
bool stop_was_open(void);

#endif
