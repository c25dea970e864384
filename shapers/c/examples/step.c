#include "quell_shapers.h"
#include <stdio.h>
static _Alignas(max_align_t) unsigned char memory[131072]; /* of the filter: there is no heap */

int main(void) {
    quell_mode believed = {51.02, 0.084}; /* rad/s, damping ratio */
    quell_train train;
    quell_filter *filter;
    if (quell_design("zvd", believed, 0.004, &train) != QUELL_OK) return 1;
    if (quell_filter_init(memory, sizeof memory, 0.004, 128, 1024, &filter) != QUELL_OK) return 1;
    if (quell_filter_install(filter, &train) != QUELL_OK) return 1;
    for (int tick = 0; tick < 40; tick++) {
        quell_setpoint planned = {1.0, 0.0, 0.0}; /* position, velocity, acceleration */
        printf("%.6f\n", quell_filter_step(filter, planned).position);
    }
    return 0;
}
