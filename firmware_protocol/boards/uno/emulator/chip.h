/* The MCU with its firmware: pins, PWM, reset, hang, and calls of single functions of the firmware. */
#ifndef UNO_CHIP_H
#define UNO_CHIP_H

#include <stdbool.h>
#include <stdint.h>

#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

struct chip {
    avr_t *avr;
    elf_firmware_t firmware;
    avr_flashaddr_t hung_at; /* 0: not hung */
    uint8_t replaced[2];
    uint16_t compare; /* of timer 1, once both of its bytes are written */
    void (*after_reset)(void); /* a reset forgets all timers */
};

/* False if the ELF cannot be read. */
bool chip_load(struct chip *c, const char *elf);

/* Runs to this cycle; false if the firmware crashed. */
bool chip_run(struct chip *c, avr_cycle_count_t until);

/* The share of time for which the gate is high, 0 to 1, by the registers of timer 1 and of port B. */
double chip_gate(const struct chip *c);

/* Bytes of RAM between the variables and the deepest stack so far. */
unsigned chip_free_ram(const struct chip *c);

bool chip_led(const struct chip *c);
void chip_open_stop(struct chip *c, bool open);
void chip_reset(struct chip *c);

/* Stops the program until the watchdog resets it; interrupts still run. */
void chip_hang(struct chip *c);

/* Address of a symbol in flash, or in RAM without its offset; 0 if there is none. */
uint32_t chip_symbol(const struct chip *c, const char *name);

/* Calls a function with words in its argument registers (r24, r22, …) and returns r24. Interrupts wait. */
uint16_t chip_call(struct chip *c, const char *name, const uint16_t *words, int count);

#endif
