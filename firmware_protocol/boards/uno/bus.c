#include "bus.h"

#include <avr/interrupt.h>
#include <avr/pgmspace.h>
#include <util/atomic.h>

#include "board.h"
#include "current_loop.h"

/* Codes of TWSR, as in the data sheet. */
enum {
    STARTED = 0x08,
    STARTED_AGAIN = 0x10,
    ADDRESS_ACK_W = 0x18,
    DATA_ACK_W = 0x28,
    ADDRESS_ACK_R = 0x40,
    DATA_ACK_R = 0x50,
    DATA_NACK_R = 0x58
};

/*
 * Configuration of the INA219: 16 V, 12 bits for the shunt (532 us), 10 bits for the bus voltage (148 us), both
 * continuously: a new pair every 680 us. The gain covers the largest current of the board.
 */
#define GAIN_4 (AMPLIFIER_BOARD_MAX_uA * SHUNT_mohm <= 150000000ul) /* 160 mV, else 320 mV */
#define INA219_SETUP (uint16_t)((GAIN_4 ? 2u : 3u) << 11 | 1u << 7 | 3u << 3 | 7u)

enum { SHUNT, BUS_VOLTAGE, ANGLE, SETUP, TRANSFERS };

/* Read `count` bytes from a register; SETUP writes two. */
struct transfer {
    uint8_t address, pointer, count;
};
static const struct transfer TRANSFER[TRANSFERS] PROGMEM = {
    {INA219_ADDRESS, 1, 2},
    {INA219_ADDRESS, 2, 2},
    {AS5600_ADDRESS, 0x0B, 3}, /* status, raw angle */
    {INA219_ADDRESS, 0, 2},
};

enum { MAGNET_SEEN = 1 << 5, GIVE_UP_ROUNDS = 3, ABSENT_AFTER = 5 };

static struct {
    struct transfer now;
    uint8_t number, done; /* of the transfer; bytes of it */
    uint8_t bytes[3];
    bool busy, set_up;
    uint8_t late_rounds;
    int16_t shunt, bus;
    uint8_t missing_current, missing_position; /* rounds in a row, at most ABSENT_AFTER */
    bool positioned, jumped;
    int32_t position;
} bus;

#define GO (1 << TWINT | 1 << TWEN | 1 << TWIE)

static void begin(uint8_t number)
{
    bus.number = number;
    bus.done = 0;
    memcpy_P(&bus.now, &TRANSFER[number], sizeof bus.now);
    TWCR = GO | 1 << TWSTA;
}

static void end_round(void)
{
    TWCR = 1 << TWINT | 1 << TWEN | 1 << TWSTO;
    bus.busy = false;
}

static void count(uint8_t *missing, bool good)
{
    if (good)
        *missing = 0;
    else if (*missing < ABSENT_AFTER)
        ++*missing;
}

/* Turns are counted by the shortest way from the last angle. */
static void take_angle(void)
{
    const int16_t angle = (int16_t)((bus.bytes[1] & 0x0F) << 8 | bus.bytes[2]);
    const bool valid = bus.bytes[0] & MAGNET_SEEN;
    count(&bus.missing_position, valid);
    if (!valid)
        return;
    int16_t step = (int16_t)((angle - bus.position) & (COUNTS_PER_TURN - 1));
    if (step >= COUNTS_PER_TURN / 2)
        step = (int16_t)(step - COUNTS_PER_TURN);
    if (bus.positioned && (step > COUNTS_PER_TURN / 4 || step < -COUNTS_PER_TURN / 4))
        bus.jumped = true;
    bus.positioned = true;
    bus.position += step;
}

static void next(uint8_t number)
{
    if (number == SETUP && bus.set_up)
        end_round();
    else
        begin(number);
}

static void transferred(void)
{
    const int16_t word = (int16_t)(bus.bytes[0] << 8 | bus.bytes[1]);
    switch (bus.number) {
    case SHUNT:
        bus.shunt = word;
        begin(BUS_VOLTAGE);
        break;
    case BUS_VOLTAGE:
        bus.bus = word >> 3;
        count(&bus.missing_current, true);
        current_loop_step(bus.shunt, bus.bus);
        begin(ANGLE);
        break;
    case ANGLE:
        take_angle();
        next(SETUP);
        break;
    default:
        bus.set_up = true;
        end_round();
    }
}

/* A device does not answer: the round goes on with the next one. */
static void failed(void)
{
    if (bus.number == ANGLE)
        count(&bus.missing_position, false);
    else {
        count(&bus.missing_current, false);
        bus.set_up = false; /* it may have lost its supply */
    }
    if (bus.number < ANGLE)
        begin(ANGLE);
    else if (bus.number == ANGLE)
        next(SETUP);
    else
        end_round();
}

static void send_byte(void)
{
    const uint16_t setup = INA219_SETUP;
    if (bus.number != SETUP) {
        TWCR = GO | 1 << TWSTA; /* now the reading part */
        return;
    }
    if (bus.done == bus.now.count) {
        transferred();
        return;
    }
    TWDR = (uint8_t)(bus.done++ ? setup & 0xFF : setup >> 8);
    TWCR = GO;
}

/* Acknowledges every byte but the last. */
static void receive_next(void)
{
    TWCR = bus.done + 1 < bus.now.count ? GO | 1 << TWEA : GO;
}

ISR(TWI_vect)
{
    switch (TWSR & 0xF8) {
    case STARTED:
    case STARTED_AGAIN:
        /* the second start of a reading transfer asks for its bytes */
        TWDR = (uint8_t)(bus.now.address << 1 | (bus.done == 0xFF));
        TWCR = GO;
        break;
    case ADDRESS_ACK_W:
        TWDR = bus.now.pointer;
        TWCR = GO;
        break;
    case DATA_ACK_W:
        if (bus.number != SETUP)
            bus.done = 0xFF; /* the pointer is written */
        send_byte();
        break;
    case ADDRESS_ACK_R:
        bus.done = 0;
        receive_next();
        break;
    case DATA_ACK_R:
        bus.bytes[bus.done++] = TWDR;
        receive_next();
        break;
    case DATA_NACK_R:
        bus.bytes[bus.done] = TWDR;
        transferred();
        break;
    default:
        failed();
    }
}

void bus_start(void)
{
    PORTC |= 1 << PC4 | 1 << PC5; /* weak pull-ups beside those of the modules */
    TWBR = (uint8_t)((F_CPU / 400000 - 16) / 2);
    TWCR = 1 << TWEN;
}

/* A round that does not end within three milliseconds is given up, whoever holds the lines. */
void bus_start_round(void)
{
    if (bus.busy && ++bus.late_rounds < GIVE_UP_ROUNDS)
        return;
    if (bus.busy) {
        TWCR = 0;
        if (bus.number == ANGLE)
            count(&bus.missing_position, false);
        else
            count(&bus.missing_current, false);
        bus.set_up = false;
    }
    bus.late_rounds = 0;
    bus.busy = true;
    begin(SHUNT);
}

int32_t bus_position(void)
{
    int32_t position;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        position = bus.position;
    }
    return position;
}

bool bus_position_is_valid(void)
{
    return bus.positioned && bus.missing_position < ABSENT_AFTER;
}

bool bus_position_jumped(void)
{
    bool jumped;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        jumped = bus.jumped;
        bus.jumped = false;
    }
    return jumped;
}

bool bus_current_is_valid(void)
{
    return bus.missing_current < ABSENT_AFTER;
}
