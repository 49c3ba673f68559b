/* The checks that protect the wire: integer arithmetic on settings and measurements. */
#include <stdbool.h>

#include "amplifier.h"
#include "words.h"

enum { SPELL_TICKS = 3 };
#define FLOWING_uA 50000ul /* less does not show the state of the circuit */

static uint32_t magnitude(int32_t value)
{
    return value < 0 ? 0u - (uint32_t)value : (uint32_t)value; /* also correct for the smallest number */
}

static uint16_t period_ms(const struct amplifier *a)
{
    return *AMPLIFIER_SETTING(a, AMP_PERIOD);
}

uint16_t guard_lease_ticks(const struct amplifier *a)
{
    const uint16_t lease_ms = *AMPLIFIER_SETTING(a, AMP_LEASE);
    const uint16_t ticks = (uint16_t)((2ul * lease_ms + period_ms(a)) / (2ul * period_ms(a)));
    return ticks ? ticks : 1;
}

void guard_warm(struct amplifier *a, int32_t current_uA)
{
    const uint64_t I_mA = magnitude(current_uA) / 1000u;
    const uint64_t forgotten = (uint64_t)a->heat * period_ms(a) / *AMPLIFIER_SETTING(a, AMP_HEAT_SETTLE);
    const uint64_t left = forgotten < a->heat ? a->heat - forgotten : 0;
    const uint64_t heat = left + I_mA * I_mA * period_ms(a) / 1000u;
    a->heat = heat < UINT32_MAX ? (uint32_t)heat : UINT32_MAX;
}

bool guard_slews(const struct amplifier *a, int32_t next_uA)
{
    /* mA/s times ms is µA */
    const uint64_t most_uA = (uint64_t)words_u32(AMPLIFIER_SETTING(a, AMP_SLEW_MAX)) * period_ms(a);
    return magnitude(next_uA - a->output_uA) > most_uA; /* both are within 5 A */
}

static bool over_current(const struct amplifier *a, int32_t current_uA)
{
    const int32_t least = words_i32(AMPLIFIER_SETTING(a, AMP_CURRENT_MIN));
    const int32_t most = words_i32(AMPLIFIER_SETTING(a, AMP_CURRENT_MAX));
    const int32_t margin = (most > -least ? most : -least) / 20;
    return current_uA < least - margin || current_uA > most + margin;
}

static bool is_open(const struct amplifier *a, int32_t current_uA)
{
    const uint32_t asked_uA = magnitude(a->output_uA);
    return asked_uA >= FLOWING_uA && 2 * (uint64_t)magnitude(current_uA) < asked_uA;
}

/* Sign of |V| - R |I| with R a limit in milliohms; 0 if the current is too small. */
static int8_t against(const struct amplifier_inputs *in, uint32_t limit_mohm)
{
    const uint32_t flows_uA = magnitude(in->current_uA);
    const uint64_t measured = 1000u * (uint64_t)magnitude(in->voltage_uV);
    const uint64_t limit = (uint64_t)limit_mohm * flows_uA;
    if (flows_uA < FLOWING_uA || measured == limit)
        return 0;
    return measured < limit ? -1 : 1;
}

static int16_t wire_temperature_max(const struct amplifier *a)
{
    return (int16_t)*AMPLIFIER_SETTING(a, AMP_WIRE_TEMPERATURE_MAX);
}

uint16_t guard_settings_words(const struct amplifier *a)
{
    return wire_temperature_max(a) == AMP_WIRE_TEMPERATURE_MAX_NONE ? AMP_WIRE_TEMPERATURE_MAX - AMP_SETTINGS_FIRST
                                                                    : AMP_SETTINGS_WORDS;
}

/* Beyond the limit, or not known any more. */
static bool too_hot(const struct amplifier *a, int16_t temperature)
{
    if (wire_temperature_max(a) == AMP_WIRE_TEMPERATURE_MAX_NONE)
        return false;
    return temperature == AMP_RING_TEMPERATURE_NONE ? a->thermometer : temperature > wire_temperature_max(a);
}

/* Three bad ticks in a row? */
static bool lasts(uint8_t *spell, bool bad)
{
    *spell = bad ? (uint8_t)(*spell + 1) : 0;
    return *spell >= SPELL_TICKS;
}

uint16_t guard_tick(struct amplifier *a, const struct amplifier_inputs *in)
{
    const uint32_t resistance_min = words_u32(AMPLIFIER_SETTING(a, AMP_RESISTANCE_MIN));
    const uint32_t resistance_max = words_u32(AMPLIFIER_SETTING(a, AMP_RESISTANCE_MAX));
    const bool open = lasts(&a->spells.open, is_open(a, in->current_uA));
    const bool short_circuit = lasts(&a->spells.short_circuit, against(in, resistance_min) < 0);
    const bool resistance = lasts(&a->spells.resistance, against(in, resistance_max) > 0);
    a->ticks_unfed++;
    /* the order decides which cause is reported */
    if (in->hardware & AMPLIFIER_STOP_OPEN)
        return AMP_FAULT_STOP;
    if (over_current(a, in->current_uA))
        return AMP_FAULT_OVER_CURRENT;
    if (open)
        return AMP_FAULT_OPEN;
    if (short_circuit)
        return AMP_FAULT_SHORT;
    if (resistance)
        return AMP_FAULT_RESISTANCE;
    if (too_hot(a, in->temperature))
        return AMP_FAULT_WIRE_TEMPERATURE;
    if (a->heat > words_u32(AMPLIFIER_SETTING(a, AMP_HEAT_MAX)))
        return AMP_FAULT_HEAT;
    return a->ticks_unfed > guard_lease_ticks(a) ? AMP_FAULT_LEASE : 0;
}
