/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command validate: that all is well, that what is off is told, and what it prints. That it
 * works as installed is in test_install.c. */
#include "cli/validate/validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

#if defined(__SANITIZE_ADDRESS__)
enum { SANITIZED = true };
#else
enum { SANITIZED = false };
#endif

/* ---- the program ---- */

static void expect_all_ok(const char *words) {
  ran r = run("validate %s", words);
  expect_good(&r, words, __LINE__);
  EXPECT(!strstr(r.out, "OFF ") && strstr(r.out, ", 0 off, in "), "%s: %s", words, r.out);
  const char *line = strchr(r.out, '\n'); /* behind the head */
  for (; line && line[1] && strchr(line + 1, '\n')[1]; line = strchr(line + 1, '\n'))
    EXPECT(!strncmp(line + 1, "ok  ", 4), "%s: %s", words, line);
  free_ran(&r);
}

/* All of it as it is built for use; with sanitizers, some of each list. */
static void all_is_well(void) {
  static const char *const SOME[] = {
      "mode",         "'phase control of R-L at 150'", "'periodic orbit, 100 deg: power'",
      "'zeta 0.265'", "'varistor, 750 V, 1 kV'",       "'circuit as switched, bare'",
      "'half sine'",  "'first peak of p against'"};
  if (!SANITIZED) expect_all_ok("");
  for (size_t k = 0; k < COUNT(SOME) && SANITIZED; k++) expect_all_ok(SOME[k]);
}

static void word_and_list(void) {
  ran all = run("validate --list"), some = run("validate --list SNUBBER");
  expect_good(&all, "list", __LINE__);
  int lines = count_lines(all.out), fewer = count_lines(some.out);
  EXPECT(lines > 200 && fewer > 20 && fewer < lines / 2, "%d and %d lines", lines, fewer);
  char *rest = some.out, *name;
  while ((name = strsep(&rest, "\n")) && *name) EXPECT(strstr(name, "snubbe"), "%s", name);
  vs_text twice = {0}; /* a name stands for one check alone */
  vs_text_add(&twice, "\n%s", all.out);
  for (char *at = twice.text; (at = strchr(at, '\n')) && at[1]; at++) {
    char line[256];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(at + 1, "\n") + 2, at);
    EXPECT(!strstr(at + 1, line), "twice: %s", line);
  }
  vs_text_free(&twice);
  free_ran(&all);
  free_ran(&some);
  refuse("validate frobnicate", "no such check",
         "validate: ", (const char *const[]){"'frobnicate'", "--list"}, __LINE__);
  refuse("validate a b", "two words", "validate: ", (const char *const[]){"too many", NULL},
         __LINE__);
  ran quiet = run("validate mode --quiet");
  EXPECT(quiet.status == 0 && !*quiet.out && !*quiet.err, "%s%s", quiet.out, quiet.err);
  free_ran(&quiet);
}

static const char *text_of(const vs_node *map, const char *key) {
  const vs_node *node = vs_tree_child(map, key);
  return node && node->text ? node->text : "";
}

/* JSON is YAML, so that the program's own reader tells whether it can be read. */
static void json(void) {
  ran r = run("validate 'half sine' --json");
  expect_good(&r, "json", __LINE__);
  write_file("v.json", r.out);
  vs_tree tree = {0};
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("v.json", &tree, &err), VS_OK);
  const vs_node *checks = vs_tree_child(tree.root, "checks");
  CU_ASSERT_FATAL(checks && checks->kind == VS_NODE_LIST && checks->child);
  const vs_node *one = checks->child;
  CU_ASSERT_PTR_NULL(one->next);
  CU_ASSERT_STRING_EQUAL(text_of(one, "unit"), "A2.s");
  CU_ASSERT_STRING_EQUAL(text_of(one, "expected"), "50");
  CLOSE(atof(text_of(one, "got")), 50, 1e-4); /* its own tolerance */
  CLOSE_OF(atof(text_of(one, "error")), fabs(atof(text_of(one, "got")) - 50) / 50, 1, 1e-12);
  CU_ASSERT(atof(text_of(one, "tolerance")) > 0);
  CU_ASSERT(*text_of(one, "source") && *text_of(one, "tolerance_why"));
  CU_ASSERT_STRING_EQUAL(text_of(one, "ok"), "true");
  CU_ASSERT_STRING_EQUAL(text_of(tree.root, "count"), "1");
  CU_ASSERT_STRING_EQUAL(text_of(tree.root, "off"), "0");
  vs_tree_free(&tree);
  if (on_path("python3")) CU_ASSERT_EQUAL(system("python3 -m json.tool v.json >/dev/null"), 0);
  free_ran(&r);
}

/* ---- lists of the test's own ---- */

static int performed;

static vs_status gives(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                       vs_error *err) {
  (void)e, (void)also, (void)err;
  performed++;
  vs_experiment_add(out, 3, "three");
  vs_experiment_add(out, NAN, "nothing");
  return VS_OK;
}
static vs_status fails(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                       vs_error *err) {
  (void)e, (void)also;
  performed++;
  vs_experiment_add(out, 3, "three");
  return vs_fail(err, VS_RUN, "this one always fails");
}
static const vs_experiment good = {.perform = gives}, same = {.perform = gives},
                           bad = {.perform = fails};

static vs_status validate(vs_comparison check, vs_error *err) {
  static const volatile sig_atomic_t never;
  const vs_validate_options quiet = {.quiet = true, .stop = &never};
  const vs_comparison items[2] = {check, check};
  const vs_comparisons list = {items, 2};
  const vs_comparisons *const lists[] = {&list};
  return vs_validate(lists, 1, &quiet, err);
}

/* On either side of the tolerance, which is of the scale; and a run is done once for all. */
static void what_is_off_is_told(void) {
  static const struct {
    vs_comparison check;
    bool good;
  } ROWS[] = {
      {{.experiment = &good, .what = "three", .expected = 3, .tolerance = 1e-12}, true},
      {{.experiment = &good, .what = "three", .expected = 3.3, .tolerance = 0.1}, true},
      {{.experiment = &good, .what = "three", .expected = 3.3, .tolerance = 0.09}, false},
      {{.experiment = &good, .what = "three", .expected = -3, .tolerance = 0.1}, false},
      {{.experiment = &good, .what = "three", .expected = 3.3, .tolerance = 0.1, .scale = 2},
       false},
      {{.experiment = &good, .what = "three", .expected = 3.3, .tolerance = 0.1, .scale = -4},
       true},
      {{.experiment = &good, .what = "three", .other = &same, .tolerance = 1e-12}, true},
      {{.experiment = &good, .what = "three", .other = &bad, .tolerance = 1}, false},
      {{.experiment = &good, .what = "nothing", .other = &same, .tolerance = 1}, false},
      {{.experiment = &good, .what = "four", .expected = 4, .tolerance = 1}, false},
      {{.experiment = &good, .what = "three", .expected = 0, .tolerance = 1}, false},
      {{.experiment = &bad, .what = "three", .expected = 3, .tolerance = 1}, false},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_comparison check = ROWS[k].check;
    vs_error err = {0};
    check.name = "a check", check.unit = "", check.source = check.why = "the test";
    performed = 0;
    vs_status status = validate(check, &err);
    EXPECT(status == (ROWS[k].good ? VS_OK : VS_RUN), "row %zu: status %d", k, (int)status);
    EXPECT(ROWS[k].good == !strstr(err.text, "2 of 2 off"), "row %zu: %s", k, err.text);
    CU_ASSERT_EQUAL(performed, check.other ? 2 : 1);
  }
}

/* The program's own first check, expected a little beside what it is. */
static void a_wrong_expectation_is_off(void) {
  for (int k = 0; k < 2; k++) {
    vs_comparison check = vs_single_shot_comparisons.item[0];
    vs_error err = {0};
    check.expected += k * 2e-8; /* Hz; allowed are 6e-9 */
    CU_ASSERT_EQUAL(validate(check, &err), k ? VS_RUN : VS_OK);
  }
}

static void a_signal_ends_it(void) {
  const volatile sig_atomic_t at_once = 1;
  const vs_validate_options options = {.quiet = true, .stop = &at_once};
  const vs_comparisons *const lists[] = {&vs_single_shot_comparisons};
  vs_error err = {0};
  CU_ASSERT_EQUAL(vs_validate(lists, 1, &options, &err), VS_SIGNAL);
}

static const vs_test TESTS[] = {
    {"all is well", all_is_well},
    {"word and list", word_and_list},
    {"JSON", json},
    {"what is off is told", what_is_off_is_told},
    {"a wrong expectation", a_wrong_expectation_is_off},
    {"a signal", a_signal_ends_it},
};

int main(void) {
  return program_suite("validate", TESTS, COUNT(TESTS));
}
