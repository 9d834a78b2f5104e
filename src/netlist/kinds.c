/* SPDX-License-Identifier: GPL-3.0-or-later
 * The kinds of devices. Who asks for a property of a kind reads it from its row of vs_kinds_all;
 * nobody compares names of kinds.
 *
 * A new kind touches: its measures, limits and row here, in the columns that kinds.h describes; a
 * plug of the test stand, in bench/figures.h and the table of bench/acceptance.c; templates for its
 * data sheet, spice/templates/KIND.inc and KIND_wrapped.inc; docs/devices.md and
 * tests/measure/test_kinds.c, which wants each row to be whole.
 *
 * A new measure touches: a row of its kind, and its limit, if any, in the kind's limits; where
 * there is no way yet in which it becomes one number, VS_REDUCTION_LIST and a plug in
 * measure/devices/reductions.c. */
#include "netlist/kinds.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* ---- measures: name, unit, text, how, of, sense, limit, held ---- */

/* Rows that several kinds have alike; ROW: of several in one macro. How a mean or rms value is
 * judged: measure/devices/means.c. */
#define ROW(...)                                                                                   \
  { __VA_ARGS__ }
#define OVER "over the span of the key measure"
#define MEAN_IS_JUDGED "judged if that is 1 s or longer, with more than one shot in it"
#define RMS_TEXT "rms current, " OVER "; " MEAN_IS_JUDGED
#define I_RMS(limit) "i_rms", "A", RMS_TEXT, VS_R_RMS, VS_OF_I2, 1, limit, VS_AT_MOST
#define I_MEAN "i_mean", "A", "mean current, " OVER, VS_R_MEAN, VS_OF_I, 1, NULL, VS_AT_MOST
#define I_PEAK(limit)                                                                              \
  "i_peak", "A", "peak current, either way", VS_R_PEAK, VS_OF_I, 0, limit, VS_AT_MOST
#define V_PEAK(limit)                                                                              \
  "v_peak", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, limit, VS_AT_MOST
#define STEEPEST(limit)                                                                            \
  "V/us", "largest rate of voltage, either way, over any 0.1 us", VS_R_STEEPEST, VS_OF_V, 0,       \
      limit, VS_AT_MOST
#define POWER_MEAN(limit)                                                                          \
  "power", "W", "mean power, " OVER "; " MEAN_IS_JUDGED, VS_R_MEAN, VS_OF_POWER, 1, limit,         \
      VS_AT_MOST
#define ENERGY "energy over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST
#define LOSS "loss", "J", "int v i dt over the run", VS_R_INTEGRAL, VS_OF_POWER, 1, NULL, VS_AT_MOST
#define LOSS_PART(name, text, how) name, "J", text, how, VS_OF_POWER, 1, NULL, VS_AT_MOST
#define LOSS_CONDUCTION                                                                            \
  LOSS_PART("loss_conduction", "part of loss while it conducts", VS_R_CONDUCTION)
#define LOSS_SWITCHING                                                                             \
  LOSS_PART("loss_switching", "part of loss while it turns on and off", VS_R_SWITCHING)
#define LOSS_BLOCKING                                                                              \
  LOSS_PART("loss_blocking", "part of loss while it blocks: the rest", VS_R_BLOCKING)
/* A voltage for ever. A direct one is told by its mean, any other by its rms value. */
#define ALTERNATING                                                                                \
  "v_rms", "V",                                                                                    \
      "rms voltage, " OVER "; " MEAN_IS_JUDGED "; where its mean exceeds the rms of its ripple, "  \
                                               "v_dc is judged instead if the part states it",     \
      VS_R_ALTERNATING, VS_OF_V2, 1, "v_rms", VS_AT_MOST
#define DIRECT                                                                                     \
  "v_dc", "V", "mean of a direct voltage, either way, " OVER "; " MEAN_IS_JUDGED, VS_R_DIRECT,     \
      VS_OF_V, 0, "v_dc", VS_AT_MOST

/* The junction: its rise over the case, the case, the junction. */
#define JUNCTION                                                                                   \
  ROW("t_j_rise", "K", "largest rise of the junction's temperature, by the part's zth",            \
      VS_R_JUNCTION, VS_OF_POWER, 1, "t_j_rise", VS_AT_MOST),                                      \
      ROW("t_case", "degC",                                                                        \
          "temperature of its case: ambient, and mean power over its heat sink or over r_th_ja; "  \
          "where no mean is judged it stays at the ambient",                                       \
          VS_R_CASE, VS_OF_POWER, 1, NULL, VS_AT_MOST),                                            \
      ROW("t_j", "degC", "largest temperature of its junction, t_j_rise above t_case",             \
          VS_R_HOTTEST, VS_OF_POWER, 1, "t_j_max", VS_AT_MOST)

/* What a rectifier or a device that latches bears for a short time. */
#define SURGE(limit)                                                                               \
  "i_surge", "A",                                                                                  \
      "largest int i^2 dt within 10 ms, told as the peak of a half sine of 10 ms that has as "     \
      "much",                                                                                      \
      VS_R_SURGE, VS_OF_I2, 1, limit, VS_AT_MOST
#define I2T(text)                                                                                  \
  ROW("i2t", "A2.s", text, VS_R_PULSE, VS_OF_I2, 1, "i2t", VS_AT_MOST),                            \
      ROW("i_surge_n", "A",                                                                        \
          "heat of the consecutive conductions that come nearest to the part's lines surge, told " \
          "as the peak of as many half sines of 10 ms, one a cycle",                               \
          VS_R_SURGES, VS_OF_I2, 1, NULL, VS_AT_MOST),                                             \
      ROW("i2t_short", "A2.s",                                                                     \
          "int i^2 dt of the conduction below 10 ms that comes nearest to its limit i2sqrt_t "     \
          "sqrt(t), where a half sine of the same peak and int i^2 dt lasts t",                    \
          VS_R_SHORT, VS_OF_I2, 1, NULL, VS_AT_MOST)

/* Of a device that latches: which voltage rises, which way its current goes. */
#define RISES(which, way)                                                                          \
  ROW("dv_dt", "V/us",                                                                             \
      "largest mean rate at which " which " rises by dv_dt_over of its part (a tenth of v_drm); "  \
                                          "a rise that ends as a gate pulse fires "                \
      "the device does not count",                                                                 \
      VS_R_RISE, VS_OF_V, 1, "dv_dt", VS_AT_MOST),                                                 \
      ROW("dv_dt_error", "V/us",                                                                   \
          "error of dv_dt besides run.tolerance: the voltage's course between the solver's "       \
          "instants "                                                                              \
          "is taken as cubic or straight",                                                         \
          VS_R_RISE_ERROR, VS_OF_V, 1, NULL, VS_AT_MOST),                                          \
      ROW("dv_dt_max", "V/us", "largest rate of " which ", over any 0.1 us", VS_R_OFF_RATE,        \
          VS_OF_V, 1, NULL, VS_AT_MOST),                                                           \
      ROW("di_dt", "A/us",                                                                         \
          "largest rate of current from firing to its first " way                                  \
          "over any turn_on_time of its part (0.1 us)",                                            \
          VS_R_ON_RATE, VS_OF_I, 1, "di_dt", VS_AT_MOST)
#define LATCHED_RMS                                                                                \
  "i_rms", "A", RMS_TEXT ", as i_surge and i2t are for what is short", VS_R_RMS, VS_OF_I2, 1,      \
      "i_t_rms", VS_AT_MOST
#define DISOBEYS(misfires, failures)                                                               \
  ROW("misfires", "", misfires, VS_R_MISFIRE, VS_OF_I, 1, NULL, VS_NEVER),                         \
      ROW("unintended_firings", "", "firings without a gate pulse", VS_R_UNINTENDED, VS_OF_I, 1,   \
          NULL, VS_NEVER),                                                                         \
      ROW("commutation_failures", "", "unintended firings " failures, VS_R_COMMUTATION_FAILURE,    \
          VS_OF_I, 1, NULL, VS_NEVER)

static const vs_device_measure THYRISTOR[] = {
    {"v_forward", "V", "peak forward voltage", VS_R_PEAK, VS_OF_V, 1, "v_drm", VS_AT_MOST},
    {"v_reverse", "V", "peak reverse voltage", VS_R_PEAK, VS_OF_V, -1, "v_rrm", VS_AT_MOST},
    RISES("forward off-state voltage", "maximum, and for 1 us at least, "),
    {"i_peak", "A", "peak current", VS_R_PEAK, VS_OF_I, 1, NULL, VS_AT_MOST},
    {SURGE("i_tsm")},
    {I_MEAN},
    {LATCHED_RMS},
    I2T("largest int i^2 dt of one conduction"),
    {LOSS},
    JUNCTION,
    {"t_off", "s",
     "shortest time from the current's zero to the return of forward voltage while its gate "
     "is off",
     VS_R_OFFERED, VS_OF_V, 1, "t_q", VS_AT_LEAST},
    DISOBEYS("gate pulses that it did not follow",
             "on the first forward voltage after a conduction and before t_q")};
static const vs_device_measure TRIAC[] = {
    {"v_forward", "V", "peak voltage, second main terminal positive", VS_R_PEAK, VS_OF_V, 1,
     "v_drm", VS_AT_MOST},
    {"v_reverse", "V", "peak voltage, second main terminal negative", VS_R_PEAK, VS_OF_V, -1,
     "v_drm", VS_AT_MOST},
    RISES("off-state voltage, either way", "extreme, and for 1 us at least, either way, "),
    {"dv_dt_c", "V/us",
     "(dv/dt)c: largest mean rate at which off-state voltage rises by dv_dt_over, or by four "
     "fifths "
     "of a smaller rise, within 1.5 ms after a conduction (ten t_q if stated); compared only, as "
     "the model of a triac fires by dv/dt",
     VS_R_RETURN_RISE, VS_OF_V, 1, "dv_dt_c", VS_AT_MOST},
    {"di_dt_c", "A/ms",
     "(di/dt)c: steepest fall of a current to zero, if voltage is back within 1.5 ms (ten t_q) "
     "after "
     "it; mean rate from a tenth of its peak on, or over the last 50 us (assumed) if steeper",
     VS_R_FALL, VS_OF_I, 1, "di_dt_c", VS_AT_MOST},
    {I_PEAK("i_trm")},
    {SURGE("i_tsm")},
    {"i_mean", "A", "mean current, the direct part of the load's, " OVER, VS_R_MEAN, VS_OF_I, 1,
     NULL, VS_AT_MOST},
    {LATCHED_RMS},
    I2T("largest int i^2 dt of one half cycle's conduction"),
    {LOSS},
    {LOSS_CONDUCTION},
    {LOSS_SWITCHING},
    {LOSS_BLOCKING},
    JUNCTION,
    DISOBEYS("gate pulses that it did not follow, of both half cycles",
             "in the half cycle that begins with the zero of a current")};
static const vs_device_measure DIODE[] = {
    {"v_reverse", "V", "peak reverse voltage", VS_R_PEAK, VS_OF_V, -1, "v_rrm", VS_AT_MOST},
    {"i_peak", "A", "peak forward current", VS_R_PEAK, VS_OF_I, 1, "i_frm", VS_AT_MOST},
    {"i_reverse", "A", "peak reverse current, of its recovery", VS_R_PEAK, VS_OF_I, -1, NULL,
     VS_AT_MOST},
    {SURGE("i_fsm")},
    {"i_mean", "A", "mean current, " OVER "; judged as i_rms is", VS_R_MEAN, VS_OF_I, 1, "i_f_av",
     VS_AT_MOST},
    {I_RMS("i_f_rms")},
    I2T("largest int i^2 dt of one conduction"),
    {LOSS},
    {LOSS_CONDUCTION},
    {LOSS_PART("loss_recovery",
               "part of loss from the zero of its current to the end of its recovery",
               VS_R_RECOVERY)},
    {LOSS_BLOCKING},
    {LOSS_PART("e_rec", "largest energy of one recovery", VS_R_E_RECOVERY)},
    JUNCTION};

static const vs_device_measure DIAC[] = {{V_PEAK(NULL)}, {I_PEAK("i_trm")}, {LOSS}};

/* A transistor that a port drives, from its current on. */
#define DRIVEN(i_peak, i_rms, i_off)                                                               \
  ROW(I_PEAK(i_peak)), ROW(I_MEAN), ROW(I_RMS(i_rms)), ROW("dv_dt", STEEPEST("dv_dt")), ROW(LOSS), \
      ROW(LOSS_CONDUCTION), ROW(LOSS_SWITCHING), ROW(LOSS_BLOCKING),                               \
      ROW(LOSS_PART("e_on", "largest energy of one turn-on", VS_R_E_ON)),                          \
      ROW(LOSS_PART("e_off", "largest energy of one turn-off", VS_R_E_OFF)),                       \
      ROW("i_off", "A", "largest current that it turned off", VS_R_TURNED_OFF, VS_OF_I, 1, i_off,  \
          VS_AT_MOST),                                                                             \
      JUNCTION
static const vs_device_measure MOSFET[] = {
    {"v_peak", "V", "peak voltage, drain positive", VS_R_PEAK, VS_OF_V, 1, "v_dss", VS_AT_MOST},
    {"e_avalanche", "J",
     "largest energy of one avalanche: a stretch above v_dss of its part; none: it never was above",
     VS_R_AVALANCHE, VS_OF_POWER, 1, "e_as", VS_AT_MOST},
    DRIVEN("i_dm", "i_d", NULL)};
static const vs_device_measure IGBT[] = {
    {"v_peak", "V", "peak voltage, collector positive", VS_R_PEAK, VS_OF_V, 1, "v_ces", VS_AT_MOST},
    {"v_reverse", "V", "peak voltage, emitter positive", VS_R_PEAK, VS_OF_V, -1, "v_ecs",
     VS_AT_MOST},
    DRIVEN("i_cm", "i_c", "i_rbsoa")};
static const vs_device_measure ELECTROLYTIC[] = {
    {"v_peak", "V", "peak voltage", VS_R_PEAK, VS_OF_V, 1, "v_rated", VS_AT_MOST},
    {"v_reverse", "V", "peak voltage the wrong way round", VS_R_PEAK, VS_OF_V, -1, "v_reverse",
     VS_AT_MOST},
    {I_PEAK("i_surge")},
    {I_RMS("i_ripple")},
    {"power", "W",
     "mean of v i " OVER ": its loss, where it stores as much at the end "
     "as at the beginning",
     VS_R_MEAN, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"t_core_rise", "K",
     "largest rise of its core's temperature under ESR i^2, by the part's limit esr and its zth",
     VS_R_CORE, VS_OF_I2, 1, "t_core_rise", VS_AT_MOST}};
static const vs_device_measure VARISTOR[] = {
    {"v_clamp", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, NULL, VS_AT_MOST},
    {I_PEAK("i_surge")},
    {"energy", "J",
     "largest heat of one pulse, without the energy in its capacitance; a pulse ends once |i| has "
     "stayed below 1 mA for a quarter of a mains cycle",
     VS_R_HEAT, VS_OF_POWER, 1, "energy", VS_AT_MOST},
    {"energy_total", "J", ENERGY},
    {POWER_MEAN("p_max")},
    {ALTERNATING},
    {DIRECT},
    {"i_pulse", "A",
     "peak current of the pulse that comes nearest to the part's table of width and number (its "
     "lines pulse); the number: pulses of the run as large as it, times the event's key times",
     VS_R_DERATED, VS_OF_I, 0, NULL, VS_AT_MOST},
    {"power_repeated", "W",
     "mean power of pulses that come again: energy_total divided by the event's key every",
     VS_R_REPEATED, VS_OF_POWER, 1, "p_max", VS_AT_MOST}};
/* Reverse current counts as positive: it flows into the cathode. The rating of a pulse is given for
 * 8.3 ms; `energy` is that of this pulse, as of a TVS. */
static const vs_device_measure ZENER[] = {
    {"v_clamp", "V", "peak reverse voltage", VS_R_PEAK, VS_OF_V, 1, NULL, VS_AT_MOST},
    {"i_peak", "A", "peak reverse current", VS_R_PEAK, VS_OF_I, 1, "i_zsm", VS_AT_MOST},
    {"i_mean", "A", "mean current, " OVER "; " MEAN_IS_JUDGED, VS_R_MEAN, VS_OF_I, 1, "i_zm",
     VS_AT_MOST},
    {"energy", "J", "largest heat of one pulse, as a varistor's", VS_R_HEAT, VS_OF_POWER, 1,
     "energy", VS_AT_MOST},
    {"energy_total", "J", ENERGY},
    {POWER_MEAN("p_d")}};
/* The rating of a pulse is given for 10/1000 us. Up to 1 ms a pulse may have that power and more,
 * and from there on that energy and more, so that the two together judge a pulse of any width. */
static const vs_device_measure TVS[] = {
    {"v_clamp", "V", "peak voltage, either way", VS_R_PEAK, VS_OF_V, 0, NULL, VS_AT_MOST},
    {I_PEAK("i_pp")},
    {"power_peak", "W", "peak power", VS_R_PEAK, VS_OF_POWER, 1, "p_pp", VS_AT_MOST},
    {"energy", "J", "largest heat of one pulse, as a varistor's", VS_R_HEAT, VS_OF_POWER, 1,
     "energy", VS_AT_MOST},
    {"energy_total", "J", ENERGY},
    {POWER_MEAN("p_d")},
    {"v_dc", "V", "mean of a direct voltage, either way, " OVER "; " MEAN_IS_JUDGED, VS_R_DIRECT,
     VS_OF_V, 0, "v_rwm", VS_AT_MOST},
    {"power_repeated", "W",
     "mean power of pulses that come again: energy_total divided by the event's key every",
     VS_R_REPEATED, VS_OF_POWER, 1, "p_d", VS_AT_MOST}};
static const vs_device_measure RESISTOR[] = {
    {POWER_MEAN("p_rated")},
    {"e_pulse", "J", "largest energy within 10 ms", VS_R_WITHIN, VS_OF_POWER, 1, "e_pulse",
     VS_AT_MOST},
    {V_PEAK("v_class")},
    {"power_peak", "W", "peak power", VS_R_PEAK, VS_OF_POWER, 1, NULL, VS_AT_MOST},
    {"energy", "J", ENERGY}};
static const vs_device_measure CAPACITOR[] = {
    {V_PEAK("v_class")},  {ALTERNATING},  {DIRECT},
    {I_RMS("i_rms_max")}, {I_PEAK(NULL)}, {"dv_dt_max", STEEPEST("dv_dt_max")}};
static const vs_device_measure FUSE[] = {
    {I_PEAK(NULL)},
    {"i_rms", "A", RMS_TEXT, VS_R_CARRIED, VS_OF_I2, 1, "i_rated", VS_AT_MOST},
    {"i_overload", "A",
     "rms current over that stretch of time which comes nearest to the part's time-current curve "
     "(its lines time_current)",
     VS_R_CURVE, VS_OF_I2, 1, NULL, VS_AT_MOST},
    {"i2t_surge", "A2.s",
     "largest int i^2 dt within 10 ms while it is whole; fuses of one type differ by 15 %",
     VS_R_MELTING, VS_OF_I2, 1, "i2t_melt", VS_AT_MOST},
    {"i2t", "A2.s", "int i^2 dt over the run", VS_R_INTEGRAL, VS_OF_I2, 1, NULL, VS_AT_MOST},
    {"let_through", "A2.s",
     "largest int i^2 dt within 10 ms; where it opens, fuses of one type differ by 15 %",
     VS_R_LET_THROUGH, VS_OF_I2, 1, "i2t", VS_WARD_AT_MOST},
    {"i2t_clear", "A2.s",
     "int i^2 dt that it lets through at its rated voltage, by the part's limit i2t_clear",
     VS_R_CLEARS, VS_OF_I2, 1, "i2t", VS_WARD_AT_MOST},
    {V_PEAK(NULL)},
    {"v_open", "V",
     "rms voltage that it has to keep off once it has opened: of half a mains cycle, or its crest "
     "over the square root of 2; at least the rms of the mains that drive it",
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

/* ---- limits: name, unit, least, most, param, is, hang ---- */

/* What a data sheet often leaves out does not decide: the junction's temperature, a triac's
 * (di/dt)c, a diode's i2t, which follows from i_fsm. Why measures hang on figures: t_off begins
 * where the current ends, at I_H. A gate pulse is followed where it is above I_GT, and the current
 * that it lets in above I_L and, behind it, above I_H. A varistor's mean power at the mains is that
 * of its voltage at 1 mA, in a pulse that of its clamping voltage. A junction is heated by the
 * on-state and by switching. */
#define DECIDES VS_LIMIT_DECIDES
#define TWIN VS_LIMIT_TWIN
#define HEATS " t_j_rise t_j "
/* Rows without a usual range. FIGURE: no measure is held against it. Some set what is measured:
 * dv_dt_over, turn_on_time, the r_th and i2sqrt_t. The others are conditions of tests, and what
 * `check` of the part tries the model by (bench/acceptance.c). */
#define LIMIT(name, unit, is) ROW(name, unit, 0, 0, NULL, is, "")
#define FIGURE(name, unit) LIMIT(name, unit, 0)
#define HANG(name, unit, hang) ROW(name, unit, 0, 0, NULL, 0, hang)

/* Rows that several kinds have alike. */
#define HEAT_LIMITS                                                                                \
  LIMIT("t_j_rise", "K", 0), LIMIT("t_j_max", "degC", 0), FIGURE("r_th_jc", "K/W"),                \
      FIGURE("r_th_cs", "K/W"), FIGURE("r_th_ja", "K/W"), FIGURE("i_test", "A"),                   \
      FIGURE("di_test", "A/us")
#define SPREAD_LIMITS FIGURE("tolerance", "%"), FIGURE("ageing", "%")
#define LATCH_LIMITS                                                                               \
  LIMIT("i_tsm", "A", DECIDES), LIMIT("i2t", "A2.s", DECIDES),                                     \
      ROW("dv_dt", "V/us", 2, 2e4, "critical_dvdt", DECIDES | TWIN, " dv_dt unintended_firings "), \
      FIGURE("dv_dt_over", "V"), FIGURE("turn_on_time", "us"), FIGURE("i2sqrt_t", "A2.sqrt_s"),    \
      HANG("i_l", "mA", " misfires "), FIGURE("i_tm", "A"),                                        \
      ROW("v_t", "V", 0.7, 6, NULL, 0, HEATS), HEAT_LIMITS
#define DRIVEN_LIMITS                                                                              \
  LIMIT("dv_dt", "V/us", 0), HANG("e_on", "mJ", HEATS), FIGURE("q_rr", "A*us"),                    \
      FIGURE("t_rr", "ns"), FIGURE("i_rm", "A"), FIGURE("v_f", "V"), FIGURE("v_test", "V"),        \
      HEAT_LIMITS

static const vs_kind_limit THYRISTOR_LIMITS[] = {
    {"v_drm", "V", 25, 15e3, "blocking_voltage", DECIDES | TWIN, ""},
    {"v_rrm", "V", 10, 15e3, NULL, DECIDES, ""},
    {"i_t_rms", "A", 0.1, 2e4, NULL, DECIDES, ""},
    {"di_dt", "A/us", 2, 5e3, NULL, DECIDES, ""},
    {"t_q", "us", 1, 2e3, "turn_off_time", DECIDES | TWIN, " t_off commutation_failures "},
    {"i_gt", "mA", 0.001, 1e3, "gate_current", 0, " misfires "},
    {"v_gt", "V", 0.55, 5, NULL, 0, ""},
    LATCH_LIMITS,
    HANG("i_h", "mA", " t_off misfires "),
    FIGURE("q_rr", "A*us"),
    {"on_voltage", "V", 0.5, 3, NULL, VS_LIMIT_PARAM, ""}};
static const vs_kind_limit TRIAC_LIMITS[] = {
    {"v_drm", "V", 25, 3e3, "blocking_voltage", DECIDES | TWIN, ""},
    {"i_t_rms", "A", 0.1, 500, NULL, DECIDES, ""},
    LIMIT("i_trm", "A", 0),
    {"di_dt", "A/us", 1, 1e3, NULL, DECIDES, ""},
    {"dv_dt_c", "V/us", 0.05, 1e3, NULL, DECIDES, " dv_dt_c commutation_failures "},
    {"di_dt_c", "A/ms", 0.1, 1e3, NULL, 0, ""},
    {"i_gt", "mA", 0.1, 500, "gate_current", 0, " misfires "},
    {"v_gt", "V", 0.4, 5, NULL, 0, ""},
    FIGURE("i_gt_4", "mA"),
    LATCH_LIMITS,
    HANG("i_h", "mA", " misfires "),
    {"on_voltage", "V", 0.4, 3, NULL, VS_LIMIT_PARAM, ""}};
static const vs_kind_limit DIODE_LIMITS[] = {{"v_rrm", "V", 5, 2e4, NULL, DECIDES, ""},
                                             {"i_f_av", "A", 1e-3, 2e4, NULL, DECIDES, ""},
                                             LIMIT("i_f_rms", "A", 0),
                                             LIMIT("i_frm", "A", 0),
                                             LIMIT("i_fsm", "A", DECIDES),
                                             LIMIT("i2t", "A2.s", 0),
                                             FIGURE("i2sqrt_t", "A2.sqrt_s"),
                                             {"v_f", "V", 0.15, 10, NULL, 0, HEATS},
                                             {"q_rr", "A*us", 1e-5, 1e5, "recovered_charge", 0, ""},
                                             {"t_rr", "ns", 1, 2e5, NULL, 0, ""},
                                             FIGURE("i_rm", "A"),
                                             FIGURE("v_test", "V"),
                                             HEAT_LIMITS,
                                             {"on_voltage", "V", 0.1, 8, NULL, VS_LIMIT_PARAM, ""}};
static const vs_kind_limit DIAC_LIMITS[] = {LIMIT("i_trm", "A", 0),
                                            {"v_bo_min", "V", 5, 1e3, NULL, 0, ""},
                                            {"v_bo_max", "V", 5, 1e3, NULL, 0, ""},
                                            FIGURE("v_bo_symmetry", "V"),
                                            FIGURE("i_bo", "uA"),
                                            FIGURE("dv_bo", "V"),
                                            FIGURE("v_t", "V"),
                                            FIGURE("i_test", "mA")};
static const vs_kind_limit MOSFET_LIMITS[] = {
    {"v_dss", "V", 5, 5e3, "blocking_voltage", DECIDES | TWIN, ""},
    {"i_d", "A", 0.01, 5e3, NULL, DECIDES, ""},
    LIMIT("i_dm", "A", DECIDES),
    LIMIT("e_as", "mJ", 0),
    {"r_ds_on", "ohm", 1e-4, 1e3, "on_resistance", 0, HEATS},
    {"v_gs_th", "V", 0.3, 10, "threshold", 0, ""},
    DRIVEN_LIMITS,
    HANG("e_off", "mJ", HEATS)};
static const vs_kind_limit IGBT_LIMITS[] = {
    {"v_ces", "V", 100, 1e4, "blocking_voltage", DECIDES | TWIN, ""},
    LIMIT("v_ecs", "V", 0),
    {"i_c", "A", 0.1, 1e4, NULL, DECIDES, ""},
    LIMIT("i_cm", "A", DECIDES),
    LIMIT("i_rbsoa", "A", 0),
    {"v_ce_sat", "V", 0.7, 8, NULL, 0, HEATS},
    {"v_ge_th", "V", 2, 10, "threshold", 0, ""},
    DRIVEN_LIMITS,
    {"e_off", "mJ", 1e-3, 1e5, "turn_off_energy", 0, HEATS}};
static const vs_kind_limit VARISTOR_LIMITS[] = {
    {"v_rms", "V", 2, 2e4, NULL, 0, ""},
    LIMIT("v_dc", "V", 0),
    {"i_surge", "A", 1, 2e5, NULL, DECIDES, ""},
    {"energy", "J", 0.01, 1e5, NULL, DECIDES, ""},
    LIMIT("p_max", "W", DECIDES),
    FIGURE("i_clamp", "A"),
    HANG("v_clamp", "V", " i_peak energy power i_pulse power_repeated "),
    {"v_varistor", "V", 4, 5e4, NULL, 0, " power "},
    SPREAD_LIMITS,
    {"varistor_exponent", "", 10, 80, NULL, VS_LIMIT_PARAM, ""}};
static const vs_kind_limit ZENER_LIMITS[] = {{"v_z", "V", 1.5, 400, NULL, 0, " energy "},
                                             FIGURE("i_zt", "mA"),
                                             LIMIT("i_zm", "mA", 0),
                                             LIMIT("i_zsm", "mA", DECIDES),
                                             {"energy", "J", 1e-4, 100, NULL, DECIDES, ""},
                                             {"p_d", "W", 0.05, 1e3, NULL, DECIDES, ""}};
static const vs_kind_limit TVS_LIMITS[] = {{"v_rwm", "V", 2, 1e3, NULL, 0, ""},
                                           {"v_br", "V", 2, 1e3, NULL, 0, " energy power "},
                                           FIGURE("i_t", "mA"),
                                           {"v_c", "V", 4, 2e3, NULL, 0, " power_peak energy "},
                                           LIMIT("i_pp", "A", 0),
                                           {"p_pp", "W", 10, 1e6, NULL, DECIDES, ""},
                                           {"energy", "J", 1e-3, 1e3, NULL, DECIDES, ""},
                                           LIMIT("p_d", "W", 0)};
static const vs_kind_limit RESISTOR_LIMITS[] = {LIMIT("p_rated", "W", 0), LIMIT("e_pulse", "J", 0),
                                                LIMIT("v_class", "V", 0), FIGURE("r_least", "ohm"),
                                                FIGURE("r_most", "ohm"),  SPREAD_LIMITS};
static const vs_kind_limit CAPACITOR_LIMITS[] = {
    LIMIT("v_class", "V", 0),      LIMIT("v_rms", "V", 0),
    LIMIT("v_dc", "V", 0),         LIMIT("i_rms_max", "A", 0),
    LIMIT("dv_dt_max", "V/us", 0), FIGURE("c_rated", "uF"),
    FIGURE("esr", "ohm"),          SPREAD_LIMITS};
static const vs_kind_limit ELECTROLYTIC_LIMITS[] = {
    {"v_rated", "V", 2, 1e3, "rated_voltage", TWIN, ""},
    LIMIT("v_reverse", "V", 0),
    {"i_ripple", "A", 1e-3, 1e3, NULL, 0, ""},
    LIMIT("i_surge", "A", 0),
    LIMIT("t_core_rise", "K", 0),
    {"c_rated", "uF", 0.05, 1e7, "capacitance", 0, ""},
    {"esr", "ohm", 3e-4, 1e3, NULL, 0, ""},
    FIGURE("i_leakage", "mA"),
    SPREAD_LIMITS};
static const vs_kind_limit FUSE_LIMITS[] = {
    {"i_rated", "A", 0.01, 1e4, "rated_current", DECIDES | TWIN, ""},
    {"v_rated", "V", 5, 1e5, "rated_voltage", DECIDES | TWIN, ""},
    {"i2t_melt", "A2.s", 1e-6, 1e8, "melting_i2t", TWIN, " i2t_surge let_through opens "},
    HANG("i_fusing", "A", " opens "),
    HANG("i2t_clear", "A2.s", " let_through "),
    {"v_arc", "V", 10, 1e5, NULL, 0, " v_arc "}};
static const vs_kind_limit GATE_DRIVE_LIMITS[] = {LIMIT("volt_seconds", "V.s", 0)};

const vs_mains_limit vs_kinds_mains[] = {{"v_drm", "peak", M_SQRT2},
                                         {"v_rrm", "peak", M_SQRT2},
                                         {"v_rms", "rms", 1},
                                         {"v_rwm", "peak", M_SQRT2},
                                         {NULL, NULL, 0}};

/* ---- kinds ---- */

#define ANODE(also) ROW(VS_PIN_FROM, "a", "anode", " a an ano anode ", also)
#define CATHODE(also) ROW(VS_PIN_TO, "k", "cathode", " k c ka ca cat cath cathode kathode ", also)
#define GATE(words) ROW(VS_PIN_GATE, "g", "gate", words, NULL)
#define FIRED GATE(" g gt ga gat gate ")
#define ALIKE(from, to)                                                                            \
  ROW(VS_PIN_FROM, from, NULL, NULL, NULL), ROW(VS_PIN_TO, to, NULL, NULL, NULL)
#define TABLES(measured, limited)                                                                  \
  .measures = measured, .n_measures = sizeof measured / sizeof *measured, .limits = limited,       \
  .n_limits = sizeof limited / sizeof *limited

const vs_kind vs_kinds_all[] = {
    {.name = "thyristor",
     .called = " thyristor scr ",
     .switches = true,
     .gated = true,
     .letters = "akg",
     .pins = {ANODE(NULL), CATHODE(NULL), FIRED},
     .ratios = {{"i_tsm", "i_t_rms", 3, 50, true}},
     .heat = {"i_t_rms", 1 / 1.57, 1},
     TABLES(THYRISTOR, THYRISTOR_LIMITS)},
    {.name = "triac",
     .called = " triac bta btb mac ",
     .switches = true,
     .both_ways = true,
     .gated = true,
     .letters = "21g",
     .pins = {{VS_PIN_FROM, "mt2", "main terminal 2", " mt2 t2 a2 m2 main2 mainterminal2 ", " a "},
              {VS_PIN_TO, "mt1", "main terminal 1", " mt1 t1 a1 m1 main1 mainterminal1 ", " k "},
              FIRED},
     .ratios = {{"i_tsm", "i_t_rms", 3, 50, true}},
     .heat = {"i_t_rms", 0.9, 1},
     TABLES(TRIAC, TRIAC_LIMITS)},
    {.name = "diode",
     .letter = 'd',
     .switches = true,
     .rectifies = true,
     .letters = "ak",
     .pins = {ANODE(" p "), CATHODE(" n ")},
     .ratios = {{"i_f_rms", "i_f_av", 0, 0, true}, {"i_fsm", "i_f_av", 3, 100, true}},
     .heat = {"i_f_av", 1, 1.57},
     TABLES(DIODE, DIODE_LIMITS)},
    {.name = "diac",
     .called = " diac sidac ",
     .pins = {ALIKE("a", "b")},
     .ratios = {{"v_bo_max", "v_bo_min", 0, 0, true}},
     TABLES(DIAC, DIAC_LIMITS)},
    {.name = "mosfet",
     .letter = 'm',
     .driven = true,
     .letters = "dgs",
     .pins = {{VS_PIN_FROM, "d", "drain", " d drain ", NULL},
              GATE(" g gate "),
              {VS_PIN_TO, "s", "source", " s source ", NULL}},
     .ratios = {{"i_dm", "i_d", 1, 20, true}},
     .heat = {"i_d", 0, 1},
     TABLES(MOSFET, MOSFET_LIMITS)},
    {.name = "igbt",
     .letter = 'z',
     .driven = true,
     .letters = "cge",
     .pins = {{VS_PIN_FROM, "c", "collector", " c collector ", NULL},
              GATE(" g gate "),
              {VS_PIN_TO, "e", "emitter", " e emitter ", NULL}},
     .ratios = {{"i_cm", "i_c", 1, 20, true}},
     .heat = {"i_c", 1, 1},
     TABLES(IGBT, IGBT_LIMITS)},
    {.name = "varistor",
     .called = " varistor mov siov ",
     .clamps = true,
     .pins = {ALIKE("a", "b")},
     .ratios = {{"v_dc", "v_rms", 0, 0, true},
                {"v_varistor", "v_dc", 0, 0, true},
                {"v_varistor", "v_rms", 1.35, 2.2, false},
                {"v_clamp", "v_varistor", 1.05, 4, false}},
     TABLES(VARISTOR, VARISTOR_LIMITS)},
    {.name = "zener",
     .called = " zener ",
     .clamps = true,
     .letters = "ka",
     .pins = {{VS_PIN_FROM, "k", "cathode", " k c ka ca cat cath cathode kathode ", " n "},
              {VS_PIN_TO, "a", "anode", " a an ano anode ", " p "}},
     .ratios = {{"i_zsm", "i_zm", 1, 50, true}},
     TABLES(ZENER, ZENER_LIMITS)},
    {.name = "tvs",
     .called = " tvs transil ",
     .clamps = true,
     .pins = {ALIKE("a", "b")},
     .ratios = {{"v_br", "v_rwm", 1.02, 1.4, true}, {"v_c", "v_br", 1.05, 2.5, true}},
     TABLES(TVS, TVS_LIMITS)},
    {.name = "resistor",
     .of_series = true,
     .pins = {ALIKE("a", "b")},
     TABLES(RESISTOR, RESISTOR_LIMITS)},
    {.name = "capacitor",
     .of_series = true,
     .stores = true,
     .pins = {ALIKE("a", "b")},
     .ratios = {{"v_class", "v_rms", 0, 0, true}, {"v_class", "v_dc", 0, 0, true}},
     TABLES(CAPACITOR, CAPACITOR_LIMITS)},
    {.name = "electrolytic",
     .of_series = true,
     .stores = true,
     .pins = {ALIKE("plus", "minus")},
     .ratios = {{"i_surge", "i_ripple", 0, 0, true}},
     TABLES(ELECTROLYTIC, ELECTROLYTIC_LIMITS)},
    {.name = "fuse",
     .called = " fuse ",
     .melts = true,
     .pins = {ALIKE("a", "b")},
     .ratios = {{"i_fusing", "i_rated", 1.02, 4, true},
                {"i2t_clear", "i2t_melt", 1, 100, true},
                {"v_arc", "v_rated", 1, 10, false}},
     TABLES(FUSE, FUSE_LIMITS)},
    {.name = "gate_drive", .stores = true, .gated = true, TABLES(GATE_DRIVE, GATE_DRIVE_LIMITS)},
    {.name = NULL}};

const vs_kind *vs_kinds_find(const char *name) {
  for (const vs_kind *kind = vs_kinds_all; kind->name && name; kind++)
    if (!strcmp(kind->name, name)) return kind;
  return NULL;
}

bool vs_kinds_latches(const char *name) {
  const vs_kind *kind = vs_kinds_find(name);
  return kind && kind->switches && kind->gated;
}

int vs_kinds_count_pins(const vs_kind *kind) {
  int n = 0;
  while (kind && n < VS_PINS && kind->pins[n].node) n++;
  return n;
}

int vs_kinds_pin(const vs_kind *kind, int role) {
  for (int k = 0; k < vs_kinds_count_pins(kind); k++)
    if (kind->pins[k].role == role) return k;
  return -1;
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

static bool is_of_mains(const char *limit) {
  for (const vs_mains_limit *m = vs_kinds_mains; m->name; m++)
    if (!strcmp(limit, m->name)) return true;
  return false;
}

/* The limit of that name of a kind; NULL: it has none, or there is no such kind. */
static const vs_kind_limit *limit_of(const vs_kind *kind, const char *name) {
  for (size_t k = 0; kind && k < kind->n_limits; k++)
    if (!strcmp(kind->limits[k].name, name) && !(kind->limits[k].is & VS_LIMIT_PARAM))
      return &kind->limits[k];
  return NULL;
}

const char *vs_kinds_limit_unit(const char *limit) {
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++) {
    const vs_kind_limit *own = limit_of(kind, limit);
    if (own) return own->unit;
  }
  return NULL;
}

bool vs_kinds_knows_limit(const char *kind_name, const char *limit, const char **nearest) {
  const vs_kind *kind = vs_kinds_find(kind_name);
  bool known = limit_of(kind, limit) || is_of_mains(limit);
  const char **names = vs_alloc(
      sizeof vs_kinds_mains / sizeof *vs_kinds_mains + (kind ? kind->n_limits : 0), sizeof *names);
  size_t count = 0;
  for (const vs_mains_limit *m = vs_kinds_mains; m->name; m++) names[count++] = m->name;
  for (size_t k = 0; kind && k < kind->n_limits; k++)
    if (!(kind->limits[k].is & VS_LIMIT_PARAM)) names[count++] = kind->limits[k].name;
  *nearest = known ? limit : vs_text_nearest(limit, names, count);
  free(names);
  return known;
}

bool vs_kinds_leaves_limit(const char *kind_name, const char *limit) {
  const vs_kind *kind = vs_kinds_find(kind_name);
  for (size_t k = 0; kind && k < kind->n_measures; k++) {
    const vs_device_measure *m = &kind->measures[k];
    if (m->limit && m->held != VS_WARD_AT_MOST && !strcmp(limit, m->limit)) return false;
  }
  return is_of_mains(limit) || !limit_of(kind, limit);
}

bool vs_kinds_decides(const char *kind, const char *limit) {
  const vs_kind_limit *own = limit_of(vs_kinds_find(kind), limit);
  return own && own->is & VS_LIMIT_DECIDES;
}

const char *vs_kinds_surge_limit(const char *kind_name) {
  const vs_kind *kind = vs_kinds_find(kind_name);
  for (size_t k = 0; kind && k < kind->n_measures; k++)
    if (kind->measures[k].how == VS_R_SURGE) return kind->measures[k].limit;
  return NULL;
}

/* ---- what measures hang on by the model ---- */

const char *vs_kinds_hanging(const vs_kind *kind, const char *measure, size_t n) {
  char spaced[VS_KIND_NAME + 2];
  snprintf(spaced, sizeof spaced, " %.*s ", VS_KIND_NAME - 1, measure);
  for (size_t k = 0; k < kind->n_limits; k++)
    if (strstr(kind->limits[k].hang, spaced) && n-- == 0) return kind->limits[k].name;
  return NULL;
}

bool vs_kinds_is_hung_on(const char *kind_name, const char *figure, char **names) {
  const vs_kind *kind = vs_kinds_find(kind_name);
  const vs_kind_limit *own = limit_of(kind, figure);
  vs_text all = {0};
  if (own && *own->hang) return true;
  for (size_t k = 0; names && kind && k < kind->n_limits; k++)
    if (*kind->limits[k].hang)
      vs_text_add(&all, "%s%s", all.length ? ", " : "", kind->limits[k].name);
  if (names) *names = all.text;
  return false;
}
