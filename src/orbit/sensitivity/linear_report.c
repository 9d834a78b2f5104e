/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/linear_report.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "linear_circuit.h"
#include "orbit/linear.h"

enum { N = VS_LINEAR_STATES, DIGITS = 17 };

/* ---- what is to be said ---- */

/* A second extreme, or a stop's edge, that comes within this part of the amplitude is said; so is
 * an extreme that comes within this part of the period of the section. */
static const double NEAR = 0.1, SOON = 0.05;

static void note_outputs(const vs_linear *l, vs_text *notes) {
  for (int k = 0; k < l->outputs; k++) {
    const vs_linear_signal *seen = &l->output[k].seen;
    double margin = vs_linear_signal_margin(seen),
           edge_s = vs_linear_signal_edge(seen, l->period_s);
    if (margin < NEAR * vs_linear_signal_amplitude(seen))
      vs_text_add(
          notes,
          "%s has a second extreme within %.3g %s of the first: a deviation that large makes "
          "it the first, with another row of C and D\n",
          seen->order.name, margin, seen->unit);
    if (edge_s < SOON * l->period_s)
      vs_text_add(notes,
                  "a turn of %s comes %.3g s from the section: C and D follow it past the section, "
                  "where the largest or least value from section to section is another turn's\n",
                  seen->order.name, edge_s);
  }
}

static void note_contacts(const vs_linear_report *m, vs_text *notes) {
  const vs_linear *l = &m->linear;
  if (l->contacts)
    vs_text_add(
        notes, "the orbit meets a stop, in %d contacts a period; the derivatives go through them\n",
        l->contacts);
  if (l->grazing_m < NEAR * vs_linear_signal_amplitude(&l->output[m->travel].seen))
    vs_text_add(notes,
                "at t = %.9g s the travel turns %.3g m from the edge of a stop: a deviation that "
                "large makes a contact come or go, and behind it the matrices are others\n",
                l->grazing_s, l->grazing_m);
}

static void find_notes(vs_linear_report *m, const vs_scene *scene) {
  const vs_linear *l = &m->linear;
  vs_text notes = {0};
  vs_text_add(&notes, "%s", "");
  if (!l->stable)
    vs_text_add(&notes,
                "the orbit is unstable: a deviation grows, and the gain is never reached\n");
  if (scene->setup.wants_fraction)
    vs_text_add(&notes, "load.fraction is held at %.6g, what auto comes to on this orbit\n",
                scene->setup.model.riding);
  note_outputs(l, &notes);
  note_contacts(m, &notes);
  m->notes = notes.text;
}

vs_status vs_linear_report_find(vs_linear_report *m, const vs_scene *scene, const vs_orbit *orbit,
                                vs_error *err) {
  vs_status status = scene->tier->has_circuit
                         ? vs_linear_circuit_find(scene, orbit, &m->linear, err)
                         : vs_linear_find(scene, orbit, NULL, 0, &m->linear, err);
  if (!status) status = vs_averaged_find(&m->linear, &m->averaged, err);
  if (status) return status;
  m->travel = vs_linear_travel(&m->linear, &scene->setup.model);
  find_notes(m, scene);
  return VS_OK;
}

void vs_linear_report_free(vs_linear_report *m) {
  free(m->notes);
  m->notes = NULL;
}

/* ---- the table ---- */

static double degree(void) {
  return vs_units_factor("deg");
}

static void print_gains(const vs_linear_report *m, FILE *out) {
  const vs_averaged *a = &m->averaged;
  fprintf(out, "%-16s %15s %18s %18s   %s\n", "amplitude", "on the orbit", "gain per deg",
          "at once per deg", "dominant pole, and what it leaves out");
  for (int k = 0; k < a->outputs; k++) {
    const vs_linear_signal *seen = &m->linear.output[k].seen;
    int pole = a->dominant[k];
    fprintf(out, "%-16s %12.6g %-3s %15.6g %-3s %14.6g %-3s   %d", seen->order.name,
            vs_linear_signal_amplitude(seen), seen->unit, a->gain[k] * degree(), seen->unit,
            a->at_once[k] * degree(), seen->unit, pole + 1);
    if (a->pole[pole].multiplier.im > 0) fprintf(out, " and %d", pole + 2);
    fprintf(out, ", %.3g %%\n", 100 * a->left_out[k]);
  }
}

static void print_poles(const vs_linear_report *m, FILE *out) {
  const vs_averaged *a = &m->averaged;
  const char *name = m->linear.output[m->travel].seen.order.name;
  fprintf(out, "%-10s %15s %15s %14s %14s   share of %s's gain\n", "pole", "re 1/s", "im rad/s",
          "beat Hz", "decays in", name);
  for (int k = 0; k < a->n; k++) {
    const vs_averaged_pole *p = &a->pole[k];
    double _Complex part = a->share[m->travel][k] / a->gain[m->travel];
    bool dominant =
        k == a->dominant[m->travel] || (k == a->dominant[m->travel] + 1 && p->multiplier.im < 0);
    fprintf(out, "%-10d %15.9g %15.9g %14.6g ", k + 1, p->re_1_s, p->im_rad_s, p->frequency_hz);
    if (p->re_1_s < 0)
      fprintf(out, "%12.4g s", p->time_constant_s);
    else
      fprintf(out, "%14s", "-");
    fprintf(out, "   %.4g at %.1f deg%s\n", cabs(part), carg(part) / degree(),
            dominant ? ", dominant" : "");
  }
}

void vs_linear_report_print(const vs_linear_report *m, FILE *out) {
  const vs_linear *l = &m->linear;
  fprintf(out, "linear model  from the firing angle on, about %.6g deg; states ",
          l->angle_rad / degree());
  for (int k = 0; k < l->n; k++) fprintf(out, "%s%s", k ? ", " : "", l->state[k].name);
  fprintf(out,
          " where the mains rise through zero before each firing, every %.9g s, fired %.9g s "
          "later\n\n",
          l->period_s, l->fires_s);
  print_gains(m, out);
  fputc('\n', out);
  print_poles(m, out);
  for (const char *line = m->notes; line && *line;) {
    int length = (int)strcspn(line, "\n");
    fprintf(out, "note: %.*s\n", length, line);
    line += length + (line[length] != 0);
  }
  fputc('\n', out);
}

/* ---- JSON ---- */

static void add_row_of_numbers(vs_json *json, const char *key, const double *values, int count) {
  vs_json_array(json, key, VS_JSON_ROW);
  for (int k = 0; k < count; k++) vs_json_number(json, NULL, values[k], DIGITS);
  vs_json_end(json);
}

static void add_matrix(vs_json *json, const char *key, double rows[][N], int count, int columns) {
  vs_json_array(json, key, VS_JSON_LINES);
  for (int k = 0; k < count; k++) add_row_of_numbers(json, NULL, rows[k], columns);
  vs_json_end(json);
}

static void add_states(const vs_linear *l, vs_json *json) {
  vs_json_array(json, "states", VS_JSON_LINES);
  for (int k = 0; k < l->n; k++) {
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "name", l->state[k].name);
    vs_json_text(json, "unit", l->state[k].unit);
    vs_json_number(json, "orbit", l->x[k], DIGITS);
    vs_json_number(json, "orbit_at_firing", l->x_firing[k], DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_outputs(const vs_linear_report *m, vs_json *json) {
  const vs_averaged *a = &m->averaged;
  vs_json_array(json, "outputs", VS_JSON_LINES);
  for (int k = 0; k < a->outputs; k++) {
    const vs_linear_signal *s = &m->linear.output[k].seen;
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "name", s->order.name);
    vs_json_text(json, "unit", s->unit);
    vs_json_bool(json, "travel", k == m->travel);
    vs_json_number(json, "amplitude", vs_linear_signal_amplitude(s), DIGITS);
    vs_json_number(json, "largest", s->best[0].value, DIGITS);
    vs_json_number(json, "largest_at_s", s->best[0].at_s, DIGITS);
    vs_json_number(json, "least", s->best[1].value, DIGITS);
    vs_json_number(json, "least_at_s", s->best[1].at_s, DIGITS);
    vs_json_number(json, "second_extreme_within", vs_linear_signal_margin(s), 6);
    vs_json_number(json, "extreme_from_section_s", vs_linear_signal_edge(s, m->linear.period_s), 6);
    vs_json_number(json, "gain_per_deg", a->gain[k] * degree(), DIGITS);
    vs_json_number(json, "at_once_per_deg", a->at_once[k] * degree(), DIGITS);
    vs_json_whole(json, "dominant_pole", a->dominant[k]);
    vs_json_number(json, "left_out", a->left_out[k], 3);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_shares(const vs_linear_report *m, int pole, vs_json *json) {
  vs_json_array(json, "shares_per_deg", VS_JSON_ROW);
  for (int k = 0; k < m->averaged.outputs; k++) {
    double _Complex share = m->averaged.share[k][pole] * degree();
    const double parts[] = {creal(share), cimag(share)};
    add_row_of_numbers(json, NULL, parts, 2);
  }
  vs_json_end(json);
  vs_json_array(json, "residues_per_deg", VS_JSON_ROW);
  for (int k = 0; k < m->averaged.outputs; k++) {
    double _Complex residue = m->averaged.residue[k][pole] * degree();
    const double parts[] = {creal(residue), cimag(residue)};
    add_row_of_numbers(json, NULL, parts, 2);
  }
  vs_json_end(json);
}

static void add_poles(const vs_linear_report *m, vs_json *json) {
  vs_json_array(json, "poles", VS_JSON_LINES);
  for (int k = 0; k < m->averaged.n; k++) {
    const vs_averaged_pole *p = &m->averaged.pole[k];
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_number(json, "multiplier_re", p->multiplier.re, DIGITS);
    vs_json_number(json, "multiplier_im", p->multiplier.im, DIGITS);
    vs_json_number(json, "re_1_s", p->re_1_s, DIGITS);
    vs_json_number(json, "im_rad_s", p->im_rad_s, DIGITS);
    vs_json_number(json, "beat_hz", p->frequency_hz, DIGITS);
    vs_json_number(json, "time_constant_s", p->time_constant_s, DIGITS);
    add_shares(m, k, json);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_notes_of_linear(const vs_linear_report *m, vs_json *json) {
  vs_json_array(json, "notes", VS_JSON_LINES);
  for (const char *line = m->notes; line && *line;) {
    int length = (int)strcspn(line, "\n");
    vs_text one = {0};
    vs_text_add(&one, "%.*s", length, line);
    vs_json_text(json, NULL, one.text);
    vs_text_free(&one);
    line += length + (line[length] != 0);
  }
  vs_json_end(json);
}

static void add_members(const vs_linear_report *m, vs_json *json) {
  vs_linear *l = (vs_linear *)(size_t)&m->linear; /* only read */
  vs_json_text(
      json, "says",
      "x[k+1] = A x[k] + B a[k], y[k] = C x[k] + D a[k]: x, what the states differ by from "
      "the orbit where the mains rise through zero before firing k; a, what its angle "
      "differs by, rad; y, what the amplitudes of the cycle behind it differ by");
  vs_json_number(json, "angle_rad", l->angle_rad, DIGITS);
  vs_json_number(json, "period_s", l->period_s, DIGITS);
  vs_json_number(json, "fires_s", l->fires_s, DIGITS);
  vs_json_number(json, "extinct_s", l->extinct_s, DIGITS);
  vs_json_bool(json, "stable", l->stable);
  vs_json_whole(json, "contacts", l->contacts);
  vs_json_number(json, "grazing_m", l->grazing_m, 6);
  vs_json_number(json, "grazing_at_s", l->grazing_s, DIGITS);
  add_states(l, json);
  add_outputs(m, json);
  add_matrix(json, "A", l->a, l->n, l->n);
  add_row_of_numbers(json, "B", l->b, l->n);
  add_matrix(json, "C", l->c, l->outputs, l->n);
  add_row_of_numbers(json, "D", l->d, l->outputs);
  add_matrix(json, "to_firing", l->to_firing, l->n, l->n);
  add_matrix(json, "A_firing", l->a_firing, l->n, l->n);
  add_row_of_numbers(json, "B_firing", l->b_firing, l->n);
  add_matrix(json, "C_firing", l->c_firing, l->outputs, l->n);
  add_poles(m, json);
  add_notes_of_linear(m, json);
}

void vs_linear_report_json(const vs_linear_report *m, vs_json *json) {
  vs_json_object(json, "linear", VS_JSON_LINES);
  add_members(m, json);
  vs_json_end(json);
}

/* ---- files ---- */

/* The files, in the order in which they are written. */
enum { TO_JSON, TO_A, TO_B, TO_C, TO_D, TO_MOVE, TO_A2, TO_B2, TO_C2, TO_POLES, FILES };
static const char *const NAMES[FILES] = {
    "linear.json",         "linear_A.csv",         "linear_B.csv",        "linear_C.csv",
    "linear_D.csv",        "linear_to_firing.csv", "linear_A_firing.csv", "linear_B_firing.csv",
    "linear_C_firing.csv", "linear_poles.csv"};

const char *vs_linear_report_files(void) {
  return "linear.json, linear_poles.csv, linear_A.csv, linear_B.csv, linear_C.csv, linear_D.csv, "
         "linear_to_firing.csv, linear_A_firing.csv, linear_B_firing.csv, linear_C_firing.csv";
}

static void write_states(const vs_linear *l, FILE *out) {
  char suffix[64];
  for (int k = 0; k < l->n; k++) {
    vs_units_suffix(l->state[k].unit, suffix, sizeof suffix);
    fprintf(out, "%s%s%s%s", k ? "," : "", l->state[k].name, *suffix ? "_" : "", suffix);
  }
  fputc('\n', out);
}

static void write_matrix(const vs_linear *l, double rows[][N], int count, FILE *out) {
  write_states(l, out);
  for (int i = 0; i < count; i++)
    for (int j = 0; j < l->n; j++)
      fprintf(out, "%.*g%c", DIGITS, rows[i][j], j + 1 < l->n ? ',' : '\n');
}

static void write_column(const double *values, int count, FILE *out) {
  fputs("angle_rad\n", out);
  for (int k = 0; k < count; k++) fprintf(out, "%.*g\n", DIGITS, values[k]);
}

static void write_poles(const vs_linear_report *m, FILE *out) {
  const vs_averaged *a = &m->averaged;
  char suffix[64];
  fputs("multiplier_re,multiplier_im,re_1_s,im_rad_s,beat_Hz,time_constant_s", out);
  for (int k = 0; k < a->outputs; k++) {
    const vs_linear_signal *s = &m->linear.output[k].seen;
    vs_units_suffix(s->unit, suffix, sizeof suffix);
    fprintf(out, ",%s_share_re_%s_deg,%s_share_im_%s_deg", s->order.name, suffix, s->order.name,
            suffix);
  }
  for (int i = 0; i < a->n; i++) {
    const vs_averaged_pole *p = &a->pole[i];
    fprintf(out, "\n%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", p->multiplier.re, p->multiplier.im,
            p->re_1_s, p->im_rad_s, p->frequency_hz, p->time_constant_s);
    for (int k = 0; k < a->outputs; k++)
      fprintf(out, ",%.17g,%.17g", creal(a->share[k][i]) * degree(),
              cimag(a->share[k][i]) * degree());
  }
  fputc('\n', out);
}

static void write_linear_json(const vs_linear_report *m, FILE *out) {
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  add_members(m, &json);
  vs_json_end(&json);
  fputs(text.text, out);
  fputc('\n', out);
  vs_text_free(&text);
}

static void write_linear_files(const vs_linear_report *m, vs_file *files) {
  vs_linear *l = (vs_linear *)(size_t)&m->linear; /* only read */
  write_linear_json(m, files[TO_JSON].stream);
  write_matrix(l, l->a, l->n, files[TO_A].stream);
  write_column(l->b, l->n, files[TO_B].stream);
  write_matrix(l, l->c, l->outputs, files[TO_C].stream);
  write_column(l->d, l->outputs, files[TO_D].stream);
  write_matrix(l, l->to_firing, l->n, files[TO_MOVE].stream);
  write_matrix(l, l->a_firing, l->n, files[TO_A2].stream);
  write_column(l->b_firing, l->n, files[TO_B2].stream);
  write_matrix(l, l->c_firing, l->outputs, files[TO_C2].stream);
  write_poles(m, files[TO_POLES].stream);
}

vs_status vs_linear_report_write(const vs_linear_report *m, const char *folder, vs_error *err) {
  vs_file *files = vs_alloc(FILES, sizeof *files);
  vs_status status = VS_OK;
  for (int k = 0; k < FILES && !status; k++)
    status = vs_file_open(&files[k], folder, NAMES[k], err);
  if (!status) write_linear_files(m, files);
  for (int k = 0; k < FILES && !status; k++) status = vs_file_commit(&files[k], err);
  for (int k = 0; k < FILES; k++) vs_file_discard(&files[k]);
  free(files);
  return status;
}

void vs_linear_report_remove(const char *folder) {
  char path[VS_PATH_SIZE];
  for (int k = 0; k < FILES; k++) {
    snprintf(path, sizeof path, "%s/%s", folder, NAMES[k]);
    unlink(path);
  }
}
