/* What the main loop needs of its chip. */
#ifndef SMARIG_CHIP_H
#define SMARIG_CHIP_H

/* Starts the watchdog, whose time is much less than the shortest lease, then lets interrupts in. */
void chip_run(void);

/* Restarts the watchdog's time. */
void chip_feed_watchdog(void);

/* Sleeps until the next interrupt, at most one millisecond. */
void chip_sleep(void);

#endif
