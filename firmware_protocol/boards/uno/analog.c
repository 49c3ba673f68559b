#include "analog.h"

#include <avr/pgmspace.h>
#include <stdbool.h>
#include <util/atomic.h>

#include "../../firmware/smarig_registers.h"
#include "board.h"

enum { CHANNELS = 2, MEAN_OF = 32 };

static struct {
    uint8_t channel, settling; /* conversions that fill the means */
    uint16_t sum[CHANNELS];    /* of MEAN_OF conversions, each forgotten gradually */
} analog;

void analog_start(void)
{
    ADMUX = 1 << REFS0 | SUPPLY_CHANNEL; /* AVcc is the reference */
    ADCSRA = 1 << ADEN | 1 << ADSC | 1 << ADPS2 | 1 << ADPS1 | 1 << ADPS0;
}

void analog_step(void)
{
    if (ADCSRA & 1 << ADSC)
        return;
    uint16_t *sum = &analog.sum[analog.channel];
    const uint16_t value = ADC;
    *sum = analog.settling < CHANNELS ? (uint16_t)(value * MEAN_OF) : (uint16_t)(*sum - *sum / MEAN_OF + value);
    if (analog.settling < CHANNELS)
        analog.settling++;
    analog.channel = analog.channel == SUPPLY_CHANNEL ? AMBIENT_CHANNEL : SUPPLY_CHANNEL;
    ADMUX = (uint8_t)(1 << REFS0 | analog.channel);
    ADCSRA |= 1 << ADSC;
}

static uint16_t sum_of(uint8_t channel)
{
    uint16_t sum;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        sum = analog.sum[channel];
    }
    return sum;
}

uint16_t analog_supply_mV(void)
{
    return (uint16_t)((uint32_t)sum_of(SUPPLY_CHANNEL) * (ADC_REFERENCE_mV * (uint32_t)SUPPLY_DIVIDES_BY) / (1024ul * MEAN_OF));
}

/*
 * 0.01 degC at every 32nd word of the ADC: 10 kohm at 25 degC, B = 3950 K, with 10 kohm to AVcc;
 * R = 10 kohm x / (1 - x), 1/T = 1/298.15 K + ln(R / 10 kohm) / B.
 */
static const int16_t AMBIENT[] PROGMEM = {
    12500, 12500, 10160, 8661, 7633, 6849, 6211, 5669, 5196, 4772, 4387,
    4030, 3696, 3379, 3077, 2784, 2500, 2221, 1945, 1670, 1393, 1113,
    825, 528, 217, -114, -471, -867, -1318, -1859, -2560, -3637, -4000,
};
enum { WORDS_APART = 32, SHORTED_BELOW = 32, OPEN_ABOVE = 992 };

int16_t analog_ambient(void)
{
    const uint16_t sum = sum_of(AMBIENT_CHANNEL);
    const uint16_t word = sum / MEAN_OF;
    if (word < SHORTED_BELOW || word > OPEN_ABOVE)
        return AMP_RING_TEMPERATURE_NONE;
    const uint8_t at = (uint8_t)(word / WORDS_APART);
    const int16_t low = (int16_t)pgm_read_word(&AMBIENT[at]);
    const int16_t high = (int16_t)pgm_read_word(&AMBIENT[at + 1]);
    const uint16_t beyond = (uint16_t)(sum - at * (uint16_t)(WORDS_APART * MEAN_OF));
    return (int16_t)(low + (int32_t)(high - low) * beyond / (WORDS_APART * MEAN_OF));
}
