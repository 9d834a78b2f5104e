/* SPDX-License-Identifier: GPL-3.0-or-later
 * Ratings with an end at 0, which says which sign a probe may have; and the coil current of a coil
 * with its pins swapped. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "measure/verdict.h"
#include "suite.h"

/* Nothing but sources that follow the mains of 100 V rms: v_half is its forward half; v_tiny goes
 * 1 mV below 0 besides, v_deep 20 V; v_minus is v_half with its sign turned. */
static const char DECK[] =
    "*$ port mains = Vm\n*$ loss r = v(a)^2/100\n*$ store none = 0*v(a)\n"
    "*$ probe v_half = v(h) V\n*$ probe v_tiny = v(t) V\n*$ probe v_deep = v(d) V\n"
    "*$ probe v_minus = -v(h) V\n*$ rating %s V\n"
    "Vm a 0 external\nR1 a 0 100\n"
    "Bh h 0 V=max(v(a),0)\nBt t 0 V=max(v(a),-1m)\nBd d 0 V=max(v(a),-20)\nRe a e 1meg\n"
    "Xeva e 0 eva\n";

/* One rating, judged. The extremes are the sine's to 1e-3, as knots lie half a millisecond apart.
 */
typedef struct row {
  const char *rating;
  double margin; /* infinite: no limit of it is a number other than 0, and its sign is kept */
} row;

static const double PEAK_V = 141.4213562373095;

static void judge(const row *r) {
  char text[1024];
  snprintf(text, sizeof text, DECK, r->rating);
  write_file("rated.cir", text);
  const char *sets[] = {"circuit.deck=rated.cir", "run.until=0.04s", "supply.voltage=100V", NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  vs_verdict *v = vs_alloc(1, sizeof *v);
  if (!t->status) vs_verdict_make(t->result.watchers.measures, NULL, NULL, v);
  const vs_judgement *j = v->item;
  EXPECT(v->count == 1, "%s: %zu judged", r->rating, v->count);
  if (v->count == 1 && isfinite(r->margin)) {
    EXPECT(fabs(j->margin - r->margin) <= 2e-3, "%s: margin %g, not %g", r->rating, j->margin,
           r->margin);
    CU_ASSERT_PTR_EQUAL(v->weakest, j);
  } else if (v->count == 1) {
    EXPECT(isinf(j->margin) && !v->weakest, "%s: margin %g", r->rating, j->margin);
  }
  EXPECT(!v->first_to_fail == !(r->margin < 0), "%s: violated or not", r->rating);
  if (r->margin < 0) /* where the second half of the first cycle begins */
    EXPECT(fabs(j->failed_s - 0.01) < 1e-3, "%s: failed at %g s", r->rating, j->failed_s);
  else
    CU_ASSERT(isnan(j->failed_s));
  vs_verdict_free(v);
  free(v);
  vs_trial_free(t);
}

static void an_end_at_zero_is_a_sign(void) {
  const row ROWS[] = {{"v_half 0..400", (400 - PEAK_V) / 400},
                      {"v_tiny 0..400", (400 - PEAK_V) / 400}, /* 1 mV is below 1e-4 of 400 V */
                      {"v_deep 0..400", -20.0 / 400},
                      {"v_deep 0..1e5", -20.0 / 1e5},
                      {"v_minus -400..0", (400 - PEAK_V) / 400},
                      {"v_deep -40..400", 0.5},
                      {"v_half -10..400", (400 - PEAK_V) / 400}};
  for (size_t k = 0; k < COUNT(ROWS); k++) judge(&ROWS[k]);
}

/* ---- the largest |i| ---- */

/* The deck halfwave_bare with the coil's pins as given. */
static double peak_with(const char *coil) {
  static const char PINS[] = "Xeva    b 0 eva";
  char path[512], text[8192] = "";
  snprintf(path, sizeof path, "%s/../spice/halfwave_bare.cir", VS_TEST_FOLDER);
  FILE *file = fopen(path, "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(file);
  size_t n = fread(text, 1, sizeof text - 1, file);
  fclose(file);
  text[n] = '\0';
  char *pins = strstr(text, PINS);
  CU_ASSERT_PTR_NOT_NULL_FATAL(pins);
  memcpy(pins, coil, strlen(PINS));
  write_file("coil.cir", text);
  const char *sets[] = {"circuit.deck=coil.cir", "run.until=0.03s", NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  CU_ASSERT_EQUAL(t->status, VS_OK);
  double peak = t->result.values[VS_M_I_PEAK].value;
  vs_trial_free(t);
  return peak;
}

/* The machine does not know which way the current flows; the two runs are each right to 1e-4. */
static void swapped_pins_have_the_same_peak(void) {
  CLOSE(peak_with("Xeva    0 b eva"), peak_with("Xeva    b 0 eva"), 2e-4);
}

static const vs_test TESTS[] = {
    {"an end at zero is a sign", an_end_at_zero_is_a_sign},
    {"swapped pins have the same peak", swapped_pins_have_the_same_peak},
};
VS_SUITE_MAIN("zero_ratings", TESTS)
