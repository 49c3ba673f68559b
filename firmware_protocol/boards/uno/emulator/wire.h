/*
 * The wire. By itself it is a first-order heat balance whose position and resistance follow the temperature; coupled to
 * another program (the twin) it is whatever that program says after each interval.
 */
#ifndef UNO_WIRE_H
#define UNO_WIRE_H

struct wire {
    double temperature_K; /* above ambient */
    double ohm, counts;   /* counts of the AS5600, over all turns */
    double ambient_degC;
};

void wire_start(struct wire *w);
void wire_heat(struct wire *w, double square_A2, double dt_s);

#endif
