#include "noise.h"

#include <stdint.h>

double noise(void)
{
    static uint64_t seed = 88172645463325252u;
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        sum += (double)(seed >> 11) / 9007199254740992.0;
    }
    return sum;
}
