/* The interface of FMI 2.0 for co-simulation (fmi-standard.org) around one Preisach operator.

   One input, one output, one parameter: the start from positive saturation. A step of communication is a monotone move
   to the input at its end, so steps must be short enough that the input does not turn within one. */
#include "MODEL.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

enum { INPUT, OUTPUT, POSITIVE }; /* value references */

typedef struct {
    MODEL_memory memory;
    double input, start;
    int given; /* whether the input was set */
} instance;

static fmi2Status begun(instance *self)
{
    MODEL_reset(&self->memory, self->start != 0.0);
    if (self->given)
        MODEL_step(&self->memory, self->input);
    return fmi2OK;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    instance *self;
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || guid == NULL || strcmp(guid, FMU_GUID) != 0)
        return NULL;
    self = calloc(1, sizeof *self);
    if (self != NULL)
        begun(self);
    return self;
}

EXPORT void fmi2FreeInstance(fmi2Component c) { free(c); }

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean limited, fmi2Real tolerance, fmi2Real start,
                                      fmi2Boolean ends, fmi2Real stop)
{
    (void)limited, (void)tolerance, (void)start, (void)ends, (void)stop;
    return c ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return c ? begun(c) : fmi2Error; }
EXPORT fmi2Status fmi2Terminate(fmi2Component c) { return c ? fmi2OK : fmi2Error; }

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    instance *self = c;
    if (self == NULL)
        return fmi2Error;
    memset(self, 0, sizeof *self);
    return begun(self);
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real value[])
{
    instance *self = c;
    size_t k;
    if (self == NULL)
        return fmi2Error;
    for (k = 0; k < n; k++) {
        if (r[k] == INPUT)
            value[k] = self->input;
        else if (r[k] == OUTPUT)
            value[k] = self->memory.y;
        else if (r[k] == POSITIVE)
            value[k] = self->start;
        else
            return fmi2Error;
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real value[])
{
    instance *self = c;
    size_t k;
    if (self == NULL)
        return fmi2Error;
    for (k = 0; k < n; k++) {
        if (isnan(value[k]))
            return fmi2Error;
        if (r[k] == INPUT) {
            self->input = value[k];
            self->given = 1;
        } else if (r[k] == POSITIVE) {
            self->start = value[k];
        } else {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean keep)
{
    instance *self = c;
    (void)now, (void)keep;
    if (self == NULL || !(step >= 0))
        return fmi2Error;
    if (self->given)
        MODEL_step(&self->memory, self->input);
    return fmi2OK;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c) { (void)c; return fmi2Error; }

/* --- state: a copy of the instance ---------------------------------------------------------------------------- */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (c == NULL || state == NULL)
        return fmi2Error;
    if (*state == NULL)
        *state = malloc(sizeof(instance));
    if (*state == NULL)
        return fmi2Error;
    memcpy(*state, c, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (c == NULL || state == NULL)
        return fmi2Error;
    memcpy(c, state, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(instance);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    (void)c;
    if (state == NULL || size < sizeof(instance))
        return fmi2Error;
    memcpy(bytes, state, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    (void)c;
    if (size != sizeof(instance) || state == NULL)
        return fmi2Error;
    *state = malloc(sizeof(instance));
    if (*state == NULL)
        return fmi2Error;
    memcpy(*state, bytes, sizeof(instance));
    return fmi2OK;
}

/* --- what this model does not have ------------------------------------------------------------------------------ */

#define REFUSED(name, type)                                                                              \
    EXPORT fmi2Status name(fmi2Component c, const fmi2ValueReference r[], size_t n, type value[])        \
    {                                                                                                    \
        (void)c, (void)r, (void)value;                                                                   \
        return n ? fmi2Error : fmi2OK;                                                                   \
    }
REFUSED(fmi2GetInteger, fmi2Integer)
REFUSED(fmi2GetBoolean, fmi2Boolean)
REFUSED(fmi2GetString, fmi2String)
REFUSED(fmi2SetInteger, const fmi2Integer)
REFUSED(fmi2SetBoolean, const fmi2Boolean)
REFUSED(fmi2SetString, const fmi2String)

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                               const fmi2ValueReference k[], size_t nk, const fmi2Real d[],
                                               fmi2Real out[])
{
    (void)c, (void)u, (void)nu, (void)k, (void)nk, (void)d, (void)out;
    return fmi2Error;
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                              const fmi2Integer order[], const fmi2Real value[])
{
    (void)c, (void)r, (void)order, (void)value;
    return n ? fmi2Error : fmi2OK;
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                               const fmi2Integer order[], fmi2Real value[])
{
    (void)c, (void)r, (void)order, (void)value;
    return n ? fmi2Error : fmi2OK;
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)c, (void)kind;
    *value = fmi2OK;
    return fmi2Discard;
}
EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    (void)c, (void)kind;
    *value = 0.0;
    return fmi2Discard;
}
EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c, (void)kind;
    *value = 0;
    return fmi2Discard;
}
EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c, (void)kind;
    *value = 0;
    return fmi2Discard;
}
EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)c, (void)kind;
    *value = "";
    return fmi2Discard;
}
