/* Device time against the time of this machine, of the host, and of the parent. */
#ifndef UNO_PACE_H
#define UNO_PACE_H

#include "commands.h"
#include "serial_port.h"

struct pace {
    double speed; /* device seconds per second; 0: as fast as possible */
    long wait_ms; /* device time stops so long after the host's last byte; 0: never */
};

/* After every device millisecond: returns when the next one may begin. */
void pace_millisecond(struct pace pace, struct bench *bench, const struct serial_port *port);

#endif
