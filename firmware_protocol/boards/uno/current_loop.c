/*
 * A buck converter with the wire at ground. PWM through the wire would heat it by the mean square and not by the mean,
 * and with a switch at its low side the voltage would be a difference of two large readings.
 */
#include "current_loop.h"

#include <util/atomic.h>

#include "board.h"

enum {
    TOP = 511,          /* 16 MHz / 512: 31 kHz */
    BLIND_ms = 5,       /* without a measurement */
    MOVE_STEPS = 4,     /* of a large change of duty: at once, it would make inductor and capacitor ring */
    HOLD_STEPS = 3,     /* after it: what is measured is still the current before it */
    GAIN_SHIFT = 2,     /* a step corrects a quarter of the error, for a wire of the least resistance */
    LEAST_mohm = 1000,  /* where the host states none: slow, but never more than the wire needs */
    SUPPLY_LEAST_mV = 3000,
    DIODE_mV = 350,
    PER_LSB_MOST = 30000 /* times the largest error it still fits 32 bits */
};

/* The duty is a fraction of 2^24; timer 1 takes its upper 9 bits, and the rest is spread over the next steps. */
#define FULL_DUTY ((1l << 24) - 1)
#define REST_BITS 15

static struct {
    int16_t set, cut;  /* LSB of the shunt */
    int32_t per_lsb;   /* duty for one LSB through the least resistance */
    int32_t diode;     /* duty that only makes up for the diode's drop while the gate is closed */
    int32_t duty;
    uint16_t rest;
    int32_t part;       /* of a large change, added in each of its steps */
    uint8_t left;       /* steps of a large change and of the hold after it */
    bool estimated;     /* the change rests on the least resistance; the next one on what flows then */
    uint8_t blind_ms;
    bool closed;       /* until the next current_loop_drive */
    int16_t peak;      /* what closed it, 0 for nothing */
    int32_t sum_shunt, sum_bus;
    uint8_t measured;
    bool measuring;
} loop;

static void close_gate(void)
{
    TCCR1A &= (uint8_t) ~(1 << COM1A1);
    PORTB &= (uint8_t) ~(1 << GATE_PIN);
}

static void open_gate(uint16_t compare)
{
    if (!compare) {
        close_gate(); /* timer 1 has no pulse of length 0 */
        return;
    }
    OCR1A = compare;
    TCCR1A |= 1 << COM1A1;
}

/* Fast PWM with ICR1 as its top (mode 14); the gate is a plain low output until a current is driven. */
void current_loop_start(void)
{
    close_gate();
    DDRB |= 1 << GATE_PIN;
    ICR1 = TOP;
    TCCR1A = 1 << WGM11;
    TCCR1B = 1 << WGM13 | 1 << WGM12 | 1 << CS10;
    loop.closed = true;
}

static void apply_duty(void)
{
    uint16_t compare = (uint16_t)(loop.duty >> REST_BITS);
    loop.rest = (uint16_t)(loop.rest + (loop.duty & ((1l << REST_BITS) - 1)));
    if (loop.rest >= 1u << REST_BITS) {
        loop.rest = (uint16_t)(loop.rest - (1u << REST_BITS));
        compare++;
    }
    open_gate(compare < TOP ? compare : TOP);
}

static void change_duty(int32_t by)
{
    loop.duty += by;
    if (loop.duty < 0)
        loop.duty = 0;
    if (loop.duty > FULL_DUTY)
        loop.duty = FULL_DUTY;
}

static void begin_change(int32_t by)
{
    loop.part = by / MOVE_STEPS;
    loop.left = MOVE_STEPS + HOLD_STEPS;
}

/* After a change by estimate, current and duty are known: beyond the diode's share they are proportional. */
static void correct_estimate(int16_t shunt)
{
    const int32_t used = loop.duty - loop.diode;
    loop.estimated = false;
    if (used > 0 && shunt > loop.set / 4 && shunt / 4 < loop.set)
        begin_change(used / shunt * (loop.set - (int32_t)shunt));
}

static void change_in_progress(int16_t shunt)
{
    if (loop.left > HOLD_STEPS)
        change_duty(loop.part);
    if (--loop.left == 0 && loop.estimated)
        correct_estimate(shunt);
}

static int16_t in_lsb(int32_t current_uA)
{
    const int32_t lsb = current_uA / (int32_t)uA_PER_LSB;
    return lsb < 0 ? 0 : lsb > INT16_MAX ? INT16_MAX : (int16_t)lsb; /* one direction only */
}

static int32_t duty_per_lsb(uint32_t least_mohm, uint16_t supply_mV)
{
    if (least_mohm < LEAST_mohm)
        least_mohm = LEAST_mohm;
    /* 2^24 mohm uA / (10^6 mV) */
    const uint32_t duty = least_mohm * (uA_PER_LSB * 16777ul / 1000) / supply_mV;
    return duty < PER_LSB_MOST ? (int32_t)duty : PER_LSB_MOST;
}

void current_loop_drive(int32_t current_uA, uint32_t least_mohm, uint16_t supply_mV, int32_t cut_uA)
{
    const int16_t set = in_lsb(current_uA), cut = in_lsb(cut_uA);
    if (supply_mV < SUPPLY_LEAST_mV)
        supply_mV = SUPPLY_LEAST_mV;
    const int32_t diode = FULL_DUTY / (supply_mV + DIODE_mV) * DIODE_mV;
    const int32_t per_lsb = duty_per_lsb(least_mohm, supply_mV);
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if (set != loop.set || !set) {
            begin_change((set - (int32_t)loop.set) * per_lsb);
            loop.estimated = true;
        }
        if (!set) {
            loop.peak = 0;
            loop.duty = 0;
        }
        loop.set = set;
        loop.cut = cut;
        loop.per_lsb = per_lsb;
        loop.diode = diode;
        loop.closed = !set || loop.peak || loop.blind_ms >= BLIND_ms;
        if (loop.closed)
            close_gate();
    }
}

void current_loop_off(void)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        close_gate();
        loop.closed = true;
        loop.duty = 0;
        loop.set = 0;
    }
}

void current_loop_step(int16_t shunt, int16_t bus)
{
    loop.blind_ms = 0;
    if (loop.measuring && loop.measured < UINT8_MAX) {
        loop.sum_shunt += shunt;
        loop.sum_bus += bus;
        loop.measured++;
    }
    if (loop.closed)
        return;
    if (shunt > loop.cut) {
        loop.peak = shunt;
        current_loop_off();
        return;
    }
    if (loop.left)
        change_in_progress(shunt);
    else
        change_duty((loop.set - (int32_t)shunt) * loop.per_lsb >> GAIN_SHIFT);
    apply_duty();
}

void current_loop_watch(void)
{
    if (loop.blind_ms < BLIND_ms)
        loop.blind_ms++;
    else
        current_loop_off();
}

void current_loop_begin_measurement(void)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        loop.sum_shunt = loop.sum_bus = 0;
        loop.measured = 0;
        loop.measuring = true;
    }
}

/* Nothing measured reads as no current: the gate is closed then. */
struct measurement current_loop_end_measurement(void)
{
    struct measurement found = {0, 0, false};
    int32_t shunt, bus;
    uint8_t count;
    int16_t peak;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        loop.measuring = false;
        shunt = loop.sum_shunt;
        bus = loop.sum_bus;
        count = loop.measured;
        peak = loop.peak;
        found.saturated = loop.duty == FULL_DUTY;
    }
    if (count) {
        found.current_uA = shunt * (int32_t)uA_PER_LSB / count;
        found.voltage_uV = bus * (int32_t)uV_PER_BUS_LSB / count;
    }
    if (peak)
        found.current_uA = peak * (int32_t)uA_PER_LSB;
    return found;
}
