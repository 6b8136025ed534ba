/* A collector head on a damper under a static force, as an FMU that misbehaves on demand; compiled by tests/isolation.rs.

   m dv/dt = S - F - d v, dz/dt = v; semi-implicit Euler, 20 steps per communication step.

   value references: 0 F [N] in; 1 z [m], 2 v [m/s] out; 3 at [s]; 4 fault (String); 5 S [N]
   faults from the step that reaches t = at on: see fail(). The environment variable HEAD_FAULT is one for fmi2Instantiate,
   HEAD_LOAD one for loading the library. */
#define _GNU_SOURCE
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct { logger_t logger; void *allocate, *free, *finished, *environment; } callbacks_t;
typedef struct {
    callbacks_t host;
    double force, z, v, at, static_force, time;
    char fault[64];
    int done;
} head_t;

static volatile int forever = 1;

static int is(const head_t *c, const char *fault) { return strcmp(c->fault, fault) == 0; }

static void *chatter(void *argument) {
    head_t *c = argument;
    c->host.logger(c->host.environment, "head", 0, NULL, "from another thread, %d", 42);
    return NULL;
}

/* Writes bytes that mean nothing to every socket of the process. */
static void corrupt(void) {
    for (int place = 0; place < 64; place++) send(place, "\1\1\1\1\1", 5, MSG_NOSIGNAL | MSG_DONTWAIT);
}

/* A process in a session of its own, which outlives its parents. */
static void daemon_of_its_own(void) {
    if (fork() == 0) {
        setsid();
        if (fork() == 0) sleep(60);
        _exit(0);
    }
    wait(NULL);
}

/* A thread that outlives the instance, and crashes when the library is unloaded. */
static volatile int haunted = 0, unloading = 0;
static void *haunt(void *nobody) {
    while (!unloading) { }
    *(volatile int *)8 = 1;
    return nobody;
}
__attribute__((destructor)) static void unloaded(void) {
    if (haunted) { unloading = 1; sleep(10); }
}

/* Takes all memory that it can have, and does not bear to have no more. */
static void hoard(void) {
    for (;;) {
        char *memory = malloc(1 << 24);
        if (memory == NULL) abort();
        memset(memory, 1, 1 << 24);
    }
}

/* Returns a status, or does not return. */
static int fail(head_t *c, const char *fault) {
    if (strcmp(fault, "abort") == 0) {
        fprintf(stderr, "head: assertion failed\n");
        abort();
    }
    if (strcmp(fault, "segv") == 0) *(volatile int *)8 = 1;
    if (strcmp(fault, "loop") == 0) while (forever) { }
    if (strcmp(fault, "exit") == 0) exit(3);
    if (strcmp(fault, "_exit") == 0) _exit(4);
    if (strcmp(fault, "_exit0") == 0) _exit(0);
    if (strcmp(fault, "kill") == 0) raise(SIGKILL);
    if (strcmp(fault, "stop") == 0) raise(SIGSTOP);
    if (strcmp(fault, "corrupt") == 0) { corrupt(); raise(SIGSTOP); }
    if (strcmp(fault, "hoard") == 0) hoard();
    if (strcmp(fault, "daemon") == 0 && !c->done++) daemon_of_its_own();
    if (strcmp(fault, "fork") == 0 && !c->done++) fork();
    if (strcmp(fault, "helper") == 0 && !c->done++) {
        if (fork() == 0) exit(0);
        wait(NULL);
    }
    if (strcmp(fault, "fatal") == 0) return 4;
    if (strcmp(fault, "error") == 0) {
        c->host.logger(c->host.environment, "head", 3, "e", "the head is lost at %.2f m", c->z);
        return 3;
    }
    if (strcmp(fault, "discard") == 0) return 2;
    if (strcmp(fault, "print") == 0) { printf("PFMU nonsense on stdout\n"); fflush(stdout); }
    if (strcmp(fault, "wander") == 0 && (chdir("/") != 0 || setlocale(LC_ALL, "C.UTF-8") == NULL)) abort();
    if (strcmp(fault, "home") == 0 && strcmp(setlocale(LC_ALL, NULL), "C") != 0) abort();
    if (strcmp(fault, "haunt") == 0 && !c->done++) {
        pthread_t thread;
        haunted = pthread_create(&thread, NULL, haunt, NULL) == 0;
    }
    if (strcmp(fault, "thread") == 0) {
        pthread_t thread;
        pthread_create(&thread, NULL, chatter, c);
        pthread_join(thread, NULL);
    }
    return 0;
}

__attribute__((constructor)) static void loaded(void) {
    const char *fault = getenv("HEAD_LOAD");
    static head_t nobody;
    if (fault != NULL) fail(&nobody, fault);
}

const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *location,
                      const callbacks_t *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)location, (void)visible, (void)logging;
    head_t *c = calloc(1, sizeof *c);
    c->host = *callbacks;
    c->z = 5.3;
    c->static_force = 120.0;
    c->at = 1e9;
    const char *fault = getenv("HEAD_FAULT");
    if (fault != NULL) fail(c, fault);
    FILE *here = fopen("beside.txt", "r"); /* in the folder resources, if that is the current directory */
    if (here != NULL) {
        c->host.logger(c->host.environment, name, 0, NULL, "resources are the current directory");
        fclose(here);
    }
    return c;
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int td, double t, double s, int ed, double e) {
    (void)c, (void)td, (void)t, (void)s, (void)ed, (void)e; return 0;
}
int fmi2EnterInitializationMode(void *c) { (void)c; return 0; }
int fmi2ExitInitializationMode(void *p) {
    head_t *c = p;
    return is(c, "initialise") ? fail(c, "segv") : 0;
}
int fmi2Terminate(void *c) { return is(c, "terminate") ? fail(c, "loop") : 0; }
int fmi2Reset(void *c) { (void)c; return 0; }
static double *real(head_t *c, unsigned r) {
    switch (r) {
    case 0: return &c->force;
    case 1: return &c->z;
    case 2: return &c->v;
    case 3: return &c->at;
    case 5: return &c->static_force;
    default: return NULL;
    }
}
int fmi2GetReal(void *p, const unsigned *r, size_t n, double *v) {
    head_t *c = p;
    if (is(c, "get") && c->time >= c->at) fail(c, "segv");
    for (size_t i = 0; i < n; i++) {
        if (real(c, r[i]) == NULL) return 3;
        v[i] = *real(c, r[i]);
    }
    return 0;
}
int fmi2SetReal(void *p, const unsigned *r, size_t n, const double *v) {
    head_t *c = p;
    if (is(c, "set") && c->time >= c->at) fail(c, "abort");
    for (size_t i = 0; i < n; i++) {
        if (real(c, r[i]) == NULL) return 3;
        *real(c, r[i]) = v[i];
    }
    return 0;
}
int fmi2SetString(void *p, const unsigned *r, size_t n, const char *const *v) {
    head_t *c = p;
    for (size_t i = 0; i < n; i++) {
        if (r[i] != 4) return 3;
        strncpy(c->fault, v[i], sizeof c->fault - 1);
    }
    return 0;
}
#define NONE(name, type) int name(void *c, const unsigned *r, size_t n, type *v) \
    { (void)c, (void)r, (void)v; return n == 0 ? 0 : 3; }
NONE(fmi2GetInteger, int) NONE(fmi2GetBoolean, int) NONE(fmi2GetString, const char *)
NONE(fmi2SetInteger, const int) NONE(fmi2SetBoolean, const int)
int fmi2DoStep(void *p, double t, double h, int no_rollback) {
    head_t *c = p;
    (void)no_rollback;
    if (t + h >= c->at - 1e-9) {
        int status = fail(c, c->fault);
        if (status != 0) return status;
    }
    for (int i = 0; i < 20; i++) {
        c->v = (c->v + h / 20 / 8.0 * (c->static_force - c->force)) / (1 + h / 20 / 8.0 * 120.0);
        c->z += h / 20 * c->v;
    }
    c->time = t + h;
    return 0;
}
