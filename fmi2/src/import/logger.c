/* The logger an FMU calls: turns a printf format with its arguments into one text. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#define LARGEST (1 << 20)

typedef void (*line_function)(void *environment, const char *instance, int status, const char *category,
                              const char *text);

/* The first member of the Rust type behind componentEnvironment. */
struct environment {
    line_function line;
};

void fmi2_import_logger(void *environment, const char *instance, int status, const char *category,
                        const char *message, ...) {
    const struct environment *receiver = environment;
    char small[1024] = "";
    char *large = NULL;
    int length = 0;
    if (receiver == NULL || receiver->line == NULL) {
        return;
    }
    if (message != NULL) {
        va_list arguments;
        va_start(arguments, message);
        length = vsnprintf(small, sizeof small, message, arguments);
        va_end(arguments);
    }
    if (length >= (int)sizeof small && length < LARGEST) {
        large = malloc((size_t)length + 1);
    }
    if (large != NULL) {
        va_list arguments;
        va_start(arguments, message);
        vsnprintf(large, (size_t)length + 1, message, arguments);
        va_end(arguments);
    }
    receiver->line(environment, instance, status, category, large != NULL ? large : length < 0 ? message : small);
    free(large);
}
