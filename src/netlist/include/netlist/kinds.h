/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of devices: what is measured of a thyristor, a varistor, a fuse, ..., and which limit of
 * its part's file each measure is held against. One table serves lists, summary and verdict,
 * `check` of parts, the test stand and `import`. The head of kinds.c says what a new kind touches.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The courses of a device over time: the flux linkage of its core (V.s), its voltage (V), its
 * current (A), voltage times current (W), current squared (A2), voltage squared (V2). From VS_OF_V
 * on they are integrated over time. */
enum { VS_OF_FLUX, VS_OF_V, VS_OF_I, VS_OF_POWER, VS_OF_I2, VS_OF_V2, VS_COURSES };

/* How a course becomes one number. Each row is an id and the name of its plug, which
 * measure/devices/reductions.h declares. Those from VS_R_RISE to VS_R_COMMUTATION_FAILURE are of a
 * device that conducts or blocks, VS_R_GATE_LEAST is of one with a gate.
 *   VS_R_PEAK         largest value, in the sense that the measure gives
 *   VS_R_MEAN         mean over the stretch that the scene's section measure says
 *   VS_R_RMS          root of the mean over that stretch
 *   VS_R_ALTERNATING  the same, of a voltage that is not direct or whose part states no v_dc
 *   VS_R_DIRECT       size of the mean of a direct voltage, over that stretch
 *   VS_R_CARRIED      the same as VS_R_RMS, of what a fuse carries
 *   VS_R_INTEGRAL     integral over the run
 *   VS_R_PULSE        largest integral over one conduction
 *   VS_R_HEAT         most that one pulse turned into heat: measure/devices/pulse.c
 *   VS_R_WITHIN       largest integral within 10 ms
 *   VS_R_LET_THROUGH  the same, of a fuse: 15 % from one to the next, once it has melted
 *   VS_R_MELTING      the same, of a fuse while it is whole
 *   VS_R_CLEARS       what a fuse lets through by its maker's i2t_clear, whatever the run
 *   VS_R_CURVE        rms current over the time that comes nearest to a fuse's time-current curve
 *   VS_R_OPEN         largest rms over half a mains cycle, of a fuse that has opened
 *   VS_R_ARC          largest magnitude, of a fuse from melting to clearing
 *   VS_R_SURGE        peak of the half sine of 10 ms that has this integral
 *   VS_R_STEEPEST     largest rate, in the sense that the measure gives, over any 0.1 us
 *   VS_R_JUNCTION     rise of the junction's temperature, by the part's lines zth
 *   VS_R_RISE         steepest mean rate of a rise of forward voltage over any stretch that rises
 *                     by the limit dv_dt_over
 *   VS_R_RISE_ERROR   what that may be wrong by for how the voltage runs between two knots
 *   VS_R_OFF_RATE     largest rising rate of blocked forward voltage, over any 0.1 us
 *   VS_R_ON_RATE      largest rate of current from firing to its first maximum, and for 1 us at
 *                     least, over any 0.1 us
 *   VS_R_OFFERED      shortest time between a conduction and forward voltage without a gate pulse
 *   VS_R_MISFIRE, VS_R_UNINTENDED, VS_R_COMMUTATION_FAILURE   how often: measure/switching.h
 *   VS_R_OPENS, VS_R_ARCS   how often a fuse melts, and arcs again behind that:
 *                     measure/devices/melting.h
 *   VS_R_GATE_LEAST   smallest of all gate pulses' peaks
 *   VS_R_CORE         rise of a capacitor's core, by the part's lines zth and its ESR
 *   VS_R_RETURN_RISE, VS_R_FALL   (dv/dt)c and (di/dt)c of a triac: measure/switching.h
 *   VS_R_CONDUCTION, VS_R_SWITCHING, VS_R_RECOVERY, VS_R_BLOCKING   the parts that the loss is
 *                     made of: measure/devices/losses.h
 *   VS_R_E_ON, VS_R_E_OFF, VS_R_E_RECOVERY   the largest of a single switching
 *   VS_R_TURNED_OFF   largest current that was turned off
 *   VS_R_AVALANCHE    largest energy of one stretch above the part's v_dss
 *   VS_R_DERATED      peak of the pulse that comes nearest to what the part's lines `pulse` allow
 *                     for its width and number
 *   VS_R_REPEATED     mean over the time from one pulse to the next, where events repeat the run
 *   VS_R_CASE, VS_R_HOTTEST   temperature of the case; the junction's largest
 *   VS_R_SURGES       peak of half sines in consecutive cycles, against the part's lines `surge`
 *   VS_R_SHORT        integral over one conduction below 10 ms, against the part's i2sqrt_t */
#define VS_REDUCTION_LIST(X)                                                                       \
  X(VS_R_PEAK, peak)                                                                               \
  X(VS_R_MEAN, mean)                                                                               \
  X(VS_R_RMS, rms)                                                                                 \
  X(VS_R_ALTERNATING, alternating)                                                                 \
  X(VS_R_DIRECT, direct)                                                                           \
  X(VS_R_CARRIED, carried)                                                                         \
  X(VS_R_INTEGRAL, integral)                                                                       \
  X(VS_R_PULSE, pulse)                                                                             \
  X(VS_R_HEAT, vs_pulse_heat)                                                                      \
  X(VS_R_WITHIN, vs_surge_within)                                                                  \
  X(VS_R_LET_THROUGH, vs_surge_let_through)                                                        \
  X(VS_R_MELTING, vs_surge_melting)                                                                \
  X(VS_R_CLEARS, vs_fuse_reduction_clears)                                                         \
  X(VS_R_CURVE, vs_fuse_reduction_curve)                                                           \
  X(VS_R_OPEN, vs_fuse_reduction_open)                                                             \
  X(VS_R_ARC, vs_fuse_reduction_arc)                                                               \
  X(VS_R_SURGE, vs_surge_peak)                                                                     \
  X(VS_R_STEEPEST, steepest)                                                                       \
  X(VS_R_JUNCTION, vs_junction_of_power)                                                           \
  X(VS_R_RISE, vs_switching_reductions_rise)                                                       \
  X(VS_R_RISE_ERROR, vs_switching_reductions_rise_error)                                           \
  X(VS_R_OFF_RATE, vs_switching_reductions_off_rate)                                               \
  X(VS_R_ON_RATE, vs_switching_reductions_on_rate)                                                 \
  X(VS_R_OFFERED, vs_switching_reductions_offered)                                                 \
  X(VS_R_MISFIRE, vs_switching_reductions_misfire)                                                 \
  X(VS_R_UNINTENDED, vs_switching_reductions_unintended)                                           \
  X(VS_R_COMMUTATION_FAILURE, vs_switching_reductions_commutation_failure)                         \
  X(VS_R_OPENS, vs_fuse_reduction_opens)                                                           \
  X(VS_R_ARCS, vs_fuse_reduction_arcs)                                                             \
  X(VS_R_GATE_LEAST, vs_switching_reductions_gate_least)                                           \
  X(VS_R_CORE, vs_junction_of_current)                                                             \
  X(VS_R_RETURN_RISE, vs_switching_reductions_return_rise)                                         \
  X(VS_R_FALL, vs_switching_reductions_fall)                                                       \
  X(VS_R_CONDUCTION, vs_switching_reductions_conduction)                                           \
  X(VS_R_SWITCHING, vs_switching_reductions_switching)                                             \
  X(VS_R_RECOVERY, vs_switching_reductions_recovery)                                               \
  X(VS_R_BLOCKING, vs_switching_reductions_blocking)                                               \
  X(VS_R_E_ON, vs_switching_reductions_e_on)                                                       \
  X(VS_R_E_OFF, vs_switching_reductions_e_off)                                                     \
  X(VS_R_E_RECOVERY, vs_switching_reductions_e_recovery)                                           \
  X(VS_R_TURNED_OFF, vs_switching_reductions_turned_off)                                           \
  X(VS_R_AVALANCHE, vs_switching_reductions_avalanche)                                             \
  X(VS_R_DERATED, vs_surge_pulses)                                                                 \
  X(VS_R_REPEATED, repeated)                                                                       \
  X(VS_R_CASE, vs_junction_case)                                                                   \
  X(VS_R_HOTTEST, vs_junction_hottest)                                                             \
  X(VS_R_SURGES, vs_surge_rows)                                                                    \
  X(VS_R_SHORT, vs_surge_short)

typedef enum vs_reduction {
#define VS_REDUCTION_ID(id, plug) id,
  VS_REDUCTION_LIST(VS_REDUCTION_ID)
#undef VS_REDUCTION_ID
      VS_REDUCTIONS
} vs_reduction;

/* How a measure is held to its limit: it may be at most the limit, or at least the limit; or it may
 * be at most the limit of the device that this one protects. VS_NEVER: the measure counts something
 * that must not happen at all, whatever the part, unless the scene's key `expect` names it. */
enum { VS_AT_MOST, VS_AT_LEAST, VS_WARD_AT_MOST, VS_NEVER };

/* One measure. A device's measure is called DEVICE.name. */
typedef struct vs_device_measure {
  const char *name, *unit, *text;
  vs_reduction how;
  int of;            /* the course it is made of: VS_OF_... */
  int sense;         /* of a peak or rate: +1 the largest, -1 the least with its sign turned, 0 the
                        largest magnitude */
  const char *limit; /* the limit of a part's file that it is held against; NULL: none */
  int held;          /* VS_AT_MOST, ... */
} vs_device_measure;

/* What a measure with VS_NEVER counts, as summary.json calls it ("fuse_opens"), and as people do,
 * behind the device's name ("opens"). The scene's key `expect` takes either. */
typedef struct vs_happening_words {
  const char *what, *verb;
} vs_happening_words;
const vs_happening_words *vs_kinds_happening(const vs_device_measure *measure);

/* Bytes that a kind's name may have, its end included. */
enum { VS_KIND_NAME = 64 };

/* What a limit is besides.
 *   VS_LIMIT_DECIDES  nothing can be said of the part's work without it: where a real part does not
 *                     state it, the verdict is undecided
 *   VS_LIMIT_TWIN     the model's parameter `param` has to have the same value
 *   VS_LIMIT_PARAM    it is no limit, but a parameter of the model alone */
enum { VS_LIMIT_DECIDES = 1, VS_LIMIT_TWIN = 2, VS_LIMIT_PARAM = 4 };

/* A limit that a part's file may state; also a figure of a data sheet that no measure is held to.
 */
typedef struct vs_kind_limit {
  const char *name, *unit; /* the unit that it is usually given in */
  double least, most;      /* what devices have, in that unit; both 0: anything. The ends are wide
                              and assumed: they find a wrong unit or a slip of the pen, no poor
                              device */
  const char *param; /* the parameter by which a model is made that has the figure; NULL: none */
  int is;            /* VS_LIMIT_... */
  const char *hang;  /* the measures, each between blanks, that hang on this figure by the model:
                        were it another in the model, so would they, or whether the device obeys */
} vs_kind_limit;

/* Two limits of one part: `more` is `least` to `most` times `less`, or it is implausible; both 0:
 * anything. refused: a file in which `more` is below `less` contradicts itself. */
typedef struct vs_kind_ratio {
  const char *more, *less;
  double least, most;
  bool refused;
} vs_kind_ratio;

/* A pin of a part. The current that counts flows into the first and out of the second. */
enum { VS_PIN_FROM, VS_PIN_TO, VS_PIN_GATE, VS_PINS };
typedef struct vs_kind_pin {
  int role;          /* VS_PIN_... */
  const char *node;  /* its name in the part's subcircuit; NULL: no further pin */
  const char *text;  /* NULL: the two pins are alike */
  const char *words; /* what netlists call it, each between blanks; NULL: its name tells nothing */
  const char *also;  /* beginnings of what vendors call it besides, which alone tell nothing */
} vs_kind_pin;

enum { VS_KIND_RATIOS = 4 };
typedef struct vs_kind {
  const char *name;   /* as in `*$ part KIND` and `*$ device NAME KIND` */
  const char *called; /* words, each between blanks, that say in the name or the comment of a
                         subcircuit what it is; NULL: there are none */
  char letter;        /* of an element of this kind that ngspice knows, whose nodes are `pins`; 0 */
  bool switches;      /* it conducts or blocks, and which of the two its current tells, as that of a
                         thyristor does */
  bool both_ways;     /* it conducts either way, as a triac does */
  bool rectifies;     /* it conducts one way, by its voltage, as a diode does */
  bool gated;         /* it goes by the deck's gate pulses */
  bool driven;        /* a port turns it on and off, as a mosfet; nobody judges whether it obeys */
  bool stores;    /* it may give energy for a time, as a capacitor does, and lie at any voltage */
  bool melts;     /* it is a fuse, of which events.csv tells when it melts and has cleared */
  bool clamps;    /* it limits the voltage of what it stands across, as a varistor does */
  bool of_series; /* an element with a value, whose limits are those of a series of parts */
  vs_kind_pin pins[VS_PINS]; /* in the order of the part's subcircuit */
  const char *letters;       /* the pins for `import --pins`, a letter each; NULL: they are alike */
  vs_kind_ratio ratios[VS_KIND_RATIOS];
  struct {
    const char *current; /* the limit that it is rated for; NULL: it has no junction */
    double mean, rms;    /* mean size and rms over that: half sines have an rms of 1.57 times their
                            mean, and a triac's sines a mean size of 0.9 times their rms */
  } heat;
  const vs_device_measure *measures;
  size_t n_measures;
  const vs_kind_limit *limits;
  size_t n_limits;
} vs_kind;

/* All kinds; the last row has no name. */
extern const vs_kind vs_kinds_all[];

/* Limits in V that are held against the mains, whatever the part: the mains' peak or rms value,
 * which is `factor` times the rms. The last row has no name. */
typedef struct vs_mains_limit {
  const char *name, *what;
  double factor;
} vs_mains_limit;
extern const vs_mains_limit vs_kinds_mains[];

/* The kind of that name; NULL: there is none. */
const vs_kind *vs_kinds_find(const char *name);
/* True for a kind that a gate pulse fires and that then conducts until its current ends. */
bool vs_kinds_latches(const char *name);

/* The number of its pins, 0 of no kind; the index of the one with that role, -1: it has none. */
int vs_kinds_count_pins(const vs_kind *kind);
int vs_kinds_pin(const vs_kind *kind, int role);

/* The unit a limit of that name is usually given in; NULL: no measure is held against such a limit,
 * and no maker's figure of that name is known either. */
const char *vs_kinds_limit_unit(const char *limit);

/* True where a limit of that name means something for a part of that kind: a measure of the kind is
 * held against it, the mains are, or it is a maker's figure that readers look for. Otherwise
 * *nearest is the name that may be meant; NULL: none is near. */
bool vs_kinds_knows_limit(const char *kind, const char *limit, const char **nearest);

/* True where a limit of that name is held by nothing that the program measures of such a part, and
 * is no figure that merely describes the part, as a holding current does. */
bool vs_kinds_leaves_limit(const char *kind, const char *limit);

/* The n-th figure that a measure of the kind hangs on by the model, from 0, as the limit of that
 * name; NULL: there are no more. */
const char *vs_kinds_hanging(const vs_kind *kind, const char *measure, size_t n);

/* True where measures hang on a figure of that name of a part of that kind. Otherwise *names are
 * all those there are, with commas, to be freed. names may be NULL. */
bool vs_kinds_is_hung_on(const char *kind, const char *figure, char **names);

/* True for a limit with VS_LIMIT_DECIDES. */
bool vs_kinds_decides(const char *kind, const char *limit);

/* The limit of a single half sine of 10 ms, which the limit i2t has to fit; NULL: it has none. */
const char *vs_kinds_surge_limit(const char *kind);
