/* The Preisach operator of the model MODEL, exported by smarig. C99; no allocation, no global state.

   Inputs are in INPUT_UNIT, from LOWER_TEXT to UPPER_TEXT; outputs are in OUTPUT_UNIT. Inputs beyond the range are
   saturated. The arithmetic is that of smarig, operation by operation: compiled without contraction of products and
   sums (gcc and clang: -ffp-contract=off), results are the same to the last bit as far as exp and tanh are. */
#ifndef MODEL_H
#define MODEL_H

#ifndef MODEL_EXTREMA
#define MODEL_EXTREMA 128 /* remembered extrema; a deeper nesting forgets the innermost loop */
#endif

#if MODEL_EXTREMA < 4
#error "MODEL_EXTREMA must be at least 4"
#endif

typedef struct {
    double u, y;                  /* the present point */
    int top;                      /* index of the youngest extremum */
    int forgotten;                /* loops that did not fit into the memory */
    double U[MODEL_EXTREMA + 2];  /* extrema, alternately minima and maxima; U[1] is the smallest input */
    double K[MODEL_EXTREMA + 2];  /* their keys in the table */
    double Y[MODEL_EXTREMA + 2];  /* outputs at them */
} MODEL_memory;

enum { MODEL_FOUND = 0, MODEL_OUT_OF_RANGE = 1, MODEL_NOT_MONOTONE = 2, MODEL_NOT_A_NUMBER = 3 };

/* Go to negative or (positive != 0) positive saturation; returns the output there. */
double MODEL_reset(MODEL_memory *memory, int positive);

/* Move monotonically to the input u; returns the output. A NaN moves nothing. */
double MODEL_step(MODEL_memory *memory, double u);

/* The input of the least monotone move that gives the output y. The memory does not change.
   MODEL_OUT_OF_RANGE: *u is the end of the range that is nearest to y. MODEL_NOT_MONOTONE: the output reverses on the
   way, so there is no inverse; *u is where it reverses. */
int MODEL_inverse(const MODEL_memory *memory, double y, double *u);

#endif
