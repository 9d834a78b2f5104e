/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "digest/digest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "closeup/strips.h"
#include "digest/chapters.h"
#include "digest/flow.h"
#include "picture/gnuplot.h"
#include "report/html.h"

enum {
  WIDTH = 820,
  HEIGHT = 380,     /* pixels of a picture */
  MOST_ROWS = 50000 /* of a run that is drawn whole; the page would be too large */
};

/* The usual probes, and as far as there is room what the deck has besides. */
static vs_status choose(const vs_traces *t, vs_probes_shown *probes, vs_error *err) {
  vs_status status = vs_probes_find(NULL, t, probes, err);
  int mains = vs_traces_find(t, "v_mains_v");
  for (size_t c = (size_t)(mains + 1); !status && mains > 0 && c < t->columns; c++)
    if (probes->count < VS_PROBES_MOST) status = vs_probes_find(t->name[c], t, probes, err);
  return status;
}

static vs_status add_picture(const vs_stretch *s, int probe, vs_text *html, vs_error *err) {
  vs_text script = {0};
  char *svg = NULL;
  size_t size;
  const char *label = s->probes.item[probe].label;
  vs_text_add(&script,
              "set terminal svg dynamic mousing standalone noenhanced size %d,%d font "
              "'sans-serif,15' background rgb 'white'\n",
              WIDTH, HEIGHT);
  vs_strips_one(s, probe, &script);
  vs_status status = vs_gnuplot_picture(script.text, &svg, &size, err);
  const vs_html_picture picture = {label, s->probes.item[probe].column, svg, WIDTH, HEIGHT};
  if (!status) vs_html_picture_add(html, &picture);
  free(svg);
  vs_text_free(&script);
  return status;
}

static vs_status add_waveforms(const vs_stretch *s, bool whole, vs_text *html, vs_error *err) {
  vs_status status = VS_OK;
  vs_text_add(html,
              "<section id=\"waveforms\">\n<h2>Waveforms</h2>\n<p class=\"of screen\">A click "
              "shows where the mouse is; Ctrl and the wheel zoom, the right button goes "
              "back.</p>\n");
  if (!whole)
    vs_text_add(html, "<p>The run has more than %d rows, and is drawn from %.6g s to %.6g s.</p>\n",
                MOST_ROWS, s->from_s, s->to_s);
  vs_text_add(html, "<div class=\"pictures\">\n");
  for (int k = 0; k < s->probes.count && !status; k++) status = add_picture(s, k, html, err);
  vs_text_add(html, "</div>\n</section>\n");
  return status;
}

static vs_status write_page(const char *folder, const vs_text *html, bool quiet, vs_error *err) {
  vs_file file = {0};
  vs_status status = vs_file_open(&file, folder, "report.html", err);
  if (status) return status;
  fwrite(html->text, 1, html->length, file.stream); /* an error stays in the stream */
  status = vs_file_commit(&file, err);
  if (!status && !quiet) printf("%s\n", file.path);
  return status;
}

/* Fills the stretch with the whole run, or where that has too many rows, with its last ones. */
static vs_status open_run(const char *folder, vs_stretch *s, bool *whole, vs_error *err) {
  vs_stretch_run *run = &s->run[0];
  s->runs = 1;
  run->folder = folder;
  vs_status status = vs_traces_read(folder, &run->traces, err);
  if (!status) status = vs_moments_read(folder, &run->moments, err);
  if (!status) status = choose(&run->traces, &s->probes, err);
  if (status) return status;
  size_t rows = run->traces.rows;
  *whole = rows <= MOST_ROWS;
  s->from_s = vs_trace_time(&run->traces, *whole ? 0 : rows - MOST_ROWS);
  s->to_s = vs_trace_time(&run->traces, rows - 1);
  return VS_OK;
}

vs_status vs_digest_write(const char *folder, bool quiet, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_tree summary = {0};
  vs_text html = {0};
  bool whole = true;
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (access(path, R_OK)) return VS_OK;
  vs_stretch *s = vs_alloc(1, sizeof *s);
  vs_status status = open_run(folder, s, &whole, err);
  if (!status) status = vs_tree_read(path, &summary, err);
  if (!status) {
    vs_chapter_head(&html, folder, summary.root, s->to_s);
    vs_chapter_verdict(&html, summary.root);
    vs_flow_add(&html, vs_tree_child(summary.root, "energy"));
    status = add_waveforms(s, whole, &html, err);
    vs_chapter_measures(&html, summary.root);
    vs_chapter_parameters(&html, summary.root);
    vs_text_add(&html, "</main>\n</body>\n</html>\n");
  }
  if (!status) status = write_page(folder, &html, quiet, err);
  vs_tree_free(&summary);
  vs_text_free(&html);
  vs_traces_free(&s->run[0].traces);
  vs_moments_free(&s->run[0].moments);
  free(s);
  return status;
}
