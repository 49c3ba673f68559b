/* The serial port of a chip: 115200 8N1. Its interrupts call link_byte, link_next and link_silence. */
#ifndef SMARIG_SERIAL_H
#define SMARIG_SERIAL_H

#define BAUD 115200ul
#define SILENCE_us 1750ul /* 3.5 characters, fixed by Modbus above 19200 baud */

void serial_start(void);

/* Sends what link_next gives, until it gives nothing. Interrupts are off. */
void serial_send(void);

/* The timer of the silence that ends a frame: link_silence is called SILENCE_us after the last restart. */
void silence_start(void);
void silence_restart(void);

#endif
