/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the columns of run.csv and study.csv are stands in summary.json and in manifest.json, and
 * whoever draws or compares them goes by that, not by names. The machine of these tests has probes
 * that are named as coordinates, instruments and what a control shows. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/tree.h"
#include "program.h"
#include "report/traces.h"
#include "study/folder.h"

static const vs_method *const NO_METHODS[] = {NULL};

/* Puts the text behind a mark. */
static void put_behind(vs_text *out, const char *text, const char *mark, const char *more) {
  const char *at = strstr(text, mark);
  EXPECT(at != NULL, "no '%s'", mark);
  if (!at) return;
  vs_text_add(out, "%.*s%s%s", (int)(at - text + (long)strlen(mark)), text, more,
              at + strlen(mark));
}

static void write_machine(void) {
  char *text = read_file(VS_TEST_FOLDER "/../spice/machines/two_mass.yaml");
  vs_text some = {0}, all = {0};
  put_behind(&some, text, "\nparameters:\n",
             "  kk: {default: 100 1/s2, text: k}\n  kr: {default: 1 rad/m, text: k}\n"
             "  kf: {default: 1 N/m2, text: k}\n");
  put_behind(&all, some.text, "\nprobes:\n",
             "  amax: {of: kk * (x - y), unit: m/s2, text: no acceleration of a coordinate max}\n"
             "  flow: {of: kf * x, unit: N/m, text: its name ends as that of a torque}\n"
             "  q: {of: x, unit: m, text: no coordinate}\n"
             "  aq: {of: kk * x, unit: m/s2, text: nor its acceleration}\n"
             "  s_meas: {of: y, unit: m, text: no instrument}\n"
             "  firing_angle: {of: kr * x, unit: rad, text: no control}\n"
             "  setpoint: {of: y, unit: m, text: no set point}\n"
             "  amplitude_meas: {of: y, unit: m, text: no amplitude of a control}\n");
  write_file("tm.yaml", all.text);
  write_file("tms.yaml", "machine: {model: ./tm.yaml}\nrun: {until: 9 ms, tier: switched}\n");
  vs_text_free(&some);
  vs_text_free(&all);
  free(text);
}

/* Fills in what the run's summary.json tells of a column. */
static vs_column told(const char *folder, const char *name) {
  vs_traces t = {0};
  vs_error err = {0};
  vs_column found = {.name = ""};
  EXPECT(!vs_traces_read(folder, &t, &err), "%s", err.text);
  const int k = vs_traces_find(&t, name);
  EXPECT(k >= 0, "%s has no %s", folder, name);
  if (k >= 0) found = t.column[k];
  vs_traces_free(&t);
  return found;
}

/* The list and the header name the same, in the same order. */
static void expect_list(const char *json, const char *csv, int line) {
  vs_tree tree = {0};
  vs_error err = {0};
  vs_text names = {0};
  expect(!vs_tree_read(json, &tree, &err), line, "%s", err.text);
  const vs_node *list = vs_tree_child(tree.root, "columns");
  for (const vs_node *n = list ? list->child : NULL; n; n = n->next)
    vs_text_add(&names, "%s%s", names.length ? "," : "", vs_tree_child(n, "name")->text);
  char *header = read_file(csv);
  header[strcspn(header, "\n")] = '\0';
  expect(names.text && !strcmp(names.text, header), line, "%s\n%s", names.text, header);
  free(header);
  vs_text_free(&names);
  vs_tree_free(&tree);
}

static void columns_of_a_run(void) {
  static const vs_column ROWS[] = {{"t_s", "t", "s", VS_COLUMN_TIME, "", false},
                                   {"x_m", "x", "m", VS_COLUMN_COORDINATE, "machine", false},
                                   {"vy_m_s", "vy", "m/s", VS_COLUMN_RATE, "y", false},
                                   {"ax_m_s2", "ax", "m/s2", VS_COLUMN_ACCELERATION, "x", false},
                                   {"i_a", "i", "A", VS_COLUMN_PROBE, "actuator", false},
                                   {"v_mains_v", "v_mains", "V", VS_COLUMN_PROBE, "supply", false},
                                   {"amax_m_s2", "amax", "m/s2", VS_COLUMN_PROBE, "machine", false},
                                   {"flow_n_m", "flow", "N/m", VS_COLUMN_PROBE, "machine", false},
                                   {"setpoint_m", "setpoint", "m", VS_COLUMN_PROBE, "machine", false},
                                   {"s_meas_m", "s_meas", "m", VS_COLUMN_PROBE, "machine", false}};
  write_machine();
  RUN_GOOD("run tms.yaml -o o --quiet");
  expect_list("o/summary.json", "o/run.csv", __LINE__);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const vs_column c = told("o", ROWS[k].name), *r = &ROWS[k];
    EXPECT(!strcmp(c.quantity, r->quantity) && !strcmp(c.unit, r->unit) &&
               !strcmp(c.role, r->role) && !strcmp(c.of, r->of),
           "%s: %s, %s, %s, %s", r->name, c.quantity, c.unit, c.role, c.of);
  }
}

/* What a control and instruments fill, and a deck's probe. */
static void columns_of_a_control(void) {
  static const char *const ROWS[][4] = {
      {"trough_meas_m", "trough_meas", VS_COLUMN_INSTRUMENT, "p"},
      {"setpoint_m", "setpoint", VS_COLUMN_SET_POINT, "trough"},
      {"amplitude_meas_m", "amplitude_meas", VS_COLUMN_MEASURE, "trough"},
      {"firing_angle_rad", "firing_angle", VS_COLUMN_MEASURE, "firing"},
      {"v_ak_v", "v_ak", VS_COLUMN_PROBE, "circuit"}};
  RUN_GOOD("run paper --tier circuit --set run.until=4ms --set record=[p,v_ak] --quiet -o c --set "
           "firing.every=1 --set 'instruments={trough: {channel: p, range: [-3 mm, 3 mm]}}' --set "
           "'control={law: amplitude, sensor: trough, setpoint: 1 mm, gain: -5 deg/mm, integral: "
           "60 deg/mm.s}'");
  expect_list("c/summary.json", "c/run.csv", __LINE__);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const vs_column c = told("c", ROWS[k][0]);
    EXPECT(!strcmp(c.quantity, ROWS[k][1]) && !strcmp(c.role, ROWS[k][2]) &&
               !strcmp(c.of, ROWS[k][3]),
           "%s: %s, %s, %s", ROWS[k][0], c.quantity, c.role, c.of);
  }
}

/* The coordinates x and y, their accelerations, and the force: nothing else moves, and no control
 * and no instrument is drawn. A probe is drawn as such, in its own unit. */
static void pictures_of_probes(void) {
  if (!on_path("gnuplot")) return;
  write_machine();
  RUN_GOOD("run tms.yaml -o o --quiet");
  RUN_GOOD("plot o --quiet");
  char *motion = read_file("o/motion_run.svg"), *page = read_file("o/report.html");
  EXPECT(strstr(motion, ">x / mm<") && strstr(motion, ">ẍ / (m/s²)<"), "%s", motion);
  EXPECT(!strstr(motion, "max /") && !strstr(motion, "q /") && !strstr(motion, "q\u0308 /"),
         "a probe is drawn as a coordinate");
  EXPECT(access("o/control_run.svg", F_OK) && access("o/measured_run.svg", F_OK),
         "a probe is drawn as a control's or an instrument's");
  EXPECT(strstr(page, "\"amax / m/s2\"") && strstr(page, "\"flow / N/m\"") &&
             strstr(page, "\"setpoint / mm\""),
         "the page has other labels");
  free(motion);
  free(page);
  RUN_GOOD("plot o --probe amax,flow --quiet -o probes.svg");
  char *probes = read_file("probes.svg");
  EXPECT(strstr(probes, ">amax / m/s2<") && strstr(probes, ">flow / N/m<"), "%s", probes);
  free(probes);
  static const char *const SAYS[] = {"--orbit", "'amax_m_s2', which coordinates have"};
  refuse("plot o --probe amax --orbit -o x.svg", "a probe has no rate", "", SAYS, __LINE__);
}

/* Rewrites the summary: `with` in the place of `what`. */
static void rewrite_summary(const char *folder, const char *what, const char *with) {
  char path[64];
  vs_text changed = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  char *text = read_file(path), *at = strstr(text, what);
  EXPECT(at != NULL, "%s has no %s", path, what);
  if (at) vs_text_add(&changed, "%.*s%s%s", (int)(at - text), text, with, at + strlen(what));
  if (at) write_file(path, changed.text);
  vs_text_free(&changed);
  free(text);
}

/* Two columns of one name are compared where they are the same kind of thing. The other run's
 * machine has a coordinate max. */
static void compared_by_role(void) {
  write_machine();
  RUN_GOOD("run tms.yaml -o o --quiet");
  RUN_GOOD("run tms.yaml -o other --quiet");
  ran r = run("compare o other");
  EXPECT(r.status == 0 && !strstr(r.out, "only A has"), "%s%s", r.out, r.err);
  free_ran(&r);
  rewrite_summary("other", "\"quantity\": \"amax\", \"unit\": \"m/s2\", \"role\": \"probe\"",
                  "\"quantity\": \"amax\", \"unit\": \"m/s2\", \"role\": \"acceleration\"");
  r = run("compare o other");
  EXPECT(r.status == 0 && strstr(r.out, "only A has amax_m_s2\n") &&
             strstr(r.out, "only B has amax_m_s2\n"),
         "%s%s", r.out, r.err);
  free_ran(&r);
}

/* A run of an older version, and a case that a study has stored, do not say what their columns are:
 * names tell, as far as they do. Coordinates have a rate and an acceleration. */
static void told_by_names(void) {
  write_machine();
  write_file("s.yaml", "scene: ./tms.yaml\nvary: {firing.angle: [100 deg]}\nreport: [i_peak]\n");
  RUN_GOOD("study s.yaml -o s --keep runs --quiet");
  static const char *const ROWS[][3] = {{"x_m", VS_COLUMN_COORDINATE, "m"},
                                        {"vx_m_s", VS_COLUMN_RATE, "m/s"},
                                        {"ay_m_s2", VS_COLUMN_ACCELERATION, "m/s2"},
                                        {"i_a", "", "A"},
                                        {"q_m", "", "m"},
                                        {"amax_m_s2", "", "m/s2"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const vs_column c = told("s/runs/0", ROWS[k][0]);
    EXPECT(!strcmp(c.role, ROWS[k][1]) && !strcmp(c.unit, ROWS[k][2]), "%s: %s, %s", c.name, c.role,
           c.unit);
  }
  RUN_GOOD("run tms.yaml -o a --quiet");
  RUN_GOOD("run tms.yaml -o b --quiet");
  rewrite_summary("a", "\"quantity\": \"x\", \"unit\": \"m\", \"role\": \"coordinate\"",
                  "\"quantity\": \"x\", \"unit\": \"m\", \"role\": \"probe\"");
  rewrite_summary("b", "\"columns\": [", "\"unread\": [");
  ran r = run("compare a b");
  EXPECT(r.status == 0 && !strstr(r.out, "only A has"), "what is guessed sets nothing apart: %s%s",
         r.out, r.err);
  free_ran(&r);
  RUN_GOOD("run paper --tier switched --set run.until=20ms -o new --quiet --reproducible");
  RUN_GOOD("run paper --tier switched --set run.until=20ms -o old --quiet --reproducible");
  rewrite_summary("old", "\"columns\": [", "\"unread\": [");
  if (!on_path("gnuplot")) return;
  RUN_GOOD("plot new --quiet");
  RUN_GOOD("plot old --quiet -o old.svg");
  RUN_GOOD("plot new --quiet -o new.svg");
  char *a = read_file("new.svg"), *b = read_file("old.svg");
  EXPECT(strstr(a, ">p / mm<") && strstr(b, ">p / mm<") && strstr(b, ">p̈ / (m/s²)<"), "%s", b);
  free(a);
  free(b);
}

/* The manifest's list, study.csv's header and what its folder is read as. */
static void columns_of_a_study(void) {
  write_file("m.yaml", "set: {run.until: 15 ms, circuit.deck: halfwave_paper, run.tier: circuit}\n"
                       "vary: {supply.voltage: [440 V], firing.every: [once]}\n"
                       "report: [p_min, v_ak_max, thyristor.v_forward, energy_in]\n");
  ran r = run("study m.yaml -o m --jobs 1 --quiet");
  EXPECT(r.status == 0 || r.status == 3, "%s", r.err);
  free_ran(&r);
  expect_list("m/manifest.json", "m/study.csv", __LINE__);
  vs_folder *t = vs_alloc(1, sizeof *t);
  vs_error err = {0};
  EXPECT(!vs_folder_open(t, "m", NO_METHODS, &err), "%s", err.text);
  const vs_node *list = vs_tree_child(t->manifest.root, "columns"), *n = list ? list->child : NULL;
  static const char *const OF[][2] = {{"p_min", "p"},
                                      {"v_ak_max", "v_ak"},
                                      {"thyristor.v_forward", "thyristor"},
                                      {"energy_in", ""}};
  for (size_t k = 0; k < t->count && n; k++, n = n->next) {
    const vs_folder_column *c = &t->column[k];
    const char *quantity = vs_tree_child(n, "quantity")->text;
    EXPECT(!strcmp(vs_tree_child(n, "role")->text, vs_folder_kinds[c->role].word), "%s", c->title);
    EXPECT(!strcmp(vs_tree_child(n, "unit")->text, c->unit) && !strcmp(quantity, c->name), "%s: %s",
           c->title, c->unit);
    for (size_t m = 0; m < COUNT(OF); m++)
      if (!strcmp(quantity, OF[m][0]))
        CU_ASSERT_STRING_EQUAL(vs_tree_child(n, "of")->text, OF[m][1]);
  }
  EXPECT(t->count == 2 + 2 + 4 + 3 * 39 + 9 && !n, "%zu", t->count); /* 39 lines of the verdict */
  vs_folder_close(t);
  free(t);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"columns of a run", columns_of_a_run},     {"columns of a control", columns_of_a_control},
      {"pictures of probes", pictures_of_probes}, {"compared by role", compared_by_role},
      {"told by names", told_by_names},           {"columns of a study", columns_of_a_study},
  };
  return program_suite("columns", TESTS, COUNT(TESTS));
}
