/* An FMU that misbehaves as told; compiled by tests/foreign.rs. */
#include <stddef.h>
#include <stdlib.h>
#include <xmmintrin.h>

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct { logger_t logger; void *allocate, *free, *finished, *environment; } callbacks_t;

static callbacks_t host;
static int fatal;

const char *fmi2GetVersion(void) { return "2.0.4"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *location,
                      const callbacks_t *callbacks, int visible, int logging) {
    (void)type, (void)guid, (void)location, (void)visible, (void)logging;
    host = *callbacks;
    _mm_setcsr(_mm_getcsr() | 0x8040); /* flush to zero */
    host.logger(host.environment, name, 0, NULL, "made %s, %d%% of #r0#, %.3f", name, 100, 1.5);
    return &host;
}
void fmi2FreeInstance(void *c) { (void)c; if (fatal) abort(); }
int fmi2SetupExperiment(void *c, int td, double t, double s, int ed, double e) {
    (void)c, (void)td, (void)t, (void)s, (void)ed, (void)e; return 1;
}
int fmi2EnterInitializationMode(void *c) { (void)c; return 0; }
int fmi2ExitInitializationMode(void *c) { (void)c; return 0; }
int fmi2Terminate(void *c) { (void)c; if (fatal) abort(); return 0; }
int fmi2Reset(void *c) { (void)c; return 0; }
#define ACCESS(name, type) int name(void *c, const unsigned *r, size_t n, type *v) \
    { (void)c, (void)r, (void)n, (void)v; return 0; }
ACCESS(fmi2GetReal, double) ACCESS(fmi2GetInteger, int) ACCESS(fmi2GetBoolean, int) ACCESS(fmi2GetString, const char *)
ACCESS(fmi2SetReal, const double) ACCESS(fmi2SetInteger, const int) ACCESS(fmi2SetBoolean, const int)
ACCESS(fmi2SetString, const char *const)
#ifndef INCOMPLETE
/* The step size says what happens: the status, or 42. */
int fmi2DoStep(void *c, double t, double h, int no_rollback) {
    static char text[5001];
    (void)c, (void)t, (void)no_rollback;
    for (int i = 0; i < 5000; i++) text[i] = 'x';
    host.logger(host.environment, NULL, (int)h, "step", "%s", (int)h == 2 ? text : "line 1\nline 2\n");
    if ((int)h == 4 || (int)h == 42) fatal = 1;
    return (int)h;
}
#endif
int fmi2GetStatus(void *c, int kind, int *value) { (void)c, (void)kind; *value = 2; return 0; }
