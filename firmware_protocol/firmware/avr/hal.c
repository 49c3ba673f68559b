#include "../program/hal.h"
#include "plant.h"

volatile struct plant plant;

void hal_start(void)
{
}

void hal_drive(int32_t current_uA)
{
    plant.output_uA = current_uA;
}

void hal_mark_tick(void)
{
    plant.tick++;
}

void hal_measure(int32_t *first, int32_t *second, int16_t *temperature, uint16_t *hardware)
{
    plant.taken = 1;
    *first = plant.first;
    *second = plant.second;
    *temperature = plant.temperature;
    *hardware = plant.hardware;
    plant.taken = 0;
}

int32_t hal_counts(void)
{
    plant.taken = 1;
    const int32_t counts = plant.first;
    plant.taken = 0;
    return counts;
}
