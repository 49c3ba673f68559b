/* Noise with a fixed seed, so that two runs of the emulator are equal. */
#ifndef UNO_NOISE_H
#define UNO_NOISE_H

/* A normal number of standard deviation 1 (sum of twelve uniform ones). */
double noise(void);

#endif
