/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/sheets.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/path.h"
#include "base/tree.h"
#include "plant/machine.h"
#include "plot/time_window.h"
#include "traces.h"

/* The run that the sheets are for. */
typedef struct run {
  vs_column *column; /* owned */
  size_t count;
  bool is_paper;  /* the run has the paper's machine, a scene's default, or does not say which */
  bool is_direct; /* its supply is a direct voltage */
  bool is_figure; /* and it is fired as in the paper's figures, through the same circuit */
  double until_s; /* of its last row */
  double event_s; /* when the scene's first event begins; NaN: none does */
} run;

static bool is_of(const vs_column *c, const char *role) {
  return !strcmp(c->role, role);
}

/* The first column with this role and quantity (NULL: any). NULL: there is none. */
static const vs_column *find_column(const run *r, const char *role, const char *quantity) {
  for (const vs_column *c = r->column; c < r->column + r->count; c++)
    if (is_of(c, role) && (!quantity || !strcmp(c->quantity, quantity))) return c;
  return NULL;
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

static void look_at_run(run *r, const char *folder, const char *header) {
  char path[VS_PATH_SIZE];
  vs_tree tree = {0};
  vs_error unread = {0};
  r->column = vs_traces_columns(folder, header, &r->count);
  snprintf(path, sizeof path, "%s/summary.json", folder);
  bool known = !vs_tree_read(path, &tree, &unread);
  const vs_node *scene = known ? vs_tree_child_map(tree.root, "scene") : NULL;
  const vs_node *model = vs_tree_child(vs_tree_child(scene, "machine"), "model");
  r->is_paper = !model || !model->text || !strcmp(model->text, vs_machine_key.default_text);
  r->is_figure = r->is_paper && is_of_figures(scene);
  const vs_node *kind = vs_tree_child(vs_tree_child(scene, "supply"), "kind");
  r->is_direct = kind && kind->text && !strcmp(kind->text, "step");
  vs_tree_free(&tree);
  vs_moments moments = {0};
  r->event_s = vs_time_window_read_moments(folder, &moments, &unread)
                   ? -1
                   : vs_time_window_first_event(&moments);
  vs_time_window_free_moments(&moments);
}

/* ---- what instruments have filled ---- */

/* The column of the channel that the instrument measures; the instrument's own if that was not
 * recorded. */
static const vs_column *find_channel(const run *r, const vs_column *instrument) {
  for (const vs_column *c = r->column; c < r->column + r->count; c++)
    if (!is_of(c, VS_COLUMN_INSTRUMENT) && !strcmp(c->quantity, instrument->of)) return c;
  return instrument;
}

static void add_shown(vs_sheets *all, const char *name, const vs_column *c, const char *of) {
  if (all->n_shown >= VS_SHEET_INSTRUMENTS) return;
  vs_sheet_shown *s = &all->shown[all->n_shown++];
  snprintf(s->name, sizeof s->name, "%s", name);
  snprintf(s->column, sizeof s->column, "%.*s", VS_SHEET_NAME - 1, c->name);
  snprintf(s->of, sizeof s->of, "%.*s", VS_SHEET_NAME - 1, of);
}

/* An instrument NAME fills the column NAME_meas. */
static void find_shown(vs_sheets *all, const run *r) {
  static const char MARK[] = "_meas";
  for (const vs_column *c = r->column; c < r->column + r->count; c++) {
    char name[VS_SHEET_NAME];
    const int length = (int)strlen(c->quantity) - (int)strlen(MARK);
    if (!is_of(c, VS_COLUMN_INSTRUMENT)) continue;
    snprintf(name, sizeof name, "instrument %.*s", length > 0 ? length : 0, c->quantity);
    add_shown(all, name, c, find_channel(r, c)->name);
  }
}

const vs_sheet_shown *vs_sheets_shown(const vs_sheets *all, const char *column, int n) {
  for (int k = 0; k < all->n_shown; k++)
    if (!strcmp(all->shown[k].of, column) && n-- == 0) return &all->shown[k];
  return NULL;
}

/* ---- labels ---- */

/* A coordinate's name in its usual typography: Greek letters as such. */
static const char *as_written(const char *name) {
  static const char *const GREEK[][2] = {
      {"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"}, {"delta", "δ"}, {"theta", "θ"},
      {"xi", "ξ"},    {"sigma", "σ"}, {"phi", "φ"},   {"psi", "ψ"},   {"eta", "η"}};
  for (size_t k = 0; k < sizeof GREEK / sizeof *GREEK; k++)
    if (!strcmp(name, GREEK[k][0])) return GREEK[k][1];
  return name;
}

/* Writes a name with two dots over its first character, for the second derivative. Some letters
 * have a character of their own with them. */
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
static void add_coordinate(vs_sheet *s, const vs_column *c) {
  char label[VS_SHEET_NAME];
  bool small = !strcmp(c->unit, "m") || !strcmp(c->unit, "rad");
  snprintf(label, sizeof label, "%.40s / %s%.20s", as_written(c->quantity), small ? "m" : "",
           c->unit);
  vs_sheet_add(s, c->name, label, small ? 1e3 : 1);
}

/* The unit of an acceleration ends in "/s2". */
static void add_acceleration(vs_sheet *s, const vs_column *c) {
  char label[VS_SHEET_NAME], name[VS_SHEET_NAME / 2 + 4];
  write_dotted(name, sizeof name, as_written(c->of));
  snprintf(label, sizeof label, "%s / (%.*s/s²)", name, (int)strcspn(c->unit, "/"), c->unit);
  vs_sheet_add(s, c->name, label, 1);
}

/* ---- sheets ---- */

void vs_sheet_add(vs_sheet *s, const char *column, const char *label, double scale) {
  if (s->count >= VS_SHEET_PANELS) return;
  vs_panel *p = &s->panels[s->count++];
  snprintf(p->column, sizeof p->column, "%.*s", VS_SHEET_NAME - 1, column);
  snprintf(p->label, sizeof p->label, "%s", label);
  p->scale = scale;
}

const vs_panel *vs_sheet_find(const vs_sheet *s, const char *column) {
  for (int k = 0; k < s->count; k++)
    if (!strcmp(s->panels[k].column, column)) return &s->panels[k];
  return NULL;
}

/* Adds all coordinates and accelerations, and the force. */
static void fill_motion(vs_sheet *s, const run *r) {
  for (size_t k = 0; k < r->count; k++)
    if (is_of(&r->column[k], VS_COLUMN_COORDINATE)) add_coordinate(s, &r->column[k]);
  for (size_t k = 0; k < r->count; k++)
    if (is_of(&r->column[k], VS_COLUMN_ACCELERATION)) add_acceleration(s, &r->column[k]);
  vs_sheet_add(s, "force_n", "F / N", 1);
}

static void add_first_coordinate(vs_sheet *s, const run *r) {
  const vs_column *c = find_column(r, VS_COLUMN_COORDINATE, NULL);
  if (c) add_coordinate(s, c);
}

/* Adds a probe of the deck, where it has that. */
static void add_probe(vs_sheet *s, const run *r, const char *column, const char *label) {
  for (size_t k = 0; k < r->count; k++)
    if (!strcmp(r->column[k].name, column)) vs_sheet_add(s, column, label, 1);
}

static void fill_pulse(vs_sheet *s, const run *r) {
  add_first_coordinate(s, r);
  vs_sheet_add(s, "force_n", "F / N", 1);
  vs_sheet_add(s, "i_a", "i / A", 1);
  vs_sheet_add(s, "v_eva_v", r->is_paper ? "EVA voltage / V" : "coil voltage / V", 1);
  add_probe(s, r, "v_ds_v", "switch voltage / V");
}

static void fill_overview(vs_sheet *s, const run *r) {
  const vs_column *c = find_column(r, VS_COLUMN_ACCELERATION, NULL);
  add_first_coordinate(s, r);
  if (c) add_acceleration(s, c);
  vs_sheet_add(s, "force_n", "F / N", 1);
  vs_sheet_add(s, "i_a", "i / A", 1);
  vs_sheet_add(s, "v_eva_v", r->is_paper ? "EVA voltage / V" : "coil voltage / V", 1);
  vs_sheet_add(s, "v_mains_v", r->is_direct ? "supply voltage / V" : "mains voltage / V", 1);
  add_probe(s, r, "v_ds_v", "switch voltage / V");
}

/* Adds a panel for each curve that instruments have measured, in their order. Its label is that of
 * another sheet, else the column's name. */
static void add_measured(vs_sheet *s, const vs_sheets *all) {
  for (int k = 0; k < all->n_shown; k++) {
    const char *of = all->shown[k].of;
    const vs_panel *p = vs_sheet_find(&all->set[0], of);
    if (!p) p = vs_sheet_find(&all->overview, of);
    if (!vs_sheet_find(s, of)) vs_sheet_add(s, of, p ? p->label : of, p ? p->scale : 1);
  }
}

static void fill_nothing(vs_sheet *s, const run *r) {
  (void)s, (void)r;
}

/* Adds the panel of a control's measure, with lengths in thousandths. Returns its column; NULL: the
 * run has none. */
static const vs_column *add_controls(vs_sheet *s, const run *r, const char *name,
                                     const char *label) {
  const vs_column *c = find_column(r, VS_COLUMN_MEASURE, name);
  char text[VS_SHEET_NAME];
  if (!c) return NULL;
  bool metre = !strcmp(c->unit, "m");
  snprintf(text, sizeof text, "%s / %s%.40s", label, metre ? "m" : "", c->unit);
  vs_sheet_add(s, c->name, text, metre ? 1e3 : 1);
  return c;
}

/* Adds the firing angle, what the control's law shows, and the set point over its amplitude. */
static void fill_control(vs_sheets *all, vs_sheet *s, const run *r) {
  const vs_column *angle = find_column(r, VS_COLUMN_MEASURE, "firing_angle"),
                  *set_point = find_column(r, VS_COLUMN_SET_POINT, NULL);
  if (!angle) return;
  const vs_column *amplitude = add_controls(s, r, "amplitude_meas", "amplitude seen");
  vs_sheet_add(s, angle->name, "firing angle / °", 57.29577951308232);
  add_controls(s, r, "f_motion", "frequency of the motion");
  add_controls(s, r, "swing_meas", "swing");
  add_first_coordinate(s, r);
  vs_sheet_add(s, "i_a", "i / A", 1);
  if (amplitude && set_point) add_shown(all, "set point", set_point, amplitude->name);
}

/* What an event does is shown for the most of a picture, where that would end before or soon after
 * it. */
static const double BEFORE = 0.2;

static void begin_at_event(vs_sheet *s, const run *r) {
  const double span_s = s->until_s;
  s->from_s = r->event_s - BEFORE * span_s;
  s->until_s = s->from_s + span_s;
  char *first = strstr(s->title, ", first ");
  if (first)
    snprintf(first, sizeof s->title - (size_t)(first - s->title), ", from %.6g ms on",
             1e3 * s->from_s);
}

/* Fills the k-th sheet; after those of the set comes the overview. */
static void fill_sheet(vs_sheet *s, int k, const run *r) {
  /* titles for any machine, for the paper's, and for the paper's scene; where a direct voltage has
   * it show the whole run: for any machine on that */
  static const struct {
    const char *name, *title[4];
    double until_s;
    int columns;
    void (*fill)(vs_sheet *s, const run *r);
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
        "Displacement, force, EVA current and voltage, first 50 ms (as Fig. 11)",
        "Displacement, force, coil current and voltage"},
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
        "Vibratory conveyor and its thyristor converter, first 50 ms", "Machine and converter"},
       0.05,
       2,
       fill_overview}};
  s->name = SHEETS[k].name;
  const char *title = SHEETS[k].title[r->is_paper + r->is_figure];
  s->until_s = SHEETS[k].until_s;
  s->columns = SHEETS[k].columns;
  if (r->is_direct &&
      SHEETS[k].title[3]) { /* one pulse: what happens is not over after some cycles */
    title = SHEETS[k].title[3];
    s->until_s = 0;
  }
  snprintf(s->title, sizeof s->title, "%s", title);
  if (s->until_s > 0 && s->until_s < r->until_s && r->event_s > BEFORE * s->until_s)
    begin_at_event(s, r);
  SHEETS[k].fill(s, r);
  if (s->from_s > 0 && SHEETS[k].fill != fill_motion)
    add_probe(s, r, "i_thyristor_a", "i_thyristor / A");
}

vs_sheets *vs_sheets_new(const char *folder, const char *header, double until_s) {
  vs_sheets *all = vs_alloc(1, sizeof *all);
  run r = {.column = NULL};
  look_at_run(&r, folder, header);
  r.until_s = until_s;
  for (int k = 0; k < VS_SHEETS; k++) fill_sheet(&all->set[k], k, &r);
  fill_sheet(&all->overview, VS_SHEETS, &r);
  find_shown(all, &r);
  for (int k = VS_SHEETS_OF_RUN; k < VS_SHEETS - 1; k++) add_measured(&all->set[k], all);
  fill_control(all, &all->set[VS_SHEETS - 1], &r);
  if (all->set[VS_SHEETS - 1].count) all->overview = all->set[VS_SHEETS - 1];
  free(r.column);
  return all;
}
