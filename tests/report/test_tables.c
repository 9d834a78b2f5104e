/* SPDX-License-Identifier: GPL-3.0-or-later
 * Rows of tables that nothing would miss: a kind of event that does nothing, a picture that a
 * method names and nobody draws. */
#include "engine/events.h"
#include "report/plot/study_pictures.h"
#include "study/methods.h"
#include "suite.h"

static void every_event_does_something(void) {
  size_t count = 0;
  for (const vs_event_kind *k; (k = vs_events_kind(count)); count++)
    EXPECT(k->mains || k->pulse || k->wire || k->adds_pulse || k->jams || k->load,
           "%s does nothing", k->name);
  CU_ASSERT(count > 0);
}

static size_t known_of(const char *method, const char *const *names) {
  size_t count = 0;
  for (; names && names[count]; count++)
    EXPECT(vs_study_pictures_knows(names[count]), "%s names the picture %s", method, names[count]);
  return count;
}

static void every_picture_is_there(void) {
  size_t count = 0;
  for (const vs_method *const *m = vs_methods_all; *m; m++) {
    const vs_method_report *r = &(*m)->report;
    count += known_of((*m)->name, r->lead) + known_of((*m)->name, r->each) +
             known_of((*m)->name, r->last);
  }
  CU_ASSERT(count > 0);
  CU_ASSERT_FALSE(vs_study_pictures_knows("none of them"));
}

static const vs_test TESTS[] = {
    {"every kind of event does something", every_event_does_something},
    {"every picture that a method names is there", every_picture_is_there},
};

int main(void) {
  return vs_suite("tables", TESTS, COUNT(TESTS));
}
