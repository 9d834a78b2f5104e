/* SPDX-License-Identifier: GPL-3.0-or-later
 * Pulse-width modulation: edges against their closed form and as roots; dead time and shift; the
 * current of a coil behind an ideal switch against the closed form of a first-order circuit; the
 * shipped decks against plain ngspice on their export; what is refused, and what is said. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/gate.h"
#include "engine/pwm.h"
#include "engine/scene_event.h"
#include "program.h"
#include "suite.h"

static const vs_pwm_switch HIGH = {0, false}, LOW = {0, true};

/* The value of a signal behind t, and at t, where an edge has not acted yet. */
static bool behind(const vs_pwm_values *p, vs_pwm_switch of, double t_s) {
  return vs_pwm_is_on(p, of, vs_gate_of_step(t_s, t_s));
}

/* ---- edges ---- */

/* With a constant duty the upper switch is on around the middle of its pulse, n/f: it ends at
 * (n + duty/2)/f and begins at (n + 1 - duty/2)/f + dead_time, the lower one the other way round.
 * A step's instants are told apart from vs_scene_event_rounding on, which is the tolerance. */
static void closed_form(void) {
  static const double CYCLES[] = {0, 1, 7, 12345, 1e6, 1e9};
  static const double DUTIES[] = {0.1, 0.5, 0.87}, DEAD[] = {0, 1.5e-6};
  for (size_t k = 0; k < COUNT(CYCLES) * COUNT(DUTIES) * COUNT(DEAD); k++) {
    double n = CYCLES[k / 6], d = DUTIES[k / 2 % 3], dead = DEAD[k % 2], f = 20e3;
    const vs_pwm_values p = {.carrier_hz = f, .duty = {.first = d}, .dead_s = dead};
    double ends = (n + d / 2) / f, begins = (n + 1 - d / 2) / f,
           slack = vs_scene_event_rounding(ends);
    CLOSE_OF(vs_pwm_edge(&p, HIGH, n / f), ends, 1, slack);
    CLOSE_OF(vs_pwm_edge(&p, HIGH, ends), begins + dead, 1, slack);
    CLOSE_OF(vs_pwm_edge(&p, LOW, n / f), ends + dead, 1, slack);
    CLOSE_OF(vs_pwm_edge(&p, LOW, ends + dead), begins, 1, slack);
    double edge = vs_pwm_edge(&p, HIGH, n / f);
    CU_ASSERT(vs_pwm_is_on(&p, HIGH, edge) && !behind(&p, HIGH, edge));
    CU_ASSERT(!vs_pwm_is_on(&p, LOW, edge) && behind(&p, LOW, edge) == (dead == 0));
  }
}

/* The reference as the header writes it. */
static double reference(const vs_pwm_values *p, double shift_rad, double t_s) {
  double turns = fmod(p->frequency_hz * t_s, 1);
  return vs_field_profile_at(&p->duty, t_s) +
         p->depth / 2 * sin(2 * M_PI * turns + p->phase_rad - shift_rad);
}

static double carrier(const vs_pwm_values *p, double t_s) {
  double turns = fmod(p->carrier_hz * t_s, 1);
  return turns < 0.5 ? 2 * turns : 2 - 2 * turns;
}

static vs_pwm_values modulated(void) {
  return (vs_pwm_values){.carrier_hz = 5e3,
                         .duty = {.first = 0.5},
                         .depth = 0.96,
                         .frequency_hz = 51,
                         .phase_rad = 0.3,
                         .dead_s = 1e-6};
}

/* At a crossing reference and carrier differ by what the rounding of the instant makes of the
 * carrier's slope, 2 f times some 1e-16 t; the sine's angle is as exact. */
static void roots(void) {
  vs_pwm_values p = modulated();
  double worst = 0;
  for (int table = 0; table < 2; table++) {
    for (double k = 0; k < 2e5; k += k < 2000 ? 1 : 997)
      for (double shift = 0; shift < 4; shift += M_PI) {
        double at = vs_pwm_crossing(&p, shift, k), flank = 1 / (2 * p.carrier_hz);
        CU_ASSERT(at >= k * flank * (1 - 1e-15) && at <= (k + 1) * flank * (1 + 1e-15));
        double allowed = 4 * p.carrier_hz * 4e-16 * at + 2e-15;
        worst = fmax(worst, fabs(reference(&p, shift, at) - carrier(&p, at)) / allowed);
      }
    p.depth = 0.2; /* and with a soft start */
    p.duty = (vs_field_profile){
        .first = 0.1, .count = 3, .at_s = {0, 0.1, 0.2}, .value = {0.1, 0.5, 0.4}};
  }
  printf(" residual %.2g of what is allowed", worst);
  EXPECT(worst <= 1, "a crossing is off by %.3g of what is allowed", worst);
}

/* Each edge changes the signal, and there is no other change; a pulse of one switch begins the dead
 * time behind the end of the other's; a reference shifted by half a turn is that of the other sign.
 */
static void dead_time_and_shift(void) {
  vs_pwm_values p = modulated(), other = p;
  other.phase_rad += M_PI;
  double ended[2] = {NAN, NAN}, t = 0;
  int edges = 0;
  for (int n = 0; n < 4000; n++) {
    double high = vs_pwm_edge(&p, HIGH, t), low = vs_pwm_edge(&p, LOW, t);
    bool is_low = low < high;
    double next = fmin(high, low);
    for (int m = 1; m < 8; m++) /* between the edges nothing changes */
      CU_ASSERT(vs_pwm_is_on(&p, HIGH, t + m * (next - t) / 8) == behind(&p, HIGH, t));
    CU_ASSERT(!(vs_pwm_is_on(&p, HIGH, next) && vs_pwm_is_on(&p, LOW, next)));
    vs_pwm_switch of = is_low ? LOW : HIGH;
    bool begins = behind(&p, of, next);
    EXPECT(begins != vs_pwm_is_on(&p, of, next), "no change at %.9g", next);
    if (!begins) ended[is_low] = next;
    if (begins && !isnan(ended[!is_low])) CLOSE_OF(next - ended[!is_low], p.dead_s, 1, 1e-14);
    edges++;
    t = next;
  }
  EXPECT(edges / t > 3.99 * p.carrier_hz, "%d edges in %g s", edges, t);
  const vs_pwm_switch turned = {M_PI, false};
  for (double k = 0; k < 500; k++)
    CLOSE_OF(vs_pwm_crossing(&p, M_PI, k), vs_pwm_crossing(&other, 0, k), 1, 1e-15);
  CU_ASSERT(vs_pwm_edge(&p, turned, 0.1) == vs_pwm_edge(&p, turned, 0.1));
}

/* Beyond the ends of the range a pulse is shorter than the dead time: it is left out, and the
 * other switch begins again the dead time behind it. At 0 and 1 nothing ever changes. */
static void short_pulses(void) {
  vs_pwm_values p = modulated();
  char text[256];
  p.depth = 1;
  int shortest = 0, seconds = 0;
  for (double t = 0; t < 0.2; seconds++) {
    double begins = vs_pwm_edge(&p, LOW, t), ends = vs_pwm_edge(&p, LOW, begins);
    if (behind(&p, LOW, begins) && !behind(&p, LOW, ends)) shortest += ends - begins < 1e-6;
    t = begins;
  }
  CU_ASSERT(seconds > 1000);
  CU_ASSERT(vs_pwm_drops(&p, true, text, sizeof text) && strstr(text, "pwm_low"));
  CU_ASSERT(vs_pwm_drops(&p, false, text, sizeof text) && !strstr(text, "pwm_low"));
  p.depth = 0.96; /* 4 us at least */
  CU_ASSERT(!vs_pwm_drops(&p, true, text, sizeof text));
  for (int full = 0; full < 2; full++) {
    const vs_pwm_values always = {.carrier_hz = 1e4, .duty = {.first = full}, .dead_s = 1e-6};
    for (double t = 0; t < 1e-3; t += 0.7e-6) {
      CU_ASSERT(vs_pwm_is_on(&always, HIGH, t + 2e-4) == full);
      CU_ASSERT(vs_pwm_is_on(&always, LOW, t + 2e-4) == !full);
    }
    CU_ASSERT(vs_pwm_edge(&always, HIGH, 0.1) <= 0.1 + 3e-4);
  }
}

/* One pulse: the switch is on from behind its first edge up to its last one, and a lower one the
 * rest of the time, less the dead time. */
static void one_pulse(void) {
  const vs_pwm_values p = {.on_s = 5e-3, .off_s = 60e-3, .dead_s = 1e-3}, open = {.on_s = 5e-3},
                      first = {.off_s = 60e-3};
  CU_ASSERT(vs_pwm_edge(&p, HIGH, 0) == 6e-3 && vs_pwm_edge(&p, HIGH, 6e-3) == 60e-3);
  CU_ASSERT(vs_pwm_edge(&p, LOW, 0) == 5e-3 && vs_pwm_edge(&p, LOW, 5e-3) == 61e-3);
  CU_ASSERT(isinf(vs_pwm_edge(&p, LOW, 61e-3)) && isinf(vs_pwm_edge(&open, HIGH, 5e-3)));
  CU_ASSERT(!vs_pwm_is_on(&p, HIGH, 6e-3) && vs_pwm_is_on(&p, HIGH, 6.1e-3));
  CU_ASSERT(vs_pwm_is_on(&p, HIGH, 60e-3) && !vs_pwm_is_on(&p, HIGH, 60.1e-3));
  CU_ASSERT(vs_pwm_is_on(&p, LOW, 5e-3) && !vs_pwm_is_on(&p, LOW, 60.5e-3));
  CU_ASSERT(vs_pwm_is_on(&open, HIGH, 1e9) && vs_pwm_is_on(&first, HIGH, 0));
}

/* ---- the current of a coil ---- */

static void write_switch(void) {
  write_file("ideal.cir", "*$ title an ideal switch and diode before the coil\n"
                          "*$ port pwm = Von\n*$ probe v_on = v(on) V\n"
                          "Von on 0 external\nEsw a 0 on 0 48\nXeva a 0 eva\n");
}

/* i' = (U s(t) - R i)/L, s = 1 while the switch is on: exponentials from edge to edge. Gives the
 * time since the last edge, too. */
static double current(const vs_pwm_values *p, double t_s, double *since_s) {
  static const double u_v = 48, r_ohm = 24, l_h = 20e-3;
  double i = 0, at = 0;
  while (at < t_s) {
    double to = fmin(vs_pwm_edge(p, HIGH, at), t_s);
    *since_s = to - at;
    double goal = behind(p, HIGH, at) ? u_v / r_ohm : 0;
    i = goal + (i - goal) * exp(-(to - at) * r_ohm / l_h);
    at = to;
  }
  return i;
}

/* The solver's tolerance is a tenth of run.tolerance, and of the second order of its rule nothing
 * is lost at the edges, where it begins anew: so the current stays within run.tolerance of its
 * peak. Within the first step behind an edge, of up to BENDS_S, a row lies on a cubic that bends
 * where the current has a corner; there 1e-3 are allowed. */
static const double BENDS_S = 1e-6;

static void ripple(void) {
  static const char *const CARRIERS[] = {"5 kHz", "20 kHz"};
  write_switch();
  for (int k = 0; k < 4; k++) {
    bool sine = k / 2;
    vs_pwm_values p = {.carrier_hz = k % 2 ? 20e3 : 5e3, .duty = {.first = sine ? 0.5 : 0.3}};
    if (sine) p.depth = 0.8, p.frequency_hz = 51;
    ran r = run("run paper --set circuit.deck=ideal.cir --set actuator.law=moving_coil --set "
                "'actuator.emf_constant=0 V.s/m' --set 'actuator.inductance=20 mH' --set "
                "'actuator.resistance=24 ohm' --set 'run={until: 5 ms, sample: 7 us}' --set "
                "'record=[i]' --set 'pwm={carrier: %s, duty: %g, depth: %g, frequency: 51 Hz}' "
                "--quiet -o out",
                CARRIERS[k % 2], p.duty.first, p.depth);
    EXPECT(r.status == 0, "%s", r.err);
    free_ran(&r);
    char *text = read_file("out/run.csv"), *rest = text, *line;
    double worst = 0, between = 0, peak = 0, t, i, since = 0;
    int rows = 0;
    while ((line = strsep(&rest, "\n")))
      if (sscanf(line, "%lf,%lf", &t, &i) == 2) {
        double off = fabs(i - current(&p, t, &since));
        if (since > BENDS_S) worst = fmax(worst, off);
        between = fmax(between, off);
        peak = fmax(peak, fabs(i));
        rows++;
      }
    free(text);
    printf(" %.1e (%.1e)", worst / peak, between / peak);
    EXPECT(between <= 1e-3 * peak, "%s: %.2e between two steps", CARRIERS[k % 2], between / peak);
    EXPECT(rows > 700 && worst <= 1e-4 * peak, "%s: off by %.2e of the peak, %d rows",
           CARRIERS[k % 2], worst / peak, rows);
  }
}

/* ---- against plain ngspice ---- */

/* "name = VALUE" in x.log; NaN: it is not there. */
static double told(const char *log, const char *name) {
  char wanted[64];
  double value = NAN;
  snprintf(wanted, sizeof wanted, "\n%s ", name);
  const char *at = strstr(log, wanted), *sign = at ? strchr(at, '=') : NULL;
  if (sign) sscanf(sign + 1, "%lf", &value);
  EXPECT(at, "ngspice does not tell %s", name);
  return value;
}

/* Exports to x.cir, with the extremes of these columns measured besides, and runs ngspice. Returns
 * its words. */
static char *plain(const char *scene, const char *sets, const char *const *columns, size_t count) {
  ran r = run("export %s %s -o x.cir", scene, sets);
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  char *text = read_file("x.cir"), *at = strstr(text, "\nlinearize ");
  FILE *f = fopen("y.cir", "w");
  CU_ASSERT_FATAL(at && f);
  fprintf(f, "%.*s\n", (int)(at - text), text);
  for (size_t k = 0; k < count; k++)
    fprintf(f, "meas tran max_%zu max %s\nmeas tran min_%zu min %s\n", k, columns[k], k,
            columns[k]);
  fputs(at, f);
  fclose(f);
  free(text);
  int status = system("timeout 300 ngspice -b y.cir >x.log 2>&1");
  EXPECT(status == 0, "ngspice ends with %d", status);
  return read_file("x.log");
}

/* Columns of the export and the probes they are of. */
typedef struct pair {
  const char *column, *probe;
} pair;

static void agree(const char *scene, const char *sets, const pair *pairs, size_t count, int line) {
  const char *columns[8];
  for (size_t k = 0; k < count; k++) columns[k] = pairs[k].column;
  char *log = plain(scene, sets, columns, count), name[32];
  ran r = run("run %s %s --json --quiet", scene, sets);
  expect(r.status == 0 || r.status == 3, line, "%s", r.err);
  vs_close(told(log, "i_peak_a"), json_measure(r.out, "i_peak", ""),
           json_measure(r.out, "i_peak", ""), 1e-3, "i_peak", line);
  vs_close(told(log, "force_peak_n"), json_measure(r.out, "force_peak", ""),
           json_measure(r.out, "force_peak", ""), 1e-3, "force_peak", line);
  for (size_t k = 0; k < count; k++) {
    snprintf(name, sizeof name, "max_%zu", k);
    double max = told(log, name), own_max = json_measure(r.out, pairs[k].probe, "_max");
    snprintf(name, sizeof name, "min_%zu", k);
    double min = told(log, name), own_min = json_measure(r.out, pairs[k].probe, "_min");
    double peak = fmax(fabs(own_max), fabs(own_min));
    double off = fmax(fabs(max - own_max), fabs(min - own_min)) / peak;
    printf(" %s %.1e", pairs[k].probe, off);
    expect(off <= 1e-3, line, "%s, %s: off by %.2e of its peak", sets, pairs[k].probe, off);
  }
  free_ran(&r);
  free(log);
}
#define AGREE(scene, sets, pairs) agree(scene, sets, pairs, COUNT(pairs), __LINE__)

/* Fills `row` with the named column of a table, whose cells any of these characters part. Returns
 * how many rows there are, at most `most`. */
static size_t read_column(const char *path, const char *parts, const char *name, double *row,
                          size_t most) {
  char *text = read_file(path), *rest = text, *line, *word;
  size_t n = 0;
  int column = -1;
  while ((line = strsep(&rest, "\n")) && n < most) {
    int at = 0;
    for (char *cells = line; (word = strsep(&cells, parts));) {
      if (!*word) continue;
      if (n == 0 && column < 0 && !strcmp(word, name)) {
        column = at;
        break;
      }
      if (at++ == column) row[n++] = atof(word);
    }
  }
  free(text);
  return n;
}

/* At t = 0 the supply and an empty snubber make v_link ring for some nanoseconds, as high as the
 * first step makes it, and plain ngspice takes that one without a look at the error. So v_link is
 * compared behind the first 20 us, at samples of 1 us. Its ripple is a thousandth of it, and the
 * difference is held against that: 0.1 % in the mean of all samples was measured, and three times
 * as much is allowed. Single samples differ more, where they lie in the ring of an edge. */
static void link_agrees(const char *sets, int line) {
  enum { MOST = 20000, FROM = 20 };
  double *own = vs_alloc(MOST, sizeof *own), *other = vs_alloc(MOST, sizeof *other);
  double most = -INFINITY, least = INFINITY, off = 0;
  char more[256];
  snprintf(more, sizeof more, "%s --set 'run.sample=1 us'", sets);
  free(plain("chopper", more, NULL, 0));
  ran r =
      run("run chopper %s --set 'record=[v_link]' --set run.verify=never --quiet -o link", more);
  expect(r.status == 0, line, "%s", r.err);
  free_ran(&r);
  size_t n = read_column("link/run.csv", ",", "v_link_v", own, MOST);
  size_t count = read_column("x.txt", " ", "v_link_v", other, MOST);
  for (size_t k = FROM; k < n && k < count; k++) {
    most = fmax(most, own[k]);
    least = fmin(least, own[k]);
    off += fabs(own[k] - other[k]) / (double)(n - FROM);
  }
  printf(" v_link %.1e of its ripple", off / (most - least));
  expect(n > 1000 && n == count && off < 0.003 * (most - least), line,
         "%s: v_link is off by %.2e V in the mean of %zu and %zu samples, with a ripple of %.2e V",
         sets, off, n, count, most - least);
  remove_tree("link");
  free(own);
  free(other);
}

static void chopper(void) {
  static const pair PAIRS[] = {{"v_ds_v", "v_ds"}, {"p_m", "p"}};
  static const char *const SETS[] = {
      "--set 'run.until=12 ms' --set 'pwm={carrier: 5 kHz, duty: 0.4}'",
      "--set 'run.until=4 ms' --set 'pwm.carrier=20 kHz'"};
  for (size_t k = 0; k < COUNT(SETS); k++) {
    AGREE("chopper", SETS[k], PAIRS);
    link_agrees(SETS[k], __LINE__);
  }
}

static void bridge(void) {
  static const pair PAIRS[] = {{"v_link_v", "v_link"}, {"i_source_a", "i_source"}, {"p_m", "p"}};
  AGREE("bridge_link", "--set 'run.until=8 ms' --set 'pwm.carrier=5 kHz'", PAIRS);
  /* at the sine's largest value, with the link charged: else the coil has no current to speak of */
  AGREE("bridge_link",
        "--set 'run.until=2 ms' --set 'pwm.carrier=20 kHz' --set 'pwm.phase=90 deg' "
        "--set 'circuit.electrolytic_start=300 V'",
        PAIRS);
}

/* ---- what is refused, and what is said ---- */

static void refused(void) {
  static const struct {
    const char *words, *what;
  } ROWS[] = {
      {"run chopper --tier switched",
       "circuit.deck: tier switched (asked for by --tier) has no port pwm"},
      {"steady chopper", "port pwm"},
      {"steady bridge_link", "for which no periodic orbit is sought"},
      {"run bridge_link --set start=steady", "no orbit is sought where the deck has a port pwm"},
      {"run chopper --set load.fraction=auto", "no orbit is sought where the deck has a port pwm"},
      {"run chopper --set firing.angle=90deg",
       "firing.angle: the deck has no port gate, and nothing fires"},
      {"run bridge_link --set control.law=phase", "control: "},
      {"run chopper --set pwm.depth=0.9", "pwm.depth: duty and half of depth make a reference"},
      {"run chopper --set 'pwm.duty=[[0 s, 0.4], [0.1 s, 0.4], [0.1 s, 0.5]]'",
       "pwm.duty: it jumps"},
      {"run chopper --set 'pwm.frequency=20 kHz'", "pwm.carrier: the reference changes"},
      {"run chopper --set 'pwm.dead_time=60 us' --set 'pwm.carrier=10 kHz'",
       "pwm.dead_time: 60 us is half a period"},
      {"export chopper --set 'run.until=10 s' -o x.cir", "each of its edges is written"},
      {"run paper --tier switched --set pwm.depth=0.1", "pwm.depth: tier switched"},
      {"run relay --set pwm.on=50ms", "pwm.off: 50 ms is not behind pwm.on, 50 ms"},
      {"run relay --set pwm.duty=0.3", "pwm.duty: with pwm.on and pwm.off there is one pulse"},
      {"run chopper --set pwm.depth=0 --set pwm.on=0ms", "pwm.carrier: with pwm.on and pwm.off"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("%s", ROWS[k].words);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k].what), "%s: %d %s", ROWS[k].words, r.status,
           r.err);
    free_ran(&r);
  }
}

static void said(void) {
  ran r = run("check paper --set pwm.depth=0.1");
  EXPECT(r.status == 0 && strstr(r.err, "pwm.depth: the deck has no port pwm"), "%s", r.err);
  free_ran(&r);
  r = run("check bridge_link --set pwm.depth=1");
  EXPECT(r.status == 0 && strstr(r.err, "pulses of port pwm_low no longer than"), "%s", r.err);
  free_ran(&r);
  r = run("check chopper");
  EXPECT(r.status == 0 && strstr(r.out, "auto: the scene names a deck with a port pwm"), "%s",
         r.out);
  free_ran(&r);
  r = run("run paper --json --quiet --set 'run.until=1 ms'");
  EXPECT(r.status == 0 && !strstr(r.out, "\"pwm\""), "a section of no use is shown");
  free_ran(&r);
  r = run("run chopper --json --quiet --set 'run.until=0.1 ms' --set run.verify=never");
  EXPECT(strstr(r.out, "\"pwm\": {") && strstr(r.out, "\"carrier\": "), "%s", r.out);
  free_ran(&r);
  r = run("list parameters");
  EXPECT(strstr(r.out, "pwm.dead_time") && strstr(r.out, "pwm.duty"), "the keys are not listed");
  free_ran(&r);
}

/* A capacitor straight across a switch is emptied within picoseconds, and the peak of that current
 * is what the first step makes of it: the run says so. With a resistor it has a width, and nothing
 * is said; nor where the peak is far below what it is held against. */
static void peaks_of_one_step(void) {
  for (int k = 0; k < 3; k++) { /* 1: with a resistor; 2: far below its rating */
    char deck[900];
    snprintf(deck, sizeof deck, "%s%s",
             k == 1 ? "*$ title a resistor in series with the capacitor\n*$ port pwm = Vg\n"
                      "*$ probe i_s = i(Vs) A\nVg g 0 external\nVdc p 0 100\nVs a q 0\n"
                      "S1 q 0 g 0 sw off\nRsn a sn 220\nCsn sn 0 10n ic=100\nD1 a p dw\n"
                      ".model sw sw(ron=1m roff=10meg vt=0.5 vh=0.1)\n"
                      ".model dw d(is=1e-9 rs=20m bv=2000)\nXeva p a eva\n"
                    : "*$ title a capacitor across a switch\n*$ port pwm = Vg\n"
                      "*$ probe i_s = i(Vs) A\nVg g 0 external\nVdc p 0 100\nVs a q 0\n"
                      "S1 q 0 g 0 sw off\nCsn a 0 10n ic=100\nD1 a p dw\n"
                      ".model sw sw(ron=1m roff=10meg vt=0.5 vh=0.1)\n"
                      ".model dw d(is=1e-9 rs=20m bv=2000)\nXeva p a eva\n",
             k == 2 ? "*$ rating i_s -1e9..1e9 A\n" : "");
    write_file("sharp.cir", deck);
    ran r = run("run paper --set circuit.deck=sharp.cir --set run.until=2ms");
    bool told = strstr(r.err, "is met by one step alone") != NULL;
    EXPECT(r.status == 0 && told == (k == 0), "%d: %d %s", k, r.status, r.err);
    free_ran(&r);
  }
}

/* Behind an edge of an ideal gate drive the gate's current begins with its peak, and is back within
 * 50 ns. The peak is that of steps of 1e-12 s but for 1 %, at any tolerance, and nothing is said.
 */
static void peaks_at_an_ideal_edge(void) {
  static const char *const TOLERANCES[] = {"1e-3", "1e-4", "1e-5"};
  for (size_t k = 0; k < COUNT(TOLERANCES); k++) {
    ran r = run("run paper --set circuit.deck=halfwave_paper --set circuit.gate_drive=gate_ideal "
                "--set run.ladder=stay --set run.until=15ms --set run.tolerance=%s --json",
                TOLERANCES[k]);
    EXPECT(!strstr(r.err, "is met by one step alone"), "%s: %s", TOLERANCES[k], r.err);
    CLOSE(json_measure(r.out, "i_gate", "_max"), 0.600, 0.01);
    CLOSE(json_measure(r.out, "i_gate", "_min"), -0.563, 0.01);
    free_ran(&r);
  }
}

/* What rings as the supply jumps at t = 0 is the same at any tolerance. With a first step of 1e-4
 * of the largest the least v_link was 95 V at 1e-3, and 80 V with 1e-6. Where it converges to, 75.9
 * V and 1.888 A, was found with 1e-8. Steps of the ring leave up to 0.3 % of that at 1e-2. */
static void the_start_rings(void) {
  static const char *const TOLERANCES[] = {"1e-2", "1e-3", "1e-4", "1e-5"};
  for (size_t k = 0; k < COUNT(TOLERANCES); k++) {
    ran r = run("run chopper --json --quiet --set run.until=0.1ms --set run.verify=never --set "
                "run.tolerance=%s",
                TOLERANCES[k]);
    EXPECT(!r.status, "%d %s", r.status, r.err);
    CLOSE(json_measure(r.out, "v_link", "_min"), 75.9, 5e-3);
    CLOSE(json_measure(r.out, "switch.i_peak", ""), 1.888, 5e-3);
    free_ran(&r);
  }
}

int main(void) {
  static const vs_test TESTS[] = {
      {"the start rings", the_start_rings},
      {"peaks at an ideal edge", peaks_at_an_ideal_edge},
      {"edges: closed form", closed_form},
      {"edges: roots", roots},
      {"dead time and shift", dead_time_and_shift},
      {"short pulses, and none", short_pulses},
      {"one pulse", one_pulse},
      {"ripple of a constant coil", ripple},
      {"chopper as plain ngspice", chopper},
      {"bridge as plain ngspice", bridge},
      {"refused", refused},
      {"said", said},
      {"peaks of one step", peaks_of_one_step},
  };
  return program_suite("pwm", TESTS, COUNT(TESTS));
}
