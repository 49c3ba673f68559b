#include "wire.h"

#include <math.h>

/* The one-wire rig of the twin: 174 K at 1 A, 0.3 mm thick; 350 counts of motion around 50 K. */
static const double K_PER_A2 = 174.1, TAU_s = 5.3, MIDDLE_K = 50.0, WIDTH_K = 12.0, MOTION_counts = 350.0;
static const double COLD_ohm = 5.0, HOT_ohm = 4.5, REST_counts = 1000.0;

void wire_start(struct wire *w)
{
    *w = (struct wire){.ohm = COLD_ohm, .counts = REST_counts, .ambient_degC = 22.0};
}

void wire_heat(struct wire *w, double square_A2, double dt_s)
{
    w->temperature_K += (K_PER_A2 * square_A2 - w->temperature_K) * dt_s / TAU_s;
    const double hot = 1.0 / (1.0 + exp((MIDDLE_K - w->temperature_K) / WIDTH_K));
    w->ohm = COLD_ohm + hot * (HOT_ohm - COLD_ohm);
    w->counts = REST_counts + hot * MOTION_counts;
}
