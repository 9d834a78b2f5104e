/* SPDX-License-Identifier: GPL-3.0-or-later
 * Names that are looked up: the table itself, and what netlists of other programs look up in it;
 * and sets of numbers. */
#include "base/names.h"

#include <math.h>
#include <string.h>

#include "base/disjoint_sets.h"
#include "import/elements.h"
#include "suite.h"

static size_t number_of(const vs_names *names, const char *name) {
  size_t number = 999999;
  vs_names_find(names, name, strlen(name), &number);
  return number;
}

static void names_have_numbers(void) {
  enum { MANY = 5000 };
  vs_names names = {0};
  char name[32];
  CU_ASSERT_FALSE(vs_names_find(&names, "a", 1, NULL));
  for (size_t k = 0; k < MANY; k++) {
    snprintf(name, sizeof name, "Name%zu", k);
    vs_names_put(&names, name, strlen(name), k);
  }
  CU_ASSERT_EQUAL(names.count, MANY);
  CU_ASSERT(names.room >= 2 * names.count);
  size_t wrong = 0;
  for (size_t k = 0; k < MANY; k++) {
    snprintf(name, sizeof name, "nAME%zu", k);
    wrong += number_of(&names, name) != k;
  }
  CU_ASSERT_EQUAL(wrong, 0);
  CU_ASSERT(vs_names_find(&names, "name12345", 6, NULL)); /* "name12" */
  CU_ASSERT_FALSE(vs_names_find(&names, "name", 4, NULL));
  vs_names_put(&names, "NAME7", 5, 8);
  CU_ASSERT_EQUAL(number_of(&names, "Name7"), 8);
  CU_ASSERT_EQUAL(names.count, MANY);
  vs_names_free(&names);
  CU_ASSERT_EQUAL(names.room, 0);
}

/* The numbers with the same rest are joined, the larger ones first. */
static void numbers_in_sets(void) {
  enum { MANY = 3000, SETS = 7 };
  vs_disjoint_sets sets = {0};
  for (size_t k = 0; k < MANY; k++) CU_ASSERT_EQUAL_FATAL(vs_disjoint_sets_add(&sets), k);
  size_t joined = 0, wrong = 0;
  for (size_t k = MANY - 1; k >= SETS; k--) joined += vs_disjoint_sets_join(&sets, k, k - SETS);
  CU_ASSERT_EQUAL(joined, MANY - SETS);
  CU_ASSERT_FALSE(vs_disjoint_sets_join(&sets, 0, MANY / SETS * SETS));
  for (size_t k = 0; k < MANY; k++) wrong += vs_disjoint_sets_find(&sets, k) != k % SETS;
  CU_ASSERT_EQUAL(wrong, 0);
  CU_ASSERT_TRUE(vs_disjoint_sets_join(&sets, 5, 3));
  CU_ASSERT_EQUAL(vs_disjoint_sets_find(&sets, 5 + SETS), 3);
  vs_disjoint_sets_free(&sets);
  CU_ASSERT_EQUAL(sets.count, 0);
}

/* Reads a netlist with this text. */
static void read_netlist(const char *text, vs_listing *listing, vs_values *values,
                         vs_elements *elements) {
  vs_error err = {0};
  write_file("names.net", text);
  CU_ASSERT_EQUAL_FATAL(vs_listing_read(listing, "names.net", NULL, &err), VS_OK);
  vs_values_read(values, listing);
  CU_ASSERT_EQUAL_FATAL(vs_elements_read(elements, listing, &err), VS_OK);
}

/* Each parameter is found out once, so that the order of lines makes no difference, and a long
 * chain is no work. One that needs itself is not known, and neither is who needs that. */
static void parameters_need_each_other(void) {
  vs_listing listing = {0};
  vs_values values = {0};
  vs_elements elements = {0};
  vs_text text = {0};
  double value = 0;
  vs_text_add(&text, "* of parameters\n");
  for (int k = 60; k > 0; k--)
    vs_text_add(&text, ".param p%d=(p%d+q%d) q%d=(p%d-q%d)\n", k, k - 1, k - 1, k, k - 1, k - 1);
  vs_text_add(&text, ".param p0=1 q0=0\n"
                     ".param round=(turn+1) turn=(round-1) lost=(2*turn) twice=1 twice=2\n"
                     "R1 a 0 1\n");
  read_netlist(text.text, &listing, &values, &elements);
  CU_ASSERT(vs_values_of(&values, vs_words_of("p60"), &value) && value == ldexp(1, 30));
  CU_ASSERT(vs_values_of(&values, vs_words_of("p59+q59"), &value) && value == ldexp(1, 30));
  CU_ASSERT(vs_values_of(&values, vs_words_of("TWICE"), &value) && value == 2);
  CU_ASSERT_FALSE(vs_values_of(&values, vs_words_of("round"), &value));
  CU_ASSERT_FALSE(vs_values_of(&values, vs_words_of("lost"), &value));
  CU_ASSERT_FALSE(vs_values_find(&values, "turn")->known);
  vs_text_free(&text);
  vs_elements_free(&elements);
  vs_values_free(&values);
  vs_listing_free(&listing);
}

static void elements_are_found(void) {
  vs_listing listing = {0};
  vs_values values = {0};
  vs_elements w = {0};
  read_netlist("* of names\nR_R1 a b 1\nR1 b c 1\nr1 c d 1\nL1 d e 1m\nL2 e 0 1m\nK1 L1 l2 0.5\n"
               "C1 d d 1u\nL3 e f 1m\n",
               &listing, &values, &w);
  CU_ASSERT_PTR_EQUAL(vs_elements_find(&w, vs_words_of("r_r1")), &w.elements[0]);
  CU_ASSERT_PTR_EQUAL(vs_elements_find(&w, vs_words_of("r1")), &w.elements[1]);
  CU_ASSERT_PTR_EQUAL(vs_elements_find(&w, vs_words_of("r1_2")), &w.elements[2]);
  CU_ASSERT_PTR_NULL(vs_elements_find(&w, vs_words_of("r9")));
  CU_ASSERT(w.elements[3].coupled && w.elements[4].coupled && !w.elements[7].coupled);
  CU_ASSERT(vs_elements_is_taken(&w, "E") && !vs_elements_is_taken(&w, "z"));
  /* two ends of two elements meet at b and c, more at d and e, one at a */
  CU_ASSERT_PTR_EQUAL(vs_elements_next(&w, &w.elements[0], w.elements[0].nodes[1]), &w.elements[1]);
  CU_ASSERT_PTR_EQUAL(vs_elements_next(&w, &w.elements[1], w.elements[0].nodes[1]), &w.elements[0]);
  CU_ASSERT_PTR_EQUAL(vs_elements_next(&w, &w.elements[1], w.elements[1].nodes[1]), &w.elements[2]);
  CU_ASSERT_PTR_NULL(vs_elements_next(&w, &w.elements[0], w.elements[0].nodes[0]));
  CU_ASSERT_PTR_NULL(vs_elements_next(&w, &w.elements[3], w.elements[3].nodes[0]));
  vs_elements_free(&w);
  vs_values_free(&values);
  vs_listing_free(&listing);
}

int main(void) {
  static const vs_test TESTS[] = {{"names have numbers", names_have_numbers},
                                  {"numbers in sets", numbers_in_sets},
                                  {"parameters need each other", parameters_need_each_other},
                                  {"elements are found", elements_are_found}};
  return vs_suite("names", TESTS, COUNT(TESTS));
}
