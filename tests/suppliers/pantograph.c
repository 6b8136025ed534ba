/*
 * Two-mass pantograph as a supplier might deliver: FMI 2.0 for co-simulation, in C, with only the C library.
 *
 * The collector head m1 stands on the frame m2, the frame on the base. u1 and u2 are rises from the state in which both
 * springs are unstretched; the strip is at reference_height then:
 *
 *     m1 u1'' = -k1 (u1 - u2) - c1 (u1' - u2') - F
 *     m2 u2'' =  k1 (u1 - u2) + c1 (u1' - u2') - k2 u2 - c2 u2' + S
 *
 * F is the contact force, positive in compression, S the static force. Start: at rest, strip at start_height.
 * Runge-Kutta of order 4 with steps of at most SUBSTEP; the input follows its derivatives inside a step.
 *
 * Macros of the build choose abilities and misbehaviour. Abilities, each 1 by default:
 *     ROLLBACK       states can be saved and restored; 0: refused with an error; 2: restored without the speeds
 *     INTERPOLATE    input derivatives are followed
 *     DERIVATIVES    directional derivatives are given; 2: wrong ones
 * Misbehaviour, absent by default:
 *     ONLY_STEP=h                 refuses communication steps other than h
 *     REFUSE_NEGATIVE_START       refuses a start time below 0
 *     REFUSE_NONZERO_START        refuses a start time other than 0
 *     NEED_RESOURCES              takes the masses from pantograph.txt in its resources
 *     NEED_DIRECTORY              goes to its resources and stays there; reads the masses from pantograph.txt at each start
 *     NEED_CURRENT_DIRECTORY      opens pantograph.txt in the current directory
 *     LOG_ARGUMENTS, LOG_NULL_CATEGORY, LOG_FROM_THREAD, LOG_EVERY_STEP
 *     PRINT                       prints a line at its start
 *     STEP_STATUS=s               returns s from steps that start at STEP_STATUS_AT or later
 *     DISCARD_LONGER_THAN=h       discards steps longer than h
 *     NAN_AT=t                    the height is not a number from t on
 *     FAULT=f                     SEGV, ABORT, EXIT, LOOP in FAULT_IN=INSTANTIATE, INITIALISE, STEP, TERMINATE (in the
 *                                 last two from FAULT_AT on)
 */
#define _GNU_SOURCE
#include "fmi2.h"
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef GUID
#define GUID "{3f0d5d8e-6a5c-4f43-9c0b-2f3d1a7e5b10}"
#endif
#ifndef ROLLBACK
#define ROLLBACK 1
#endif
#ifndef INTERPOLATE
#define INTERPOLATE 1
#endif
#ifndef DERIVATIVES
#define DERIVATIVES 1
#endif
#ifndef STEP_STATUS_AT
#define STEP_STATUS_AT 0.0
#endif
#ifndef FAULT_AT
#define FAULT_AT 0.0
#endif

/* Words of FAULT and FAULT_IN. */
enum { NOTHING, SEGV, ABORT, EXIT, LOOP, INSTANTIATE, INITIALISE, STEP, TERMINATE };
#ifndef FAULT
#define FAULT NOTHING
#endif
#ifndef FAULT_IN
#define FAULT_IN NOTHING
#endif

/* Longest internal step, s: 500 per period of the head on its spring. */
#define SUBSTEP 1e-4

/* Value references. */
enum { M1 = 1, M2, K1, K2, C1, C2, STATIC_FORCE, REFERENCE_HEIGHT, START_HEIGHT, FORCE = 10, Z1 = 20, V1, Z2, V2, RAISED = 30,
       KIND = 40, SERIAL = 50 };
#define PARAMETERS 10 /* index 0 is not used */
#define ORDERS 3

/* Content of a state: derivatives of the input are those of the coming step. */
typedef struct {
    double parameter[PARAMETERS];
    double force;
    double force_derivative[ORDERS];
    double u[4]; /* u1, u2, u1', u2' */
    double t;
    int kind;
    int raised;
} State;

typedef struct {
    State state;
    fmi2CallbackFunctions callbacks;
    char name[256];
    char resources[4096];
    char serial[64];
    int running;
    int logging;
} Pantograph;

static const double DEFAULTS[PARAMETERS] = {0.0, 7.2, 15.0, 4200.0, 50.0, 10.0, 90.0, 120.0, 5.3, 5.3};

static void say(Pantograph *p, fmi2Status status, const char *category, const char *text) {
    if (p->callbacks.logger != NULL) {
        p->callbacks.logger(p->callbacks.componentEnvironment, p->name, status, category, "%s", text);
    }
}

static fmi2Status refuse(Pantograph *p, const char *what, double value) {
    char text[160];
    snprintf(text, sizeof text, "%s = %g is not possible", what, value);
    say(p, fmi2Error, "logStatusError", text);
    return fmi2Error;
}

static void misbehave(int here) {
    if (FAULT_IN != here) {
        return;
    }
    switch (FAULT) {
    case SEGV: {
        volatile int *nowhere = NULL;
        *nowhere = 1;
        break;
    }
    case ABORT:
        abort();
    case EXIT:
        exit(0);
    case LOOP:
        for (;;) {
            usleep(1000);
        }
    default:
        break;
    }
}

#ifdef LOG_FROM_THREAD
static void *log_elsewhere(void *pantograph) {
    say(pantograph, fmi2OK, "logEvents", "said by another thread");
    return NULL;
}
#endif

/* Messages of a pantograph, in the chosen way. */
static void chatter(Pantograph *p, const char *where) {
    (void)p, (void)where;
#ifdef LOG_ARGUMENTS
    p->callbacks.logger(p->callbacks.componentEnvironment, p->name, fmi2OK, "logEvents", "%s: %d masses, F = %f N, 100 %% of #r10#",
                        where, 2, p->state.force);
#endif
#ifdef LOG_NULL_CATEGORY
    p->callbacks.logger(p->callbacks.componentEnvironment, p->name, fmi2Warning, NULL, "no category\nbut two lines");
    p->callbacks.logger(p->callbacks.componentEnvironment, NULL, fmi2OK, NULL, "no name");
#endif
#ifdef LOG_FROM_THREAD
    pthread_t thread;
    if (pthread_create(&thread, NULL, log_elsewhere, p) == 0) {
        pthread_join(thread, NULL);
    }
#endif
}

/* Path of a URI with the scheme file. */
static void path_of(const char *uri, char *path, size_t size) {
    size_t n = 0;
    if (strncmp(uri, "file://", 7) == 0) {
        uri += 7;
    } else if (strncmp(uri, "file:", 5) == 0) {
        uri += 5;
    }
    while (*uri != '\0' && n + 1 < size) {
        unsigned int byte;
        if (*uri == '%' && sscanf(uri + 1, "%2x", &byte) == 1) {
            path[n++] = (char)byte;
            uri += 3;
        } else {
            path[n++] = *uri++;
        }
    }
    path[n] = '\0';
}

#if defined(NEED_RESOURCES) || defined(NEED_DIRECTORY) || defined(NEED_CURRENT_DIRECTORY)
static fmi2Status read_masses(Pantograph *p, const char *folder) {
    char path[4200];
    FILE *file;
    int found;
    snprintf(path, sizeof path, "%s%spantograph.txt", folder, *folder == '\0' ? "" : "/");
    file = fopen(path, "r");
    if (file == NULL) {
        char text[4300];
        snprintf(text, sizeof text, "cannot open %s", path);
        say(p, fmi2Error, "logStatusError", text);
        return fmi2Error;
    }
    found = fscanf(file, "%lf %lf", &p->state.parameter[M1], &p->state.parameter[M2]);
    fclose(file);
    return found == 2 ? fmi2OK : fmi2Error;
}
#endif

static void start(Pantograph *p) {
    const double *c = p->state.parameter;
    double *u = p->state.u;
    u[0] = c[START_HEIGHT] - c[REFERENCE_HEIGHT];
    u[1] = (c[STATIC_FORCE] + c[K1] * u[0]) / (c[K1] + c[K2]);
    u[2] = u[3] = 0.0;
}

/* u' at the force of the time tau after the start of the step. */
static void rates(const State *s, const double *u, double tau, double *rate) {
    const double *c = s->parameter, *d = s->force_derivative;
    const double force = s->force + tau * (d[0] + tau * (d[1] / 2.0 + tau * d[2] / 6.0));
    const double spring = c[K1] * (u[0] - u[1]) + c[C1] * (u[2] - u[3]);
    rate[0] = u[2];
    rate[1] = u[3];
    rate[2] = (-spring - force) / c[M1];
    rate[3] = (spring - c[K2] * u[1] - c[C2] * u[3] + c[STATIC_FORCE]) / c[M2];
}

static void advance(State *s, double length) {
    const int count = (int)ceil(length / SUBSTEP * (1.0 - 1e-9));
    const double h = count > 0 ? length / count : 0.0;
    int n, i, stage;
    for (n = 0; n < count; n++) {
        static const double AT[4] = {0.0, 0.5, 0.5, 1.0}, WEIGHT[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
        double slope[4] = {0.0}, sum[4] = {0.0};
        for (stage = 0; stage < 4; stage++) {
            double u[4];
            for (i = 0; i < 4; i++) {
                u[i] = s->u[i] + h * AT[stage] * slope[i];
            }
            rates(s, u, (n + AT[stage]) * h, slope);
            for (i = 0; i < 4; i++) {
                sum[i] += WEIGHT[stage] * slope[i];
            }
        }
        for (i = 0; i < 4; i++) {
            s->u[i] += h * sum[i];
        }
    }
    s->t += length;
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    (void)n;
    (void)categories;
    ((Pantograph *)c)->logging = on;
    return fmi2OK;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    Pantograph *p;
    (void)visible;
    if (type != fmi2CoSimulation || strcmp(guid, GUID) != 0 || (p = calloc(1, sizeof *p)) == NULL) {
        return NULL;
    }
    memcpy(p->state.parameter, DEFAULTS, sizeof DEFAULTS);
    p->state.force = DEFAULTS[STATIC_FORCE];
    p->callbacks = *callbacks;
    p->logging = logging;
    snprintf(p->name, sizeof p->name, "%s", name);
    snprintf(p->serial, sizeof p->serial, "%s", "none");
    path_of(resources != NULL ? resources : "", p->resources, sizeof p->resources);
    chatter(p, "instantiate");
    misbehave(INSTANTIATE);
#ifdef NEED_DIRECTORY
    if (chdir(p->resources) != 0) {
        say(p, fmi2Error, "logStatusError", "cannot go to the resources");
        free(p);
        return NULL;
    }
    if (read_masses(p, "") != fmi2OK) {
        free(p);
        return NULL;
    }
#endif
    start(p);
    return p;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) { free(c); }

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real begin,
                                           fmi2Boolean stop_defined, fmi2Real stop) {
    Pantograph *p = c;
    (void)tolerance_defined;
    (void)tolerance;
    (void)stop_defined;
    (void)stop;
#ifdef REFUSE_NEGATIVE_START
    if (begin < 0.0) {
        return refuse(p, "startTime", begin);
    }
#endif
#ifdef REFUSE_NONZERO_START
    if (begin != 0.0) {
        return refuse(p, "startTime", begin);
    }
#endif
    p->state.t = begin;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Pantograph *p = c;
    misbehave(INITIALISE);
#ifdef PRINT
    puts("two masses, at your service");
#endif
    chatter(p, "initialise");
#ifdef NEED_RESOURCES
    return read_masses(p, p->resources);
#elif defined(NEED_CURRENT_DIRECTORY)
    return read_masses(p, "");
#else
    return fmi2OK;
#endif
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Pantograph *p = c;
    const double *parameter = p->state.parameter;
    int i;
    for (i = M1; i <= C2; i++) {
        if (!(parameter[i] >= 0.0) || (i <= M2 && parameter[i] == 0.0)) {
            return refuse(p, i <= M2 ? "a mass" : "a stiffness or damping", parameter[i]);
        }
    }
    start(p);
    p->running = 1;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    Pantograph *p = c;
    if (p->state.t > FAULT_AT - 1e-9) {
        misbehave(TERMINATE);
    }
    p->running = 0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    Pantograph *p = c;
    memset(&p->state, 0, sizeof p->state);
    memcpy(p->state.parameter, DEFAULTS, sizeof DEFAULTS);
    p->running = 0;
    start(p);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    Pantograph *p = c;
    const State *s = &p->state;
    size_t i;
    if (!p->running) {
        start(p);
    }
    for (i = 0; i < n; i++) {
        if (vr[i] >= M1 && vr[i] < PARAMETERS) {
            value[i] = s->parameter[vr[i]];
        } else if (vr[i] == FORCE) {
            value[i] = s->force;
        } else if (vr[i] == Z1 || vr[i] == Z2) {
            value[i] = s->parameter[REFERENCE_HEIGHT] + s->u[vr[i] == Z2];
        } else if (vr[i] == V1 || vr[i] == V2) {
            value[i] = s->u[2 + (vr[i] == V2)];
        } else {
            return refuse(p, "a value reference", vr[i]);
        }
#ifdef NAN_AT
        if (vr[i] == Z1 && s->t > NAN_AT - 1e-9) {
            value[i] = NAN;
        }
#endif
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Pantograph *p = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (!isfinite(value[i])) {
            return refuse(p, "a real value", value[i]);
        } else if (vr[i] >= M1 && vr[i] < PARAMETERS) {
            p->state.parameter[vr[i]] = value[i];
        } else if (vr[i] == FORCE) {
            p->state.force = value[i];
            memset(p->state.force_derivative, 0, sizeof p->state.force_derivative);
        } else {
            return refuse(p, "a value reference", vr[i]);
        }
    }
    return fmi2OK;
}

/* Getter and setter of the one variable of a type. */
#define ACCESS(NAME, TYPE, REFERENCE, READ, WRITE)                                                              \
    FMI2_EXPORT fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, TYPE value[]) {       \
        Pantograph *p = c;                                                                                      \
        size_t i;                                                                                               \
        for (i = 0; i < n; i++) {                                                                               \
            if (vr[i] != REFERENCE) {                                                                           \
                return refuse(p, "a value reference", vr[i]);                                                   \
            }                                                                                                   \
            value[i] = READ;                                                                                    \
        }                                                                                                       \
        return fmi2OK;                                                                                          \
    }                                                                                                           \
    FMI2_EXPORT fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, const TYPE value[]) { \
        Pantograph *p = c;                                                                                      \
        size_t i;                                                                                               \
        for (i = 0; i < n; i++) {                                                                               \
            if (vr[i] != REFERENCE) {                                                                           \
                return refuse(p, "a value reference", vr[i]);                                                   \
            }                                                                                                   \
            WRITE;                                                                                              \
        }                                                                                                       \
        return fmi2OK;                                                                                          \
    }

ACCESS(Integer, fmi2Integer, KIND, p->state.kind, p->state.kind = value[i])
ACCESS(Boolean, fmi2Boolean, RAISED, p->state.raised, p->state.raised = value[i])
ACCESS(String, fmi2String, SERIAL, p->serial, snprintf(p->serial, sizeof p->serial, "%s", value[i]))

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    Pantograph *p = c;
    if (!ROLLBACK) {
        return refuse(p, "a copy of a state of bytes", sizeof(State));
    }
    if (*state == NULL && (*state = malloc(sizeof(State))) == NULL) {
        return refuse(p, "a copy of a state of bytes", sizeof(State));
    }
    memcpy(*state, &p->state, sizeof(State));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    Pantograph *p = c;
    const double speeds[2] = {p->state.u[2], p->state.u[3]};
    if (!ROLLBACK) {
        return refuse(p, "a copy of a state of bytes", sizeof(State));
    }
    memcpy(&p->state, state, sizeof(State));
    if (ROLLBACK == 2) {
        memcpy(p->state.u + 2, speeds, sizeof speeds);
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)c;
    (void)state;
    *size = sizeof(State);
    return ROLLBACK ? fmi2OK : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    (void)c;
    if (!ROLLBACK || size < sizeof(State)) {
        return fmi2Error;
    }
    memcpy(bytes, state, sizeof(State));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    (void)c;
    if (!ROLLBACK || size != sizeof(State) || (*state == NULL && (*state = malloc(sizeof(State))) == NULL)) {
        return fmi2Error;
    }
    memcpy(*state, bytes, sizeof(State));
    return fmi2OK;
}

/* The height does not depend on the force with the states frozen. */
FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                                    const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                                    fmi2Real derivative[]) {
    size_t i;
    (void)unknown;
    (void)known;
    if (!DERIVATIVES) {
        return refuse(c, "a number of directional derivatives", (double)unknowns);
    }
    for (i = 0; i < unknowns; i++) {
        derivative[i] = DERIVATIVES == 2 && knowns > 0 ? 0.5 * seed[0] : 0.0;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
    Pantograph *p = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (!INTERPOLATE || vr[i] != FORCE || order[i] < 1 || order[i] > ORDERS) {
            return refuse(p, "an input derivative of order", order[i]);
        }
        p->state.force_derivative[order[i] - 1] = value[i];
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set_state_before) {
    Pantograph *p = c;
    State *s = &p->state;
    (void)no_set_state_before;
    if (!p->running) {
        return refuse(p, "a step before the end of the initialisation, at t", t);
    }
    if (fabs(t - s->t) > 1e-9) {
        return refuse(p, "a step that does not begin where the last one ended, at t", t);
    }
#ifdef ONLY_STEP
    if (fabs(h - ONLY_STEP) > 1e-9) {
        return refuse(p, "communicationStepSize", h);
    }
#endif
#ifdef DISCARD_LONGER_THAN
    if (h > DISCARD_LONGER_THAN * (1.0 + 1e-9)) {
        say(p, fmi2Discard, "logStatusDiscard", "the step is too long");
        return fmi2Discard;
    }
#endif
    if (t > FAULT_AT - 1e-9) {
        misbehave(STEP);
    }
#ifdef LOG_EVERY_STEP
    chatter(p, "step");
#endif
    (void)chatter;
#ifdef STEP_STATUS
    if (t > STEP_STATUS_AT - 1e-9) {
        say(p, STEP_STATUS, "logEvents", "the air spring is at its stop");
        if (STEP_STATUS != fmi2Warning) {
            return STEP_STATUS;
        }
        advance(s, h);
        memset(s->force_derivative, 0, sizeof s->force_derivative);
        return STEP_STATUS;
    }
#endif
    advance(s, h);
    s->t = t + h;
    s->force += h * (s->force_derivative[0] + h * (s->force_derivative[1] / 2.0 + h * s->force_derivative[2] / 6.0));
    memset(s->force_derivative, 0, sizeof s->force_derivative);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
    (void)c;
    return fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
    (void)c;
    (void)vr;
    (void)order;
    memset(value, 0, n * sizeof *value);
    return fmi2OK;
}

/* Requests without an answer. */
#define NO_STATUS(NAME, TYPE)                                                                          \
    FMI2_EXPORT fmi2Status NAME(fmi2Component c, const fmi2StatusKind kind, TYPE *value) {              \
        (void)c;                                                                                       \
        (void)kind;                                                                                    \
        (void)value;                                                                                   \
        return fmi2Discard;                                                                            \
    }

NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = ((Pantograph *)c)->state.t;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    (void)c;
    if (kind != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = 0;
    return fmi2OK;
}
