/* What the LED of the board says; docs/how_to/uno_board.md lists the codes. */
#ifndef UNO_LED_H
#define UNO_LED_H

#include <stdbool.h>
#include <stdint.h>

struct led_state {
    uint16_t state, trip; /* of the amplifier */
    bool current, sensor_missing;
};

void led_start(void);
void led_show(struct led_state now, uint16_t now_ms);

#endif
