#include "power_stage.h"

static const double L_H = 330e-6, COIL_ohm = 0.2, C_F = 100e-6, ESR_ohm = 0.2;
static const double SWITCH_ohm = 0.15; /* MOSFET, fuse and supply lead */
static const double DIODE_V = 0.33, DIODE_ohm = 0.05;
static const double SHUNT_ohm = 0.1, LEAD_ohm = 0.02;

void power_stage_start(struct power_stage *p)
{
    *p = (struct power_stage){.supply_V = 6.0, .wire_ohm = 5.0};
}

static double switch_node_V(const struct power_stage *p, bool gate, double out_V)
{
    if (gate)
        return p->supply_V - SWITCH_ohm * p->inductor_A;
    return p->inductor_A > 0 ? -DIODE_V - DIODE_ohm * p->inductor_A : out_V;
}

void power_stage_step(struct power_stage *p, bool gate, double dt_s)
{
    const double load_ohm = SHUNT_ohm + LEAD_ohm + p->wire_ohm;
    const double out_V = (p->capacitor_V + ESR_ohm * p->inductor_A) / (1 + ESR_ohm / load_ohm);
    p->wire_A = out_V / load_ohm;
    p->shunt_out_V = p->wire_A * (LEAD_ohm + p->wire_ohm);
    p->capacitor_V += (p->inductor_A - p->wire_A) * dt_s / C_F;
    p->inductor_A += (switch_node_V(p, gate, out_V) - COIL_ohm * p->inductor_A - out_V) * dt_s / L_H;
    if (p->inductor_A < 0)
        p->inductor_A = 0; /* neither the diode nor the MOSFET's body diode lets it flow back to ground */
}
