/* The UART of the MCU on a pty of this machine, byte by byte in the time of a line of 115200 baud. */
#ifndef UNO_SERIAL_PORT_H
#define UNO_SERIAL_PORT_H

#include <stdbool.h>
#include <stdint.h>

#include <simavr/sim_avr.h>

struct serial_port {
    avr_t *avr;
    avr_irq_t *input;
    int pty;
    bool ready;
    avr_cycle_count_t last_byte; /* when the host's last byte arrived */
    unsigned long bytes;         /* of the host */
};

/* Starts the line, also after a reset of the MCU. */
void serial_port_run(struct serial_port *s);

/* Opens the pty and returns its path; NULL if there is none. */
const char *serial_port_open(struct serial_port *s, avr_t *avr);

#endif
