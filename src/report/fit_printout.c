/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit_printout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "fit/fit_result.h"

/* ---- how a fitted scene is run by itself: `vibrospice run`, with --set of what the fit found ----
 */

/* Writes a value as it may stand after `--set KEY=`. */
static void add_value(const vs_node *node, vs_text *text) {
  const bool map = node->kind == VS_NODE_MAP;
  if (node->kind == VS_NODE_TEXT) {
    vs_text_add(text, "%s", node->text);
    return;
  }
  vs_text_add(text, map ? "{" : "[");
  for (const vs_node *n = node->child; n; n = n->next) {
    if (map) vs_text_add(text, "%s: ", n->key);
    add_value(n, text);
    if (n->next) vs_text_add(text, ", ");
  }
  vs_text_add(text, map ? "}" : "]");
}

/* Prints an option --set, with quotes where the shell would split it. */
static void print_set(const char *set, FILE *out) {
  static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_.,:/%+-=@";
  const char *quote = set[strspn(set, PLAIN)] ? "'" : "";
  fprintf(out, " --set %s%s%s", quote, set, quote);
}

/* ---- what the fit set ---- */

/* Prints a map key by key, as it is merged with the scene's own map key by key. */
static void show_node(const char *key, const vs_node *node, FILE *out) {
  vs_text set = {0};
  if (node->kind == VS_NODE_MAP && node->child) {
    for (const vs_node *n = node->child; n; n = n->next) {
      vs_text below = {0};
      vs_text_add(&below, "%s.%s", key, n->key);
      show_node(below.text, n, out);
      vs_text_free(&below);
    }
    return;
  }
  vs_text_add(&set, "%s=", key);
  add_value(node, &set);
  print_set(set.text, out);
  vs_text_free(&set);
}

static void show_map(const vs_node *map, FILE *out) {
  for (const vs_node *n = map ? map->child : NULL; n; n = n->next) show_node(n->key, n, out);
}

/* ---- a run ---- */

/* The map of the run with this number; NULL: the fit has only one run, at its root. */
static const vs_node *find_run(const vs_fit_problem *q, size_t number) {
  const vs_node *runs = vs_tree_child(q->tree.root, "runs");
  const vs_node *own = runs ? runs->child : NULL;
  for (size_t k = 0; own && k < number; k++) own = own->next;
  return own;
}

static void show_run(const vs_fit_result *o, size_t number, FILE *out) {
  const vs_fit_problem *q = o->inquiry;
  const vs_node *root = q->tree.root, *own = find_run(q, number);
  const vs_node *scene = vs_tree_child(own, "scene");
  if (!scene) scene = vs_tree_child(root, "scene");
  int periods = q->runs[number].periods;
  fprintf(out, "vibrospice %s %s", periods ? "steady" : "run",
          scene && scene->text ? scene->text : "paper");
  if (periods > 1) fprintf(out, " --period %d", periods);
  show_map(vs_tree_child(root, "set"), out);
  show_map(vs_tree_child(own, "set"), out);
  for (size_t k = 0; k < q->n_sets; k++)
    if (!vs_fit_problem_owns(q->sets[k])) print_set(q->sets[k], out);
  for (size_t k = 0; k < q->n_unknowns; k++) {
    const vs_unknown *u = &q->unknowns[k];
    if (u->run < 0 || u->run == (int)number)
      fprintf(out, " --set %s=%.7g%s", u->axis.key, o->estimate.value[k], u->axis.unit);
  }
  fputc('\n', out);
}

/* Prints for each run of a fit the command that runs its scene with the estimates: with the keys
 * that the fit set, and the unknowns to seven digits. */
static void rerun_show(const vs_fit_result *o, FILE *out) {
  for (size_t r = 0; r < o->inquiry->n_runs; r++) {
    fputs(r ? "        " : "\nrun it  ", out);
    show_run(o, r, out);
  }
}

enum { FIGURE = 32 }; /* size of a number's text in a table */

/* ---- what was asked ---- */

static const char *plural(size_t count) {
  return count == 1 ? "" : "s";
}

static void show_head(const vs_fit_result *o, FILE *out) {
  const vs_fit_problem *q = o->inquiry;
  const vs_scene *scene = q->runs[0].scene;
  fprintf(out, "fit     %zu unknown%s from %zu number%s", q->n_unknowns, plural(q->n_unknowns),
          q->n_data, plural(q->n_data));
  if (q->n_priors) fprintf(out, " and %zu prior%s", q->n_priors, plural(q->n_priors));
  fprintf(out, " of %zu run%s; %s on tier %s\n", q->n_runs, plural(q->n_runs),
          scene->setup.model.parameters.model, scene->tier->name);
  fprintf(out, "search  %zu of %zu starts converged, %zu of them to the least chi2", o->converged,
          o->descents.count, o->reached);
  if (!isnan(o->next_chi2)) fprintf(out, "; the next minimum has %.4g", o->next_chi2);
  fprintf(out, "\ncost    %ld runs of a scene, of which %ld failed; slopes by %s",
          o->prediction.runs, o->prediction.failures, o->slopes);
  if (o->prediction.inexact)
    fprintf(out, ", but %ld columns by differences", o->prediction.inexact);
  fputc('\n', out);
}

/* ---- the unknowns ---- */

/* Writes the standard error of an unknown: a share where the unknown is estimated by its logarithm,
 * else an amount in the key's unit. */
static void print_error(const vs_unknown *u, double error, char *text, size_t size) {
  if (isnan(error))
    snprintf(text, size, "on its bound");
  else if (u->log)
    snprintf(text, size, "%.4g %%", 100 * error);
  else
    snprintf(text, size, "%.4g %s", error * u->scale, u->axis.unit);
}

static void show_unknown(const vs_estimate *e, size_t k, FILE *out) {
  const vs_unknown *u = &e->inquiry->unknowns[k];
  char error[64];
  print_error(u, e->error[k], error, sizeof error);
  fprintf(out, "%-30s %14.6g %-6s %14s", u->name, e->value[k], u->axis.unit, error);
  if (isnan(e->error[k]))
    fprintf(out, " %12s %12s", "-", "-");
  else
    fprintf(out, " %12.6g %12.6g", e->least[k], e->most[k]);
  fprintf(out, " %12.6g\n", u->start);
}

static void show_profile(const vs_fit_result *o, const vs_likelihood *p, FILE *out) {
  const vs_unknown *u = &o->inquiry->unknowns[p->unknown];
  const double ends[2] = {p->least, p->most};
  fprintf(out, "%-30s %14s %-6s %14s", u->name, "", u->axis.unit, "profile");
  for (int k = 0; k < 2; k++)
    if (isnan(ends[k]))
      fprintf(out, " %12s", "open");
    else
      fprintf(out, " %12.6g", ends[k]);
  fputc('\n', out);
}

static void show_unknowns(const vs_fit_result *o, FILE *out) {
  fprintf(out, "\n%-30s %14s %-6s %14s %12s %12s %12s\n", "unknown", "estimate", "", "std error",
          "95 % from", "to", "start");
  for (size_t k = 0; k < o->estimate.n; k++) show_unknown(&o->estimate, k, out);
  for (size_t k = 0; k < o->n_profiles; k++) show_profile(o, &o->profiles[k], out);
}

static void show_chi2(const vs_fit_result *o, FILE *out) {
  const vs_estimate *e = &o->estimate;
  fprintf(out, "\nchi2    %.6g with %ld degrees of freedom", e->minimum.chi2, e->freedom);
  if (!isnan(e->probability))
    fprintf(out, ": a true model has as much in %.3g %% of all cases", 100 * e->probability);
  fprintf(out, "%s\n", vs_estimate_fits(e) ? "" : "; THE MODEL DOES NOT FIT");
  if (!isnan(o->descents.first_chi2))
    fprintf(out, "        %.6g at the start\n", o->descents.first_chi2);
}

static void show_correlation(const vs_estimate *e, FILE *out) {
  fprintf(out, "\n%-30s", "correlation");
  for (size_t k = 0; k < e->n; k++) fprintf(out, " %7zu", k + 1);
  fputc('\n', out);
  for (size_t i = 0; i < e->n; i++) {
    fprintf(out, "%2zu %-27s", i + 1, e->inquiry->unknowns[i].name);
    for (size_t k = 0; k <= i; k++) {
      double r = vs_estimate_correlation(e, i, k);
      if (isnan(r))
        fprintf(out, " %7s", "-");
      else
        fprintf(out, " %7.3f", r);
    }
    fputc('\n', out);
  }
}

/* ---- directions ---- */

static void print_share(const vs_combination *c, char *text, size_t size) {
  snprintf(text, size, c->product ? "%.3g %%" : "%.3g", c->product ? 100 * c->error : c->error);
}

static void show_directions(const vs_estimate *e, FILE *out) {
  char share[32], first[64], second[64];
  fprintf(out, "\n%12s %14s  %s\n", "known to", "singular value", "combination");
  for (size_t k = 0; k < e->n_directions; k++) {
    const vs_combination *c = &e->directions[k];
    print_share(c, share, sizeof share);
    fprintf(out, "%12s %14.6g  %s\n", share, c->singular, c->text);
  }
  for (size_t k = 0; k < e->n_pairs; k++) {
    const vs_combination *c = &e->pairs[k];
    size_t pair[2], n = 0;
    for (size_t i = 0; i < e->n && n < 2; i++)
      if (c->exponent[i] != 0) pair[n++] = i;
    print_share(c, share, sizeof share);
    print_error(&e->inquiry->unknowns[pair[0]], e->error[pair[0]], first, sizeof first);
    print_error(&e->inquiry->unknowns[pair[1]], e->error[pair[1]], second, sizeof second);
    fprintf(out, "%s is known to %s; alone the one is known to %s, the other to %s\n", c->text,
            share, first, second);
  }
}

/* ---- residuals ---- */

static void show_datum(const vs_fit_result *o, size_t n, FILE *out) {
  const vs_fit_problem *q = o->inquiry;
  const vs_datum *d = &q->data[n];
  const char *unit = vs_fit_problem_unit(q, d);
  double factor = vs_units_factor(unit);
  char name[128], error[64];
  snprintf(name, sizeof name, "%.120s", vs_fit_problem_name(q, d));
  if (q->n_runs > 1)
    snprintf(name, sizeof name, "%d.%.110s", d->run + 1, vs_fit_problem_name(q, d));
  if (d->relative)
    snprintf(error, sizeof error, "%.4g %%", 100 * d->error);
  else
    snprintf(error, sizeof error, "%.4g %s", d->error / factor, unit);
  fprintf(out, "%-24s %14.6g %14.6g %-6s %12s %9.3f\n", name, d->value / factor,
          o->estimate.computed[n] / factor, unit, error, o->estimate.residual[n]);
}

static void show_aims(const vs_fit_result *o, FILE *out) {
  size_t aims = 0, n;
  for (n = 0; n < o->inquiry->n_data; n++) aims += o->inquiry->data[n].aim >= 0;
  if (!aims) return;
  fprintf(out, "\n%-24s %14s %14s %-6s %12s %9s\n", "measure", "measured", "fitted", "",
          "std error", "residual");
  for (n = 0; n < o->inquiry->n_data; n++)
    if (o->inquiry->data[n].aim >= 0) show_datum(o, n, out);
}

static void show_priors(const vs_fit_result *o, FILE *out) {
  size_t row = o->inquiry->n_data;
  for (size_t k = 0; k < o->inquiry->n_unknowns; k++)
    if (!isnan(o->inquiry->unknowns[k].prior))
      fprintf(out, "prior of %-52s %26.3f\n", o->inquiry->unknowns[k].name,
              o->estimate.residual[row++]);
}

/* Prints a dash where there are too few samples. */
static void print_figure(double figure, const char *format, char *text) {
  snprintf(text, FIGURE, format, figure);
  if (isnan(figure)) snprintf(text, FIGURE, "-");
}

static void show_pattern(const vs_residual_tests *p, FILE *out) {
  char runs[FIGURE], ljung_box[FIGURE], chance[FIGURE], durbin_watson[FIGURE];
  print_figure(100 * p->runs_probability, "%.3g%%", runs);
  print_figure(p->ljung_box, "%.4g", ljung_box);
  print_figure(100 * p->ljung_box_probability, "%.3g%%", chance);
  print_figure(p->durbin_watson, "%.3f", durbin_watson);
  fprintf(out, " %8zu %8.3f %6ld %9.1f %10s %10s %10s %8s%s\n", p->count, p->rms, p->runs,
          p->runs_expected, runs, ljung_box, chance, durbin_watson, p->found ? "  PATTERN" : "");
}

static void show_columns(const vs_fit_result *o, FILE *out) {
  if (!o->n_columns) return;
  fprintf(out, "\n%-24s %8s %8s %6s %9s %10s %10s %10s %8s\n", "residuals of", "samples", "rms",
          "runs", "expected", "chance", "Ljung-Box", "chance", "D-W");
  for (size_t k = 0; k < o->n_columns; k++) {
    const vs_fit_result_column *c = &o->columns[k];
    fprintf(out, "%zu.%-22s", c->run + 1,
            o->inquiry->runs[c->run].recording.columns.item[c->column].name);
    show_pattern(&c->pattern, out);
  }
}

void vs_fit_printout_show(const vs_fit_result *o, FILE *out) {
  show_head(o, out);
  show_unknowns(o, out);
  show_chi2(o, out);
  show_correlation(&o->estimate, out);
  show_directions(&o->estimate, out);
  show_aims(o, out);
  show_priors(o, out);
  show_columns(o, out);
  rerun_show(o, out);
}

/* ---- a model that does not fit ---- */

/* The index of the datum with the largest residual. */
static size_t farthest(const vs_fit_result *o) {
  const double *residual = o->estimate.residual;
  size_t worst = 0;
  for (size_t n = 1; n < o->inquiry->n_data; n++)
    if (fabs(residual[n]) > fabs(residual[worst])) worst = n;
  return worst;
}

vs_status vs_fit_printout_judge(const vs_fit_result *o, vs_error *err) {
  const vs_estimate *e = &o->estimate;
  if (vs_estimate_fits(e)) return VS_OK;
  const size_t worst = farthest(o);
  return vs_fail(err, VS_RATING,
                 "the model does not fit: no values within the bounds come nearer than %.3g times "
                 "the stated errors (rms; %s is off by %.3g of its own), and chi2 = %.4g, which a "
                 "true model has in %.2g of all cases; the estimates mean little",
                 sqrt(e->minimum.chi2 / (double)e->freedom),
                 vs_fit_problem_name(o->inquiry, &o->inquiry->data[worst]),
                 fabs(e->residual[worst]), e->minimum.chi2, e->probability);
}

/* ---- warnings ---- */

typedef struct warner {
  void (*each)(void *ctx, const char *text);
  void *ctx;
} warner;

static void pass_warning(const warner *w, vs_text *text) {
  w->each(w->ctx, text->text);
  vs_text_free(text);
  *text = (vs_text){0};
}

static void warn_of_unknowns(const vs_fit_result *o, const warner *w) {
  const vs_estimate *e = &o->estimate;
  vs_text text = {0};
  for (size_t k = 0; k < e->n; k++) {
    const vs_unknown *u = &o->inquiry->unknowns[k];
    if (isnan(e->error[k])) {
      vs_text_add(&text,
                  "%s is on its bound, %.6g %s, and the data ask for more: it has no standard "
                  "error, and those of the others hold while it stays there",
                  u->name, e->value[k], u->axis.unit);
      pass_warning(w, &text);
    } else if (e->least[k] < u->from || e->most[k] > u->to) {
      vs_text_add(&text, "the 95 %% interval of %s passes its bounds, %g..%g %s", u->name, u->from,
                  u->to, u->axis.unit);
      pass_warning(w, &text);
    }
  }
}

static void warn_of_recordings(const vs_fit_result *o, const warner *w) {
  vs_text text = {0};
  for (size_t r = 0; r < o->inquiry->n_runs; r++) {
    const vs_recording *rec = &o->inquiry->runs[r].recording;
    if (rec->at_end) {
      vs_text_add(&text,
                  "%s: %zu samples at an end of their A/D's range are left out, as they tell no "
                  "more than that",
                  rec->path, rec->at_end);
      pass_warning(w, &text);
    }
    if (rec->again) {
      vs_text_add(&text,
                  "%s: %zu cells show a sample that a row before has shown, and are left out",
                  rec->path, rec->again);
      pass_warning(w, &text);
    }
    if (rec->columns.unused.length) {
      vs_text_add(&text, "%s: not used: %s", rec->path, rec->columns.unused.text);
      pass_warning(w, &text);
    }
    if (rec->empty) {
      vs_text_add(&text, "%s: %zu cells that are empty or nan are left out", rec->path, rec->empty);
      pass_warning(w, &text);
    }
  }
}

void vs_fit_printout_warnings(const vs_fit_result *o, void (*each)(void *ctx, const char *text),
                              void *ctx) {
  const warner w = {each, ctx};
  vs_text text = {0};
  if (o->estimate.probability > 1 - 1e-3) {
    vs_text_add(&text,
                "chi2 = %.4g is far below the %ld degrees of freedom: the errors are stated too "
                "large, or they are not independent",
                o->estimate.minimum.chi2, o->estimate.freedom);
    pass_warning(&w, &text);
  }
  if (o->estimate.unstable) {
    vs_text_add(&text,
                "an orbit is unstable at the estimate: no machine stays there, so that it is "
                "not the one that was measured");
    pass_warning(&w, &text);
  }
  warn_of_unknowns(o, &w);
  for (size_t k = 0; k < o->n_columns; k++) {
    const vs_fit_result_column *c = &o->columns[k];
    if (!c->pattern.found) continue;
    vs_text_add(&text,
                "the residuals of %s in run %zu follow a pattern that chance hardly makes: the "
                "model lacks something, or the errors are not independent",
                o->inquiry->runs[c->run].recording.columns.item[c->column].name, c->run + 1);
    pass_warning(&w, &text);
  }
  for (size_t k = 0; k < o->n_profiles; k++)
    if (o->profiles[k].lower_minimum) {
      vs_text_add(&text, "the profile of %s meets a lower chi2 than the fit: add starts",
                  o->inquiry->unknowns[o->profiles[k].unknown].name);
      pass_warning(&w, &text);
    }
  warn_of_recordings(o, &w);
}
