/* Input shapers for a robot controller in C.
 *
 * A train of impulses leaves a vibratory mode at rest; a filter runs one axis' setpoints through it, tick by
 * tick, and can be retuned to another mode in mid-move. Nothing allocates, blocks or keeps global state:
 * a filter lives in memory that the caller gives. SI throughout: s, rad, rad/s, rad/s^2, rad/s^3 (or m ...).
 *
 * Build, for the machine at hand or with --target for another (a panic handler of its own, no std, no heap):
 *
 *     cargo rustc -p quell-shapers-c --profile bare --features bare --crate-type staticlib
 *     cc -std=c11 -I shapers/c/include program.c target/bare/libquell_shapers_c.a -lm
 *
 * Functions return QUELL_OK or another code of quell_status, for which quell_text gives a sentence; they
 * then leave their results untouched. Pointers must be null (refused, QUELL_NULL), or point to as many
 * objects as the function reads or writes; what is not aligned is refused (QUELL_ALIGNMENT). A filter may be
 * used by one thread at a time. Stack (measured on x86-64): a step 9 KiB while trains fade and 1 else,
 * install 30, design and convolve 42, init 50, retune 75 KiB. examples/shape.c is a whole program.
 */
#ifndef QUELL_SHAPERS_H
#define QUELL_SHAPERS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How a call ended. */
typedef int32_t quell_status;
enum {
    QUELL_OK = 0,
    QUELL_NULL = 1,             /* a pointer is null */
    QUELL_ALIGNMENT = 2,        /* a pointer is not aligned */
    QUELL_MEMORY = 3,           /* the memory is smaller than quell_filter_bytes says */
    QUELL_NOT_A_FILTER = 4,     /* the memory holds no filter: quell_filter_init comes first */
    QUELL_UNKNOWN_SHAPER = 5,   /* no shaper of that name */
    QUELL_MODE = 6,             /* frequency not finite and above 0, or damping ratio not in [0, 1) */
    QUELL_DAMPING = 7,          /* the shaper is not solved for so high a damping ratio */
    QUELL_SAMPLE_TIME = 8,      /* not finite and above 0, or not that of the filter */
    QUELL_TOO_FAST = 9,         /* half a damped period of the mode is below two ticks */
    QUELL_TOO_LONG = 10,        /* the train is longer than the filter's capacity */
    QUELL_TRAIN = 11,           /* too many taps, not in order, or amplitudes that do not add up to 1 */
    QUELL_RANGE = 12,           /* a number or a length is out of its range */
    QUELL_HISTORY = 13,         /* the start of the move is older than the filter remembers */
    QUELL_LIMITS = 14,          /* no correction that begins now keeps the limits */
    QUELL_BUSY = 15,            /* too many steps of earlier corrections are under way */
    QUELL_NOT_WORTH = 16        /* no correction leaves less vibration than the present command */
};

/* The code in a sentence; never null. */
const char *quell_text(quell_status status);

/* A vibratory mode: natural frequency omega_n > 0 (rad/s; 2 pi times Hz), damping ratio 0 <= xi < 1. */
typedef struct {
    double natural_frequency;
    double damping_ratio;
} quell_mode;

/* Position, velocity and acceleration of one axis at one tick. */
typedef struct {
    double position;
    double velocity;
    double acceleration;
} quell_setpoint;

/* Largest velocity, acceleration and jerk of the move, above 0; INFINITY for none. */
typedef struct {
    double velocity;
    double acceleration;
    double jerk;
} quell_limits;

/* A share of the command that is delayed by so many ticks. */
typedef struct {
    uint32_t delay;
    double amplitude;
} quell_tap;

#define QUELL_TAPS 256

/* A train on the controller's ticks: plain data, delays in ascending order, amplitudes with sum 1. */
typedef struct {
    double sample_time; /* length of a tick, s */
    uint32_t count;     /* taps in use, 1 to QUELL_TAPS */
    quell_tap taps[QUELL_TAPS];
} quell_train;

/* The train of a shaper ("zv", "mzv", "zvd", "ei", "zvdd", "ei2", "ei3", "umzv", "optimal") for a mode, its
 * taps on ticks of sample_time seconds, its zeros at the mode kept exact. Some 0.1 ms for "optimal", "ei" and
 * its kin: between two ticks. */
quell_status quell_design(const char *shaper, quell_mode mode, double sample_time, quell_train *train);

/* One train for `count` modes at once: that of the shaper for each of them, one after the other. Its length is the sum of theirs. With
 * no mode it changes nothing. QUELL_TRAIN where it has more than QUELL_TAPS taps. */
quell_status quell_design_modes(const char *shaper, const quell_mode *modes, size_t count, double sample_time,
                                quell_train *train);

/* The train that does what both do, for two modes at once. `both` may be one of the two. */
quell_status quell_convolve(const quell_train *first, const quell_train *second, quell_train *both);

/* The adaptive filter of one axis. */
typedef struct quell_filter quell_filter;

/* Bytes that a filter needs for trains of up to `capacity` ticks, and a memory and a look-ahead of
 * `horizon` ticks: at least the longest move with the longest train. 0 where no memory is large enough. */
size_t quell_filter_bytes(size_t capacity, size_t horizon);

/* Makes a filter at rest at position 0 that changes nothing. `memory` is aligned as for malloc (that of
 * max_align_t), stays where it is, and is only used through `*filter` until the last call on it. No call
 * ends its life: the memory may then be used for something else. */
quell_status quell_filter_init(void *memory, size_t bytes, double sample_time, size_t capacity,
                               size_t horizon, quell_filter **filter);

/* Puts the filter to rest at a position, not vibrating; a train that waits is in force then. */
quell_status quell_filter_reset(quell_filter *filter, double position);

/* Installs a train; in mid-move it waits for rest. */
quell_status quell_filter_install(quell_filter *filter, const quell_train *train);

/* One tick: takes the planned setpoint, gives the shaped one. Never allocates, blocks or fails; where
 * `filter` is null or holds no filter the setpoint comes back as it is. */
quell_setpoint quell_filter_step(quell_filter *filter, quell_setpoint planned);

/* Whether the output is constant: 1 or 0; 0 without a filter. */
int32_t quell_filter_is_settled(const quell_filter *filter);

/* What a retune did. Times in s from now. */
typedef struct {
    int32_t installed;   /* 1: nothing had moved, the train is in force or will be at rest; the rest is 0 */
    int32_t robust;      /* 1: the slope over frequency and damping is cancelled too */
    double cross_fade;   /* length of the cross-fade; 0 where the old train is kept to the end of the move */
    double duration;     /* of the correction */
    double until_rest;   /* to the end of the whole command */
    double peak;         /* largest of velocity, acceleration and jerk from now on over its limit, up to 1 */
} quell_correction;

/* Goes over to another train in motion, and takes away what the wrong one has left of the given modes (1 to 3, the
 * first sets the pace). Of all ways that begin now and keep the limits, the one of least vibration over the rest of
 * the move is taken; where none is better than the present command, nothing is changed (QUELL_NOT_WORTH). `spread` says
 * how well the modes are known, 0 or above: one standard deviation of the frequencies as a fraction, and of the
 * damping ratios. `planned` are the setpoints of the `remaining` ticks to come,
 * after which the plan stays where it is. Call it between two ticks, or while no step is taken. Where it is refused
 * nothing is changed: call it again a quarter period later. `correction` may be null. */
quell_status quell_filter_retune(quell_filter *filter, const quell_train *train, const quell_mode *modes,
                                 size_t count, double spread, quell_limits limits,
                                 const quell_setpoint *planned, size_t remaining,
                                 quell_correction *correction);

/* Vibration that the command leaves in a mode, in units of the position. */
typedef struct {
    double shaped;   /* left by what was sent */
    double unshaped; /* left by the planned input, had it been sent as it is */
} quell_residual;

/* The vibration of a mode now, due to everything sent since the last reset. Cost proportional to the
 * horizon. */
quell_status quell_filter_residual(const quell_filter *filter, quell_mode mode, quell_residual *residual);

#ifdef __cplusplus
}
#endif

#endif
