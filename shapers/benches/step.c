/* The least that a C programmer writes for the same step: a ring of setpoints, and for each tap a
 * multiplication and an addition of position, velocity and acceleration.
 *
 * Arguments: steps, rounds, then for each tap its delay (ticks) and its amplitude.
 * Prints the least time of a step (ns) of all rounds, and the sum of all shaped positions. */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define LENGTH 257
#define MOST_TAPS 32

typedef struct { double position, velocity, acceleration; } setpoint;
typedef struct { unsigned delay; double amplitude; } tap;

static setpoint ring[LENGTH];
static tap taps[MOST_TAPS];
static unsigned newest, count;

static setpoint step(setpoint input) {
    newest = newest + 1 == LENGTH ? 0 : newest + 1;
    ring[newest] = input;
    setpoint out = {input.position, 0.0, 0.0};
    for (unsigned i = 0; i < count; i++) {
        unsigned delay = taps[i].delay;
        const setpoint *past = &ring[delay <= newest ? newest - delay : newest + LENGTH - delay];
        out.position += taps[i].amplitude * (past->position - input.position);
        out.velocity += taps[i].amplitude * past->velocity;
        out.acceleration += taps[i].amplitude * past->acceleration;
    }
    return out;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(int argc, char **argv) {
    if (argc < 5) return 2;
    long steps = atol(argv[1]), rounds = atol(argv[2]);
    for (int i = 3; i + 1 < argc && count < MOST_TAPS; i += 2, count++) {
        taps[count].delay = (unsigned)atol(argv[i]);
        taps[count].amplitude = atof(argv[i + 1]);
    }
    double least = 1e300, sum = 0.0;
    for (long round = 0; round < rounds; round++) {
        double start = now();
        for (long k = 0; k < steps; k++) {
            double x = 1e-3 * (double)(k & 1023);
            setpoint input = {x, 2.0 * x, 3.0 * x};
            setpoint out = step(input);
            sum += out.position + out.velocity + out.acceleration;
        }
        double time = (now() - start) / (double)steps;
        least = time < least ? time : least;
    }
    printf("%.17g %.17g\n", least, sum);
    return 0;
}
