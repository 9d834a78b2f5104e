/* SPDX-License-Identifier: GPL-3.0-or-later
 * run.tolerance is held on tiers circuit and compiled over scenes drawn at random from what a user
 * may set, against the tests' own solver of the same equations: a few of them here; 100 at 1e-3 ...
 * 1e-7 with tools/test --long, which writes tolerance_grid.csv (committed in tests/long). The norm
 * is run.tolerance's (compare.h). A case whose thyristor fires or goes out another number of times
 * than in truth is none of a size: it is named and counted apart. Scenes that end in pole contact
 * are left out. */
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compare.h"
#include "suite.h"

enum { DIMENSIONS = 20, SCENES = 100, N_SETS = 24, COARSEST = -3, FINEST = -7 };

/* What is promised is run.tolerance; this is held, in its parts. */
static const struct {
  const char *name;
  double allowed;
  const char *table;
} TIERS[] = {{"circuit", 2, "tolerance_grid.csv"}, {"compiled", 1.1, "compiled_grid.csv"}};
/* Of 100 cases, so many may have another sequence of events. */
static const double MOST_CHANGED = 0.03;

/* Scenes of the grid at a tolerance where the error was 6 to 23 times that as long as the steps
 * knew of no ring and the solver of no least charge; the eighth's run went on, but with other
 * options of the solver it ended where the thyristor fired over an empty capacitor. At 1e-7: 3
 * times as a latch let go before its current was zero, 7 times as it leaked more than
 * off_resistance; 2.06 times as the coil's voltage alternated from step to step after the first
 * steps of a firing. Tier compiled was off by 7.6 and 2.1 times in scene 41 by a method whose order
 * falls while the thyristor leaks. */
static const struct {
  int number, decade;
} FEW[] = {{45, -4}, {84, -3}, {9, -4},  {108, -4}, {76, -5}, {81, -5},
           {41, -6}, {60, -6}, {35, -7}, {41, -7},  {65, -7}};

typedef struct grid_scene {
  int number;
  bool bare;
  double off_ohm;
  char text[N_SETS][64];
  const char *sets[N_SETS + 2];
  int n_sets;
} grid_scene;

static double logarithmic(double x, double low, double high) {
  return low * pow(high / low, x);
}

/* Scene `number` of all that may be drawn. Every third deck is the bare one. */
static void scene_at(int number, grid_scene *s) {
  double x[DIMENSIONS];
  gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, DIMENSIONS);
  for (int k = 0; k <= number; k++) gsl_qrng_get(sobol, x);
  gsl_qrng_free(sobol);
  *s = (grid_scene){.number = number, .bare = number % 3 == 2};
#define KEY(...) snprintf(s->text[s->n_sets++], sizeof s->text[0], __VA_ARGS__)
  KEY("circuit.deck=%s", s->bare ? "halfwave_bare" : "halfwave_snubbed");
  KEY("firing.angle=%.6gdeg", 5 + 170 * x[0]);
  KEY("firing.every=%s", x[1] < 0.34 ? "once" : x[1] < 0.67 ? "1" : "2");
  KEY("run.until=%.4gms", 20 + 80 * x[2]);
  KEY("supply.voltage=%.4gV", 100 + 400 * x[3]);
  KEY("supply.frequency=%.4gHz", 45 + 20 * x[4]);
  KEY("supply.resistance=%.4gohm", logarithmic(x[5], 0.05, 5));
  KEY("supply.inductance=%.4gmH", logarithmic(x[6], 0.03, 3));
  KEY("actuator.gap=%.4gmm", 3 + 7 * x[7]);
  KEY("actuator.inductance=%.4gH", logarithmic(x[8], 0.5, 6));
  KEY("actuator.resistance=%.4gohm", logarithmic(x[9], 10, 300));
  KEY("circuit.on_voltage=%.4gV", 0.5 + 2 * x[10]);
  KEY("circuit.on_resistance=%.4gohm", logarithmic(x[11], 2e-3, 0.5));
  s->off_ohm = 1e6 * logarithmic(x[12], 0.1, 10);
  KEY("circuit.off_resistance=%.4gMohm", s->off_ohm / 1e6);
  KEY("firing.pulse_width=%.4gms", 0.5 + 7.5 * x[19]);
  KEY("load.fraction=%.3g", x[18]);
  if (!s->bare) {
    KEY("circuit.r1=%.4gohm", logarithmic(x[13], 5, 10e3));
    KEY("circuit.c1=%.4gnF", logarithmic(x[14], 1, 1000));
    KEY("circuit.r2=%.4gohm", logarithmic(x[15], 10, 10e3));
    KEY("circuit.c2=%.4gnF", logarithmic(x[16], 1, 1000));
    KEY("circuit.varistor_voltage=%.4gV", 700 + 800 * x[17]);
  }
#undef KEY
  for (int k = 0; k < s->n_sets; k++) s->sets[k] = s->text[k];
}

/* ---- its truth ---- */

typedef struct truth {
  comparison *course;
  oracle_events events;
  bool left_out; /* it ends in pole contact */
} truth;

static truth truth_of(const grid_scene *s) {
  truth out = {0};
  vs_trial *t = vs_trial_read("paper", "circuit", s->sets);
  EXPECT(t->status == VS_OK, "scene %d: %s", s->number, t->err.text);
  oracle_scene o = oracle_of(&t->scene.setup, s->bare ? ORACLE_BARE : ORACLE_SNUBBED);
  out.course = compare_with_run(&o);
  out.left_out = !oracle_run(&o, out.course->table, &out.events);
  for (size_t n = 0; n < out.course->rows && !out.left_out; n++)
    out.left_out = out.course->table[n * ORACLE_COLUMNS + ORACLE_P] <= -o.actuator.gap_m;
  vs_trial_free(t);
  return out;
}

/* ---- a run beside it ---- */

typedef struct cell {
  comparison *course;
  double off_ohm;
  int channel_v, channel_i;
  bool on;
  size_t fired, ended;
  double error; /* in parts of the tolerance */
  const char *probe;
  long steps;
  bool changed; /* the sequence of events */
} cell;

/* Does the thyristor conduct? Then there is more than leakage, by more than the solver's error. */
static bool conducts(const cell *c, const vs_step *step) {
  double v = vs_step_channel(step, step->to->t_s, c->channel_v);
  double i = vs_step_channel(step, step->to->t_s, c->channel_i), leaks = v / c->off_ohm;
  return i - leaks > 1e-7 + 1e-3 * fabs(leaks);
}

static vs_status accept(void *ctx, const vs_step *step, vs_error *err) {
  cell *c = ctx;
  if (c->channel_v < 0) {
    c->channel_v = vs_channel_find(step->frame, "v_ak");
    c->channel_i = vs_channel_find(step->frame, "i_thyristor");
  }
  bool on = conducts(c, step);
  c->fired += on && !c->on;
  c->ended += !on && c->on;
  c->on = on;
  return compare_accept(c->course, step, err);
}

static cell run_cell(grid_scene *s, const truth *of, const char *tier, int decade) {
  char key[64];
  snprintf(key, sizeof key, "run.tolerance=1e%d", decade);
  s->sets[s->n_sets] = key;
  cell c = {.course = of->course,
            .off_ohm = s->off_ohm,
            .channel_v = -1,
            .channel_i = -1,
            .probe = "none"};
  compare_again(of->course);
  const vs_observer observer = {&c, accept};
  vs_trial *t = vs_trial_run("paper", tier, s->sets, &observer);
  EXPECT(t->status == VS_OK, "scene %d, tier %s, 1e%d: %s", s->number, tier, decade, t->err.text);
  c.error = compare_error(of->course, &c.probe) / pow(10, decade);
  c.steps = t->result.steps;
  c.changed = c.fired != of->events.fired || c.ended != of->events.ended;
  vs_trial_free(t);
  s->sets[s->n_sets] = NULL;
  return c;
}

/* ---- a few, and all ---- */

static void a_few(void) {
  double worst[COUNT(TIERS)] = {0};
  if (getenv("VS_LONG")) return;
  for (size_t k = 0; k < COUNT(FEW); k++) {
    grid_scene s;
    scene_at(FEW[k].number, &s);
    truth of = truth_of(&s);
    for (size_t tier = 0; tier < COUNT(TIERS); tier++) {
      cell c = run_cell(&s, &of, TIERS[tier].name, FEW[k].decade);
      EXPECT(c.error <= TIERS[tier].allowed,
             "scene %d, tier %s, tolerance 1e%d: %s is off by %.3g times that", FEW[k].number,
             TIERS[tier].name, FEW[k].decade, c.probe, c.error);
      EXPECT(!c.changed, "scene %d, tier %s, tolerance 1e%d: fires %zu times, in truth %zu",
             FEW[k].number, TIERS[tier].name, FEW[k].decade, c.fired, of.events.fired);
      worst[tier] = fmax(worst[tier], c.error);
    }
    compare_free(of.course);
  }
  printf(" off by %.3g and %.3g times the tolerance at most ", worst[0], worst[1]);
}

typedef struct tally {
  int cases, changed;
  double worst;
} tally;

static void run_scene(grid_scene *s, const truth *of, size_t tier, FILE *table, tally *sum) {
  for (int decade = COARSEST; decade >= FINEST; decade--) {
    cell c = run_cell(s, of, TIERS[tier].name, decade);
    fprintf(table, "%d,1e%d,%.3g,%s,%s,%ld,%zu,%zu", s->number, decade, c.error, c.probe,
            c.changed ? "changed" : "same", c.steps, c.fired, of->events.fired);
    for (int k = 0; k < s->n_sets; k++) fprintf(table, ",%s", strchr(s->text[k], '=') + 1);
    fputs("\n", table);
    fflush(table);
    sum->cases++;
    sum->changed += c.changed;
    if (c.changed) {
      printf(" scene %d at 1e%d fires %zu times for %zu;", s->number, decade, c.fired,
             of->events.fired);
      continue;
    }
    sum->worst = fmax(sum->worst, c.error);
    EXPECT(c.error <= TIERS[tier].allowed,
           "scene %d, tier %s, tolerance 1e%d: %s is off by %.3g times that", s->number,
           TIERS[tier].name, decade, c.probe, c.error);
  }
}

static void all_of_them(void) {
  tally sum[COUNT(TIERS)] = {0};
  FILE *table[COUNT(TIERS)];
  if (!getenv("VS_LONG")) return;
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    table[k] = fopen(TIERS[k].table, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(table[k]);
    fputs(
        "scene,tolerance,worst_error_per_tolerance,probe,sequence,steps,fired,fired_in_truth,deck,"
        "angle,every,until,voltage,frequency,r_source,l_source,gap,inductance,resistance,"
        "on_voltage,on_resistance,off_resistance,pulse_width,fraction,r1,c1,r2,c2,"
        "varistor_voltage\n",
        table[k]);
  }
  for (int number = 0, kept = 0; kept < SCENES; number++) {
    grid_scene s;
    scene_at(number, &s);
    truth of = truth_of(&s);
    if (!of.left_out) {
      kept++;
      for (size_t k = 0; k < COUNT(TIERS); k++) run_scene(&s, &of, k, table[k], &sum[k]);
    }
    compare_free(of.course);
  }
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    fclose(table[k]);
    printf(" tier %s is off by %.3g times the tolerance at most, %d of %d cases with other events ",
           TIERS[k].name, sum[k].worst, sum[k].changed, sum[k].cases);
    CU_ASSERT(sum[k].changed <= MOST_CHANGED * sum[k].cases);
  }
}

/* ---- some of tools/metamorphic ---- */

/* Scenes that tools/metamorphic drew, with fewer keys. Each is compared with itself at a finer
 * tolerance, and was off by `was` of its tolerances before the steps knew what is named. */
static const struct {
  const char *what;
  double tolerance, finer, until_s, was;
  const char *scene;
} DRAWN[] = {
    {"a shaker's thyristor lets go (vs_swing_instant)", 0.0001, 10, 0.016, 19,
     "{'machine': {'model': 'lds_v203_piece'}, 'supply': {'voltage': '5.2 V', 'phase': "
     "'-100 deg', 'kind': 'sine'}, 'firing': {'angle': '111 deg', 'pulse_width': '1.81 "
     "ms', 'valve': 'thyristor'}, 'circuit': {'deck': 'halfwave_paper', 'c1': '43 nF'}, "
     "'actuator': {'gap': '5.6 mm'}}"},
    {"the voltage comes back within t_q (longest_strained)", 0.0001, 100, 0.008, 3.1,
     "{'machine': {'model': 'conveyor', 'mount_4': ['217.41 mm', '16.181 mm'], "
     "'mount_damping_x': '0.123987 N.s/m'}, 'supply': {'voltage': '347.46 V', "
     "'resistance': '0.0654385 ohm', 'decoupling': '1.21712 mH'}, 'firing': {'every': 1}, "
     "'circuit': {'deck': 'halfwave_paper', 'line_voltage': '200.442 V', 'r1': '7.81746 "
     "kohm', 'c1': '609.333 nF', 'r2': '0.127586 kohm', 'fuse_1': 'FWP-50A14F', "
     "'critical_dvdt': '138.502 V/us', 'blocking_voltage': '766.86 V', 'gate_inductance': "
     "'8.10861 mH', 'gate_primary_r': '1.38314 ohm', 'gate_secondary_r': '1.39399 ohm'}, "
     "'load': {'fraction': '0.712894'}, 'control': {'law': 'amplitude', 'sensor': 'p', "
     "'setpoint': '0.722088 mm', 'gain': '0.56995 deg/mm', 'integral': '77.9061 deg/mm.s', "
     "'angle': ['90 deg', '175 deg']}, 'instruments': {}}"},
    {"a chopper's edges add up (OF_MODULATED)", 0.0001, 100, 0.00386928, 11,
     "{'machine': {'model': 'fixed_base'}, 'circuit': {'deck': 'chopper'}}"},
    {"a coil is cut off ahead of its firing (vs_setup_coil_cut)", 0.001, 100, 0.0062, 24,
     "{'machine': {'model': 'solenoid'}, 'supply': {'voltage': '10 V', 'kind': 'sine'}, "
     "'firing': {'valve': 'thyristor', 'angle': '107 deg'}, 'events': {'e0': {'kind': "
     "'open', 'cycle': '1', 'angle': '105 deg', 'element': 'Xeva'}}, 'circuit': {'deck': "
     "'halfwave_snubbed', 'c1': '500 nF'}}"},
    {"a sag ends a small conduction (longest_behind_an_edge)", 0.0001, 10, 0.01, 11,
     "{'machine': {'model': 'conveyor'}, 'supply': {'voltage': '339 V', 'resistance': "
     "'1.74 ohm'}, 'firing': {'pulse_width': '21 us'}, 'events': {'e0': {'kind': 'sag', "
     "'at': '5.9812 ms', 'duration': '20 ms', 'level': '84.3 %'}}}"},
    {"a step beyond a latch's firing is rejected (longest_latching)", 0.0001, 100, 0.0233149, 16,
     "{'machine': {'model': 'two_mass'}, 'supply': {'voltage': '150.41 V', 'frequency': '44.066 "
     "Hz', 'phase': '-124.706 deg', 'inductance': '1.513 mH'}, 'firing': {'angle': '88.8046 deg', "
     "'pulse_width': '0.0273491 ms', 'every': '3', 'burst_duty': '17.5219 %'}, 'circuit': "
     "{'deck': 'halfwave_paper', 'r1': '12.9604 kohm', 'r2': '0.107217 kohm', 'thyristor': "
     "'latch', 'varistor_3': 's14k510', 'fuse_2': 'A070gRB10T13', 'transformer_saturates': "
     "'0.775218 Wb', 'gate_turns': '1.60562', 'gate_leakage': '98.8708 uH', 'gate_primary_r': "
     "'1.35908 ohm', 'gate_secondary_r': '0.830043 ohm', 'gate_r3': '43.073 ohm'}, 'actuator': "
     "{'leakage': '0.0641801 H'}}"},
    {"a thyristor lets go of a current that rises, behind its sub-pulse (is_fed)", 0.0001, 10,
     0.0079, 41,
     "{'machine': {'model': 'solenoid', 'mu_initial': '396.871', 'flux_density': '1.26666 "
     "Wb/m2'}, 'supply': {'voltage': '5.9059 V', 'kind': 'sine', 'frequency': '45.803 "
     "Hz'}, 'firing': {'valve': 'thyristor', 'angle': '119.408 deg', 'every': '1'}, "
     "'circuit': {'deck': 'halfwave_paper', 'varistor_1': 's20k460', 'fuse_1': "
     "'FWP-50A14F', 'latching_current': '55.9863 mA', 'critical_dvdt': '138.302 V/us', "
     "'recovered_charge': '8.55093 A*us', 'test_slope': '26.0282 A/us', 'gate_supply': "
     "'26.6242 V', 'gate_coupling': '43.9281 pF', 'varistor_2_scale': '0.789764'}}"},
    {"a gate drive's core saturates below the latching current (COLLAPSES_S)", 0.0001, 10, 0.0048,
     330,
     "{'machine': {'model': 'solenoid'}, 'supply': {'voltage': '7.238 V', 'kind': 'sine', "
     "'frequency': '54.675 Hz'}, 'firing': {'valve': 'thyristor', 'angle': '89.0094 deg', "
     "'burst_duty': '59.5854 %'}, 'circuit': {'deck': 'halfwave_paper'}}"},
    {"a latch discharges a varistor and is told to let go (has_fired_late)", 0.0001, 10, 0.012, 7.1,
     "{'machine': {'model': 'two_mass'}, 'supply': {'voltage': '77.3688 V', 'frequency': "
     "'44.066 Hz', 'phase': '-124.706 deg', 'inductance': '1.513 mH'}, 'firing': "
     "{'angle': '65.314 deg', 'pulse_width': '0.26787 ms', 'every': '3', 'burst_duty': "
     "'17.5219 %'}, 'circuit': {'deck': 'halfwave_paper', 'r1': '5.82195 kohm', 'r2': "
     "'0.380425 kohm', 'thyristor': 'latch', 'varistor_3': 's20k510', 'fuse_2': "
     "'A070gRB10T13', 'transformer_saturates': '0.775218 Wb', 'gate_turns': '1.60562', "
     "'gate_leakage': '150.032 uH', 'gate_primary_r': '1.35908 ohm', 'gate_secondary_r': "
     "'0.830043 ohm', 'gate_r3': '43.073 ohm', 'c1': '50.62 nF', 'c2': '132.94 nF', "
     "'varistor_1': 's20k510'}, 'actuator': {'leakage': '0.0641801 H'}}"},
    {"a latch is fired anew by its second sub-pulse (is_driven)", 0.00001, 10, 0.012, 31,
     "{'machine': {'model': 'two_mass'}, 'supply': {'voltage': '213.713 V', 'frequency': "
     "'44.066 Hz', 'phase': '-124.706 deg', 'inductance': '1.513 mH'}, 'firing': "
     "{'angle': '56.396 deg', 'pulse_width': '0.22443 ms', 'every': '3', 'burst_duty': "
     "'17.5219 %'}, 'circuit': {'deck': 'halfwave_paper', 'r1': '10.4576 kohm', 'r2': "
     "'0.0596214 kohm', 'thyristor': 'latch', 'varistor_3': 's20k510', 'fuse_2': "
     "'A070gRB10T13', 'transformer_saturates': '0.775218 Wb', 'gate_turns': '1.60562', "
     "'gate_leakage': '38.4266 uH', 'gate_primary_r': '1.35908 ohm', 'gate_secondary_r': "
     "'0.830043 ohm', 'gate_r3': '43.073 ohm', 'c1': '34.051 nF', 'c2': '56.485 nF', "
     "'varistor_1': 'v511da40'}, 'actuator': {'leakage': '0.0641801 H'}}"},
    {"a run ends 0.2 ms behind its firing (fired)", 0.0001, 10, 0.01, 9.7,
     "{'machine': {'model': 'two_mass'}, 'supply': {'voltage': '80.2932 V', 'frequency': "
     "'44.066 Hz', 'phase': '-124.706 deg', 'inductance': '1.513 mH'}, 'firing': "
     "{'angle': '30.359 deg', 'pulse_width': '0.28918 ms', 'every': '3', 'burst_duty': "
     "'17.5219 %'}, 'circuit': {'deck': 'halfwave_paper', 'r1': '5.37876 kohm', 'r2': "
     "'0.11143 kohm', 'thyristor': 'latch', 'varistor_3': 'v511da40', 'fuse_2': "
     "'A070gRB10T13', 'transformer_saturates': '0.775218 Wb', 'gate_turns': '1.60562', "
     "'gate_leakage': '111.068 uH', 'gate_primary_r': '1.35908 ohm', 'gate_secondary_r': "
     "'0.830043 ohm', 'gate_r3': '43.073 ohm', 'c1': '103.47 nF', 'c2': '75.866 nF', "
     "'varistor_1': 's14k510'}, 'actuator': {'leakage': '0.0641801 H'}}"},
};

/* What docs/accuracy.md promises. The finer run has errors of its own of a tenth of that or less.
 */
static const double PROMISED = 2.4;

enum { SAMPLES = 2000, CHANNELS = 3 };
static const int CHANNEL[CHANNELS] = {VS_CH_Q, VS_CH_I, VS_CH_FORCE};

typedef struct drawn_run {
  double y[SAMPLES + 1][CHANNELS], until_s;
  int next;
} drawn_run;

static vs_status note_drawn(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  drawn_run *r = ctx;
  double end_s = step->to->t_s;
  if (step->from->t_s == 0) r->next = 0; /* the ladder may begin anew */
  for (; r->next <= SAMPLES && r->until_s * r->next / SAMPLES <= end_s * (1 + 1e-12); r->next++) {
    double at_s = fmin(r->until_s * r->next / SAMPLES, end_s);
    for (int k = 0; k < CHANNELS; k++) r->y[r->next][k] = vs_step_channel(step, at_s, CHANNEL[k]);
  }
  return VS_OK;
}

static drawn_run *run_drawn(size_t n, double tolerance) {
  char sets[2][40];
  const char *list[] = {sets[0], sets[1], "run.verify=never", NULL};
  drawn_run *r = vs_alloc(1, sizeof *r);
  const vs_observer observer = {r, note_drawn};
  r->until_s = DRAWN[n].until_s;
  snprintf(sets[0], sizeof sets[0], "run.tolerance=%g", tolerance);
  snprintf(sets[1], sizeof sets[1], "run.until=%.9g ms", 1e3 * DRAWN[n].until_s);
  write_file("drawn.yaml", DRAWN[n].scene);
  vs_trial *t = vs_trial_run("drawn.yaml", NULL, list, &observer);
  EXPECT(t->status == VS_OK && r->next == SAMPLES + 1, "%s at %g: %d of %d samples. %s",
         DRAWN[n].what, tolerance, r->next, SAMPLES + 1, t->err.text);
  vs_trial_free(t);
  return r;
}

static void drawn(void) {
  for (size_t n = 0; n < COUNT(DRAWN); n++) {
    double tolerance = DRAWN[n].tolerance;
    drawn_run *one = run_drawn(n, tolerance), *fine = run_drawn(n, tolerance / DRAWN[n].finer);
    for (int k = 0; k < CHANNELS; k++) {
      double off = 0, peak = 0;
      for (int m = 0; m <= SAMPLES; m++) {
        off = fmax(off, fabs(one->y[m][k] - fine->y[m][k]));
        peak = fmax(peak, fabs(fine->y[m][k]));
      }
      EXPECT(off <= PROMISED * tolerance * peak, "%s: %s is off by %.3g tolerances; it was by %g",
             DRAWN[n].what, k ? k > 1 ? "force" : "i" : "the first coordinate",
             off / peak / tolerance, DRAWN[n].was);
    }
    free(one);
    free(fine);
  }
}

static void note_strained(void *ctx, const char *text) {
  if (strstr(text, "phi, i and force may be off by more than run.tolerance: a thyristor's voltage"))
    ++*(int *)ctx;
}

static int told_of_strained(const char *const *sets) {
  int told = 0;
  write_file("drawn.yaml", DRAWN[1].scene);
  vs_trial *t = vs_trial_run("drawn.yaml", NULL, sets, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  if (!t->status) vs_result_warnings(&t->result, note_strained, &told);
  vs_trial_free(t);
  return told;
}

/* The scene where the voltage comes back within t_q is off by 1.7 tolerances in the force and
 * by 3.9 in phi at 1e-4. With another thyristor a firing by what charge is left comes in the finer
 * run alone, and the force is off by 112. No steps settle that, so it is told. Where the snubber
 * rings less nothing is told: there it is 0.1. */
static void strained_is_told(void) {
  const char *sets[] = {"run.tolerance=1e-4",
                        "run.until=8ms",
                        "run.verify=never",
                        "circuit.r1=4.15162 kohm",
                        "circuit.blocking_voltage=485.564 V",
                        NULL};
  CU_ASSERT_EQUAL(told_of_strained(sets), 1);
  sets[3] = NULL;
  CU_ASSERT_EQUAL(told_of_strained(sets), 1);
  sets[3] = "circuit.r1=15.4741 kohm";
  sets[4] = "supply.voltage=415.81 V";
  CU_ASSERT_EQUAL(told_of_strained(sets), 0);
}

static void note_letting_go(void *ctx, const char *text) {
  if (strstr(text, "phi by them, may be off by more than run.tolerance: the coil got "))
    ++*(int *)ctx;
}

static int told_of_letting_go(const char *text) {
  int told = 0;
  write_file("drawn.yaml", text);
  vs_trial *t = vs_trial_run("drawn.yaml", NULL, NULL, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  if (!t->status) vs_result_warnings(&t->result, note_letting_go, &told);
  vs_trial_free(t);
  return told;
}

/* A shaker of 0.8 mH gets 26 mA: the mains bring a tenth of that in 0.5 us, and the current is off
 * by 2.85 tolerances, with steps of 25 ns. A solenoid's 10 mA stand for nine times the flux
 * linkage: that is off by 0.7, and no warning is due. */
static void letting_go_is_told(void) {
  CU_ASSERT_EQUAL(
      told_of_letting_go(
          "{'machine': {'model': 'lds_v203_piece', 'mass': '0.0421819 kg', 'stiffness': '2871.09 "
          "N/m'}, 'supply': {'voltage': '3.3661 V', 'kind': 'sine', 'frequency': '66.6573 Hz', "
          "'phase': '-74.1719 deg'}, 'firing': {'valve': 'thyristor', 'angle': '40.0588 deg', "
          "'pulse_width': '0.0206506 ms'}, 'circuit': {'deck': 'bridge_halfcontrolled', 'r1': "
          "'0.16104 kohm', 'thyristor': '12TTS08S'}, 'run': {'until': '6 ms', 'tolerance': 1e-3, "
          "'verify': 'never'}}"),
      1);
  CU_ASSERT_EQUAL(
      told_of_letting_go("{'machine': {'model': 'solenoid'}, 'supply': {'voltage': '5.9059 V', "
                         "'kind': 'sine'}, 'firing': {'valve': 'thyristor', 'angle': '119 deg'}, "
                         "'circuit': {'deck': 'halfwave_paper'}, 'run': {'until': '8 ms', "
                         "'tolerance': 1e-3, 'verify': 'never'}}"),
      0);
}

static const vs_test TESTS[] = {
    {"a few scenes", a_few},
    {"what charge is left is told", strained_is_told},
    {"what some nanoseconds count in is told", letting_go_is_told},
    {"drawn scenes", drawn},
    {"all scenes (long)", all_of_them},
};
VS_SUITE_MAIN("tolerance_grid", TESTS)
