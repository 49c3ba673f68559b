#include "led.h"

#include "../../firmware/smarig_registers.h"
#include "board.h"

enum { FLASH_ms = 200, PAUSE_FLASHES = 5 };

/* As many flashes as the number of the trip, then a pause. */
static bool flashes(uint16_t number, uint16_t now_ms)
{
    const uint16_t length_ms = (uint16_t)(2 * number + PAUSE_FLASHES) * FLASH_ms;
    const uint16_t at = now_ms % length_ms / FLASH_ms;
    return at < 2 * number && at % 2 == 0;
}

static bool lit(struct led_state now, uint16_t now_ms)
{
    if (now.state == AMP_STATE_TRIPPED)
        return flashes(now.trip, now_ms);
    if (now.sensor_missing)
        return now_ms % 100 < 50;
    if (now.state == AMP_STATE_ARMED)
        return now.current || now_ms % 1000 < 500;
    return now_ms % 2000 < 50;
}

void led_start(void)
{
    DDRB |= 1 << LED_PIN;
}

void led_show(struct led_state now, uint16_t now_ms)
{
    if (lit(now, now_ms))
        PORTB |= 1 << LED_PIN;
    else
        PORTB &= (uint8_t) ~(1 << LED_PIN);
}
