/*
 * The electrical side: supply, P-channel MOSFET, Schottky diode, inductor, capacitor, shunt and wire.
 *
 *     L diL/dt = v_switch - R_L iL - v_out        v_switch: supply, or minus the diode's drop, or v_out at iL = 0
 *     C dvC/dt = iL - i_wire                      v_out = vC + ESR (iL - i_wire) = i_wire (R_shunt + R_lead + R_wire)
 */
#ifndef UNO_POWER_STAGE_H
#define UNO_POWER_STAGE_H

#include <stdbool.h>

struct power_stage {
    double supply_V, wire_ohm;
    double inductor_A, capacitor_V; /* states */
    double wire_A, shunt_out_V;     /* after the last step */
};

void power_stage_start(struct power_stage *p);

/* One step of `dt_s`, a microsecond or less. */
void power_stage_step(struct power_stage *p, bool gate, double dt_s);

#endif
