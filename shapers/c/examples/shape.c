/* A move of one axis, shaped for a mode that turns out to be another one halfway: the filter is retuned, and
 * nothing of the true mode is left. Prints the train, the shaped setpoints and the residual. */
#include "quell_shapers.h"

#include <math.h>
#include <stdio.h>

#define TICK 0.004
#define MOVE 100 /* ticks */
#define TICKS 400
#define CAPACITY 128
#define HORIZON 1024

/* Static: a controller has no heap. quell_filter_bytes(CAPACITY, HORIZON) must fit. */
static _Alignas(max_align_t) unsigned char memory[131072];

static int failed(const char *what, quell_status status) {
    if (status == QUELL_OK) return 0;
    fprintf(stderr, "%s: %s\n", what, quell_text(status));
    return 1;
}

/* A smooth move from 0 to 1. */
static quell_setpoint planned(int tick) {
    double duration = MOVE * TICK, x = tick < MOVE ? (double)tick / MOVE : 1.0, rest = 1.0 - x;
    quell_setpoint setpoint = {
        x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * x * x * rest * rest / duration,
        60.0 * x * rest * (1.0 - 2.0 * x) / (duration * duration),
    };
    return setpoint;
}

int main(void) {
    const double hertz = 6.283185307179586;
    quell_mode believed = {8.0 * hertz, 0.05}, identified = {9.0 * hertz, 0.04};
    quell_train first, second, both;
    if (failed("first train", quell_design("zvd", believed, TICK, &first))) return 1;
    if (failed("second train", quell_design("zvd", identified, TICK, &second))) return 1;
    printf("train");
    for (uint32_t i = 0; i < first.count; i++)
        printf(" %u %.17g", (unsigned)first.taps[i].delay, first.taps[i].amplitude);
    printf("\n");

    quell_filter *filter;
    quell_status status = quell_filter_init(memory, sizeof memory, TICK, CAPACITY, HORIZON, &filter);
    if (failed("filter", status)) return 1;
    if (failed("install", quell_filter_install(filter, &first))) return 1;

    for (int tick = 1; tick <= TICKS; tick++) {
        quell_setpoint out = quell_filter_step(filter, planned(tick));
        printf("step %.17g %.17g %.17g\n", out.position, out.velocity, out.acceleration);
        if (tick == MOVE / 2) {
            quell_setpoint ahead[MOVE / 2];
            for (int k = 0; k < MOVE / 2; k++) ahead[k] = planned(tick + 1 + k);
            quell_limits limits = {10.0, 100.0, INFINITY};
            quell_correction correction;
            status = quell_filter_retune(filter, &second, &identified, 1, 0.005, limits, ahead, MOVE / 2, &correction);
            if (failed("retune", status)) return 1;
            printf("correction of %.3f s, at rest in %.3f s\n", correction.duration, correction.until_rest);
        }
    }

    quell_residual left;
    if (failed("residual", quell_filter_residual(filter, identified, &left))) return 1;
    printf("residual %.17g of %.17g, settled %d\n", left.shaped, left.unshaped,
           (int)quell_filter_is_settled(filter));

    /* An arm that rings in two modes has one train for both. */
    quell_mode modes[] = {{8.0 * hertz, 0.05}, {19.0 * hertz, 0.03}};
    if (failed("train for two modes", quell_design_modes("zv", modes, 2, TICK, &both))) return 1;
    printf("both");
    for (uint32_t i = 0; i < both.count; i++)
        printf(" %u %.17g", (unsigned)both.taps[i].delay, both.taps[i].amplitude);
    printf("\n");

    /* What is refused is told. */
    printf("refused %d %d %d %d\n", (int)quell_filter_install(filter, NULL),
           (int)quell_design("none", believed, TICK, &first),
           (int)quell_filter_init(memory, 64, TICK, CAPACITY, HORIZON, &filter),
           (int)quell_filter_init(memory + 1, sizeof memory - 1, TICK, CAPACITY, HORIZON, &filter));
    return 0;
}
