#include "sensors.h"

#include <math.h>

#include <simavr/avr_adc.h>
#include <simavr/avr_twi.h>

#include "noise.h"

enum { INA219 = 0x40, AS5600 = 0x36, POWER_UP_SETUP = 0x399F };
static const double SHUNT_ohm = 0.1, AS5600_NOISE_counts = 0.17, ADC_NOISE_mV = 3.0;

/* --- INA219 --- */

/* Data sheet, table 5: 9 to 12 bits take 84, 148, 276, 532 us. */
static double conversion_s(uint16_t code)
{
    static const double of_bits[] = {84e-6, 148e-6, 276e-6, 532e-6};
    return of_bits[code & 3u];
}

/* 12 bits over the whole range: the step is larger than the 10 uV of the register if the range is. */
static int16_t shunt_word(const struct ina219 *s, double volts)
{
    const double range_V = 0.04 * (1u << (s->setup >> 11 & 3u)), step_V = range_V / 4000;
    double read_V = step_V * floor((volts * s->gain + s->offset_V) / step_V + 0.5 * noise() + 0.5);
    read_V = fmax(-range_V, fmin(range_V, read_V));
    return (int16_t)lround(read_V / 10e-6);
}

static void convert(struct ina219 *s)
{
    if (s->bus_next)
        s->bus_word = (uint16_t)((uint16_t)fmax(0, floor(s->bus_sum / s->time_s / 4e-3 + 0.3 * noise() + 0.5)) << 3 | 2u);
    else
        s->shunt_word = shunt_word(s, s->shunt_sum / s->time_s);
    s->bus_next = !s->bus_next;
    s->time_s = s->shunt_sum = s->bus_sum = 0;
}

void sensors_step(struct sensors *s, double dt_s)
{
    struct ina219 *ina = &s->ina219;
    ina->shunt_sum += s->power->wire_A * SHUNT_ohm * dt_s;
    ina->bus_sum += s->power->shunt_out_V * dt_s;
    ina->time_s += dt_s;
    if (ina->time_s >= conversion_s(ina->bus_next ? ina->setup >> 7 : ina->setup >> 3))
        convert(ina);
}

static uint16_t ina219_register(const struct ina219 *s)
{
    const uint16_t words[] = {s->setup, (uint16_t)s->shunt_word, s->bus_word};
    return s->pointer < 3 ? words[s->pointer] : 0;
}

static void ina219_written(struct ina219 *s, uint8_t byte)
{
    s->incoming = (uint16_t)(s->incoming << 8 | byte);
    if (s->written++ == 0)
        s->pointer = byte;
    else if (s->written == 3 && s->pointer == 0)
        s->setup = s->incoming;
}

/* --- AS5600 --- */

static uint8_t as5600_byte(struct as5600 *s, uint8_t number)
{
    switch (s->pointer + number) {
    case 0x0B: return s->no_magnet ? 0x10 : 0x20;
    case 0x0C:
        s->latched = lround(s->counts + AS5600_NOISE_counts * noise()) & 0xFFF;
        return (uint8_t)(s->latched >> 8);
    case 0x0D: return (uint8_t)s->latched;
    default: return 0;
    }
}

/* --- the bus --- */

static void say(struct sensors *s, uint8_t what, uint8_t data)
{
    avr_raise_irq(s->to_twi, avr_twi_irq_msg(what, s->selected, data));
}

static void started(struct sensors *s, uint8_t address)
{
    const uint8_t device = address >> 1;
    s->selected = 0;
    s->bytes = 0;
    s->addressed = !(address & 1u);
    if ((device == INA219 && !s->ina219.unplugged) || (device == AS5600 && !s->as5600.unplugged)) {
        s->selected = address;
        s->ina219.written = 0;
        say(s, TWI_COND_ACK, 1);
    }
}

static uint8_t read_byte(struct sensors *s)
{
    const uint8_t number = s->bytes++;
    if (s->selected >> 1 == INA219)
        return (uint8_t)(ina219_register(&s->ina219) >> (number % 2 ? 0 : 8));
    return as5600_byte(&s->as5600, number);
}

/* simavr 1.6 reports an acknowledged address like an acknowledged byte; the data sheet has a code of its own. */
static void on_status(struct avr_irq_t *irq, uint32_t value, void *param)
{
    enum { TWSR = 0xB9, DATA_ACK = 0x28, ADDRESS_ACK = 0x18 };
    struct sensors *s = param;
    (void)irq;
    if (s->addressed && value == DATA_ACK)
        s->avr->data[TWSR] = (uint8_t)(ADDRESS_ACK | (s->avr->data[TWSR] & 3u));
    if (value == DATA_ACK)
        s->addressed = false;
}

static void on_twi(struct avr_irq_t *irq, uint32_t value, void *param)
{
    struct sensors *s = param;
    avr_twi_msg_irq_t message = {.u = {.v = value}};
    (void)irq;
    if (message.u.twi.msg & TWI_COND_STOP)
        s->selected = 0;
    if (message.u.twi.msg & TWI_COND_START)
        started(s, message.u.twi.addr);
    if (s->selected && message.u.twi.msg & TWI_COND_WRITE) {
        say(s, TWI_COND_ACK, 1);
        if (s->selected >> 1 == INA219)
            ina219_written(&s->ina219, message.u.twi.data);
        else
            s->as5600.pointer = message.u.twi.data;
    }
    if (s->selected && message.u.twi.msg & TWI_COND_READ)
        say(s, TWI_COND_READ, read_byte(s));
}

/* --- the ADC: supply through 20 and 10 kohm; thermistor of 10 kohm, B = 3950 K, with 10 kohm to 5 V --- */

static double thermistor_mV(double degC)
{
    const double ratio = exp(3950.0 * (1 / (degC + 273.15) - 1 / 298.15));
    return 5000.0 * ratio / (1 + ratio);
}

static void on_conversion(struct avr_irq_t *irq, uint32_t value, void *param)
{
    struct sensors *s = param;
    union {
        uint32_t v;
        avr_adc_mux_t mux;
    } asked = {.v = value};
    (void)irq;
    const double mV = asked.mux.src == 0 ? 1000.0 * s->power->supply_V / 3 : thermistor_mV(s->wire->ambient_degC);
    avr_raise_irq(s->to_adc + asked.mux.src, (uint32_t)fmax(0, mV + ADC_NOISE_mV * noise()));
}

void sensors_connect(struct sensors *s, avr_t *avr, const struct power_stage *power, const struct wire *wire)
{
    *s = (struct sensors){.ina219 = {.gain = 1.0, .offset_V = 10e-6, .setup = POWER_UP_SETUP, .bus_word = 2},
                          .avr = avr,
                          .power = power,
                          .wire = wire};
    s->to_twi = avr_io_getirq(avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_INPUT);
    s->to_adc = avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_OUTPUT), on_twi, s);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_STATUS), on_status, s);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER), on_conversion, s);
}
