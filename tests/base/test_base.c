/* SPDX-License-Identifier: GPL-3.0-or-later
 * Wing base: units, names, trees, field tables, files that appear whole or not at all. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/field.h"
#include "base/file.h"
#include "base/gnuplot.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/text.h"
#include "base/tree.h"
#include "base/units.h"
#include "run/engineering.h"
#include "suite.h"

/* The first bytes of a file; empty when it is not there. */
static const char *head(const char *path, char text[256]) {
  FILE *f = fopen(path, "rb");
  text[f ? fread(text, 1, 255, f) : 0] = '\0';
  if (f) fclose(f);
  return text;
}

/* ---- CSV and JSON ---- */

/* Reads rows.csv; of each cell its place and text: "1:1<a>1:3<b>", and of the error its text. */
static vs_text rows_of(const char *text, bool trim, bool comments) {
  vs_text all = {0};
  vs_error err = {0};
  write_file("rows.csv", text);
  FILE *f = fopen("rows.csv", "r");
  vs_csv csv = {.file = "rows.csv", .stream = f, .trim = trim, .comments = comments};
  vs_status status;
  while (!(status = vs_csv_next(&csv, &err)) && csv.count) {
    for (size_t k = 0; k < csv.count; k++)
      vs_text_add(&all, "%d:%d<%s>", csv.where[k].line, csv.where[k].column, csv.cell[k]);
    vs_text_add(&all, ";");
  }
  if (status) vs_text_add(&all, "%s", err.text);
  vs_csv_free(&csv);
  fclose(f);
  return all;
}

static void rows_of_csv(void) {
  static const struct {
    const char *text;
    bool trim, comments;
    const char *rows;
  } ROWS[] = {
      {"", false, false, NULL},
      {"a,b\n1,\n", false, false, "1:1<a>1:3<b>;2:1<1>2:3<>;"},
      {"\xEF\xBB\xBF"
       "a,b\r\n1,2",
       false, false, "1:1<a>1:3<b>;2:1<1>2:3<2>;"},
      {"\"a,b\",\"say \"\"x\"\"\",\"\"\n", false, false, "1:1<a,b>1:7<say \"x\">1:19<>;"},
      {"\"two\nlines\",x\nnext\n", false, false, "1:1<two\nlines>2:8<x>;3:1<next>;"},
      {" a , \" b \" \n\n# \"no\n", true, true, "1:2<a>1:6< b >;"},
      {" a , b\n\n", false, false, "1:1< a >1:5< b>;2:1<>;"},
      {"5\" pipe,a\"b\n", false, false, "1:1<5\" pipe>1:9<a\"b>;"},
      {"a\n1,\"x\n\n", false, false,
       "1:1<a>;rows.csv:2:3: a cell in quotes that has no closing quote"},
      {"\"a\"b\n", true, false, "rows.csv:1:1: behind a cell in quotes a comma is wanted"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text rows = rows_of(ROWS[k].text, ROWS[k].trim, ROWS[k].comments);
    EXPECT(ROWS[k].rows ? rows.text && !strcmp(rows.text, ROWS[k].rows) : !rows.text, "%s: %s",
           ROWS[k].text, rows.text ? rows.text : "no rows");
    vs_text_free(&rows);
  }
}

/* A name that is no UTF-8 must not make a file that is no JSON. */
static void json_is_utf8(void) {
  vs_text text = {0};
  vs_json_string(&text, "a\xfe\xff\xc3\xa4"
                        "b\xc3");
  CU_ASSERT_STRING_EQUAL(text.text, "\"a\\ufffd\\ufffd\xc3\xa4"
                                    "b\\ufffd\"");
  vs_text_free(&text);
}

static void json_is_laid_out(void) {
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_text(&json, "a \"b\"", "\\\n");
  vs_json_array(&json, "rows", VS_JSON_LINES);
  vs_json_object(&json, NULL, VS_JSON_ROW);
  vs_json_number(&json, "x", 1.0 / 3, 3);
  vs_json_number(&json, "y", NAN, 3);
  vs_json_end(&json);
  vs_json_end(&json);
  vs_json_array(&json, "none", VS_JSON_ROW);
  vs_json_end(&json);
  vs_json_same_row(&json);
  vs_json_bool(&json, "yes", true);
  vs_json_whole(&json, "n", -7);
  vs_json_end(&json);
  CU_ASSERT_STRING_EQUAL(text.text, "{\n  \"a \\\"b\\\"\": \"\\\\\\u000a\",\n  \"rows\": [\n"
                                    "    {\"x\": 0.333, \"y\": null}\n  ],\n  \"none\": [], "
                                    "\"yes\": true,\n  \"n\": -7\n}");
  vs_text_free(&text);
}

/* ---- units ---- */

/* A power of ten is one multiplication or division, which rounds once: no digits are lost. */
static void good_quantities(void) {
  static const double DEG = 3.14159265358979323846 / 180;
  const struct {
    const char *text, *unit;
    double si;
  } ROWS[] = {
      {"6 mm", "mm", 0.006},
      {"6mm", "mm", 0.006},
      {"6   mm", "mm", 0.006},
      {"0.006 m", "mm", 0.006},
      {"0.6 cm", "mm", 0.006},
      {"6000 um", "mm", 0.006},
      {"6000 µm", "mm", 0.006},
      {"211.83 mm", "mm", 211.83 / 1000},
      {"-1.5 mm", "m", -0.0015},
      {"+1.5e0 mm", "m", 0.0015},
      {"2 km", "m", 2000},
      {"3.86e-3 kg.m2", "kg.m2", 3.86e-3},
      {"3.86e-3 kg*m2", "kg.m2", 3.86e-3},
      {"3.86e-3 kg . m^2", "kg.m2", 3.86e-3},
      {"3860 g.m2", "kg.m2", 3.86},
      {"830 g", "kg", 0.83},
      {"0.1 N.s/m", "N.s/m", 0.1},
      {"0.1 kg/s", "N.s/m", 0.1},
      {"0.43e5 N/m", "N/m", 43000},
      {"43 kN/m", "N/m", 43000},
      {"1 g/cm3", "g/cm3", 1000},
      {"1.5 g/cm3", "g/cm3", 1500},
      {"1500 kg/m3", "g/cm3", 1500},
      {"380 cm3", "cm3", 380e-6},
      {"95deg", "deg", 95 * DEG},
      {"95 °", "deg", 95 * DEG},
      {"1 rad", "deg", 1},
      {"1 Mohm", "ohm", 1e6},
      {"1 MΩ", "ohm", 1e6},
      {"220 Ohm", "ohm", 220},
      {"4.7 kohm", "ohm", 4700},
      {"1 V/A", "ohm", 1},
      {"5 %", "", 0.05},
      {"0.05", "", 0.05},
      {"1e-4", "", 1e-4},
      {"100 nF", "nF", 1e-7},
      {"47 pF", "nF", 47e-12},
      {"0.1 uF", "nF", 0.1 / 1e6},
      {"0", "mm", 0},
      {"-0.0", "deg", 0},
      {"0 mm", "mm", 0},
      {"0", "", 0},
      {"8 ms", "ms", 0.008},
      {"0.1 ms", "s", 1e-4},
      {"2 min", "s", 120},
      {"50 Hz", "Hz", 50},
      {"50 1/s", "Hz", 50},
      {"50 s-1", "Hz", 50},
      {"175 m/s2", "m/s2", 175},
      {"175 m.s^-2", "m/s2", 175},
      {"0.5 mH", "mH", 5e-4},
      {"440 V", "V", 440},
      {"1 GV", "V", 1e9},
      {"1 Wb", "V.s", 1},
      {"1 J", "N.m", 1},
      {"1 W.s", "J", 1},
      {"7 fF", "F", 7e-15},
      {"47n", "nF", 47e-9},
      {"4n7", "uF", 4.7e-9},
      {"100p", "nF", 1e-10},
      {"330R", "kohm", 330},
      {"4R7", "ohm", 4.7},
      {"4k7", "ohm", 4700},
      {"4.7k", "kohm", 4700},
      {"1meg", "ohm", 1e6},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double si = NAN;
    char why[256] = "";
    bool good = vs_units_read(ROWS[k].text, ROWS[k].unit, &si, why, sizeof why);
    EXPECT(good && si == ROWS[k].si, "'%s' = %.17g, expected %.17g %s", ROWS[k].text, si,
           ROWS[k].si, why);
  }
}

static void bad_quantities(void) {
  static const struct {
    const char *text, *unit, *says[2];
  } ROWS[] = {
      {"", "mm", {"not a number", "in mm"}},
      {"abc", "mm", {"'abc' is not a number", "mm"}},
      {"mm", "mm", {"'mm' is not a number", NULL}},
      {"abc", "", {"'abc' is not a number", "a plain number"}},
      {"6", "mm", {"no unit", "'6 mm'"}},
      {"90", "deg", {"no unit", "'90 deg'"}},
      {"330", "kohm", {"no unit", "'330 ohm' or '330 kohm'"}}, /* not a thousandfold by itself */
      {"47x", "nF", {"'x' is no unit", "write F or nF"}},
      {"20 MS", "s", {"'MS' is no unit", "write ms or Ms: capitals count"}},
      {"1M", "kohm", {"'1M' may be milli or mega", "write '1 mohm' or '1 Mohm'"}},
      {"1m", "uF", {"'1m' may be milli or mega", "write '1 mF' or '1 MF'"}},
      {"4.5k7", "ohm", {"'k7' is no unit", "write"}},
      {"47n", "kg", {"'n' is no unit", "write g or kg"}},
      {"6 kg", "mm", {"'6 kg'", "wrong unit; write mm"}},
      {"6 m2", "mm", {"wrong unit", "mm"}},
      {"0 kg", "mm", {"wrong unit", "mm"}},
      {"5 deg", "", {"wrong unit", "a plain number"}},
      {"5 %", "mm", {"wrong unit", "mm"}},
      {"5 Hz", "rad/s", {"wrong unit", "rad/s"}},
      {"6 mmm", "mm", {"'mmm'", "unit known here; write m or mm"}},
      {"6 mdeg", "deg", {"'mdeg'", "write deg"}},
      {"6 m%", "", {"'m%'", "a plain number"}},
      {"6 MM", "mm", {"'MM'", NULL}},
      {"1,5 mm", "mm", {"'1.5 mm'", "decimal sign"}},
      {"6 mm mm", "mm", {"unit known here", NULL}},
      {"6 m/", "m", {"unit known here", NULL}},
      {"6 /m", "m", {"unit known here", NULL}},
      {"6 m/s/s", "m/s2", {"unit known here", NULL}},
      {"6 m//s2", "m/s2", {"unit known here", NULL}},
      {"6 m.", "m", {"unit known here", NULL}},
      {"6 m^", "m", {"unit known here", NULL}},
      {"6 m10", "m", {"unit known here", NULL}},
      {"6 m99999999999999999999", "m", {"unit known here", NULL}},
      {"nan mm", "mm", {"not a finite", NULL}},
      {"inf", "", {"not a finite", NULL}},
      {"-infinity mm", "mm", {"not a finite", NULL}},
      {"1e999 mm", "mm", {"not a finite", NULL}},
      {"1e308 km", "mm", {"'1e308 km'", NULL}},
      {"0 Gm9.Gm9.Gm9.Gm9/m9.m9.m9.m8", "m", {"Gm9", NULL}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double si = NAN;
    char why[256] = "";
    bool good = vs_units_read(ROWS[k].text, ROWS[k].unit, &si, why, sizeof why);
    EXPECT(!good, "'%s' in %s was read as %g", ROWS[k].text, ROWS[k].unit, si);
    size_t n = strlen(why);
    EXPECT(good || (n > 0 && why[n - 1] != '.'), "'%s': %s", ROWS[k].text, why);
    for (int w = 0; !good && w < 2 && ROWS[k].says[w]; w++)
      EXPECT(strstr(why, ROWS[k].says[w]), "'%s': no '%s' in: %s", ROWS[k].text, ROWS[k].says[w],
             why);
  }
}

static void units_known(void) {
  static const char *const GOOD[] = {"", "m", "kg.m2", "N.s/m", "1/s", "%", "µm", "Mohm", "m^-2"},
                           *const BAD[] = {"x", "mm mm", "m/", "/s", "m2m", "dm", "kk", "."};
  for (size_t k = 0; k < COUNT(GOOD); k++)
    EXPECT(vs_units_known(GOOD[k]), "'%s' is unknown", GOOD[k]);
  for (size_t k = 0; k < COUNT(BAD); k++) EXPECT(!vs_units_known(BAD[k]), "'%s' is known", BAD[k]);
  CU_ASSERT(vs_units_factor("") == 1);
  CU_ASSERT(vs_units_factor("kg") == 1);
  CU_ASSERT(vs_units_factor("min") == 60);
  CLOSE(vs_units_factor("g/cm3"), 1000, 1e-15);
  CLOSE(vs_units_factor("kg.cm2"), 1e-4, 1e-15);
  CLOSE(vs_units_factor("deg"), 0.017453292519943295, 1e-15);
}

/* ---- text ---- */

static void nearest_names(void) {
  static const char *const KEYS[] = {"trough_mass", "base_mass", "gap", "r1", "until", "force"};
  static const struct {
    const char *name, *nearest;
  } ROWS[] = {
      {"trough_mas", "trough_mass"},
      {"through_mass", "trough_mass"},
      {"basemass", "base_mass"},
      {"TROUGH_MASS", "trough_mass"},
      {"R1", "r1"},
      {"gpa", "gap"},
      {"utnil", "until"},
      {"frce", "force"},
      {"gap", "gap"},
      {"xyzzyplugh", NULL},
      {"voltage", NULL},
      {"a_name_that_is_longer_than_any_that_this_function_has_room_for_in_its_rows", NULL},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const char *nearest = vs_text_nearest(ROWS[k].name, KEYS, COUNT(KEYS));
    bool same =
        nearest && ROWS[k].nearest ? !strcmp(nearest, ROWS[k].nearest) : nearest == ROWS[k].nearest;
    EXPECT(same, "nearest to '%s': %s", ROWS[k].name, nearest ? nearest : "none");
  }
  CU_ASSERT_PTR_NULL(vs_text_nearest("gap", KEYS, 0));
  CU_ASSERT_STRING_EQUAL(vs_text_hint("gpa", KEYS, COUNT(KEYS), "; see list").text,
                         "; did you mean 'gap'?");
  CU_ASSERT_STRING_EQUAL(vs_text_hint("voltage", KEYS, COUNT(KEYS), "; see list").text,
                         "; see list");
}

static void unit_suffixes(void) {
  static const struct {
    const char *unit, *suffix;
  } ROWS[] = {{"m", "m"}, {"m/s", "m_s"}, {"m/s2", "m_s2"},   {"rad/s2", "rad_s2"}, {"Wb", "wb"},
              {"A", "a"}, {"V", "v"},     {"N.s/m", "n_s_m"}, {"kg.m2", "kg_m2"},   {"", ""}};
  char suffix[32];
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_units_suffix(ROWS[k].unit, suffix, sizeof suffix);
    EXPECT(!strcmp(suffix, ROWS[k].suffix), "'%s': '%s'", ROWS[k].unit, suffix);
  }
  memset(suffix, 'x', sizeof suffix);
  vs_units_suffix("rad/s2", suffix, 4);
  CU_ASSERT_STRING_EQUAL(suffix, "rad");
  CU_ASSERT_EQUAL(suffix[4], 'x');
}

/* What a column's name ends in, read back: with capitals lost or kept, and '.' and '/' told apart
 * by the kind of unit that is wanted. */
static void units_from_suffixes(void) {
  static const struct {
    const char *suffix, *unit;
    double factor;
  } ROWS[] = {{"m", "m", 1},
              {"mm", "m", 1e-3},
              {"um", "mm", 1e-6},
              {"a", "A", 1},
              {"ma", "A", 1e-3},
              {"mA", "A", 1e-3},
              {"MA", "A", 1e6},
              {"kv", "V", 1e3},
              {"wb", "Wb", 1},
              {"mwb", "Wb", 1e-3},
              {"v_s", "Wb", 1},
              {"n", "N", 1},
              {"kn", "N", 1e3},
              {"mhz", "Hz", 1e-3},
              {"ms", "s", 1e-3},
              {"min", "s", 60},
              {"mm_s2", "m/s2", 1e-3},
              {"mm_ms2", "m/s2", 1e3},
              {"deg_s", "rad/s", 3.14159265358979323846 / 180},
              {"kn_ms_m", "N.s/m", 1},
              {"n_mm", "N.m", 1e-3},
              {"n_mm", "N/m", 1e3},
              {"v_us", "V/s", 1e6},
              {"m", "kg", NAN},
              {"M", "m", NAN},
              {"m_s", "m/s2", NAN},
              {"m_s2_kg", "m/s2", NAN},
              {"_m", "m", NAN},
              {"m_", "m", NAN},
              {"", "m", NAN},
              {"x", "m", NAN}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double factor = vs_units_suffix_factor(ROWS[k].suffix, ROWS[k].unit);
    EXPECT(isnan(ROWS[k].factor) ? isnan(factor)
                                 : fabs(factor / ROWS[k].factor - 1) < 1e-15, /* rounding */
           "'%s' as %s: %.17g", ROWS[k].suffix, ROWS[k].unit, factor);
  }
}

static void growing_text(void) {
  vs_text t = {0};
  for (int k = 0; k < 1000; k++) vs_text_add(&t, "%03d,", k);
  CU_ASSERT_EQUAL(t.length, 4000);
  CU_ASSERT_EQUAL(strlen(t.text), 4000);
  CU_ASSERT_STRING_EQUAL(t.text + 3992, "998,999,");
  vs_text_free(&t);
  CU_ASSERT_PTR_NULL(t.text);
  vs_json_string(&t, "a \"b\" \\ \n\x01 ü");
  CU_ASSERT_STRING_EQUAL(t.text, "\"a \\\"b\\\" \\\\ \\u000a\\u0001 ü\"");
  vs_text_free(&t);
}

static void errors_are_one_line(void) {
  static const struct {
    vs_where where;
    const char *text;
  } ROWS[] = {{{"s.yaml", 3, 7}, "s.yaml:3:7: what: 5"},
              {{"--set a=1", 0, 0}, "--set a=1: what: 5"},
              {{NULL, 0, 0}, "what: 5"}};
  vs_error err = {0};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    CU_ASSERT_EQUAL(vs_fail_at(&err, ROWS[k].where, "what: %d", 5), VS_INPUT);
    CU_ASSERT_STRING_EQUAL(err.text, ROWS[k].text);
  }
  CU_ASSERT_EQUAL(vs_fail(&err, VS_SIGNAL, "%s", "stop"), VS_SIGNAL);
  CU_ASSERT_STRING_EQUAL(err.text, "stop");
  char *endless = vs_alloc(4 * sizeof err.text + 1, 1);
  memset(endless, 'x', 4 * sizeof err.text);
  vs_fail_at(&err, (vs_where){"f", 1, 1}, "%s", endless);
  CU_ASSERT_EQUAL(strlen(err.text), sizeof err.text - 1);
  CU_ASSERT_EQUAL(strncmp(err.text, "f:1:1: xxx", 10), 0);
  free(endless);
  vs_fail(&err, VS_RUN, "two\nlines");
  CU_ASSERT_PTR_NULL(strchr(err.text, '\n'));
  vs_fail_at(&err, (vs_where){"f\nf", 1, 1}, "key '%s'", "a\r\nb");
  CU_ASSERT_PTR_NULL(strpbrk(err.text, "\r\n"));
}

static void errors_can_be_carried_on_from(void) {
  static const vs_where PLACES[] = {{"b", 2, 1}, {"a", 3, 1}, {"b", 1, 9}, {"b", 2, 1},
                                    {"b", 1, 2}, {"a", 0, 0}, {NULL, 0, 0}};
  static const char *const SORTED[] = {"b:1:2: e", "b:1:9: e", "b:2:1: e", "a: e", "a:3:1: e", "e"};
  vs_findings *all = vs_alloc(1, sizeof *all);
  vs_error err = {0};
  CU_ASSERT_EQUAL(vs_error_keep(&err, vs_fail(&err, VS_INPUT, "e")), VS_INPUT); /* kept nowhere */
  CU_ASSERT_EQUAL(vs_error_count(&err), 0);
  err.findings = all;
  for (size_t k = 0; k < COUNT(PLACES); k++) /* one of them twice */
    CU_ASSERT_EQUAL(vs_error_keep(&err, vs_fail_at(&err, PLACES[k], "e")), VS_OK);
  CU_ASSERT_EQUAL(vs_error_keep(&err, VS_OK), VS_OK);
  CU_ASSERT_EQUAL(vs_error_keep(&err, vs_fail(&err, VS_RUN, "no input")), VS_RUN);
  CU_ASSERT_EQUAL_FATAL(vs_error_count(&err), COUNT(SORTED));
  for (size_t k = 0; k < COUNT(SORTED); k++) CU_ASSERT_STRING_EQUAL(all->item[k].text, SORTED[k]);
  const vs_error *e = &all->item[1];
  CU_ASSERT_EQUAL(e->line, 1);
  CU_ASSERT_EQUAL(e->column, 9);
  CU_ASSERT_EQUAL(e->file_size, 1);
  CU_ASSERT_STRING_EQUAL(e->text + e->place_size, "e");
  for (int k = 0; vs_error_count(&err) < VS_MOST_FINDINGS; k++)
    vs_error_keep(&err, vs_fail(&err, VS_INPUT, "%d", k));
  CU_ASSERT_EQUAL(vs_error_keep(&err, vs_fail(&err, VS_INPUT, "no room")), VS_INPUT);
  free(all);
}

/* A letter of two bytes is one column. */
static void columns_are_characters(void) {
  static const char LINE[] = "aµb\tc";
  CU_ASSERT_EQUAL(vs_text_column(LINE, LINE), 1);
  CU_ASSERT_EQUAL(vs_text_column(LINE, LINE + 3), 3);
  CU_ASSERT_EQUAL(vs_text_column(LINE, LINE + 5), 5);
}

/* ---- trees ---- */

/* "a.b", and "0", "1", ... for the elements of a list */
static const vs_node *node_at(const vs_node *node, const char *path) {
  char words[128], *rest = words;
  snprintf(words, sizeof words, "%s", path);
  for (char *word; node && (word = strsep(&rest, "."));) {
    if (node->kind == VS_NODE_MAP) {
      node = vs_tree_child(node, word);
      continue;
    }
    node = node->child;
    for (long n = strtol(word, NULL, 10); node && n > 0; n--) node = node->next;
  }
  return node;
}

static const char *text_of(const vs_tree *tree, const char *path) {
  const vs_node *node = node_at(tree->root, path);
  return node && node->kind == VS_NODE_TEXT ? node->text : "(no text)";
}

static const char SCENE[] = "# a comment\n"
                            "machine:\n"
                            "  trough_mass: 1 kg   # behind it\n"
                            "  base_com: [1 mm, 2 mm]\n"
                            "run: {until: 2 s, sample: \"0.1 ms\"}\n"
                            "empty:\n"
                            "record:\n"
                            "  - p\n"
                            "  - i\n"
                            "other: {}\r\n";

static void a_tree_remembers_where_things_stood(void) {
  const struct {
    const char *path, *text;
    vs_node_kind kind;
    int line, column, key_line, key_column;
  } ROWS[] = {
      {"machine", NULL, VS_NODE_MAP, 3, 3, 2, 1},
      {"machine.trough_mass", "1 kg", VS_NODE_TEXT, 3, 16, 3, 3},
      {"machine.base_com", NULL, VS_NODE_LIST, 4, 14, 4, 3},
      {"machine.base_com.0", "1 mm", VS_NODE_TEXT, 4, 14, 0, 0},
      {"machine.base_com.1", "2 mm", VS_NODE_TEXT, 4, 20, 0, 0},
      {"run.until", "2 s", VS_NODE_TEXT, 5, 14, 5, 7},
      {"run.sample", "0.1 ms", VS_NODE_TEXT, 5, 28, 5, 19},
      {"empty", "", VS_NODE_TEXT, 6, is_newer_yaml() ? 6 : 1, 6, 1},
      {"record.0", "p", VS_NODE_TEXT, 8, 5, 0, 0},
      {"record.1", "i", VS_NODE_TEXT, 9, 5, 0, 0},
      {"other", NULL, VS_NODE_MAP, 10, 1, 10, 1},
  };
  vs_tree tree;
  vs_error err = {0};
  write_file("s.yaml", SCENE);
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("s.yaml", &tree, &err), VS_OK);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const vs_node *n = node_at(tree.root, ROWS[k].path);
    EXPECT(n != NULL, "no %s", ROWS[k].path);
    if (!n) continue;
    EXPECT(n->kind == ROWS[k].kind, "%s: kind %d", ROWS[k].path, (int)n->kind);
    EXPECT(!ROWS[k].text || !strcmp(n->text, ROWS[k].text), "%s: '%s'", ROWS[k].path, n->text);
    EXPECT(n->where.line == ROWS[k].line && n->where.column == ROWS[k].column &&
               !strcmp(n->where.file, "s.yaml"),
           "%s: %s:%d:%d", ROWS[k].path, n->where.file, n->where.line, n->where.column);
    EXPECT(!n->key ||
               (n->key_where.line == ROWS[k].key_line && n->key_where.column == ROWS[k].key_column),
           "%s: key at %d:%d", ROWS[k].path, n->key_where.line, n->key_where.column);
  }
  CU_ASSERT_PTR_NULL(vs_tree_child(tree.root, "nothing"));
  CU_ASSERT_PTR_NULL(vs_tree_child(NULL, "nothing"));
  vs_tree_free(&tree);
}

static void files_that_say_nothing_are_empty_maps(void) {
  static const char *const TEXTS[] = {"", "\n\n", "# only this\n", "---\n", "{}\n"};
  for (size_t k = 0; k < COUNT(TEXTS); k++) {
    vs_tree tree;
    vs_error err = {0};
    write_file("s.yaml", TEXTS[k]);
    EXPECT(!vs_tree_read("s.yaml", &tree, &err) && tree.root->kind == VS_NODE_MAP &&
               !tree.root->child,
           "'%s': %s", TEXTS[k], err.text);
    vs_tree_free(&tree);
  }
}

static void bad_files_are_refused(void) {
  static const struct {
    const char *text, *says[2];
  } ROWS[] = {
      {"a: {b: 1\n", {"s.yaml:2:1: ", "not YAML"}},
      {"a: [1\n", {"s.yaml:2:1: ", "not YAML"}},
      {"a:\n\tb: 1\n", {"s.yaml:2:1: ", "tab"}},
      {"a: 1\nb: 2\na: 3\n", {"s.yaml:3:1: ", "duplicate"}},
      {"a: 1\n---\nb: 2\n", {"s.yaml", "second document"}},
      {"a: 1\n---\nb: [\n", {"s.yaml:", "not YAML"}},
      {"a: &x 1\nb: *x\n", {"s.yaml:2:", "aliases"}},
      {"a: &x {c: 1}\nb: [*x]\n", {"s.yaml:2:", "aliases"}},
      {"? [a]\n: 1\n", {"s.yaml:1:", "plain name"}},
      {"[1, 2]\n", {"s.yaml:1:2: ", "key: value"}},
      {"hello\n", {"s.yaml:1:1: ", "key: value"}},
      {"a: \"\xff\"\n", {"s.yaml:1:", "UTF8"}},
  };
  vs_tree tree;
  vs_error err = {0};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    err.text[0] = '\0';
    write_file("s.yaml", ROWS[k].text);
    EXPECT(vs_tree_read("s.yaml", &tree, &err) == VS_INPUT, "'%s' was read", ROWS[k].text);
    for (int w = 0; w < 2; w++)
      EXPECT(strstr(err.text, ROWS[k].says[w]), "'%s': no '%s' in: %s", ROWS[k].text,
             ROWS[k].says[w], err.text);
    vs_tree_free(&tree);
  }
  CU_ASSERT_EQUAL(vs_tree_read("nowhere.yaml", &tree, &err), VS_INPUT);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "nowhere.yaml: cannot be opened: No such file"));
  vs_tree_free(&tree);
  char sum[VS_HASH_TEXT];
  CU_ASSERT_EQUAL(vs_hash_file("no.law", sum, &err), VS_INPUT);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "no.law: cannot be opened: No such file"));
}

static void what_is_set_lies_over_the_file(void) {
  static const struct {
    const char *assignment, *path, *text;
  } ROWS[] = {
      {"machine.trough_mass=2 kg", "machine.trough_mass", "2 kg"},
      {"run.until=3s", "run.until", "3s"},
      {"run.until=4s", "run.until", "4s"}, /* the later one counts */
      {"firing.angle=95deg", "firing.angle", "95deg"},
      {"machine.base_com=[5 mm, 6 mm]", "machine.base_com.1", "6 mm"},
      {"record=all", "record", "all"},
      {"load={fraction: 0.5}", "load.fraction", "0.5"},
      {"empty.now=filled", "empty.now", "filled"},
      {"circuit.deck=a=b.cir", "circuit.deck", "a=b.cir"},
      {"run.sample=", "run.sample", ""},
      {"a.b.c.d=1", "a.b.c.d", "1"},
  };
  vs_tree tree;
  vs_error err = {0};
  write_file("s.yaml", SCENE);
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("s.yaml", &tree, &err), VS_OK);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char label[128];
    snprintf(label, sizeof label, "--set %s", ROWS[k].assignment);
    EXPECT(!vs_tree_set(&tree, ROWS[k].assignment, &err), "%s: %s", label, err.text);
    EXPECT(!strcmp(text_of(&tree, ROWS[k].path), ROWS[k].text), "%s: %s = '%s'", label,
           ROWS[k].path, text_of(&tree, ROWS[k].path));
    const vs_node *n = node_at(tree.root, ROWS[k].path);
    EXPECT(n && n->where.line == 0 && !strcmp(n->where.file, label), "%s: stands at %s", label,
           n ? n->where.file : "");
  }
  CU_ASSERT_STRING_EQUAL(text_of(&tree, "machine.base_com.0"), "5 mm");
  CU_ASSERT_PTR_NULL(node_at(tree.root, "machine.base_com.2"));
  CU_ASSERT_PTR_NULL(node_at(tree.root, "machine")->next->next->next->next->child); /* record */
  vs_tree_free(&tree);
}

static void bad_settings_are_refused(void) {
  static const char *const ROWS[] = {"", "run.until", "=1", "run.until=[1", "a={b: 1", "a=*b"};
  vs_tree tree;
  vs_error err = {0};
  write_file("s.yaml", SCENE);
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("s.yaml", &tree, &err), VS_OK);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char label[64];
    snprintf(label, sizeof label, "--set %s: ", ROWS[k]);
    EXPECT(vs_tree_set(&tree, ROWS[k], &err) == VS_INPUT, "%swas taken", label);
    EXPECT(!strncmp(err.text, label, strlen(label)), "%s%s", label, err.text);
  }
  CU_ASSERT_STRING_EQUAL(text_of(&tree, "run.until"), "2 s");
  vs_tree_free(&tree);
}

/* ---- fields ---- */

typedef struct values {
  double gap_m, angle_rad, pair_m[2];
  int choice, count;
  char name[VS_NAME_SIZE];
} values;
#define AT(member) offsetof(values, member)

static const vs_field FIELDS[] = {
    {"gap", VS_REAL, "mm", "6 mm", 0, 10, false, AT(gap_m), "closed range", NULL, NULL},
    {"angle", VS_REAL, "deg", "100 deg", 0, 180, true, AT(angle_rad), "open range", NULL, NULL},
    {"place", VS_PAIR, "mm", "1 mm, 2 mm", -5, 5, false, AT(pair_m), "two numbers", NULL, NULL},
    {"kind", VS_CHOICE, "", "paper", 0, 0, false, AT(choice), "a word", "none|paper|derived", NULL},
    {"every", VS_COUNT, "", "once", 1, 9, false, AT(count), "a whole number", "once", NULL},
    {"deck", VS_NAME, "", "standard", 0, 0, false, AT(name), "a name", NULL, NULL},
};
static const vs_section SECTION = {"part", FIELDS, COUNT(FIELDS)};

static vs_status read_part(const char *yaml, values *v, vs_error *err) {
  vs_tree tree;
  memset(v, 0x55, sizeof *v); /* every member must be written */
  write_file("part.yaml", yaml);
  vs_status status = vs_tree_read("part.yaml", &tree, err);
  if (!status) status = vs_field_section_read(&SECTION, vs_tree_child(tree.root, "part"), v, err);
  vs_tree_free(&tree);
  return status;
}

static const vs_inside PLACES = {
    .rows = VS_ROWS({"at", .kind = VS_NEEDED | VS_LIST}, {"on", .kind = VS_TEXT}),
    .besides = &SECTION};

/* A map has the keys of its rows, and those of a section besides. */
static void keys_of_a_map(void) {
  static const char *const ROWS[][2] = {
      {"part: {at: [0, 0], on: base, gap: 1 mm}", ""},
      {"part: {att: [0, 0]}",
       "part has no key 'att'; did you mean 'at'? it has: at, on, gap, angle, "
       "place, kind, every, deck"},
      {"part: {evry: 2}", "did you mean 'every'?"},
      {"part: [at, on]", "part: a map of keys is wanted, and this is a list"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_tree tree;
    vs_error err = {0};
    write_file("part.yaml", ROWS[k][0]);
    CU_ASSERT_EQUAL(vs_tree_read("part.yaml", &tree, &err), VS_OK);
    vs_status status = vs_field_map_keys(vs_tree_child(tree.root, "part"), "part", &PLACES, &err);
    EXPECT((status == VS_OK) == !*ROWS[k][1] && strstr(err.text, ROWS[k][1]), "%s: %s", ROWS[k][0],
           err.text);
    vs_tree_free(&tree);
  }
}

static void defaults_fill_what_is_not_named(void) {
  static const char *const TEXTS[] = {"", "part:\n", "part: {}\n"};
  for (size_t k = 0; k < COUNT(TEXTS); k++) {
    values v;
    vs_error err = {0};
    EXPECT(!read_part(TEXTS[k], &v, &err), "'%s': %s", TEXTS[k], err.text);
    EXPECT(v.gap_m == 0.006 && v.pair_m[0] == 0.001 && v.pair_m[1] == 0.002, "'%s'", TEXTS[k]);
    EXPECT(v.choice == 1 && v.count == 0 && !strcmp(v.name, "standard"), "'%s'", TEXTS[k]);
    CLOSE(v.angle_rad, 1.7453292519943295, 1e-15);
  }
}

static void good_fields(void) {
  values v;
  vs_error err = {0};
  CU_ASSERT_EQUAL(read_part("part: {gap: 10 mm, angle: 0.001 deg, place: [-5 mm, 0], kind: none,\n"
                            "  every: 9, deck: my deck.cir}\n",
                            &v, &err),
                  VS_OK);
  CU_ASSERT(v.gap_m == 0.01);
  CLOSE(v.angle_rad, 1.7453292519943295e-5, 1e-15);
  CU_ASSERT(v.pair_m[0] == -0.005 && v.pair_m[1] == 0);
  CU_ASSERT_EQUAL(v.choice, 0);
  CU_ASSERT_EQUAL(v.count, 9);
  CU_ASSERT_STRING_EQUAL(v.name, "my deck.cir");
  CU_ASSERT_EQUAL(read_part("part: {gap: 0, every: once, kind: derived}\n", &v, &err), VS_OK);
  CU_ASSERT(v.gap_m == 0);
  CU_ASSERT_EQUAL(v.count, 0);
  CU_ASSERT_EQUAL(v.choice, 2);
}

static void bad_fields(void) {
  static const struct {
    const char *part, *at, *says[2];
  } ROWS[] = {
      {"{gpa: 1 mm}", "part.yaml:1:8: ", {"'gpa'", "did you mean 'gap'?"}},
      {"{voltage_of_mains: 1 V}", "part.yaml:1:8: ", {"part has no key", NULL}},
      {"{gap: 10.001 mm}", "part.yaml:1:13: ", {"out of range", "0..10 mm"}},
      {"{gap: -1 um}", "part.yaml:1:13: ", {"part.gap: -1 um is out of range", "0..10 mm"}},
      {"{gap: 1}", "part.yaml:1:13: ", {"part.gap", "no unit"}},
      {"{gap: 1 V}", "part.yaml:1:13: ", {"wrong unit", "mm"}},
      {"{gap: [1 mm]}", "part.yaml:1:14: ", {"one value", "6 mm"}},
      {"{gap: {a: 1 mm}}", "part.yaml:1:", {"one value", "6 mm"}},
      {"{gap: ''}", "part.yaml:1:14: ", {"not a number", "mm"}},
      {"{angle: 0}", "part.yaml:1:15: ", {"out of range", "0..180 deg (ends excluded)"}},
      {"{angle: 180 deg}", "part.yaml:1:15: ", {"out of range", "ends excluded"}},
      {"{place: 1 mm}", "part.yaml:1:15: ", {"part.place", "[x, y]"}},
      {"{place: [1 mm]}", "part.yaml:1:16: ", {"[x, y]", NULL}},
      {"{place: [1 mm, 2 mm, 3 mm]}", "part.yaml:1:16: ", {"[x, y]", NULL}},
      {"{place: [1 mm, 6 mm]}", "part.yaml:1:22: ", {"out of range", "-5..5 mm"}},
      {"{place: [1 mm, [2 mm]]}", "part.yaml:1:23: ", {"one value", NULL}},
      {"{kind: Paper}", "part.yaml:1:14: ", {"'Paper'", "none|paper|derived"}},
      {"{kind: pap}", "part.yaml:1:14: ", {"'pap'", "none|paper|derived"}},
      {"{kind: [paper]}", "part.yaml:1:15: ", {"a list or map", "none|paper|derived"}},
      {"{every: 0}", "part.yaml:1:15: ", {"out of range", "once or 1..9"}},
      {"{every: 10}", "part.yaml:1:15: ", {"out of range", "once or 1..9"}},
      {"{every: 1.5}", "part.yaml:1:15: ", {"1.5", "whole number"}},
      {"{every: twice}", "part.yaml:1:15: ", {"not a number", NULL}},
      {"{deck: ''}", "part.yaml:1:15: ", {"a name", "standard"}},
      {"{deck: [a]}", "part.yaml:1:15: ", {"a name", "standard"}},
      {"[1]", "part.yaml:1:8: ", {"part: a map", NULL}},
      {"3", "part.yaml:1:7: ", {"part: a map", NULL}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char yaml[128];
    values v;
    vs_error err = {0};
    snprintf(yaml, sizeof yaml, "part: %s\n", ROWS[k].part);
    EXPECT(read_part(yaml, &v, &err) == VS_INPUT, "%s was read", ROWS[k].part);
    EXPECT(!strncmp(err.text, ROWS[k].at, strlen(ROWS[k].at)), "%s: not at %s: %s", ROWS[k].part,
           ROWS[k].at, err.text);
    for (int w = 0; w < 2 && ROWS[k].says[w]; w++)
      EXPECT(strstr(err.text, ROWS[k].says[w]), "%s: no '%s' in: %s", ROWS[k].part, ROWS[k].says[w],
             err.text);
  }
  char yaml[VS_NAME_SIZE + 64] = "part: {deck: ";
  values v;
  vs_error err = {0};
  memset(yaml + strlen(yaml), 'x', VS_NAME_SIZE);
  strcat(yaml, "}\n");
  CU_ASSERT_EQUAL(read_part(yaml, &v, &err), VS_INPUT);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "longer than 255 bytes"));
}

static void fields_as_json_and_ranges(void) {
  static const struct {
    const char *json, *range;
  } ROWS[] = {{"{\"value\": 6, \"unit\": \"mm\"}", "0..10 mm"},
              {"{\"value\": 100, \"unit\": \"deg\"}", "0..180 deg (ends excluded)"},
              {"{\"value\": [1, 2], \"unit\": \"mm\"}", "-5..5 mm"},
              {"\"paper\"", "none|paper|derived"},
              {"\"once\"", "once or 1..9"},
              {"\"standard\"", ""}};
  values v;
  vs_error err = {0};
  char range[128];
  CU_ASSERT_EQUAL_FATAL(read_part("", &v, &err), VS_OK);
  for (size_t k = 0; k < COUNT(FIELDS); k++) {
    vs_text json = {0};
    vs_field_json(&FIELDS[k], &v, &json);
    EXPECT(!strcmp(json.text, ROWS[k].json), "%s: %s", FIELDS[k].key, json.text);
    vs_text_free(&json);
    vs_field_range(&FIELDS[k], range, sizeof range);
    EXPECT(!strcmp(range, ROWS[k].range), "%s: %s", FIELDS[k].key, range);
  }
  CU_ASSERT_EQUAL(read_part("part: {every: 3}", &v, &err), VS_OK);
  vs_text json = {0};
  vs_field_json(&FIELDS[4], &v, &json);
  CU_ASSERT_STRING_EQUAL(json.text, "3");
  vs_text_free(&json);
}

/* ---- files ---- */

static void a_committed_file_is_there_whole(void) {
  vs_file file;
  vs_error err = {0};
  char text[256];
  struct stat st;
  CU_ASSERT_EQUAL(mkdir("there", 0777), 0);
  write_file("there/run.csv", "old");
  mode_t mask = umask(022);
  CU_ASSERT_EQUAL_FATAL(vs_file_open(&file, "there", "run.csv", &err), VS_OK);
  fputs("new and longer", file.stream);
  fflush(file.stream);
  CU_ASSERT_STRING_EQUAL(head("there/run.csv", text), "old");
  CU_ASSERT_EQUAL(vs_file_commit(&file, &err), VS_OK);
  CU_ASSERT_PTR_NULL(file.stream);
  CU_ASSERT_STRING_EQUAL(head("there/run.csv", text), "new and longer");
  CU_ASSERT_EQUAL(stat("there/run.csv", &st), 0);
  CU_ASSERT_EQUAL(st.st_mode & 0777, 0644);
  EXPECT_FILES("there", "run.csv ");
  vs_file_discard(&file); /* safe on a closed one */
  CU_ASSERT_EQUAL_FATAL(vs_file_open(&file, "", "beside.csv", &err), VS_OK);
  CU_ASSERT_EQUAL(vs_file_commit(&file, &err), VS_OK);
  CU_ASSERT_EQUAL(unlink("beside.csv"), 0);
  umask(mask);
}

static void a_discarded_file_never_was(void) {
  vs_file file = {0};
  vs_error err = {0};
  char text[256];
  vs_file_discard(&file);
  CU_ASSERT_EQUAL(mkdir("gone", 0777), 0);
  CU_ASSERT_EQUAL_FATAL(vs_file_open(&file, "gone", "run.csv", &err), VS_OK);
  fputs("something", file.stream);
  vs_file_discard(&file);
  CU_ASSERT_PTR_NULL(file.stream);
  EXPECT_FILES("gone", "");
  write_file("gone/run.csv", "old");
  CU_ASSERT_EQUAL_FATAL(vs_file_open(&file, "gone", "run.csv", &err), VS_OK);
  vs_file_discard(&file);
  CU_ASSERT_STRING_EQUAL(head("gone/run.csv", text), "old");
  EXPECT_FILES("gone", "run.csv ");
}

static void a_file_is_committed_under_another_name(void) {
  vs_file file;
  vs_error err = {0};
  char text[256];
  CU_ASSERT_EQUAL(mkdir("other", 0777), 0);
  CU_ASSERT_EQUAL_FATAL(vs_file_open(&file, "other", "run.csv", &err), VS_OK);
  fputs("half", file.stream);
  CU_ASSERT_EQUAL(vs_file_commit_as(&file, "other", "run.partial.csv", &err), VS_OK);
  EXPECT_FILES("other", "run.partial.csv ");
  CU_ASSERT_STRING_EQUAL(head("other/run.partial.csv", text), "half");
}

static void files_that_cannot_be_written(void) {
  vs_file file;
  vs_error err = {0};
  CU_ASSERT_EQUAL(vs_file_open(&file, "nowhere", "run.csv", &err), VS_INPUT);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "nowhere/run.csv: cannot be written: No such file"));
  vs_file_discard(&file);
  CU_ASSERT_EQUAL(mkdir("blocked", 0777), 0);
  CU_ASSERT_EQUAL_FATAL(vs_file_open(&file, "blocked", "run.csv", &err), VS_OK);
  fputs("text", file.stream);
  CU_ASSERT_EQUAL(mkdir("blocked/run.csv", 0777), 0); /* a rename onto it must fail */
  CU_ASSERT_EQUAL(vs_file_commit(&file, &err), VS_RUN);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "blocked/run.csv: cannot be written"));
  EXPECT_FILES("blocked", "run.csv ");
  CU_ASSERT_EQUAL(vs_file_open(&file, "blocked", "run.csv", &err), VS_INPUT); /* seen at once */
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "blocked/run.csv: "));
  vs_file_discard(&file);
}

static void folders(void) {
  static const struct {
    const char *folder, *says;
  } BAD[] = {{"", "empty"}, {"plain", "not a directory"}, {"plain/below", "Not a directory"}};
  vs_error err = {0};
  int made = -1;
  write_file("plain", "");
  CU_ASSERT_EQUAL(vs_file_folder_make("one/two/three", &made, &err), VS_OK);
  CU_ASSERT_EQUAL(made, 3);
  EXPECT_FILES("one/two", "three ");
  vs_file_folder_unmake("one/two/three", 2);
  EXPECT_FILES("one", "");
  CU_ASSERT_EQUAL(vs_file_folder_make("one/four/five/", &made, &err), VS_OK);
  CU_ASSERT_EQUAL(made, 2);
  write_file("one/four/kept", "");
  vs_file_folder_unmake("one/four/five/", made);
  EXPECT_FILES("one/four", "kept ");
  CU_ASSERT_EQUAL(vs_file_folder_make("one/four", &made, &err), VS_OK); /* there already */
  CU_ASSERT_EQUAL(made, 0);
  vs_file_folder_unmake("one/four", made);
  EXPECT_FILES("one", "four ");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    EXPECT(vs_file_folder_make(BAD[k].folder, &made, &err) == VS_INPUT, "'%s' was made",
           BAD[k].folder);
    EXPECT(strstr(err.text, BAD[k].says), "'%s': %s", BAD[k].folder, err.text);
  }
}

static const vs_shelf SHELF = {"scene", "scenes", ".yaml"};

static void add_listed(void *ctx, const char *path) {
  if (strstr(path, "library/")) vs_text_add(ctx, "%s ", path);
}

static void shipped_files_are_found(void) {
  vs_error err = {0};
  vs_text listed = {0};
  int made;
  char path[VS_PATH_SIZE];
  const vs_where asked = {"s.yaml", 4, 2};
  CU_ASSERT_EQUAL(vs_file_folder_make("library/scenes", &made, &err), VS_OK);
  write_file("library/scenes/mine.yaml", "");
  write_file("library/scenes/another.yaml", "");
  write_file("library/scenes/notes.txt", "");
  setenv("VIBROSPICE_PATH", "nowhere::library", 1);
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "mine", asked, path, &err), VS_OK);
  CU_ASSERT_STRING_EQUAL(path, "library/scenes/mine.yaml");
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "library/scenes/notes.txt", asked, path, &err), VS_OK);
  CU_ASSERT_STRING_EQUAL(path, "library/scenes/notes.txt");
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "paper", asked, path, &err), VS_OK);
  CU_ASSERT_PTR_NULL(strstr(path, "library/"));
  write_file("library/scenes/paper.yaml", ""); /* the user's own comes first */
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "paper", asked, path, &err), VS_OK);
  CU_ASSERT_STRING_EQUAL(path, "library/scenes/paper.yaml");
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "anothr", asked, path, &err), VS_INPUT);
  CU_ASSERT_EQUAL(strncmp(err.text, "s.yaml:4:2: no scene 'anothr'", 29), 0);
  CU_ASSERT_PTR_NOT_NULL(strstr(err.text, "did you mean 'another'?"));
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "library", asked, path, &err), VS_INPUT); /* a folder */
  CU_ASSERT_EQUAL(vs_path_find(&SHELF, "", asked, path, &err), VS_INPUT);
  vs_path_list(&SHELF, add_listed, &listed);
  CU_ASSERT_STRING_EQUAL(listed.text, "library/scenes/another.yaml library/scenes/mine.yaml "
                                      "library/scenes/paper.yaml ");
  vs_text_free(&listed);
  unsetenv("VIBROSPICE_PATH");
}

/* ---- numbers ---- */

static bool prints_as_printf(double value, int digits) {
  char got[VS_NUMBER_SIZE], expected[64];
  size_t length = vs_text_number(got, value, digits);
  snprintf(expected, sizeof expected, "%.*g", digits, value);
  bool same = !strcmp(got, expected) && length == strlen(expected);
  EXPECT(same, "%.17g with %d digits: %s, and printf has %s", value, digits, got, expected);
  return same;
}

/* Any bits at all; what a run writes; the middle between two numbers, which must round as printf
 * does; around powers of ten, where the number of digits changes. */
static void numbers_are_written_as_printf_does(void) {
  static const double SPECIAL[] = {0,    -0.0, 1,       -1,   INFINITY,  -INFINITY, NAN,
                                   1e22, 1e23, 5e-324,  1e15, 123456789, 0.5,       9.5,
                                   0.1,  1e-4, 9.99e-5, 1e-5, DBL_MAX,   DBL_MIN,   999999999.5};
  bool good = true;
  for (size_t k = 0; k < COUNT(SPECIAL); k++)
    for (int digits = 1; digits <= 17; digits++) good &= prints_as_printf(SPECIAL[k], digits);
  uint64_t bits = 88172645463325252u; /* xorshift */
  for (int n = 0; n < 100000 && good; n++) {
    double any;
    bits ^= bits << 13, bits ^= bits >> 7, bits ^= bits << 17;
    memcpy(&any, &bits, sizeof any);
    int digits = 1 + n % 17, power = (int)(bits % 40) - 20;
    double usual = ((double)(bits >> 11) / (1ull << 52) - 1) * pow(10, power);
    double middle =
        ((double)(bits % (uint64_t)pow(10, digits < 15 ? digits : 15)) + 0.5) * pow(10, power / 4);
    double round = nextafter(pow(10, power), n % 3 ? n % 3 - 1.5 : pow(10, power));
    good = prints_as_printf(any, digits) && prints_as_printf(usual, digits) &&
           prints_as_printf(middle, digits) && prints_as_printf(round, digits);
  }
}

/* Four digits and a prefix; what rounds to 1000 of a prefix is 1 of the next. */
static void amounts(void) {
  static const struct {
    double value;
    const char *unit, *text;
  } ROWS[] = {{0.841894, "A", "841.9 mA"},
              {0.99994, "A", "999.9 mA"},
              {0.99996, "A", "1 A"},
              {-999.97, "V", "-1 kV"},
              {999.97e9, "Hz", "1000 GHz"},
              {999.97, "rad", "1000 rad"},
              {0, "A", "0 A"},
              {1e-300, "A", "1e-285 fA"},
              {9.9997e-16, "s", "1 fs"},
              {INFINITY, "V", "inf V"},
              {NAN, "V", "nan V"},
              {0.25, "", "0.25"}};
  char text[2 * VS_ENGINEERING_SIZE];
  for (size_t k = 0; k < COUNT(ROWS); k++)
    CU_ASSERT_STRING_EQUAL(vs_engineering_text(ROWS[k].value, ROWS[k].unit, text), ROWS[k].text);
  CU_ASSERT_STRING_EQUAL(vs_engineering_range(-0.99997, 0.5, "m", text), "-1 m .. 0.5 m");
  CU_ASSERT_STRING_EQUAL(vs_engineering_range(4.441e-16, 0.003169, "A2.s", text),
                         "0 A2.s .. 0.003169 A2.s");
  CU_ASSERT_STRING_EQUAL(vs_engineering_range(-2e-3, 1e3, "V", text), "-2e-06 kV .. 1 kV");
}

/* A caption ends at a word's end, and has no more characters than there is room for. */
static void captions(void) {
  static const struct {
    const char *text, *is;
  } ROWS[] = {{"margin over all cases", "margin over all cases"},
              {"margin over all the cases", "margin over all..."},
              {"Ωmega over all the cases ever", "Ωmega over all the..."},
              {"circuit.varistor_voltage_of_all", "circuit.varistor_v..."}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text t = {0};
    vs_text_add(&t, "%s", ROWS[k].text);
    vs_text_shorten(&t, 21);
    CU_ASSERT_STRING_EQUAL(t.text, ROWS[k].is);
    vs_text_free(&t);
  }
  vs_script script = {0};
  vs_gnuplot_caption(&script, "margin_least: the least over circuit.varistor_voltage", 300, 12);
  CU_ASSERT_STRING_EQUAL(script.text.text, "\"margin_least: the least over...\"");
  vs_gnuplot_free(&script);
}

static const vs_test TESTS[] = {
    {"captions", captions},
    {"amounts", amounts},
    {"rows of CSV", rows_of_csv},
    {"JSON is laid out", json_is_laid_out},
    {"JSON of what is no UTF-8", json_is_utf8},
    {"good quantities", good_quantities},
    {"bad quantities", bad_quantities},
    {"units known", units_known},
    {"nearest names", nearest_names},
    {"unit suffixes", unit_suffixes},
    {"units from suffixes", units_from_suffixes},
    {"growing text", growing_text},
    {"numbers are written as printf does", numbers_are_written_as_printf_does},
    {"errors are one line", errors_are_one_line},
    {"errors can be carried on from", errors_can_be_carried_on_from},
    {"columns are characters", columns_are_characters},
    {"a tree remembers where things stood", a_tree_remembers_where_things_stood},
    {"files that say nothing are empty maps", files_that_say_nothing_are_empty_maps},
    {"bad files are refused", bad_files_are_refused},
    {"what is set lies over the file", what_is_set_lies_over_the_file},
    {"bad settings are refused", bad_settings_are_refused},
    {"keys of a map", keys_of_a_map},
    {"defaults fill what is not named", defaults_fill_what_is_not_named},
    {"good fields", good_fields},
    {"bad fields", bad_fields},
    {"fields as JSON, ranges", fields_as_json_and_ranges},
    {"a committed file is there whole", a_committed_file_is_there_whole},
    {"a discarded file never was", a_discarded_file_never_was},
    {"a file is committed under another name", a_file_is_committed_under_another_name},
    {"files that cannot be written", files_that_cannot_be_written},
    {"folders", folders},
    {"shipped files are found", shipped_files_are_found},
};

int main(void) {
  const char *temporary = getenv("TMPDIR");
  char folder[VS_PATH_SIZE];
  snprintf(folder, sizeof folder, "%s/vibrospice.XXXXXX", temporary ? temporary : "/tmp");
  if (!mkdtemp(folder)) return 1;
  int failed = chdir(folder) || vs_suite("base", TESTS, COUNT(TESTS));
  if (chdir("/") == 0) remove_tree(folder);
  return failed;
}
