/* What is connected to which pin of the Uno, and the values of the parts. docs/how_to/uno_board.md draws it. */
#ifndef UNO_BOARD_H
#define UNO_BOARD_H

#include <avr/io.h>
#include <stdint.h>

/* Port B: D9, the gate (OC1A; high lets the current flow), and D13, the LED. */
#define GATE_PIN PB1
#define LED_PIN PB5

/* Port D: D2, the stop contact to ground. It is closed in operation, so a broken lead stops too. */
#define STOP_PIN PD2

/* Port C: A0, the supply of the wire through 20 kohm and 10 kohm; A1, a thermistor to ground; A4 and A5, I2C. */
enum { SUPPLY_CHANNEL = 0, AMBIENT_CHANNEL = 1, SUPPLY_DIVIDES_BY = 3, ADC_REFERENCE_mV = 5000 };

enum { INA219_ADDRESS = 0x40, AS5600_ADDRESS = 0x36 };

/* The shunt: 0.1 ohm, as on the usual modules, gives 10 uV of the INA219 per 0.1 mA. */
#define SHUNT_mohm 100ul
#define uA_PER_LSB (10000ul / SHUNT_mohm)
#define uV_PER_BUS_LSB 4000ul

#define COUNTS_PER_TURN 4096

#endif
