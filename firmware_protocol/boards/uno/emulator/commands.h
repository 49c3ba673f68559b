/* What the parent of the emulator may say on its stdin; emulator.c lists it. */
#ifndef UNO_COMMANDS_H
#define UNO_COMMANDS_H

#include <stdbool.h>

#include "chip.h"
#include "sensors.h"

struct bench {
    struct chip chip;
    struct power_stage power;
    struct wire wire;
    struct sensors sensors;
    double turned; /* counts by which the magnet is turned by hand */
    bool answered; /* the wire's state has arrived */
    bool held;     /* device time stands still but for go_ms */
    long go_ms;    /* device time to pass whatever the host does */
};

/* Obeys all that the parent has said; ends the emulator when the parent has ended. */
void commands_listen(struct bench *b);

#endif
