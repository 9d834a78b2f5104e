/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot`: pictures of runs and studies. */
#include "report/plot.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "commands.h"
#include "options.h"
#include "report/harmonics.h"
#include "report/margin_bars.h"
#include "report/plot_window.h"
#include "report/report.h"
#include "report/run_page.h"
#include "report/schematic.h"
#include "report/tornado.h"
#include "study/folder.h"
#include "study/methods.h"

typedef struct plot_line {
  vs_arguments common;
  vs_plot_window_options window;
  const char *overlay;
} plot_line;

/* A window of a run's time: what was asked for, or where an event of the scene begins. */
static vs_status draw_window(const plot_line *line, vs_error *err) {
  vs_plot_window_options o = line->window;
  o.folders = line->common.names;
  o.n_folders = line->common.n_names;
  o.output = line->common.output;
  o.quiet = line->common.quiet;
  return vs_plot_window_command(&o, err);
}

/* All pictures of a run. */
static vs_status plot_run(const plot_line *line, const vs_plot_options *o, vs_error *err) {
  const bool all = !o->output && !o->overlay;
  vs_status status = vs_plot_check(o, err);
  if (!status && all) status = vs_margin_bars_draw(o->folder, o->quiet, err);
  if (!status) status = vs_plot_command(o, err);
  if (status || !all) return status;
  status = vs_harmonics_draw(o->folder, o->quiet, err);
  if (!status && vs_plot_window_wanted(o->folder)) status = draw_window(line, err);
  return status ? status : vs_run_page_write(o->folder, o->quiet, err);
}

static bool ends_in(const char *name, const char *ending) {
  const size_t n = strlen(name), m = strlen(ending);
  return n > m && !strcmp(name + n - m, ending);
}

/* The schematic of a deck, into -o or into NAME.svg. */
static vs_status plot_deck(const vs_arguments *a, vs_error *err) {
  const char *deck = vs_command_name(a), *base = strrchr(deck, '/');
  char path[VS_PATH_SIZE];
  vs_file file = {0};
  vs_html svg = {0};
  base = base ? base + 1 : deck;
  if (a->n_names > 1 || (a->output && !ends_in(a->output, ".svg")))
    return vs_fail(err, VS_INPUT,
                   "%.500s: of a deck one schematic is drawn, into a FILE that ends in .svg", deck);
  if ((size_t)snprintf(path, sizeof path, "%.*s.svg", (int)(strlen(base) - 4), base) >= sizeof path)
    return vs_fail(err, VS_INPUT, "%.100s...: too long a name", deck);
  vs_status status = vs_schematic_of_deck(deck, &svg, err);
  if (!status) status = vs_file_open(&file, "", a->output ? a->output : path, err);
  if (!status) fputs(svg.text.text, file.stream); /* an error stays in the stream */
  if (!status) status = vs_file_commit(&file, err);
  if (!status && !a->quiet) printf("%s\n", file.path);
  vs_file_discard(&file);
  vs_html_free(&svg);
  return status;
}

static vs_status plot_command(const void *given, vs_error *err) {
  const plot_line *line = given;
  const vs_arguments *a = &line->common;
  const vs_plot_window_options *w = &line->window;
  const char *folder = vs_command_name(a);
  const vs_plot_options o = {folder, a->output, line->overlay, a->quiet};
  if (ends_in(folder, ".cir")) return plot_deck(a, err);
  bool close = a->n_names > 1 || w->probes || w->from || w->to || w->fft || w->orbit;
  if (close && line->overlay)
    return vs_fail(err, VS_INPUT,
                   "--overlay: it goes with the one folder alone, without --probe "
                   "and its like");
  for (size_t k = 0; close && k < a->n_names; k++)
    if (vs_folder_here(a->names[k]))
      return vs_fail(err, VS_INPUT, "%.500s holds a study; a close-up is of runs", a->names[k]);
  if (close) return draw_window(line, err);
  if (vs_tornado_here(folder) && !a->output && !line->overlay)
    return vs_tornado_draw(folder, a->quiet, err);
  if (vs_folder_here(folder)) return vs_report_command(&o, vs_methods_all, err);
  return plot_run(line, &o, err);
}

static const vs_option PLOT_OPTIONS[] = {
    VS_OPTIONS_OUTPUT("FILE",
                      "one sheet (of a study, the first picture) into FILE, which ends in .png or "
                      ".svg, instead of the set in DIR"),
    VS_OPTIONS_WORD(plot_line, window.probes, "probe", "NAME,...",
                    "of runs: one picture of these columns, named as in run.csv, with or without "
                    "unit; runs of several DIR lie over one another"),
    VS_OPTIONS_WORD(plot_line, window.from, "from", "T",
                    "the picture's first instant, as 60ms (default: where something happens)"),
    VS_OPTIONS_WORD(plot_line, window.to, "to", "T", "its last instant"),
    VS_OPTIONS_FLAG(
        plot_line, window.fft, "fft",
        "the spectrum of the probes over the whole cycles of the mains in that time, and "
        "its numbers as CSV"),
    VS_OPTIONS_FLAG(plot_line, window.orbit, "orbit",
                    "each probe, a coordinate, and its rate over one another"),
    VS_OPTIONS_WORD(plot_line, overlay, "overlay", "FILE",
                    "draws measured curves over the computed ones: a CSV file, t_s or t_ms first, "
                    "then columns named as in run.csv, also in other units (p_mm, i_ma)"),
    VS_OPTIONS_QUIET,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_plot_cli = {
    .name = "plot",
    .argument = "DIR...",
    .text = "draws a run, as PNG and SVG: displacements, accelerations, force, current and "
            "voltage, and report.html; or a "
            "study: report.html and its pictures as PNG; or of a deck FILE.cir its schematic, as "
            "SVG",
    .examples = "  vibrospice plot out\n  vibrospice plot out -o sheet.svg --overlay measured.csv\n"
                "  vibrospice plot before after --probe v_ak,i_thyristor --from 60ms --to 70ms\n"
                "  vibrospice plot out --probe i --fft\n"
                "  vibrospice plot triac_feeder.cir -o feeder.svg\n",
    .takes_many = true,
    .results = true,
    .options = PLOT_OPTIONS,
    .size = sizeof(plot_line),
    .run = plot_command};
