/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/sheets.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/path.h"
#include "base/text.h"
#include "base/tree.h"
#include "base/units.h"
#include "plant/machine.h"

/* A coordinate of the machine: the names of its columns, and its unit. */
typedef struct coordinate {
  char name[VS_SHEET_NAME / 2], unit[16];
  char column[VS_SHEET_NAME], column2[VS_SHEET_NAME]; /* its own, its acceleration's */
} coordinate;

typedef struct found {
  coordinate item[VS_MACHINE_COORDINATES];
  int count;
  bool is_paper;  /* the run is of the machine that a scene has by default, the paper's, or does not
                     say of which */
  bool is_figure; /* and it is fired as in the paper's figures, through the same circuit */
} found;

/* ---- which coordinates the machine has ---- */

static void note_found(found *f, const char *name, size_t length, const char *unit) {
  coordinate c = {.name = ""};
  char suffix[32];
  snprintf(c.name, sizeof c.name, "%.*s", (int)length, name);
  snprintf(c.unit, sizeof c.unit, "%s", unit);
  vs_units_suffix(unit, suffix, sizeof suffix);
  snprintf(c.column, sizeof c.column, "%s%s%s", c.name, *suffix ? "_" : "", suffix);
  snprintf(c.column2, sizeof c.column2, "a%s%s%s_s2", c.name, *suffix ? "_" : "", suffix);
  for (int k = 0; k < f->count; k++)
    if (!strcmp(f->item[k].name, c.name)) return;
  if (f->count < VS_MACHINE_COORDINATES) f->item[f->count++] = c;
}

/* By the measures aNAME_peak, whose unit is that of NAME per s2. */
static void ask_measures(found *f, const vs_node *measures) {
  static const char PEAK[] = "_peak", PER[] = "/s2";
  for (const vs_node *m = measures ? measures->child : NULL; m; m = m->next) {
    const vs_node *node = m->kind == VS_NODE_MAP ? vs_tree_child(m, "unit") : NULL;
    size_t n = strlen(m->key), tail = sizeof PEAK - 1, per = sizeof PER - 1;
    if (*m->key != 'a' || n < tail + 2 || strcmp(m->key + n - tail, PEAK)) continue;
    size_t length = node && node->text ? strlen(node->text) : 0;
    char unit[16];
    if (length <= per || strcmp(node->text + length - per, PER)) continue;
    snprintf(unit, sizeof unit, "%.*s", (int)(length - per), node->text);
    note_found(f, m->key + 1, n - 1 - tail, unit);
  }
}

/* The instrument of that section of summary.json which has filled a column NAME_meas or
 * NAME_meas_UNIT; *unit is what follows _meas. A NAME may have _meas in it: the longest is meant.
 * NULL: none has. */
static const vs_node *filled_by(const vs_node *instruments, const char *column, const char **unit) {
  static const char MARK[] = "_meas";
  const vs_node *by = NULL;
  for (const vs_node *n = instruments ? instruments->child : NULL; n; n = n->next) {
    size_t length = strlen(n->key);
    const char *mark = column + length, *behind = mark + sizeof MARK - 1;
    if (strncmp(column, n->key, length) || strncmp(mark, MARK, sizeof MARK - 1)) continue;
    if ((*behind && *behind != '_') || (by && strlen(by->key) > length)) continue;
    by = n;
    *unit = behind;
  }
  return by;
}

/* By the columns: NAME_m and aNAME_m_s2, or where no acceleration is there to tell by, NAME_m
 * alone; likewise in rad. What instruments have filled is no coordinate. */
static void ask_header(found *f, const char *header, const vs_node *instruments, bool alone) {
  static const char *const UNITS[] = {"m", "rad"};
  char *text = vs_copy(header), *cells[512], ending[16];
  const char *unit;
  size_t n = vs_csv_split(text, cells, sizeof cells / sizeof *cells, NULL);
  if (n > sizeof cells / sizeof *cells) n = sizeof cells / sizeof *cells;
  for (size_t k = 1; k < n; k++)
    for (size_t u = 0; u < sizeof UNITS / sizeof *UNITS; u++) {
      snprintf(ending, sizeof ending, alone ? "_%s" : "_%s_s2", UNITS[u]);
      size_t length = strlen(cells[k]), tail = strlen(ending);
      if (length < tail + 2 - alone || strcmp(cells[k] + length - tail, ending)) continue;
      if (filled_by(instruments, cells[k], &unit)) continue;
      if (alone && strcmp(cells[k], "z_m"))
        note_found(f, cells[k], length - tail, UNITS[u]);
      else if (!alone && *cells[k] == 'a')
        note_found(f, cells[k] + 1, length - tail - 1, UNITS[u]);
    }
  free(text);
}

/* True where the scene has the machine, the circuit, the mains and the pulse of the paper's Figs. 9
 * to 14, or does not say. */
static bool is_of_figures(const vs_node *scene) {
  static const char *const KEYS[][3] = {{"circuit", "deck", "halfwave_snubbed"},
                                        {"firing", "every", "once"},
                                        {"firing", "angle", "100"},
                                        {"supply", "voltage", "440"}};
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS; k++) {
    const vs_node *is = vs_tree_child(vs_tree_child(scene, KEYS[k][0]), KEYS[k][1]);
    const vs_node *value = is && is->kind == VS_NODE_MAP ? vs_tree_child(is, "value") : is;
    if (is && !(value && value->text && !strcmp(value->text, KEYS[k][2]))) return false;
  }
  const vs_node *events = vs_tree_child(scene, "events");
  return !events || !events->child;
}

static void find_coordinates(found *f, const char *folder, const char *header) {
  char path[VS_PATH_SIZE];
  vs_tree tree = {0};
  vs_error unread = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  bool known = !vs_tree_read(path, &tree, &unread);
  const vs_node *scene = known ? vs_tree_child_map(tree.root, "scene") : NULL;
  const vs_node *model = vs_tree_child(vs_tree_child(scene, "machine"), "model");
  f->is_paper = !model || !model->text || !strcmp(model->text, vs_machine_key.default_text);
  f->is_figure = f->is_paper && is_of_figures(scene);
  if (known) ask_measures(f, vs_tree_child_map(tree.root, "measures"));
  const vs_node *instruments = vs_tree_child_map(scene, "instruments");
  ask_header(f, header, instruments, false);
  if (!f->count) ask_header(f, header, instruments, true);
  vs_tree_free(&tree);
}

/* ---- what instruments have filled ---- */

static bool has_column(const char *header, const char *name) {
  size_t n = strlen(name);
  for (const char *s = header; *s; s += strcspn(s, ","), s += *s == ',')
    if (strcspn(s, ",") == n && !strncmp(s, name, n)) return true;
  return false;
}

/* Takes a column that one of these instruments, of the scene in summary.json, has filled; it also
 * says which channel it measures. */
static void take_shown(vs_sheets *all, const vs_node *instruments, const char *column) {
  const char *unit = "";
  const vs_node *by = filled_by(instruments, column, &unit),
                *channel = vs_tree_child(by, "channel");
  if (!channel || !channel->text || all->n_shown >= VS_SHEET_INSTRUMENTS) return;
  vs_sheet_shown *s = &all->shown[all->n_shown++];
  snprintf(s->name, sizeof s->name, "instrument %s", by->key);
  snprintf(s->column, sizeof s->column, "%s", column);
  snprintf(s->of, sizeof s->of, "%.40s%.40s", channel->text, unit);
}

static void find_shown(vs_sheets *all, const char *folder, const char *header) {
  char path[VS_PATH_SIZE], *text = vs_copy(header), *cells[512];
  vs_tree tree = {0};
  vs_error unread = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  bool known = !vs_tree_read(path, &tree, &unread);
  const vs_node *scene = known ? vs_tree_child_map(tree.root, "scene") : NULL;
  size_t n = vs_csv_split(text, cells, sizeof cells / sizeof *cells, NULL);
  if (n > sizeof cells / sizeof *cells) n = sizeof cells / sizeof *cells;
  for (size_t k = 1; k < n; k++) take_shown(all, vs_tree_child_map(scene, "instruments"), cells[k]);
  for (int k = 0; k < all->n_shown; k++) /* alone where the channel is not recorded */
    if (!has_column(header, all->shown[k].of))
      memcpy(all->shown[k].of, all->shown[k].column, sizeof all->shown[k].of);
  vs_tree_free(&tree);
  free(text);
}

const vs_sheet_shown *vs_sheets_shown(const vs_sheets *all, const char *column, int n) {
  for (int k = 0; k < all->n_shown; k++)
    if (!strcmp(all->shown[k].of, column) && n-- == 0) return &all->shown[k];
  return NULL;
}

/* ---- labels ---- */

/* A coordinate's name as it is written: Greek letters as such. */
static const char *as_written(const char *name) {
  static const char *const GREEK[][2] = {
      {"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"}, {"delta", "δ"}, {"theta", "θ"},
      {"xi", "ξ"},    {"sigma", "σ"}, {"phi", "φ"},   {"psi", "ψ"},   {"eta", "η"}};
  for (size_t k = 0; k < sizeof GREEK / sizeof *GREEK; k++)
    if (!strcmp(name, GREEK[k][0])) return GREEK[k][1];
  return name;
}

/* The second derivative of what is so written: two dots over its first character. Some letters have
 * a character of their own with them. */
static void write_dotted(char *out, size_t size, const char *name) {
  static const char *const DOTTED[][2] = {{"a", "ä"}, {"e", "ë"}, {"h", "ḧ"}, {"i", "ï"},
                                          {"o", "ö"}, {"t", "ẗ"}, {"u", "ü"}, {"w", "ẅ"},
                                          {"x", "ẍ"}, {"y", "ÿ"}};
  size_t length = 1;
  while ((name[length] & 0xC0) == 0x80) length++; /* the rest of the character */
  for (size_t k = 0; k < sizeof DOTTED / sizeof *DOTTED; k++)
    if (*name == *DOTTED[k][0]) {
      snprintf(out, size, "%s%s", DOTTED[k][1], name + 1);
      return;
    }
  snprintf(out, size, "%.*s\u0308%s", (int)length, name, name + length);
}

/* Lengths and angles are shown in thousandths. */
static bool in_thousandths(const coordinate *c) {
  return !strcmp(c->unit, "m") || !strcmp(c->unit, "rad");
}

static void add_coordinate(vs_sheet *s, const coordinate *c) {
  char label[VS_SHEET_NAME];
  bool small = in_thousandths(c);
  snprintf(label, sizeof label, "%s / %s%s", as_written(c->name), small ? "m" : "", c->unit);
  vs_sheet_add(s, c->column, label, small ? 1e3 : 1);
}

static void add_acceleration(vs_sheet *s, const coordinate *c) {
  char label[VS_SHEET_NAME], name[VS_SHEET_NAME / 2 + 4];
  write_dotted(name, sizeof name, as_written(c->name));
  snprintf(label, sizeof label, "%s / (%s/s²)", name, c->unit);
  vs_sheet_add(s, c->column2, label, 1);
}

/* ---- sheets ---- */

void vs_sheet_add(vs_sheet *s, const char *column, const char *label, double scale) {
  if (s->count >= VS_SHEET_PANELS) return;
  vs_panel *p = &s->panels[s->count++];
  snprintf(p->column, sizeof p->column, "%s", column);
  snprintf(p->label, sizeof p->label, "%s", label);
  p->scale = scale;
}

const vs_panel *vs_sheet_find(const vs_sheet *s, const char *column) {
  for (int k = 0; k < s->count; k++)
    if (!strcmp(s->panels[k].column, column)) return &s->panels[k];
  return NULL;
}

/* All of the motion, and the force. */
static void fill_motion(vs_sheet *s, const found *f) {
  for (int k = 0; k < f->count; k++) add_coordinate(s, &f->item[k]);
  for (int k = 0; k < f->count; k++) add_acceleration(s, &f->item[k]);
  vs_sheet_add(s, "force_n", "F / N", 1);
}

static void fill_pulse(vs_sheet *s, const found *f) {
  if (f->count) add_coordinate(s, &f->item[0]);
  vs_sheet_add(s, "force_n", "F / N", 1);
  vs_sheet_add(s, "i_a", "i / A", 1);
  vs_sheet_add(s, "v_eva_v", "EVA voltage / V", 1);
}

static void fill_overview(vs_sheet *s, const found *f) {
  if (f->count) add_coordinate(s, &f->item[0]);
  if (f->count) add_acceleration(s, &f->item[0]);
  vs_sheet_add(s, "force_n", "F / N", 1);
  vs_sheet_add(s, "i_a", "i / A", 1);
  vs_sheet_add(s, "v_eva_v", "EVA voltage / V", 1);
  vs_sheet_add(s, "v_mains_v", "mains voltage / V", 1);
}

/* A panel for each curve that instruments have measured, in their order, as it is labelled in
 * another sheet; else its column's name is its label. */
static void add_measured(vs_sheet *s, const vs_sheets *all) {
  for (int k = 0; k < all->n_shown; k++) {
    const char *of = all->shown[k].of;
    const vs_panel *p = vs_sheet_find(&all->set[0], of);
    if (!p) p = vs_sheet_find(&all->overview, of);
    if (!vs_sheet_find(s, of)) vs_sheet_add(s, of, p ? p->label : of, p ? p->scale : 1);
  }
}

static void fill_nothing(vs_sheet *s, const found *f) {
  (void)s, (void)f;
}

/* A column that a control has filled. */
static const char ANGLE[] = "firing_angle_rad";

/* Adds the panel of a column of the control's, whose name begins with `name`. Lengths are shown in
 * thousandths. Returns the column; NULL: the run has none. */
static const char *add_controls(vs_sheet *s, const char *header, const char *name,
                                const char *label) {
  char column[VS_SHEET_NAME], text[VS_SHEET_NAME];
  const char *begins = strstr(header, name);
  if (!begins) return NULL;
  snprintf(column, sizeof column, "%.*s", (int)strcspn(begins, ","), begins);
  const char *unit = column + strlen(name);
  bool metre = !strcmp(unit, "m");
  snprintf(text, sizeof text, "%s / %s%s", label, metre ? "m" : "", unit);
  vs_sheet_add(s, column, text, metre ? 1e3 : 1);
  return s->panels[s->count - 1].column;
}

/* The angle, what the control's law shows, and over its amplitude the set point. */
static void fill_control(vs_sheets *all, vs_sheet *s, const char *header, const found *f) {
  if (!has_column(header, ANGLE)) return;
  const char *amplitude = add_controls(s, header, "amplitude_meas_", "amplitude seen");
  vs_sheet_add(s, ANGLE, "firing angle / °", 57.29577951308232);
  add_controls(s, header, "f_motion_", "frequency of the motion");
  add_controls(s, header, "swing_meas_", "swing");
  if (f->count) add_coordinate(s, &f->item[0]);
  vs_sheet_add(s, "i_a", "i / A", 1);
  if (!amplitude || all->n_shown >= VS_SHEET_INSTRUMENTS) return;
  vs_sheet_shown *over = &all->shown[all->n_shown++];
  snprintf(over->name, sizeof over->name, "set point");
  snprintf(over->of, sizeof over->of, "%.90s", amplitude);
  snprintf(over->column, sizeof over->column, "setpoint_%.80s",
           amplitude + strlen("amplitude_meas_"));
}

/* The k-th sheet; behind those of the set comes the overview. */
static void fill_sheet(vs_sheet *s, int k, const found *f) {
  /* of any machine, of the paper's, and of the paper's scene */
  static const struct {
    const char *name, *title[3];
    double until_s;
    int columns;
    void (*fill)(vs_sheet *s, const found *f);
  } SHEETS[VS_SHEETS + 1] = {
      {"motion_run",
       {"Displacements, accelerations and force", "Displacements, accelerations and force",
        "Displacements, accelerations and force (as Fig. 9 of the paper)"},
       0,
       3,
       fill_motion},
      {"motion_100ms",
       {"Displacements, accelerations and force, first 100 ms",
        "Displacements, accelerations and force, first 100 ms",
        "Displacements, accelerations and force, first 100 ms (as Fig. 10)"},
       0.1,
       3,
       fill_motion},
      {"pulse_50ms",
       {"Displacement, force, coil current and voltage, first 50 ms",
        "Displacement, force, EVA current and voltage, first 50 ms",
        "Displacement, force, EVA current and voltage, first 50 ms (as Fig. 11)"},
       0.05,
       2,
       fill_pulse},
      {"measured_run",
       {"What the instruments show", "What the instruments show",
        "What the instruments show (as Fig. 13 of the paper)"},
       0,
       2,
       fill_nothing},
      {"measured_100ms",
       {"What the instruments show, first 100 ms", "What the instruments show, first 100 ms",
        "What the instruments show, first 100 ms (as Fig. 14 of the paper)"},
       0.1,
       2,
       fill_nothing},
      {"control_run", {"Control", "Control", "Control"}, 0, 2, fill_nothing},
      {"",
       {"Machine and converter, first 50 ms",
        "Vibratory conveyor and its thyristor converter, first 50 ms",
        "Vibratory conveyor and its thyristor converter, first 50 ms"},
       0.05,
       2,
       fill_overview}};
  s->name = SHEETS[k].name;
  s->title = SHEETS[k].title[f->is_paper + f->is_figure];
  s->until_s = SHEETS[k].until_s;
  s->columns = SHEETS[k].columns;
  SHEETS[k].fill(s, f);
}

vs_sheets *vs_sheets_new(const char *folder, const char *header) {
  vs_sheets *all = vs_alloc(1, sizeof *all);
  found f = {.count = 0};
  find_coordinates(&f, folder, header);
  for (int k = 0; k < VS_SHEETS; k++) fill_sheet(&all->set[k], k, &f);
  fill_sheet(&all->overview, VS_SHEETS, &f);
  find_shown(all, folder, header);
  for (int k = VS_SHEETS_OF_RUN; k < VS_SHEETS - 1; k++) add_measured(&all->set[k], all);
  fill_control(all, &all->set[VS_SHEETS - 1], header, &f);
  if (all->set[VS_SHEETS - 1].count) all->overview = all->set[VS_SHEETS - 1];
  return all;
}
