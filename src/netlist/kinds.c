/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/kinds.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* Each row: name, unit, text, how, of, sense, limit, held. */
/* How a mean or rms value is judged: measure/devices/means.c. */
#define MEAN_IS_JUDGED "judged where that lasts 1 s or longer and more than one shot falls into it"

/* The texts of what several kinds have alike: measure/devices/reductions.c. */
#define CASE_TEXT                                                                                  \
  "temperature of its case: ambient, and mean power over its heat sink or over r_th_ja; where no " \
  "mean is judged it stays at the ambient"
#define HOTTEST_TEXT "largest temperature of its junction, t_j_rise above t_case"
#define SURGES_TEXT                                                                                \
  "peak of half sines of 10 ms, one a cycle, that heat as much as some consecutive conductions: "  \
  "of those that come nearest to the part's lines surge"
#define SHORT_TEXT                                                                                 \
  "int i^2 dt of the conduction below 10 ms that comes nearest to i2sqrt_t sqrt(t), with t the "   \
  "length of the half sine of its peak and its int i^2 dt"
#define TEMPERATURES                                                                               \
  {"t_case", "degC", CASE_TEXT, VS_R_CASE, VS_OF_POWER, 1, NULL, VS_AT_MOST}, {                    \
    "t_j", "degC", HOTTEST_TEXT, VS_R_HOTTEST, VS_OF_POWER, 1, "t_j_max", VS_AT_MOST               \
  }
#define SURGES                                                                                     \
  {"i_surge_n", "A", SURGES_TEXT, VS_R_SURGES, VS_OF_I2, 1, NULL, VS_AT_MOST}, {                   \
    "i2t_short", "A2.s", SHORT_TEXT, VS_R_SHORT, VS_OF_I2, 1, NULL, VS_AT_MOST                     \
  }

#define RISE_ERROR                                                                                 \
  {                                                                                                \
    "dv_dt_error", "V/us",                                                                         \
        "error of dv_dt from how the voltage is taken to run between the solver's instants, on a " \
        "cubic or straight; it comes on top of run.tolerance",                                     \
        VS_R_RISE_ERROR, VS_OF_V, 1, NULL, VS_AT_MOST                                              \
  }

static const vs_device_measure THYRISTOR[] = {
    {"v_forward", "V", "peak forward voltage", VS_R_PEAK, VS_OF_V, 1, "v_drm", VS_AT_MOST},
    {"v_reverse", "V", "peak reverse voltage", VS_R_PEAK, VS_OF_V, -1, "v_rrm", VS_AT_MOST},
    {"dv_dt", "V/us",
     "steepest rise of forward off-state voltage, mean rate over any stretch that rises by "
     "dv_dt_over of its part (a tenth of v_drm); a rise under a gate pulse that ends as the device "
     "fires does not count",
     VS_R_RISE, VS_OF_V, 1, "dv_dt", VS_AT_MOST},
    RISE_ERROR,
    {"dv_dt_max", "V/us", "largest rate of forward off-state voltage, over any 0.1 us",
     VS_R_OFF_RATE, VS_OF_V, 1, NULL, VS_AT_MOST},
    {"di_dt", "A/us",
     "largest rate of current from firing to its first maximum, and for 1 us at least, over any "
     "turn_on_time of its part (0.1 us)",
     VS_R_ON_RATE, VS_OF_I, 1, "di_dt", VS_AT_MOST},
    {"i_peak", "A", "peak current", VS_R_PEAK, VS_OF_I, 1, NULL, VS_AT_MOST},
    {"i_surge", "A",
     "peak of the half sine of 10 ms with the largest int i^2 dt within 10 ms: a shorter pulse "
     "heats as much by the same int i^2 dt",
     VS_R_SURGE, VS_OF_I2, 1, "i_tsm", VS_AT_MOST},
    {"i_mean", "A", "mean current, over the time that measure says", VS_R_MEAN, VS_OF_I, 1, NULL,
     VS_AT_MOST},
    {"i_rms", "A",
     "rms current, over the time that measure says; judged where that lasts 1 s or longer and "
     "more than one shot falls into it, as i_surge and i2t are for what is short",
     VS_R_RMS, VS_OF_I2, 1, "i_t_rms", VS_AT_MOST},
    {"i2t", "A2.s", "largest int i^2 dt of one conduction", VS_R_PULSE, VS_OF_I2, 1, "i2t",
     VS_AT_MOST},
    SURGES,
    {"loss", "J", "int v i dt over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"t_j_rise", "K", "largest rise of the junction's temperature, by the part's zth",
     VS_R_JUNCTION, VS_OF_POWER, 1, "t_j_rise", VS_AT_MOST},
    TEMPERATURES,
    {"t_off", "s",
     "shortest time from the current's zero to the return of forward voltage while its gate "
     "is off",
     VS_R_OFFERED, VS_OF_V, 1, "t_q", VS_AT_LEAST},
    {"misfires", "", "gate pulses that it did not follow", VS_R_MISFIRE, VS_OF_I, 1, NULL,
     VS_NEVER},
    {"unintended_firings", "", "firings without a gate pulse", VS_R_UNINTENDED, VS_OF_I, 1, NULL,
     VS_NEVER},
    {"commutation_failures", "",
     "of these, on the first forward voltage after a conduction and before t_q",
     VS_R_COMMUTATION_FAILURE, VS_OF_I, 1, NULL, VS_NEVER}};
static const vs_device_measure TRIAC[] = {
    {"v_forward", "V", "peak voltage, second main terminal positive", VS_R_PEAK, VS_OF_V, 1,
     "v_drm", VS_AT_MOST},
    {"v_reverse", "V", "peak voltage, second main terminal negative", VS_R_PEAK, VS_OF_V, -1,
     "v_drm", VS_AT_MOST},
    {"dv_dt", "V/us",
     "steepest rise of off-state voltage, either way, mean rate over any stretch that rises by "
     "dv_dt_over of its part (a tenth of v_drm); a rise under a gate pulse that ends as the device "
     "fires does not count",
     VS_R_RISE, VS_OF_V, 1, "dv_dt", VS_AT_MOST},
    RISE_ERROR,
    {"dv_dt_max", "V/us", "largest rate of off-state voltage, either way, over any 0.1 us",
     VS_R_OFF_RATE, VS_OF_V, 1, NULL, VS_AT_MOST},
    {"di_dt", "A/us",
     "largest rate of current from firing to its first extreme, and for 1 us at least, either way, "
     "over any turn_on_time of its part (0.1 us)",
     VS_R_ON_RATE, VS_OF_I, 1, "di_dt", VS_AT_MOST},
    {"dv_dt_c", "V/us",
     "steepest first rise of off-state voltage behind a conduction, (dv/dt)c: mean rate over a "
     "stretch that rises by dv_dt_over, or by four fifths of that rise where this is less; "
     "compared, "
     "as the model of a triac fires by dv/dt",
     VS_R_RETURN_RISE, VS_OF_V, 1, "dv_dt_c", VS_AT_MOST},
    {"di_dt_c", "A/ms",
     "steepest fall of a current to its zero, mean rate from a tenth of its peak: (di/dt)c",
     VS_R_FALL, VS_OF_I, 1, "di_dt_c", VS_AT_MOST},
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, "i_trm", VS_AT_MOST},
    {"i_surge", "A",
     "peak of the half sine of 10 ms with the largest int i^2 dt within 10 ms: a shorter pulse "
     "heats as much by the same int i^2 dt",
     VS_R_SURGE, VS_OF_I2, 1, "i_tsm", VS_AT_MOST},
    {"i_mean", "A", "mean current, a direct part of the load's, over the time that measure says",
     VS_R_MEAN, VS_OF_I, 1, NULL, VS_AT_MOST},
    {"i_rms", "A",
     "rms current, over the time that measure says; judged where that lasts 1 s or longer and "
     "more than one shot falls into it, as i_surge and i2t are for what is short",
     VS_R_RMS, VS_OF_I2, 1, "i_t_rms", VS_AT_MOST},
    {"i2t", "A2.s", "largest int i^2 dt of one half cycle's conduction", VS_R_PULSE, VS_OF_I2, 1,
     "i2t", VS_AT_MOST},
    SURGES,
    {"loss", "J", "int v i dt over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"loss_conduction", "J", "of this, while it conducts", VS_R_CONDUCTION, VS_OF_POWER, 1, NULL,
     VS_AT_MOST},
    {"loss_switching", "J", "of this, while it turns on and off", VS_R_SWITCHING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"loss_blocking", "J", "of this, while it blocks: the rest", VS_R_BLOCKING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"t_j_rise", "K", "largest rise of the junction's temperature, by the part's zth",
     VS_R_JUNCTION, VS_OF_POWER, 1, "t_j_rise", VS_AT_MOST},
    TEMPERATURES,
    {"misfires", "", "gate pulses that it did not follow, of both half cycles", VS_R_MISFIRE,
     VS_OF_I, 1, NULL, VS_NEVER},
    {"unintended_firings", "", "firings without a gate pulse", VS_R_UNINTENDED, VS_OF_I, 1, NULL,
     VS_NEVER},
    {"commutation_failures", "",
     "of these, in the half cycle that begins with the zero of a current", VS_R_COMMUTATION_FAILURE,
     VS_OF_I, 1, NULL, VS_NEVER}};
static const vs_device_measure DIODE[] = {
    {"v_reverse", "V", "peak reverse voltage", VS_R_PEAK, VS_OF_V, -1, "v_rrm", VS_AT_MOST},
    {"i_peak", "A", "peak forward current", VS_R_PEAK, VS_OF_I, 1, "i_frm", VS_AT_MOST},
    {"i_reverse", "A", "peak reverse current, of its recovery", VS_R_PEAK, VS_OF_I, -1, NULL,
     VS_AT_MOST},
    {"i_surge", "A",
     "peak of the half sine of 10 ms with the largest int i^2 dt within 10 ms: a shorter pulse "
     "heats as much by the same int i^2 dt",
     VS_R_SURGE, VS_OF_I2, 1, "i_fsm", VS_AT_MOST},
    {"i_mean", "A", "mean current, over the time that measure says; judged as i_rms is", VS_R_MEAN,
     VS_OF_I, 1, "i_f_av", VS_AT_MOST},
    {"i_rms", "A",
     "rms current, over the time that measure says; judged where that lasts 1 s or longer and "
     "more than one shot falls into it",
     VS_R_RMS, VS_OF_I2, 1, "i_f_rms", VS_AT_MOST},
    {"i2t", "A2.s", "largest int i^2 dt of one conduction", VS_R_PULSE, VS_OF_I2, 1, "i2t",
     VS_AT_MOST},
    SURGES,
    {"loss", "J", "int v i dt over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"loss_conduction", "J", "of this, while it conducts", VS_R_CONDUCTION, VS_OF_POWER, 1, NULL,
     VS_AT_MOST},
    {"loss_recovery", "J", "of this, from the zero of its current to the end of its recovery",
     VS_R_RECOVERY, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"loss_blocking", "J", "of this, while it blocks: the rest", VS_R_BLOCKING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"e_rec", "J", "largest energy of one recovery", VS_R_E_RECOVERY, VS_OF_POWER, 1, NULL,
     VS_AT_MOST},
    {"t_j_rise", "K", "largest rise of the junction's temperature, by the part's zth",
     VS_R_JUNCTION, VS_OF_POWER, 1, "t_j_rise", VS_AT_MOST},
    TEMPERATURES};
static const vs_device_measure MOSFET[] = {
    {"v_peak", "V", "peak voltage, drain positive", VS_R_PEAK, VS_OF_V, 1, "v_dss", VS_AT_MOST},
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, "i_dm", VS_AT_MOST},
    {"i_mean", "A", "mean current, over the time that measure says", VS_R_MEAN, VS_OF_I, 1, NULL,
     VS_AT_MOST},
    {"i_rms", "A",
     "rms current, over the time that measure says; judged where that lasts 1 s or longer and "
     "more than one shot falls into it",
     VS_R_RMS, VS_OF_I2, 1, "i_d", VS_AT_MOST},
    {"dv_dt", "V/us", "largest rate of voltage, either way, over any 0.1 us", VS_R_STEEPEST,
     VS_OF_V, 0, "dv_dt", VS_AT_MOST},
    {"loss", "J", "int v i dt over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"loss_conduction", "J", "of this, while it conducts", VS_R_CONDUCTION, VS_OF_POWER, 1, NULL,
     VS_AT_MOST},
    {"loss_switching", "J", "of this, while it turns on and off", VS_R_SWITCHING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"loss_blocking", "J", "of this, while it blocks: the rest", VS_R_BLOCKING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"e_on", "J", "largest energy of one turn-on", VS_R_E_ON, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"e_off", "J", "largest energy of one turn-off", VS_R_E_OFF, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"i_off", "A", "largest current that it turned off", VS_R_TURNED_OFF, VS_OF_I, 1, NULL,
     VS_AT_MOST},
    {"t_j_rise", "K", "largest rise of the junction's temperature, by the part's zth",
     VS_R_JUNCTION, VS_OF_POWER, 1, "t_j_rise", VS_AT_MOST},
    TEMPERATURES};
static const vs_device_measure IGBT[] = {
    {"v_peak", "V", "peak voltage, collector positive", VS_R_PEAK, VS_OF_V, 1, "v_ces", VS_AT_MOST},
    {"v_reverse", "V", "peak voltage, emitter positive", VS_R_PEAK, VS_OF_V, -1, "v_ecs",
     VS_AT_MOST},
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, "i_cm", VS_AT_MOST},
    {"i_mean", "A", "mean current, over the time that measure says", VS_R_MEAN, VS_OF_I, 1, NULL,
     VS_AT_MOST},
    {"i_rms", "A",
     "rms current, over the time that measure says; judged where that lasts 1 s or longer and "
     "more than one shot falls into it",
     VS_R_RMS, VS_OF_I2, 1, "i_c", VS_AT_MOST},
    {"dv_dt", "V/us", "largest rate of voltage, either way, over any 0.1 us", VS_R_STEEPEST,
     VS_OF_V, 0, "dv_dt", VS_AT_MOST},
    {"loss", "J", "int v i dt over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"loss_conduction", "J", "of this, while it conducts", VS_R_CONDUCTION, VS_OF_POWER, 1, NULL,
     VS_AT_MOST},
    {"loss_switching", "J", "of this, while it turns on and off", VS_R_SWITCHING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"loss_blocking", "J", "of this, while it blocks: the rest", VS_R_BLOCKING, VS_OF_POWER, 1,
     NULL, VS_AT_MOST},
    {"e_on", "J", "largest energy of one turn-on", VS_R_E_ON, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"e_off", "J", "largest energy of one turn-off", VS_R_E_OFF, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"i_off", "A", "largest current that it turned off", VS_R_TURNED_OFF, VS_OF_I, 1, "i_rbsoa",
     VS_AT_MOST},
    {"t_j_rise", "K", "largest rise of the junction's temperature, by the part's zth",
     VS_R_JUNCTION, VS_OF_POWER, 1, "t_j_rise", VS_AT_MOST},
    TEMPERATURES};
static const vs_device_measure ELECTROLYTIC[] = {
    {"v_peak", "V", "peak voltage", VS_R_PEAK, VS_OF_V, 1, "v_rated", VS_AT_MOST},
    {"v_reverse", "V", "peak voltage the wrong way round", VS_R_PEAK, VS_OF_V, -1, "v_reverse",
     VS_AT_MOST},
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, "i_surge", VS_AT_MOST},
    {"i_rms", "A",
     "rms current, over the time that measure says; judged where that lasts 1 s or longer and "
     "more than one shot falls into it",
     VS_R_RMS, VS_OF_I2, 1, "i_ripple", VS_AT_MOST},
    {"power", "W",
     "mean of v i over the time that measure says: its loss, where it stores as much at the end "
     "as at the beginning",
     VS_R_MEAN, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"t_core_rise", "K",
     "largest rise of its core's temperature under ESR i^2, by the part's limit esr and its zth",
     VS_R_CORE, VS_OF_I2, 1, "t_core_rise", VS_AT_MOST}};
/* A voltage for ever. A direct one is told by its mean, any other by its rms value. */
#define ALTERNATING(limit)                                                                         \
  {                                                                                                \
    "v_rms", "V",                                                                                  \
        "rms voltage, over the time that measure says; " MEAN_IS_JUDGED                            \
        "; not of a direct voltage (one whose mean is more than the rms of the rest) where the "   \
        "part "                                                                                    \
        "states v_dc",                                                                             \
        VS_R_ALTERNATING, VS_OF_V2, 1, limit, VS_AT_MOST                                           \
  }
#define DIRECT(limit)                                                                              \
  {                                                                                                \
    "v_dc", "V",                                                                                   \
        "mean of a direct voltage, either way, over the time that measure says; " MEAN_IS_JUDGED,  \
        VS_R_DIRECT, VS_OF_V, 0, limit, VS_AT_MOST                                                 \
  }
static const vs_device_measure VARISTOR[] = {
    {"v_clamp", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, NULL, VS_AT_MOST},
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, "i_surge", VS_AT_MOST},
    {"energy", "J",
     "largest heat of one pulse, without what a capacitance stores; it ends when |i| has "
     "stayed below 1 mA for a quarter of a mains cycle",
     VS_R_HEAT, VS_OF_POWER, 1, "energy", VS_AT_MOST},
    {"energy_total", "J", "energy over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"power", "W", "mean power, over the time that measure says; " MEAN_IS_JUDGED, VS_R_MEAN,
     VS_OF_POWER, 1, "p_max", VS_AT_MOST},
    ALTERNATING("v_rms"),
    DIRECT("v_dc"),
    {"i_pulse", "A",
     "peak current of the pulse that comes nearest to the part's table over width and number (its "
     "lines pulse); the number is how many pulses of the run are as large, times the event's key "
     "times",
     VS_R_DERATED, VS_OF_I, 0, NULL, VS_AT_MOST},
    {"power_repeated", "W",
     "mean power where a pulse comes again: energy_total over the event's key every", VS_R_REPEATED,
     VS_OF_POWER, 1, "p_max", VS_AT_MOST}};
static const vs_device_measure RESISTOR[] = {
    {"power", "W", "mean power, over the time that measure says; " MEAN_IS_JUDGED, VS_R_MEAN,
     VS_OF_POWER, 1, "p_rated", VS_AT_MOST},
    {"e_pulse", "J", "largest energy within 10 ms", VS_R_WITHIN, VS_OF_POWER, 1, "e_pulse",
     VS_AT_MOST},
    {"v_peak", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, "v_class", VS_AT_MOST},
    {"power_peak", "W", "peak power", VS_R_PEAK, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"energy", "J", "energy over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST}};
static const vs_device_measure CAPACITOR[] = {
    {"v_peak", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, "v_class", VS_AT_MOST},
    ALTERNATING("v_rms"),
    DIRECT("v_dc"),
    {"i_rms", "A", "rms current, over the time that measure says; " MEAN_IS_JUDGED, VS_R_RMS,
     VS_OF_I2, 1, "i_rms_max", VS_AT_MOST},
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, NULL, VS_AT_MOST},
    {"dv_dt_max", "V/us", "largest rate of voltage, either way, over any 0.1 us", VS_R_STEEPEST,
     VS_OF_V, 0, "dv_dt_max", VS_AT_MOST}};
static const vs_device_measure FUSE[] = {
    {"i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, NULL, VS_AT_MOST},
    {"i_rms", "A", "rms current, over the time that measure says; " MEAN_IS_JUDGED, VS_R_CARRIED,
     VS_OF_I2, 1, "i_rated", VS_AT_MOST},
    {"i_overload", "A",
     "rms current over the time that comes nearest to the part's time-current curve (its lines "
     "time_current)",
     VS_R_CURVE, VS_OF_I2, 1, NULL, VS_AT_MOST},
    {"i2t_surge", "A2.s",
     "largest int i^2 dt within 10 ms while it is whole; i2t_melt is 15 % more or less from one "
     "to the next",
     VS_R_MELTING, VS_OF_I2, 1, "i2t_melt", VS_AT_MOST},
    {"i2t", "A2.s", "int i^2 dt over the run", VS_R_INTEGRAL, VS_OF_I2, 1, NULL, VS_AT_MOST},
    {"let_through", "A2.s",
     "largest int i^2 dt within 10 ms; 15 % more or less from one to the next, where it opens",
     VS_R_LET_THROUGH, VS_OF_I2, 1, "i2t", VS_WARD_AT_MOST},
    {"i2t_clear", "A2.s",
     "int i^2 dt that it lets through at its rated voltage, by the part's limit i2t_clear",
     VS_R_CLEARS, VS_OF_I2, 1, "i2t", VS_WARD_AT_MOST},
    {"v_peak", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, NULL, VS_AT_MOST},
    {"v_open", "V",
     "largest rms voltage over half a mains cycle, once it has opened, or that of the sine with "
     "its crest, and no less than the mains that drive it: what it has to clear",
     VS_R_OPEN, VS_OF_V2, 1, "v_rated", VS_AT_MOST},
    {"v_arc", "V", "peak voltage of its arc, from melting to clearing", VS_R_ARC, VS_OF_V, 0,
     "v_rrm", VS_WARD_AT_MOST},
    {"opens", "", "how often its element melts", VS_R_OPENS, VS_OF_I, 1, NULL, VS_NEVER},
    {"arcs_again", "", "how often a current flows again once it has cleared", VS_R_ARCS, VS_OF_I, 1,
     NULL, VS_NEVER}};
static const vs_device_measure GATE_DRIVE[] = {
    {"i_peak", "A", "largest gate current", VS_R_PEAK, VS_OF_I, 1, NULL, VS_AT_MOST},
    {"i_min", "A", "gate current at its worst: the least of all gate pulses' peaks",
     VS_R_GATE_LEAST, VS_OF_I, 1, NULL, VS_AT_MOST},
    {"volt_seconds", "V.s", "largest flux linkage of its core, either way", VS_R_PEAK, VS_OF_FLUX,
     0, "volt_seconds", VS_AT_MOST}};

#define MEASURED(rows) .measures = rows, .n_measures = sizeof rows / sizeof *rows
/* To add a kind of device: a table of its measures, and a row here that says whether it conducts
 * or blocks, both ways, by gate pulses, or as a diode. Makers' figures that no measure is held
 * against stand in FIGURES. test_kinds wants each measure and limit in docs/devices.md. */
const vs_kind vs_kinds_all[] = {
    {.name = "thyristor", .switches = true, .gated = true, MEASURED(THYRISTOR)},
    {.name = "triac", .switches = true, .both_ways = true, .gated = true, MEASURED(TRIAC)},
    {.name = "diode", .switches = true, .rectifies = true, MEASURED(DIODE)},
    {.name = "mosfet", .driven = true, MEASURED(MOSFET)},
    {.name = "igbt", .driven = true, MEASURED(IGBT)},
    {.name = "varistor", MEASURED(VARISTOR)},
    {.name = "resistor", MEASURED(RESISTOR)},
    {.name = "capacitor", .stores = true, MEASURED(CAPACITOR)},
    {.name = "electrolytic", .stores = true, MEASURED(ELECTROLYTIC)},
    {.name = "fuse", .melts = true, MEASURED(FUSE)},
    {.name = "gate_drive", .stores = true, .gated = true, MEASURED(GATE_DRIVE)},
    {.name = NULL}};

const vs_kind *vs_kinds_find(const char *name) {
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++)
    if (!strcmp(kind->name, name)) return kind;
  return NULL;
}

/* ---- what must not happen ---- */

const vs_happening_words *vs_kinds_happening(const vs_device_measure *m) {
  static const vs_happening_words WORDS[VS_REDUCTIONS] = {
      [VS_R_MISFIRE] = {"misfire", "misfires"},
      [VS_R_UNINTENDED] = {"unintended_firing", "fires without a gate pulse"},
      [VS_R_COMMUTATION_FAILURE] = {"commutation_failure", "fails to turn off"},
      [VS_R_OPENS] = {"fuse_opens", "opens"},
      [VS_R_ARCS] = {"fuse_arcs_again", "arcs again"}};
  assert(m->held == VS_NEVER && WORDS[m->how].what);
  return &WORDS[m->how];
}

/* ---- limits ---- */

/* Limits that no measure above is held against in its own unit, with the kinds of part they are of,
 * each between blanks ("": of any). v_drm, v_rrm and v_rms are held against the mains, whatever the
 * part; over dv_dt_over dv_dt is told, over turn_on_time di_dt; t_q, which makers give in us, is
 * held against t_off; by the r_th a junction's temperature is told, by i2sqrt_t what i2t_short may
 * be; i2t_clear is held against what the
 * fuse protects; the others are for the reader, and for `check` of the part, which tries whether
 * its model keeps them (bench/acceptance.c). */
static const struct figure {
  const char *name, *unit, *kinds;
} FIGURES[] = {{"v_drm", "V", ""},
               {"v_rrm", "V", ""},
               {"v_rms", "V", ""},
               {"dv_dt_over", "V", " thyristor triac "},
               {"t_q", "us", " thyristor "},
               {"r_th_jc", "K/W", " thyristor triac diode mosfet igbt "},
               {"r_th_cs", "K/W", " thyristor triac diode mosfet igbt "},
               {"r_th_ja", "K/W", " thyristor triac diode mosfet igbt "},
               {"turn_on_time", "us", " thyristor triac "},
               {"i2sqrt_t", "A2.sqrt_s", " thyristor triac diode "},
               {"i_gt", "mA", " thyristor triac "},
               {"i_gt_4", "mA", " triac "},
               {"v_gt", "V", " thyristor triac "},
               {"i_l", "mA", " thyristor triac "},
               {"i_h", "mA", " thyristor triac "},
               {"v_t", "V", " thyristor triac "},
               {"i_tm", "A", " thyristor triac "},
               {"q_rr", "A*us", " thyristor diode mosfet igbt "},
               {"t_rr", "ns", " diode mosfet igbt "},
               {"i_rm", "A", " diode mosfet igbt "},
               {"v_f", "V", " diode mosfet igbt "},
               {"i_test", "A", " thyristor triac diode mosfet igbt "},
               {"di_test", "A/us", " thyristor triac diode mosfet igbt "},
               {"v_test", "V", " diode mosfet igbt "},
               {"r_ds_on", "ohm", " mosfet "},
               {"v_gs_th", "V", " mosfet "},
               {"v_ge_th", "V", " igbt "},
               {"v_ce_sat", "V", " igbt "},
               {"e_on", "mJ", " mosfet igbt "},
               {"e_off", "mJ", " mosfet igbt "},
               {"r_least", "ohm", " resistor "},
               {"r_most", "ohm", " resistor "},
               {"c_rated", "uF", " capacitor electrolytic "},
               {"esr", "ohm", " capacitor electrolytic "},
               {"i_leakage", "mA", " electrolytic "},
               {"i_clamp", "A", " varistor "},
               {"v_clamp", "V", " varistor "},
               {"v_varistor", "V", " varistor "},
               {"tolerance", "%", " varistor resistor capacitor electrolytic "},
               {"ageing", "%", " varistor resistor capacitor electrolytic "},
               {"i_fusing", "A", " fuse "},
               {"i2t_clear", "A2.s", " fuse "},
               {"v_arc", "V", " fuse "}};
enum { N_FIGURES = sizeof FIGURES / sizeof *FIGURES };

/* The limit of its own part's file that a measure is held against; NULL: none. */
static const char *own_limit(const vs_device_measure *measure) {
  return measure->held == VS_WARD_AT_MOST ? NULL : measure->limit;
}

const char *vs_kinds_limit_unit(const char *limit) {
  for (size_t k = 0; k < N_FIGURES; k++)
    if (!strcmp(limit, FIGURES[k].name)) return FIGURES[k].unit;
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++)
    for (size_t k = 0; k < kind->n_measures; k++) {
      const char *own = own_limit(&kind->measures[k]);
      if (own && !strcmp(limit, own)) return kind->measures[k].unit;
    }
  return NULL;
}

bool vs_kinds_knows_limit(const char *kind_name, const char *limit, const char **nearest) {
  const vs_kind *kind = vs_kinds_find(kind_name);
  size_t n_measures = kind ? kind->n_measures : 0, count = 0;
  char spaced[VS_KIND_NAME + 2];
  snprintf(spaced, sizeof spaced, " %.*s ", VS_KIND_NAME - 1, kind_name);
  const char **names = vs_alloc(N_FIGURES + n_measures, sizeof *names);
  for (size_t k = 0; k < N_FIGURES; k++)
    if (!*FIGURES[k].kinds || strstr(FIGURES[k].kinds, spaced)) names[count++] = FIGURES[k].name;
  for (size_t k = 0; k < n_measures; k++) {
    const char *own = own_limit(&kind->measures[k]);
    if (own) names[count++] = own;
  }
  bool known = false;
  for (size_t k = 0; k < count && !known; k++) known = !strcmp(limit, names[k]);
  *nearest = known ? limit : vs_text_nearest(limit, names, count);
  free(names);
  return known;
}

bool vs_kinds_leaves_limit(const char *kind_name, const char *limit) {
  /* those of FIGURES that say what the part bears */
  static const char *const BEARS[] = {"v_drm", "v_rrm", "v_rms"};
  const vs_kind *kind = vs_kinds_find(kind_name);
  const char *nearest;
  for (size_t k = 0; kind && k < kind->n_measures; k++) {
    const char *own = own_limit(&kind->measures[k]);
    if (own && !strcmp(limit, own)) return false;
  }
  for (size_t k = 0; k < sizeof BEARS / sizeof *BEARS; k++)
    if (!strcmp(limit, BEARS[k])) return true;
  return !vs_kinds_knows_limit(kind_name, limit, &nearest);
}

/* Kinds that protect or switch, with the limits without which nothing can be said of their work.
 * What a data sheet often leaves out is not among them: the junction's temperature, a triac's
 * (di/dt)c, int i^2 dt of a diode, which follows from i_fsm. */
bool vs_kinds_decides(const char *kind, const char *limit) {
  static const struct {
    const char *kind, *limits;
  } DECISIVE[] = {{"thyristor", " v_drm v_rrm i_t_rms i_tsm i2t di_dt dv_dt t_q "},
                  {"triac", " v_drm i_t_rms i_tsm i2t di_dt dv_dt dv_dt_c "},
                  {"diode", " v_rrm i_f_av i_fsm "},
                  {"mosfet", " v_dss i_d i_dm "},
                  {"igbt", " v_ces i_c i_cm "},
                  {"varistor", " energy i_surge p_max "},
                  {"fuse", " v_rated i_rated "}};
  char spaced[VS_KIND_NAME + 2];
  snprintf(spaced, sizeof spaced, " %.*s ", VS_KIND_NAME - 1, limit);
  for (size_t k = 0; k < sizeof DECISIVE / sizeof *DECISIVE; k++)
    if (!strcmp(DECISIVE[k].kind, kind)) return strstr(DECISIVE[k].limits, spaced);
  return false;
}

/* ---- what measures hang on by the model ---- */

/* t_off begins where the current ends, at I_H. A gate pulse is followed where it is above I_GT, and
 * the current that it lets in above I_L and, behind it, above I_H. What is clamped has the
 * varistor's voltage; a varistor's mean power at the mains is that of its voltage at 1 mA, in a
 * pulse that of its clamping voltage. A junction is heated by the on-state and by switching. */
static const vs_hanging HANGING[] = {
    {"", " v_forward v_reverse v_peak ", "v_clamp", "varistor"},
    {" varistor ", " i_peak energy power i_pulse power_repeated ", "v_clamp", NULL},
    {" varistor ", " power ", "v_varistor", NULL},
    {" thyristor ", " t_off commutation_failures ", "t_q", NULL},
    {" thyristor ", " t_off ", "i_h", NULL},
    {" triac ", " dv_dt_c commutation_failures ", "dv_dt_c", NULL},
    {" thyristor triac ", " dv_dt unintended_firings ", "dv_dt", NULL},
    {" thyristor triac ", " misfires ", "i_gt", NULL},
    {" thyristor triac ", " misfires ", "i_l", NULL},
    {" thyristor triac ", " misfires ", "i_h", NULL},
    {" thyristor triac ", " t_j_rise t_j ", "v_t", NULL},
    {" diode ", " t_j_rise t_j ", "v_f", NULL},
    {" mosfet ", " t_j_rise t_j ", "r_ds_on", NULL},
    {" igbt ", " t_j_rise t_j ", "v_ce_sat", NULL},
    {" mosfet igbt ", " t_j_rise t_j ", "e_on", NULL},
    {" mosfet igbt ", " t_j_rise t_j ", "e_off", NULL},
    {" fuse ", " i2t_surge let_through opens ", "i2t_melt", NULL},
    {" fuse ", " opens ", "i_fusing", NULL},
    {" fuse ", " let_through ", "i2t_clear", NULL},
    {" fuse ", " v_arc ", "v_arc", NULL}};
enum { N_HANGING = sizeof HANGING / sizeof *HANGING };

/* True where the word stands in a list of words, each between blanks. */
static bool is_among(const char *words, const char *word) {
  char spaced[VS_KIND_NAME + 2];
  snprintf(spaced, sizeof spaced, " %.*s ", VS_KIND_NAME - 1, word);
  return strstr(words, spaced) != NULL;
}

const vs_hanging *vs_kinds_hanging(const char *kind, const char *measure, size_t n) {
  for (size_t k = 0; k < N_HANGING; k++)
    if ((!*HANGING[k].kinds || is_among(HANGING[k].kinds, kind)) &&
        is_among(HANGING[k].measures, measure) && n-- == 0)
      return &HANGING[k];
  return NULL;
}

bool vs_kinds_is_hung_on(const char *kind, const char *figure, char **names) {
  vs_text all = {0};
  bool found = false;
  for (size_t k = 0; k < N_HANGING && !found; k++) {
    if (HANGING[k].beside || !is_among(HANGING[k].kinds, kind)) continue;
    found = !strcmp(HANGING[k].figure, figure);
    size_t first = 0; /* a figure may have several rows */
    while (HANGING[first].beside || !is_among(HANGING[first].kinds, kind) ||
           strcmp(HANGING[first].figure, HANGING[k].figure))
      first++;
    if (first == k) vs_text_add(&all, "%s%s", all.length ? ", " : "", HANGING[k].figure);
  }
  if (found || !names)
    vs_text_free(&all);
  else
    *names = all.text;
  return found;
}
