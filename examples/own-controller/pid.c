/*
 * PID controller of the contact force: FMI 2.0 for co-simulation, in C, with only the C library.
 *
 * One step is one sample. It takes the force F that was measured at the start of the step and gives the command u:
 *
 *     e = F_desired - F,    u = kp e + I + D,    I += ki T e,    D = a D + (1 - a) kd (e - e_last)/T,    a = exp(-T/T_d)
 *
 * with T the length of the step and T_d = derivative_lag. The command is limited, and the integral stands still where it
 * would drive a limited command further out.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { OK, ERROR = 3 };

/* Value references. */
enum { F, F_DESIRED, U, KP, KI, KD, DERIVATIVE_LAG, LIMIT, COUNT };

typedef struct {
    double value[COUNT];
    double integral, derivative, error;
    int begun;
} Pid;

static void reset(Pid *pid) {
    memset(pid, 0, sizeof *pid);
    pid->value[KP] = 0.5;
    pid->value[LIMIT] = 100.0;
}

static double command(Pid *pid, double sample) {
    const double *v = pid->value;
    const double ki = v[KI] * sample, kd = v[KD] / sample;
    const double kept = v[DERIVATIVE_LAG] > 0.0 ? exp(-sample / v[DERIVATIVE_LAG]) : 0.0;
    const double error = v[F_DESIRED] - v[F];
    if (!pid->begun) {
        pid->error = error;
        pid->begun = 1;
    }
    const double change = kd * (error - pid->error);
    pid->derivative = kept * pid->derivative + (1.0 - kept) * change;
    pid->error = error;
    const double rest = v[KP] * error + pid->derivative;
    const double integral = pid->integral + ki * error;
    if (!(fabs(rest + integral) > v[LIMIT] && (rest + integral) * error > 0.0)) {
        pid->integral = integral;
    }
    return fmax(-v[LIMIT], fmin(v[LIMIT], rest + pid->integral));
}

/* The functions of FMI. */
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const void *callbacks,
                             int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    Pid *pid = malloc(sizeof *pid);
    if (pid) {
        reset(pid);
    }
    return pid;
}

EXPORT void fmi2FreeInstance(void *c) { free(c); }

EXPORT int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return OK;
}

EXPORT int fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(void *c) { return (void)c, OK; }
EXPORT int fmi2ExitInitializationMode(void *c) { return (void)c, OK; }
EXPORT int fmi2Terminate(void *c) { return (void)c, OK; }
EXPORT int fmi2Reset(void *c) { return reset(c), OK; }

EXPORT int fmi2GetReal(void *c, const unsigned reference[], size_t n, double value[]) {
    for (size_t i = 0; i < n; i++) {
        if (reference[i] >= COUNT) {
            return ERROR;
        }
        value[i] = ((Pid *)c)->value[reference[i]];
    }
    return OK;
}

EXPORT int fmi2SetReal(void *c, const unsigned reference[], size_t n, const double value[]) {
    for (size_t i = 0; i < n; i++) {
        if (reference[i] >= COUNT || reference[i] == U) {
            return ERROR;
        }
        ((Pid *)c)->value[reference[i]] = value[i];
    }
    return OK;
}

/* It has no variables of other types. */
#define NONE(NAME, TYPE)                                                                \
    EXPORT int fmi2##NAME(void *c, const unsigned reference[], size_t n, TYPE value[]) { \
        (void)c, (void)reference, (void)value;                                          \
        return n == 0 ? OK : ERROR;                                                     \
    }
NONE(GetInteger, int)
NONE(GetBoolean, int)
NONE(GetString, const char *)
NONE(SetInteger, const int)
NONE(SetBoolean, const int)
NONE(SetString, const char *const)

EXPORT int fmi2DoStep(void *c, double t, double h, int no_rollback) {
    (void)t, (void)no_rollback;
    ((Pid *)c)->value[U] = command(c, h);
    return OK;
}

EXPORT int fmi2GetFMUstate(void *c, void **state) {
    if (!*state && !(*state = malloc(sizeof(Pid)))) {
        return ERROR;
    }
    memcpy(*state, c, sizeof(Pid));
    return OK;
}

EXPORT int fmi2SetFMUstate(void *c, void *state) { return memcpy(c, state, sizeof(Pid)), OK; }

EXPORT int fmi2FreeFMUstate(void *c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}
