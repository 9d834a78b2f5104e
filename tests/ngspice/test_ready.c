/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice gets ready in a second thread while a scene is read, and begins without code models
 * (ngspice/library.h). Neither changes a byte of what a run gives, and a run without a circuit does
 * not load ngspice. */
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* Runs a scene for 6 ms, past its firing. --allow-code keeps ngspice from getting ready early, as
 * such a scene may start processes. */
static char *told(const char *words) {
  ran r = run("run %s --set run.until=6ms --json --quiet --reproducible", words);
  expect_good(&r, words, __LINE__);
  char *out = strdup(r.out);
  free_ran(&r);
  return out;
}

static void expect_same(const char *early, const char *late) {
  char *one = told(early), *other = told(late);
  EXPECT(*one && !strcmp(one, other), "%s: other numbers than %s", early, late);
  free(one);
  free(other);
}

/* The circuit is foreseen from --tier, from run.tier, from a key of the circuit, and not at all. */
static void readiness_changes_nothing(void) {
  write_file("named.yaml", "run: {tier: circuit}\n");
  expect_same("named.yaml", "named.yaml --allow-code");
  expect_same("paper --tier circuit", "paper --tier circuit --allow-code");
  expect_same("paper --set circuit.r1=120ohm", "paper --set circuit.r1=120ohm --allow-code");
  expect_same("paper --tier switched", "paper --tier switched --allow-code");
}

/* Netlists of which ngspice makes code models by itself: an element of its own, a table, and
 * polynomials of one and of two words. Each drives 1 kohm, whose voltage is a probe. */
static void code_models_are_there_when_wanted(void) {
  static const char *const LINES[] = {
      "Adouble %v(a) %v(more) twice\n.model twice gain(gain=2)",
      "Gtable 0 more TABLE {v(a)} = (-100,-1) (0,0) (100,1)",
      "Epoly more 0 POLY(1) a 0 0 1 0.001",
      "Fpoly 0 more Vthy 0 1 0.2",
  };
  char *deck = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir"), *zero = NULL;
  for (size_t k = 0; k < COUNT(LINES); k++) {
    vs_text text = {0};
    vs_text_add(&text, "%s*$ probe more = v(more) V\nRmore more 0 1k\n%s\n", deck, LINES[k]);
    write_file("more.cir", text.text);
    vs_text_free(&text);
    write_file("more.yaml", "circuit: {deck: more.cir}\nrun: {tier: circuit}\n");
    expect_same("more.yaml", "more.yaml --allow-code");
    char *now = told("more.yaml");
    EXPECT(strstr(now, "\"more_max\""), "%s: no probe", LINES[k]);
    EXPECT(!zero || strcmp(now, zero) != 0, "%s: as the one before it", LINES[k]);
    free(zero);
    zero = now;
  }
  free(zero);
  free(deck);
}

/* Neither do the user's own variables and files of ngspice. */
static void surroundings_change_nothing(void) {
  char *plain = told("paper --tier circuit");
  setenv("SPICE_SCRIPTS", "/nowhere", 1);
  write_file(".spiceinit", "option reltol=0.1\noption method=gear\n");
  char *other = told("paper --tier circuit"), *late = told("paper --tier circuit --allow-code");
  unsetenv("SPICE_SCRIPTS");
  remove(".spiceinit");
  CU_ASSERT_STRING_EQUAL(plain, other);
  CU_ASSERT_STRING_EQUAL(plain, late);
  free(plain);
  free(other);
  free(late);
}

/* The dynamic linker tells what it loads. */
static void an_ideal_tier_loads_no_ngspice(void) {
  setenv("LD_DEBUG", "files", 1);
  ran ideal = run("run paper --tier switched --quiet --set run.until=6ms");
  ran circuit = run("run paper --tier circuit --quiet --set run.until=6ms");
  unsetenv("LD_DEBUG");
  CU_ASSERT_EQUAL(ideal.status, 0);
  CU_ASSERT_EQUAL(circuit.status, 0);
  EXPECT(!strstr(ideal.err, "ngspice"), "ngspice is loaded");
  EXPECT(strstr(circuit.err, "ngspice"), "LD_DEBUG tells nothing");
  EXPECT(!strstr(circuit.err, ".cm"), "code models are loaded");
  free_ran(&ideal);
  free_ran(&circuit);
}

/* What is wrong with a scene is told while ngspice may still be loading. */
static void a_wrong_scene_is_refused(void) {
  static const char *const SAYS[] = {"no key 'nothing'", NULL};
  for (int k = 0; k < 5; k++)
    refuse("run paper --tier circuit --set circuit.nothing=1", "paper", "", SAYS, __LINE__);
}

static const vs_test TESTS[] = {
    {"getting ready early changes no byte", readiness_changes_nothing},
    {"code models are there when wanted", code_models_are_there_when_wanted},
    {"surroundings change nothing", surroundings_change_nothing},
    {"an ideal tier loads no ngspice", an_ideal_tier_loads_no_ngspice},
    {"a wrong scene is refused meanwhile", a_wrong_scene_is_refused},
};

int main(void) {
  return program_suite("ready", TESTS, COUNT(TESTS));
}
