/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a case is told by: the same for the same scene, however it is written and whatever study it
 * stands in; another one for any other scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/units.h"
#include "program.h"
#include "run/sections.h"
#include "study/workers/case.h"
#include "study/workers/identity.h"

/* ---- of scenes ---- */

static const vs_plan NO_PLAN; /* files are then read */

typedef struct scene_id {
  char text[VS_ID_SIZE];
  bool read; /* there was no error */
} scene_id;

/* Of a scene with sets, a line each; kept: NULL for a new one. */
static scene_id id_with(vs_identity *kept, const char *name, const char *sets) {
  enum { MOST = 16 };
  char *words = vs_copy(sets), *rest = words, *set[MOST];
  size_t n = 0;
  for (char *s; (s = strsep(&rest, "\n")) && n < MOST;)
    if (*s) set[n++] = s;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error err = {0};
  scene_id id = {.read = !vs_scene_read(name, set, n, NULL, scene, &err)};
  vs_identity *identity = kept ? kept : vs_identity_new(&NO_PLAN);
  if (id.read) id.read = !vs_identity_of(identity, scene, id.text, &err);
  if (!kept) vs_identity_free(identity);
  vs_scene_free(scene);
  free(scene);
  free(words);
  EXPECT(!id.read || strspn(id.text, "0123456789abcdef") == 16, "%s is no id", id.text);
  return id;
}

static scene_id id_of(const char *name, const char *sets) {
  scene_id id = id_with(NULL, name, sets);
  EXPECT(id.read, "%s with %s is refused", name, sets);
  return id;
}

static bool same(scene_id a, scene_id b) {
  return !strcmp(a.text, b.text);
}

static void the_same_scene(void) {
  mkdir("elsewhere", 0777);
  write_file("a.yaml", "supply: {voltage: 400 V}\nload: {density: 1.6 g/cm3, fraction: 0.25}\n");
  write_file("elsewhere/b.yaml",
             "# the same\nload:\n  fraction: 25e-2 # a quarter\n  density: 1600 "
             "kg/m3\nsupply: {voltage: 0.4 kV, frequency: 50 Hz, phase: -0 "
             "deg}\nrecord: [p]\nmeasured: {i_peak: 1 A}\nrun: {sample: 1 ms, "
             "tier: switched}\nactuator: {stop: none}\n");
  const scene_id a = id_of("a.yaml", "");
  CU_ASSERT(same(a, id_of("elsewhere/b.yaml", "")));
  CU_ASSERT(same(a, id_of("paper", "supply.voltage=400V\nload.fraction=0.25\n"
                                   "load.density=1.6g/cm3\nfiring.angle=100deg")));
  CU_ASSERT(!same(a, id_of("a.yaml", "run.tier=analytic")));
  CU_ASSERT(!same(a, id_of("a.yaml", "circuit.r1=100ohm"))); /* auto: another tier */
  CU_ASSERT(same(id_of("a.yaml", "run.tier=circuit"), id_of("a.yaml", "circuit.r1=100ohm")));
  CU_ASSERT(same(id_of("a.yaml", "run.tier=circuit"), id_of("a.yaml", "record=[v_ak]")));
  CU_ASSERT(same(id_of("a.yaml", "circuit.c1=100nF"), id_of("a.yaml", "circuit.c1=0.1uF")));
}

/* ---- every key ---- */

typedef struct key_test {
  vs_identity *kept; /* one for all scenes: nothing of the scene before must stay */
  const char *base;  /* sets */
  scene_id id;       /* with these */
  int changed;
} key_test;

/* Another value that the scene takes must give another id; false: it takes none of them. */
static bool changes(key_test *t, const char *key, const char *value) {
  vs_text sets = {0};
  vs_text_add(&sets, "%s\n%s=%s", t->base, key, value);
  scene_id id = id_with(t->kept, "paper", sets.text), fresh = id_with(NULL, "paper", sets.text);
  vs_text_free(&sets);
  if (!id.read) return false;
  EXPECT(!same(id, t->id), "%s = %s has the same id", key, value);
  EXPECT(same(id, fresh), "%s = %s: %s after other scenes, and %s alone", key, value, id.text,
         fresh.text);
  EXPECT(same(id_with(t->kept, "paper", t->base), t->id), "another id after %s", key);
  t->changed++;
  return true;
}

/* By a part in a thousand million; where it is 0, a little of it. Of a pair each. */
static bool changes_number(key_test *t, const char *key, const vs_field *f, const double *si) {
  static const double BY[] = {1e-9, -1e-9};
  double value = isnan(si[0]) ? 1 : si[0] / vs_units_factor(f->unit); /* NaN: it is a word */
  char text[128];
  for (size_t k = 0; k < COUNT(BY); k++) {
    double other = value ? value * (1 + BY[k]) : BY[k];
    snprintf(text, sizeof text, "%.12g %s", other, f->unit);
    if (f->kind == VS_REAL && changes(t, key, text)) return true;
    if (f->kind == VS_REAL) continue;
    double second = si[1] / vs_units_factor(f->unit);
    snprintf(text, sizeof text, "[%.12g %s, %.12g %s]", other, f->unit, second, f->unit);
    if (!changes(t, key, text)) continue;
    snprintf(text, sizeof text, "[%.12g %s, %.12g %s]", value, f->unit, second * (1 + BY[k]),
             f->unit);
    return changes(t, key, text);
  }
  return false;
}

static void change_field(key_test *t, const char *section, const vs_field *f, const void *values) {
  char key[128], words[256], *rest = words;
  const char *member = (const char *)values + f->offset;
  bool good = true;
  double real[2] = {0, 0};
  snprintf(key, sizeof key, "%s.%s", section, f->key);
  if (f->kind == VS_REAL || f->kind == VS_PAIR) {
    memcpy(real, member, f->kind == VS_PAIR ? sizeof real : sizeof *real);
    good = changes_number(t, key, f, real);
  } else if (f->kind == VS_COUNT)
    good = changes(t, key, "7");
  else if (f->kind == VS_OPTION)
    for (size_t k = 0; k < f->inside->keys.count; k++)
      change_field(t, key, &f->inside->keys.fields[k], member);
  else if (f->kind == VS_CHOICE) {
    int choice;
    memcpy(&choice, member, sizeof choice);
    snprintf(words, sizeof words, "%s", f->choices);
    strsep(&rest, "|");
    good = changes(t, key, strsep(&rest, "|"));
  }
  EXPECT(good, "%s takes no other value", key);
}

#define MOVING_COIL "run.tier=circuit\nactuator.law=moving_coil"

/* All that `list parameters` knows, with a stop and saturation, so that their keys count. Those of
 * another law are taken with that one. */
static void every_key_counts(void) {
  char stop[] = "actuator.stop={stiffness: 1e7 N/m, damping: 300 N.s/m}",
       saturation[] = "actuator.saturation={}", *set[] = {stop, saturation};
  key_test t = {.kept = vs_identity_new(&NO_PLAN),
                .base = "run.tier=circuit\nactuator.saturation={}\n"
                        "actuator.stop={}"};
  key_test moving = {.kept = t.kept, .base = MOVING_COIL};
  t.id = id_with(t.kept, "paper", t.base);
  moving.id = id_with(t.kept, "paper", moving.base);
  key_test direct = {.kept = t.kept, .base = "run.tier=switched\nfiring.valve=none"};
  direct.id = id_with(t.kept, "paper", direct.base);
  key_test ideal = {.kept = t.kept, .base = "run.tier=switched"};
  ideal.id = id_with(t.kept, "paper", ideal.base);
  key_test modulated = {.kept = t.kept, .base = "circuit.deck=chopper"};
  modulated.id = id_with(t.kept, "paper", modulated.base);
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(vs_scene_read("paper", set, 2, NULL, scene, &err), VS_OK);
  int keys = 0;
  for (int p = 0; p < VS_SECTIONS; p++) {
    if (p == VS_SECTION_NUMBER_limits) continue; /* they never change a result */
    const vs_filled_section part = vs_section_at(&scene->setup, p);
    for (size_t k = 0; k < part.section->count; k++) {
      const vs_field *f = &part.section->fields[k];
      bool run = !strcmp(part.section->name, "run");
      bool out = !strcmp(f->key, "tier") || !strcmp(f->key, "sample") || !strcmp(f->key, "verify");
      if (f->kind == VS_NAME || (run && out)) continue;
      bool other = !strcmp(f->key, "emf_constant") || !strcmp(f->key, "force_constant");
      bool step = !strcmp(part.section->name, "supply") && !strcmp(f->key, "kind");
      bool valve = !strcmp(part.section->name, "firing") && !strcmp(f->key, "valve");
      bool pwm = !strcmp(part.section->name, "pwm");
      key_test *with = other ? &moving : step ? &direct : valve ? &ideal : pwm ? &modulated : &t;
      change_field(with, part.section->name, f, part.values);
      keys++;
    }
  }
  int changed = t.changed + moving.changed + direct.changed + ideal.changed + modulated.changed;
  EXPECT(changed > keys && keys > 50, "%d keys, %d changed", keys, changed); /* a stop has 4 */
  vs_scene_free(scene);
  free(scene);
  vs_identity_free(t.kept);
}

static void events_count(void) {
  static const char EVENT[] = "events.e={kind: ring_wave, cycle: 2, angle: 90 deg, level: 2 kV}";
  static const char *const OTHERS[] = {"events.e.kind=surge",        "events.e.angle=91deg",
                                       "events.e.cycle=3",           "events.e.level=2.5kV",
                                       "events.e.polarity=negative", "events.e.impedance=30 ohm"};
  char sets[256];
  const scene_id e = id_of("paper", EVENT);
  CU_ASSERT(!same(e, id_of("paper", "run.tier=circuit")));
  for (size_t k = 0; k < COUNT(OTHERS); k++) {
    snprintf(sets, sizeof sets, "%s\n%s", EVENT, OTHERS[k]);
    EXPECT(!same(e, id_of("paper", sets)), "%s has the same id", OTHERS[k]);
  }
  /* the same: 90 deg of the second cycle of 50 Hz */
  CU_ASSERT(same(e, id_of("paper", "events.e={kind: ring_wave, at: 25 ms, level: 2000 V, polarity: "
                                   "positive, impedance: 12 ohm}")));
}

/* ---- decks and parts ---- */

static const char DECK[] = "*$ title mine\n*$ param r1 = 100 ohm 1..1e5 \"a resistor\"\n"
                           "*$ param one = p1 part \"first\"\n*$ param two = p2 part \"second\"\n"
                           "*$ port mains = Vs\n.include more.inc\nVs a 0 external\n"
                           "X1 a b one\nX2 b c two\nR1 c d {r1}\nXeva d 0 eva\n";

static void write_deck(const char *folder, const char *name, const char *deck) {
  static const char *const PARTS[] = {"p1", "p2", "p3"};
  char path[256], text[256];
  mkdir(folder, 0777);
  snprintf(path, sizeof path, "%s/%s", folder, name);
  write_file(path, deck);
  snprintf(path, sizeof path, "%s/more.inc", folder);
  write_file(path, "R9 a 0 1meg\n");
  for (size_t k = 0; k < COUNT(PARTS); k++) {
    snprintf(path, sizeof path, "%s/%s.inc", folder, PARTS[k]);
    snprintf(text, sizeof text, "*$ part resistor \"a part\"\n.subckt %s a b\nR1 a b 1\n.ends\n",
             PARTS[k]);
    write_file(path, text);
  }
}

static void files_count_by_their_contents(void) {
  char changed[sizeof DECK + 32];
  write_deck("one", "d.cir", DECK);
  write_deck("two", "e.cir", DECK);
  const scene_id d = id_of("paper", "circuit.deck=one/d.cir");
  CU_ASSERT(same(d, id_of("paper", "circuit.deck=two/e.cir"))); /* its name is nothing */
  CU_ASSERT(same(d, id_of("paper", "circuit.deck=one/d.cir\ncircuit.two=p2.inc")));
  CU_ASSERT(!same(d, id_of("paper", "circuit.deck=one/d.cir\ncircuit.r1=101 ohm")));
  CU_ASSERT(!same(d, id_of("paper", "circuit.deck=one/d.cir\ncircuit.two=p3")));
  CU_ASSERT(!same(d, id_of("paper", "circuit.deck=one/d.cir\ncircuit.two=p1")));
  write_file("one/p3.inc", ".include p1.inc\n*$ part resistor \"a part\"\n.subckt p3 a b\nR1 a b "
                           "1\n.ends\n"); /* so that the files are the same */
  CU_ASSERT(!same(id_of("paper", "circuit.deck=one/d.cir\ncircuit.one=p3\ncircuit.two=p3"),
                  id_of("paper", "circuit.deck=one/d.cir\ncircuit.one=p3\ncircuit.two=p1")));
  CU_ASSERT(!same(id_of("paper", "circuit.deck=one/d.cir\ncircuit.two=p1"),
                  id_of("paper", "circuit.deck=one/d.cir\ncircuit.one=p2")));
  write_file("two/p2.inc", "*$ part resistor \"a part\"\n.subckt p2 a b\nR1 a b 2\n.ends\n");
  CU_ASSERT(!same(d, id_of("paper", "circuit.deck=two/e.cir")));
  write_deck("two", "e.cir", DECK);
  write_file("two/more.inc", "R9 a 0 2meg\n");
  CU_ASSERT(!same(d, id_of("paper", "circuit.deck=two/e.cir")));
  snprintf(changed, sizeof changed, "%sR8 d 0 1meg\n", DECK);
  write_deck("two", "e.cir", changed);
  CU_ASSERT(!same(d, id_of("paper", "circuit.deck=two/e.cir")));
  write_deck("two", "e.cir", DECK);
  CU_ASSERT(same(d, id_of("paper", "circuit.deck=two/e.cir")));
}

/* ---- of studies ---- */

/* The ids of a file's rows in their order, one behind the other, each with a blank. */
static char *ids_in(const char *path) {
  vs_text ids = {0};
  char *csv = read_file(path), *rest = csv, *line, *cell[64];
  vs_text_add(&ids, "%s", "");
  strsep(&rest, "\n");
  while ((line = strsep(&rest, "\n")) && *line)
    vs_text_add(&ids, "%s ", vs_csv_split(line, cell, COUNT(cell), NULL) > 2 ? cell[1] : "?");
  free(csv);
  return ids.text;
}

static void expect_ids(const char *path, const char *ids, int line) {
  char *got = ids_in(path);
  expect(!strcmp(got, ids), line, "%s: ids '%s' and not '%s'", path, got, ids);
  free(got);
}
#define EXPECT_IDS(path, ids) expect_ids(path, ids, __LINE__)

/* Two scenes, in studies that come to them by different ways and at different places. */
static void studies_agree(void) {
  char ab[64], ba[64];
  const scene_id a = id_of("paper", "run.until=20ms\nfiring.angle=110deg\nsupply.voltage=400V"),
                 b = id_of("paper", "run.until=20ms\nsupply.voltage=400V");
  snprintf(ab, sizeof ab, "%s %s ", a.text, b.text);
  snprintf(ba, sizeof ba, "%s %s ", b.text, a.text);
  write_file("1.yaml", "set: {run.until: 20 ms, supply.voltage: 400 V}\n"
                       "vary: {firing.angle: [100 deg, 110 deg]}\nreport: [p_min]\n");
  EXPECT_EXIT("study 1.yaml -o 1 --quiet", 0);
  EXPECT_IDS("1/study.csv", ba);
  write_file("own.yaml", "# mine\nfiring: {angle: 110 deg}\nrun: {until: 0.02 s, sample: 1 ms}\n");
  write_file("2.yaml", "scene: own.yaml\nset: {supply.frequency: 50 Hz}\n"
                       "vary: {firing.angle: [0.11 krad, 110 deg, 100 deg], supply.voltage: "
                       "[0.4 kV]}\nreport: [i_peak, p_min, ap_peak]\n");
  ran r = run("study 2.yaml");
  EXPECT(r.status == 2, "%s", r.out); /* 0.11 krad is no angle of firing */
  free_ran(&r);
  write_file("2.yaml", "scene: own.yaml\nset: {supply.frequency: 50 Hz}\n"
                       "vary: {firing.angle: [110 deg, 100 deg], supply.voltage: [0.4 kV]}\n"
                       "report: [i_peak, p_min, ap_peak]\n");
  EXPECT_EXIT("study 2.yaml -o 2 --quiet --jobs 1 --keep runs", 0);
  EXPECT_IDS("2/study.csv", ab);
  CU_ASSERT(!access("2/runs/1/run.csv", R_OK)); /* by its number */
  write_file("3.csv", "firing.angle_deg,supply.voltage,run.sample\n90,300 V,1 ms\n110,400 V,2 ms\n"
                      "91,300 V,1 ms\n1e2,400 V,3 ms\n");
  write_file("3.yaml", "vary: 3.csv\nset: {run.until: 20 ms}\nreport: [p_min]\n");
  EXPECT_EXIT("study 3.yaml -o 3/2 --quiet --shard 2/2", 0);
  EXPECT_IDS("3/2/study.csv", ab);
  EXPECT_EXIT("study 3.yaml -o 3/1 --quiet --shard 1/2", 0);
  EXPECT_EXIT("merge 3 -o all --quiet", 0);
  EXPECT_EXIT("study 3.yaml -o one --quiet", 0);
  char *all = read_file("all/study.csv"), *one = read_file("one/study.csv");
  CU_ASSERT(*all && !strcmp(all, one));
  free(all), free(one);
}

/* The same deck by another name and one part's file that has changed, and circuits that run. */
static void circuits_agree(void) {
  static const char STUDY[] = "set: {circuit.deck: halfwave_paper, run.until: 2 ms}\n"
                              "vary: {circuit.thyristor: [latch, mine.inc], circuit.r1: [4.7 kohm, "
                              "100 ohm]}\nreport: [p_min]\n";
  static const char PART[] =
      "*$ part thyristor \"mine\"\n*$ limit v_drm = none\n"
      "*$ limit v_rrm = none\n.subckt mine a k g\nR1 a k %s\nR2 g k 1k\n.ends\n";
  char part[512], ids[2][128];
  write_file("c.yaml", STUDY);
  for (int k = 0; k < 2; k++) {
    snprintf(part, sizeof part, PART, k ? "2meg" : "1meg");
    write_file("mine.inc", part);
    EXPECT_EXIT("study c.yaml -o c --quiet --overwrite", 0);
    char *got = ids_in("c/study.csv");
    snprintf(ids[k], sizeof ids[k], "%s", got);
    free(got);
  }
  CU_ASSERT_EQUAL_FATAL(strlen(ids[0]), 4 * 17);
  CU_ASSERT_EQUAL(strncmp(ids[0], ids[1], 2 * 17), 0);           /* with latch */
  CU_ASSERT_NOT_EQUAL(strncmp(ids[0] + 34, ids[1] + 34, 17), 0); /* with mine */
  CU_ASSERT_NOT_EQUAL(strncmp(ids[0] + 51, ids[1] + 51, 17), 0);
  for (int k = 1; k < 4; k++) CU_ASSERT_NOT_EQUAL(strncmp(ids[0], ids[0] + 17 * k, 17), 0);
  scene_id latch = id_of(
      "paper",
      "circuit.deck=halfwave_paper\nrun.until=2ms\ncircuit.r1=4700 ohm\ncircuit.thyristor=latch");
  CU_ASSERT_EQUAL(strncmp(ids[0], latch.text, 16), 0);
}

/* A run that fails has its id, one whose scene is refused has none; and so has a case that its
 * worker did not live to tell. */
static void failures_have_ids(void) {
  char want[64];
  write_file("f.yaml", "set: {run.until: 0.1 s, firing.every: 1, supply.voltage: 520 V}\n"
                       "vary: {firing.angle: [130 deg, 80 deg], start.p: [0 mm, -7 mm]}\n"
                       "report: [p_min]\n");
  EXPECT_EXIT("study f.yaml -o f --quiet", 1);
  snprintf(want, sizeof want, " %s  ",
           id_of("paper", "run.until=0.1s\nfiring.every=1\nsupply.voltage=520V\nfiring.angle=80deg")
               .text);
  EXPECT_IDS("f/failures.csv", want); /* no start beyond the cover; and the pole is met */
  write_file("h.yaml", "set: {run.sample: 1 ms}\nvary: {run.until: [10 ms, 9e5 s]}\n"
                       "report: [energy_residual]\n"); /* which wants all steps */
  EXPECT_EXIT("study h.yaml -o h --quiet --case-timeout 0.3s", 1);
  snprintf(want, sizeof want, "%s ", id_of("paper", "run.until=9e5s\nrun.sample=2ms").text);
  EXPECT_IDS("h/failures.csv", want);
}

/* A table of an actuator: 4 gaps, 4 currents; `factor` on its flux linkages. */
static void write_table(const char *path, double factor) {
  vs_text t = {0};
  vs_text_add(&t, "z_mm,i_a,lambda_wb\n");
  for (int n = 0; n < 16; n++)
    vs_text_add(&t, "%d,%d,%.12g\n", 2 * (n / 4 + 1), n % 4, factor * (n % 4) / (n / 4 + 1));
  write_file(path, t.text);
  vs_text_free(&t);
}

static void tables_count_by_their_contents(void) {
  write_table("t1.csv", 1);
  write_table("t2.csv", 1);
  write_table("t3.csv", 1.5);
  const scene_id t = id_of("paper", "actuator.law=t1.csv");
  CU_ASSERT(t.read);
  CU_ASSERT(same(t, id_of("paper", "actuator.law=t2.csv"))); /* its name is nothing */
  CU_ASSERT(!same(t, id_of("paper", "actuator.law=t3.csv")));
  CU_ASSERT(!same(t, id_of("paper", "actuator.law=t1.csv\nactuator.gap=5.9 mm")));
}

static const vs_test TESTS[] = {
    {"the same scene", the_same_scene},
    {"every key counts", every_key_counts},
    {"events count", events_count},
    {"tables count by their contents", tables_count_by_their_contents},
    {"files count by their contents", files_count_by_their_contents},
    {"studies agree", studies_agree},
    {"circuits agree", circuits_agree},
    {"failures have ids", failures_have_ids},
};

int main(void) {
  return program_suite("identity", TESTS, COUNT(TESTS));
}
