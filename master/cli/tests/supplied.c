/* A pantograph of two masses as somebody else writes it, with the manners that the defines give it; compiled by
   tests/supplied.rs. Value references: 0 F_c, 1 z1, 2 v1, 3 static force, 4 mode (enumeration, an integer). */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifdef UNITS /* kN, mm, km/h */
#define FORCE 1e3
#define LENGTH 1e-3
#define SPEED (1 / 3.6)
#else
#define FORCE 1.0
#define LENGTH 1.0
#define SPEED 1.0
#endif
#ifdef LIFTS
#define SIGN (-1.0)
#else
#define SIGN 1.0
#endif
#define ONLY_STEP 2.5e-4

typedef struct {
    double x[4]; /* heights and velocities of both masses, m and m/s, heights from the start */
    double force, rate, rest;
    int mode;
} state_t;

static void rates(const state_t *s, double force, const double *x, double *d) {
    const double m1 = 7.2, k1 = 4200, c1 = 10, m2 = 15, k2 = 50, c2 = 90;
    double between = k1 * (x[0] - x[1]) + c1 * (x[2] - x[3]);
    d[0] = x[2];
    d[1] = x[3];
    d[2] = (-SIGN * force - between) / m1;
    d[3] = (between - k2 * x[1] - c2 * x[3] + s->rest) / m2;
}

static void advance(state_t *s, double tau, double h) {
    double k[4][4], x[4];
    const double part[4] = {0, 0.5, 0.5, 1};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) x[j] = s->x[j] + (i ? part[i] * h * k[i - 1][j] : 0);
        rates(s, s->force + s->rate * (tau + part[i] * h), x, k[i]);
    }
    for (int j = 0; j < 4; j++) s->x[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
}

const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
void *fmi2Instantiate(const char *n, int t, const char *g, const char *l, const void *c, int v, int o) {
    (void)n, (void)t, (void)g, (void)l, (void)c, (void)v, (void)o;
    state_t *s = calloc(1, sizeof *s);
    s->rest = 120;
    s->mode = 1;
    return s;
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int td, double t, double s, int ed, double e) {
    (void)c, (void)td, (void)t, (void)s, (void)e;
#ifdef NO_STOP
    return ed ? 3 : 0;
#else
    (void)ed;
    return 0;
#endif
}
int fmi2EnterInitializationMode(void *c) { (void)c; return 0; }
int fmi2ExitInitializationMode(void *c) {
    state_t *s = c;
    if (s->mode == 3) s->rest = 150; /* "strong" */
    return 0;
}
int fmi2Terminate(void *c) { (void)c; return 0; }
int fmi2Reset(void *c) { (void)c; return 0; }
int fmi2GetReal(void *c, const unsigned *r, size_t n, double *v) {
    state_t *s = c;
    for (size_t i = 0; i < n; i++)
        v[i] = r[i] == 0 ? s->force / FORCE : r[i] == 1 ? s->x[0] / LENGTH : r[i] == 2 ? s->x[2] / SPEED : s->rest;
    return 0;
}
int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *v) {
    state_t *s = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == 0) s->force = v[i] * FORCE, s->rate = 0;
        if (r[i] == 3) s->rest = v[i];
    }
    return 0;
}
int fmi2SetInteger(void *c, const unsigned *r, size_t n, const int *v) {
    (void)r;
    if (n) ((state_t *)c)->mode = v[0];
    return 0;
}
#define NONE(name) int name(void *c, const void *r, size_t n, void *v) { (void)c, (void)r, (void)v; return n ? 3 : 0; }
NONE(fmi2GetInteger) NONE(fmi2GetBoolean) NONE(fmi2GetString) NONE(fmi2SetBoolean) NONE(fmi2SetString)
int fmi2SetRealInputDerivatives(void *c, const unsigned *r, size_t n, const int *o, const double *v) {
    (void)c, (void)r, (void)n, (void)o, (void)v;
#ifndef IGNORES
    for (size_t i = 0; i < n; i++) {
        if (o[i] != 1) return 3;
        if (r[i] == 0) ((state_t *)c)->rate = v[i] * FORCE;
    }
#endif
    return 0;
}
int fmi2DoStep(void *c, double t, double h, int no_rollback) {
    state_t *s = c;
    (void)no_rollback;
#ifdef FIXED
    if (fabs(h / ONLY_STEP - 1) > 1e-9) return 3;
#endif
#ifdef DISCARD
    if (t > 0.1) return 2;
#endif
#ifdef NOT_A_NUMBER
    if (t > 0.1) s->x[2] = NAN;
#endif
    (void)t;
    const int pieces = 1 + (int)(h / 1e-4);
    for (int i = 0; i < pieces; i++) advance(s, i * h / pieces, h / pieces);
    s->force += s->rate * h;
    s->rate = 0;
    return 0;
}
int fmi2GetFMUstate(void *c, void **p) {
#ifdef CRASHES
    abort();
#endif
#ifdef HANGS
    for (volatile int forever = 1; forever;) {}
#endif
    if (!*p) *p = malloc(sizeof(state_t));
    memcpy(*p, c, sizeof(state_t));
    return 0;
}
int fmi2SetFMUstate(void *c, void *p) {
    state_t *s = c;
    const double velocity = s->x[3];
    memcpy(s, p, sizeof *s);
#ifdef INEXACT
    s->x[3] = velocity; /* forgotten in the state */
#else
    (void)velocity;
#endif
    return 0;
}
int fmi2FreeFMUstate(void *c, void **p) { (void)c; free(*p); *p = NULL; return 0; }
