/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/show.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/units.h"
#include "engine/firing.h"
#include "engine/tiers.h"
#include "run/causes.h"
#include "run/engineering.h"
#include "run/listed_measure.h"
#include "verdict_table.h"

/* ---- the measures in groups: what the scene asks for, motion, electrical, devices, energy ---- */

enum { ROW = 40, WORTH_A_HEADING = 5 };

static const char *const HEADINGS[VS_SHOWN_GROUPS] = {[VS_SHOWN_MOTION] = "motion",
                                                      [VS_SHOWN_ELECTRICAL] = "electrical",
                                                      [VS_SHOWN_DEVICES] = "devices",
                                                      [VS_SHOWN_ENERGY] = "energy",
                                                      [VS_SHOWN_QUALITY] = "quality"};

/* One pass over the measures. */
typedef struct rows {
  const vs_result *result;
  const vs_show_options *options;
  FILE *out;
  int standard; /* the first so many measures may have been measured */
  int group;    /* that is printed; -1: what is asked for */
  bool begun;   /* its heading is printed */
  int printed, lines;
} rows;

/* What a short table tells of every run. */
static const char *const ALWAYS[] = {"pull_in", "release",      "stroke",
                                     "i_peak",  "t_extinction", "energy_in"};

/* ---- which of them ---- */

static const vs_value *measured_of(const rows *r, int k) {
  const vs_value *measured = &r->result->scene->measured[k < r->standard ? k : 0];
  return r->options->measured && k < r->standard && measured->known ? measured : NULL;
}

static bool begins_with_recorded(const rows *r, const char *name) {
  const vs_scene *s = r->result->scene;
  int listed[VS_CH_MOST];
  if (s->n_record == vs_channel_listed(&s->frame, listed)) return false; /* record: all */
  for (int k = 0; k < s->n_record; k++) {
    vs_channel channel = vs_channel_at(&s->frame, s->record[k]);
    size_t n = strlen(channel.name);
    if (!strncmp(name, channel.name, n) && name[n] == '_') return true;
  }
  return false;
}

static bool is_measure_asked(const rows *r, const vs_listed_measure *m, int k) {
  return measured_of(r, k) || begins_with_recorded(r, m->name);
}

static bool is_measure_wanted(const rows *r, const vs_listed_measure *m, int k) {
  if (is_measure_asked(r, m, k)) return r->group < 0;
  if ((int)m->group != r->group) return false;
  if (r->options->most == INT_MAX) return true;
  for (size_t n = 0; n < sizeof ALWAYS / sizeof *ALWAYS; n++)
    if (!strcmp(m->name, ALWAYS[n])) return false;
  return m->value.known && m->value.value != 0 && !m->doubled;
}

/* ---- their rows ---- */

static void begin_group(rows *r) {
  if (r->begun) return;
  fprintf(r->out, "\n%s\n", r->group < 0 ? "asked for" : HEADINGS[r->group]);
  r->begun = true;
  r->lines += 2;
}

/* The name to the left and the value to the right of a row. */
static void print_pair(const char *name, int length, const char *value, FILE *out) {
  int room = ROW - length;
  fprintf(out, "  %.*s %*s", length, name, room > 0 ? room : 0, value);
}

/* "   at 5.556 ms" */
static void print_at(double at_s, const char *before, FILE *out) {
  char at[VS_ENGINEERING_SIZE];
  if (!isnan(at_s)) fprintf(out, "%s%s", before, vs_engineering_text(at_s, "s", at));
}

static void print_measure(rows *r, const vs_listed_measure *m, int k) {
  char value[VS_ENGINEERING_SIZE];
  const vs_value *measured = measured_of(r, k);
  if (!m->value.known) {
    print_pair(m->name, (int)strlen(m->name), m->absent ? "-" : "-\n", r->out);
    if (m->absent) fprintf(r->out, "   %s\n", m->absent);
    return;
  }
  print_pair(m->name, (int)strlen(m->name), vs_engineering_text(m->value.value, m->unit, value),
             r->out);
  print_at(m->value.at_s, "   at ", r->out);
  if (measured) {
    fprintf(r->out, "   measured %s", vs_engineering_text(measured->value, m->unit, value));
    if (measured->value != 0)
      fprintf(r->out, ": computed is %+.1f %%", 100 * (m->value.value / measured->value - 1));
  }
  if (m->over_v > 0) fprintf(r->out, "   over %s", vs_engineering_text(m->over_v, "V", value));
  if (m->unjudged) fprintf(r->out, "   %s", m->unjudged);
  fputc('\n', r->out);
}

/* True where `largest` is the largest value of what `least` is the least of: "u_min", "u_max". */
static bool are_ends(const vs_listed_measure *least, const vs_listed_measure *largest) {
  size_t n = strlen(least->name);
  return n > 4 && n == strlen(largest->name) && !strcmp(least->name + n - 4, "_min") &&
         !strcmp(largest->name + n - 4, "_max") && !strncmp(least->name, largest->name, n - 4);
}

static void print_ends(rows *r, const vs_listed_measure *least, const vs_listed_measure *largest) {
  char range[2 * VS_ENGINEERING_SIZE];
  print_pair(least->name, (int)strlen(least->name) - 4,
             vs_engineering_range(least->value.value, largest->value.value, least->unit, range),
             r->out);
  print_at(least->value.at_s, "   at ", r->out);
  print_at(largest->value.at_s, ", ", r->out);
  fputc('\n', r->out);
}

/* Prints the k-th measure, and with it the next one where the two are the ends of a range. Returns
 * how many these were. */
static int print_next(rows *r, const vs_listed_measure *m, int k) {
  const vs_frame *frame = &r->result->scene->frame;
  vs_listed_measure next;
  const bool two = !measured_of(r, k) && vs_listed_measure_at(frame, r->result, k + 1, &next) &&
                   !measured_of(r, k + 1) &&
                   is_measure_asked(r, m, k) == is_measure_asked(r, &next, k + 1) &&
                   are_ends(m, &next) &&
                   (r->options->most == INT_MAX || (next.value.known && next.value.value != 0));
  if (two)
    print_ends(r, m, &next);
  else
    print_measure(r, m, k);
  r->lines++;
  r->printed += two ? 2 : 1;
  return two ? 2 : 1;
}

static void print_group(rows *r) {
  vs_listed_measure m;
  r->begun = false;
  for (int k = 0; vs_listed_measure_at(&r->result->scene->frame, r->result, k, &m);) {
    const bool prints = is_measure_wanted(r, &m, k) && r->lines < r->options->most;
    if (prints) begin_group(r);
    k += prints ? print_next(r, &m, k) : 1;
  }
}

/* Prints the measure of that name where it says something and does not stand there already. */
static void print_named(rows *r, const char *name) {
  vs_listed_measure m;
  for (int k = 0; vs_listed_measure_at(&r->result->scene->frame, r->result, k, &m); k++)
    if (!strcmp(m.name, name) && ((m.value.known && m.value.value != 0) || m.absent) &&
        !is_measure_asked(r, &m, k))
      print_next(r, &m, k);
}

/* Prints what the deck's probes have of its first few currents. */
static void print_currents(rows *r) {
  enum { CURRENTS = 2 };
  vs_listed_measure m;
  int printed = 0;
  for (int k = 0;
       vs_listed_measure_at(&r->result->scene->frame, r->result, k, &m) && printed < CURRENTS;) {
    const bool prints = m.channel >= 0 && !strcmp(m.unit, "A") && m.value.known &&
                        r->lines < r->options->most && !is_measure_asked(r, &m, k);
    printed += prints;
    k += prints ? print_next(r, &m, k) : 1;
  }
}

/* Prints what is asked for, what every short table tells, and the motion where there is room. */
static void print_few(rows *r) {
  r->group = -1;
  print_group(r);
  if (!r->begun) fputc('\n', r->out);
  for (size_t k = 0; k < sizeof ALWAYS / sizeof *ALWAYS && r->lines < r->options->most; k++)
    print_named(r, ALWAYS[k]);
  print_currents(r);
  r->group = VS_SHOWN_MOTION;
  if (r->options->most - r->lines >= WORTH_A_HEADING) print_group(r);
}

/* Prints the groups. Asked for is what `measured` names, and, where `record` is a list, each
 * measure whose name begins with that of a recorded channel. Where there is no room for all, what
 * is asked for is followed by the stroke, the currents, the extinction and the energy drawn, and by
 * the motion as far as there is room.
 * Returns how many measures are left out. */
static int print_groups(const vs_result *result, const vs_show_options *options, FILE *out) {
  const vs_scene *s = result->scene;
  rows r = {.result = result,
            .options = options,
            .out = out,
            .standard = vs_measures_count(&s->setup.model)};
  vs_listed_measure m;
  int count = 0;
  bool measured = false;
  while (vs_listed_measure_at(&s->frame, result, count, &m)) count++;
  for (int k = 0; k < r.standard; k++) measured = measured || s->measured[k].known;
  if (options->most < INT_MAX)
    print_few(&r);
  else
    for (r.group = -1; r.group < VS_SHOWN_GROUPS; r.group++) print_group(&r);
  if (measured && !options->measured)
    fputs("what was measured is not shown: --set has changed what it was measured of\n", out);
  return count - r.printed;
}

/* ---- what was run ---- */

/* What generators have on the line besides what the deck has, and since when. */
static void print_on_line(const vs_events *events, FILE *out) {
  char network[VS_DECK_TEXT], from[VS_ENGINEERING_SIZE];
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    if (!vs_scene_event_network(e, network, sizeof network)) continue;
    fprintf(out, "line   on the line from %s: %s %s (%s)\n",
            e->on_line_s > 0 ? vs_engineering_text(e->on_line_s, "s", from) : "the start",
            e->kind->name, e->name, network);
  }
  const vs_scene_event *repeated = vs_scene_event_repeated(events);
  if (repeated)
    fprintf(out,
            "pulses %d, %s apart: one is simulated, and t_j_rise and i_pulse are told for the last "
            "of them\n",
            repeated->v.times, vs_engineering_text(repeated->v.every_s, "s", from));
}

/* Which way the heat of each device goes, where its case is known, and how warm that is taken for.
 */
static void print_ways_of_heat(const vs_result *r, FILE *out) {
  const vs_devices *d = r->watchers.devices;
  for (size_t k = 0; d && k < d->count; k++) {
    const vs_watched *w = &d->item[k];
    const vs_reduced *of_case = vs_reducer_of(w, VS_R_CASE);
    vs_text text = {0};
    if (!of_case || !of_case->value.known) continue;
    vs_cooling_write(w->cooling, w->deck, w->device, &text);
    if (of_case->note)
      fprintf(out, "heat   %s; the case stays at the ambient, as no mean is judged (%s)\n",
              text.text, of_case->note);
    else
      fprintf(out, "heat   %s; the case is as the mean power makes it in the long run\n",
              text.text);
    vs_text_free(&text);
  }
}

/* When a switch of the deck is on. */
static void print_switching(const vs_pwm_values *p, FILE *out) {
  if (!vs_pwm_is_single(p)) {
    char carrier[VS_ENGINEERING_SIZE];
    fprintf(out, ", switched at %s\n", vs_engineering_text(p->carrier_hz, "Hz", carrier));
    return;
  }
  fprintf(out, ", switched on at %.6g ms", 1e3 * p->on_s);
  if (p->off_s > 0 && isfinite(p->off_s)) fprintf(out, ", off at %.6g ms", 1e3 * p->off_s);
  fputs("\n", out);
}

/* When the thyristor is fired, and at which angle. */
static void print_firing(const vs_timeline *timeline, const vs_deck *deck, FILE *out) {
  const vs_firing_values *f = &timeline->firing;
  double range[2];
  if (f->no_valve && vs_deck_has_port(deck, vs_port_is_modulated)) {
    print_switching(&timeline->pwm, out);
    return;
  }
  if (f->no_valve) {
    fputs(timeline->supply.direct ? ", from t = 0 on\n" : ", nothing fired\n", out);
    return;
  }
  if (f->every > 1)
    fprintf(out, ", fired in 1 of %d cycles", f->every);
  else
    fprintf(out, ", fired %s", f->every ? "in each cycle" : "once");
  if (timeline->program)
    fputs(" as its control decides", out);
  else {
    vs_firing_range(timeline, range);
    fprintf(out, " at %.6g", range[0] * 180 / M_PI);
    if (range[1] > range[0]) fprintf(out, " to %.6g", range[1] * 180 / M_PI);
    fputs(" deg", out);
  }
  if (f->first_cycle != 1) fprintf(out, ", from cycle %d on", f->first_cycle);
  fputs("\n", out);
}

/* What was run, and how. */
void vs_show_machine_and_supply(const vs_setup *setup, FILE *out) {
  const vs_supply_values *supply = &setup->timeline.supply;
  const char *model = setup->model.parameters.model, *title = setup->machine->title;
  const bool titled = *title != '\0';
  fprintf(out, "machine %s%s%s%s, supply %.9g V", model, titled ? " (" : "", title,
          titled ? ")" : "", supply->voltage_v);
  if (supply->direct)
    fputs(" direct", out);
  else
    fprintf(out, " rms, %.9g Hz", supply->frequency_hz);
  print_firing(&setup->timeline, &setup->deck, out);
}

/* How much of the material rides, where that was found and not given. */
static void print_load(const vs_scene *s, FILE *out) {
  const vs_tier *tier = vs_tiers_of_orbit(s->tier);
  if (vs_setup_found_fraction(&s->setup))
    fprintf(out,
            "load   fraction %.9g of the material rides (auto: empirical, by the throw coefficient "
            "%.6g on the orbit%s%s%s)\n",
            s->setup.model.riding, s->setup.throw_coefficient, s->tier == tier ? "" : " of tier ",
            s->tier == tier ? "" : tier->name,
            s->setup.other_on_ideal ? "; another one was looked for on an ideal tier alone" : "");
}

/* With which settings the run was made in the end, where it could not be with its own. */
static void print_rung(const vs_result *r, FILE *out) {
  if (r->ladder.rung)
    fprintf(out, "rung   %d: %s; before, %s\n", r->ladder.rung, vs_ladder_text(r->ladder.rung),
            r->ladder.failed);
}

static void print_head(const vs_result *r, FILE *out) {
  const vs_scene *s = r->scene;
  const vs_absence *absence = &r->watchers.absence;
  fprintf(out, "\nscene  %s\n", s->path);
  vs_show_machine_and_supply(&s->setup, out);
  fprintf(out, "tier   %s (%s)\n", s->tier->name, s->why);
  print_rung(r, out);
  if (absence->times)
    fprintf(
        out,
        "quiet  %.4g s of it without ngspice, from %.6g s on, %d time%s; errors by that: at most "
        "%.2g of each peak\n",
        absence->total_s, absence->first_s, absence->times, absence->times > 1 ? "s" : "",
        absence->bound);
  const char *declined = vs_result_declined(r);
  if (declined) fprintf(out, "quiet  ngspice is not left: %s\n", declined);
  print_on_line(&s->setup.timeline.events, out);
  print_load(s, out);
  print_ways_of_heat(r, out);
  if (r->watchers.devices)
    fprintf(out, "means  over %.9g..%.9g s\n", s->setup.means.from_s, s->setup.means.to_s);
}

/* ---- instruments, control, quality ---- */

/* What each instrument makes of a sine of the frequency at which the machine works. */
static void print_instruments(const vs_result *r, int width, FILE *out) {
  double hz = vs_instruments_working_hz(&r->scene->setup), gain, phase_rad;
  char at[32];
  snprintf(at, sizeof at, "at %.6g Hz: gain", hz);
  if (r->meters)
    fprintf(out, "\n%-*s %20s %14s %9s %13s\n", width, "instrument", at, "phase", "samples",
            "beyond range");
  for (int k = 0; r->meters && k < r->scene->instruments.count; k++) {
    const vs_meter *m = &r->meters[k];
    vs_lowpass_response(&m->lowpass, hz, &gain, &phase_rad);
    fprintf(out, "%-*s %20.6f %10.4f deg %9ld %13ld\n", width, m->instrument->name, gain,
            phase_rad / vs_units_factor("deg"), m->samples, m->beyond);
  }
}

static void print_control(const vs_result *r, int width, FILE *out) {
  const vs_loop *l = r->loop;
  if (l)
    fprintf(out, "%-*s law %s: %ld firings decided, %ld of them left out, %ld at a limit\n", width,
            "control", l->control->regulator->name, l->program.count, l->left_out, l->at_limit);
}

/* What the control has decided, and what it shows at the run's end. */
static void print_loop(const vs_result *r, int width, FILE *out) {
  const vs_loop *l = r->loop;
  vs_control_column column;
  if (!l) return;
  fputc('\n', out);
  print_control(r, width, out);
  for (int k = 0; k <= vs_control_outputs(l->control); k++) {
    vs_control_column_at(l->control, k, &column);
    double value = vs_loop_shows(l, k);
    const char *unit = column.unit;
    if (!strcmp(unit, "rad")) value /= vs_units_factor("deg"), unit = "deg";
    fprintf(out, "%-*s %16.9g %-5s %14s\n", width, column.name, value, unit, "at the end");
  }
}

static double percent(double part, double of) {
  return of > 0 ? 100 * part / of : 0;
}

/* How far the observer's estimates were from the true motion. */
static void print_observer(const vs_result *r, int width, FILE *out) {
  const vs_state_observer *o = &r->scene->control.observing;
  if (!r->loop || !o->system) return;
  const vs_estimator_errors *e = &r->loop->estimator.errors;
  char settled[48];
  snprintf(settled, sizeof settled, "from %.4g s on", o->settling_s);
  fprintf(out, "\n%-*s %16s %-5s %20s %24s\n", width, "estimate", "largest error", "",
          "of the peak", settled);
  for (int k = 0; k < o->estimates; k++) {
    fprintf(out, "%-*s %16.6g %-5s %18.4f %%", width, o->estimate[k].column, e->all[k],
            o->estimate[k].unit, percent(e->all[k], e->peak[k]));
    if (e->after)
      fprintf(out, " %22.4f %%\n", percent(e->settled[k], e->peak[k]));
    else
      fprintf(out, " %24s\n", "the run is shorter");
  }
}

void vs_show_windows(const vs_spectrum *s, FILE *out) {
  int windows = vs_spectrum_windows(s);
  if (!s->grouping.told) return;
  if (windows)
    fprintf(out,
            "held against limits: groups by IEC 61000-4-7, root mean square of %d window%s of %d "
            "cycles\n",
            windows, windows > 1 ? "s" : "", s->grouping.each);
  else
    fputs("held against limits: nothing, as groups by IEC 61000-4-7 want whole firing periods\n",
          out);
}

void vs_show_classes(const vs_drawn_current *drawn, FILE *out) {
  fprintf(out, "%-10s %15s %15s   %s\n", "class", "worst harmonic", "part of limit", "of");
  for (const vs_harmonic_class *c = vs_harmonic_classes_all; c->name; c++) {
    double part;
    int worst = vs_harmonic_classes_worst(c, drawn, &part);
    if (isnan(part))
      fprintf(out, "%-10s %15s %15s   %s\n", c->name, "-", "-", c->text);
    else
      fprintf(out, "%-10s %15d %13.2f %%   %s%s\n", c->name, worst, 100 * part, c->text,
              part <= 1 ? "" : ": not held");
  }
}

enum { SHOWN = 10 }; /* the last harmonic in the table; JSON has all */

/* The harmonics of a current, and what limits are set for them. */
static void print_quality_of_current(const vs_quality *q, FILE *out) {
  const vs_drawn_current drawn = vs_quality_drawn(q);
  double first_a = vs_spectrum_harmonic(&q->current, 1);
  fprintf(out, "\nquality of %s, over %d cycles of the mains\n", q->name, q->cycles);
  const bool groups = vs_spectrum_windows(&q->current) > 0;
  fprintf(out, "%-10s %15s %15s %15s%s\n", "harmonic", "A rms", "of harmonic 1", "phase",
          groups ? "     group A rms" : "");
  for (int n = 0; n <= SHOWN; n++) {
    double each = vs_spectrum_harmonic(&q->current, n), phase_rad = vs_quality_phase(q, n);
    fprintf(out, "%-10d %15.9g", n, each);
    if (first_a > 0) fprintf(out, " %13.2f %%", 100 * each / first_a);
    if (isfinite(phase_rad)) fprintf(out, " %11.2f deg", phase_rad / vs_units_factor("deg"));
    if (groups && n)
      fprintf(out, "%*s %15.9g", isfinite(phase_rad) ? 0 : 16, "",
              vs_spectrum_judged(&q->current, n));
    fputc('\n', out);
  }
  vs_show_windows(&q->current, out);
  vs_show_classes(&drawn, out);
}

/* ---- all of it ---- */

/* What the force of the analytic tier has done besides. */
static void print_one_way(const vs_result *r, FILE *out) {
  const double work_j = r->watchers.energy.joule[VS_E_WORK];
  if (r->scene->frame.gap_at_rest && work_j != 0)
    fprintf(out, "\nthe one-way force of this tier did %.4f J of work that nothing supplied\n",
            work_j);
}

void vs_show_all(const vs_result *r, const vs_show_options *options, const vs_show_more *more,
                 FILE *out) {
  const int width = 18;
  if (!more->show || r->verdict.count) vs_verdict_table_whole(r, out);
  if (r->causes) vs_causes_show(r->causes, out);
  if (more->show && r->verdict.count) fputc('\n', out);
  if (more->show) more->show(more->ctx, out);
  print_head(r, out);
  print_groups(r, options, out);
  print_one_way(r, out);
  print_instruments(r, width, out);
  print_loop(r, width, out);
  print_observer(r, width, out);
  for (int k = 0; k < r->n_quality; k++) print_quality_of_current(&r->quality[k], out);
  fprintf(out, "\n%ld steps in %.3g s\n", r->steps, r->wall_s);
}

/* ---- in short ---- */

/* The table has at most LINES, and one more tells what was written. With an orbit it has a few
 * more. The lines of the verdict get what the others leave, and at least three, for which rows of
 * what is measured give way, down to LEAST_ROWS. */
enum { LINES = 24, LINES_OF_ORBIT = 30, LEAST_LINES = 3, LEAST_ROWS = 2 };

/* What is measured has more room where nothing is judged, and less where an orbit is told. */
enum { ROWS = 6, ROWS_ALONE = 15, ROWS_OF_ORBIT = 3 };

/* "quality of mains, over 4 cycles of the mains: harmonic 2 takes 10.8 % of its limit of class A"
 */
static void tell_quality(const vs_quality *q, FILE *out) {
  const vs_drawn_current drawn = vs_quality_drawn(q);
  double part;
  int worst = vs_harmonic_classes_worst(vs_harmonic_classes_all, &drawn, &part);
  fprintf(out, "quality of %s, over %d cycles of the mains: ", q->name, q->cycles);
  if (isnan(part))
    fprintf(out, "nothing is held against the limits of class %s\n", vs_harmonic_classes_all->name);
  else
    fprintf(out, "harmonic %d takes %.3g %% of its limit of class %s\n", worst, 100 * part,
            vs_harmonic_classes_all->name);
}

/* What stands behind the verdict, with that many rows of what is measured. */
static void tell_result(const vs_result *r, int shown_rows, const vs_show_options *options,
                        const vs_show_more *m, FILE *out) {
  const vs_scene *s = r->scene;
  const bool judged = r->verdict.count > 0;
  const vs_show_options few = {shown_rows, options->measured};
  fprintf(out, "%sscene  %s\n", judged || !m->show ? "\n" : "", s->path);
  vs_show_machine_and_supply(&s->setup, out);
  fprintf(out, "tier   %s (%s)\n", s->tier->name, s->why);
  print_rung(r, out);
  print_on_line(&s->setup.timeline.events, out);
  print_load(s, out);
  if (m->show) m->show(m->ctx, out);
  int left = print_groups(r, &few, out);
  print_one_way(r, out);
  print_control(r, 0, out);
  for (int k = 0; k < r->n_quality; k++) tell_quality(&r->quality[k], out);
  if (judged || vs_verdict_table_judges_nothing(r)) vs_verdict_table_not_judged(r, out);
  if (judged) {
    if (!r->corners) vs_verdict_table_corners(r, out);
    if (!r->second.done || r->second.decides > 0) vs_verdict_table_second(r, out);
  }
  fprintf(out, "%ld steps in %.3g s; --all shows %d measures more%s\n", r->steps, r->wall_s, left,
          judged ? ", and every line of the verdict" : "");
}

static int count_lines(const char *text) {
  int n = 0;
  for (; *text; text++) n += *text == '\n';
  return n;
}

void vs_show_brief(const vs_result *r, const vs_show_options *options, const vs_show_more *more,
                   FILE *out) {
  const bool judged = r->verdict.count > 0;
  int shown_rows = more->show ? ROWS_OF_ORBIT : judged ? ROWS : ROWS_ALONE, room;
  char *front = NULL, *behind = NULL, *why = NULL;
  size_t size;
  FILE *first = vs_alloc_stream(&front, &size), *asked = vs_alloc_stream(&why, &size);
  if (judged) vs_verdict_table_head(r, first);
  if (r->causes) vs_causes_show(r->causes, asked);
  vs_alloc_stream_close(first);
  vs_alloc_stream_close(asked);
  for (;; shown_rows = shown_rows + room - LEAST_LINES > LEAST_ROWS
                           ? shown_rows + room - LEAST_LINES
                           : LEAST_ROWS) {
    FILE *last = vs_alloc_stream(&behind, &size);
    tell_result(r, shown_rows, options, more, last);
    vs_alloc_stream_close(last);
    const int others = 1 + count_lines(front) + 3 + count_lines(why) +
                       count_lines(behind); /* 3: what frames the lines */
    room = (more->show ? LINES_OF_ORBIT : LINES) - others;
    if (!judged || room >= LEAST_LINES || shown_rows <= LEAST_ROWS) break;
    free(behind);
  }
  if (judged) {
    vs_verdict_table_word(r, out);
    fputs(front, out);
    vs_verdict_table_tightest(&r->verdict, room < LEAST_LINES ? LEAST_LINES : room, out);
  } else if (!more->show)
    vs_verdict_table_none(r, out);
  fputs(why, out);
  fputs(behind, out);
  free(why);
  free(front);
  free(behind);
}
