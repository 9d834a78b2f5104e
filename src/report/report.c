/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/report.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/gnuplot.h"
#include "plot/study_pictures.h"
#include "study_page.h"

/* A picture that gnuplot drew. */
typedef struct drawing {
  char *bytes;
  size_t size;
} drawing;

typedef struct report {
  vs_folder table;
  vs_study_results survey;
  vs_study_pictures album;
} report;

static vs_status draw_album(const vs_picture *p, bool svg, drawing *d, vs_error *err) {
  vs_script script = {0};
  vs_gnuplot_add(&script,
                 svg ? "set terminal svg dynamic mousing standalone noenhanced size %d,%d font "
                       "'sans-serif,15' background rgb 'white'\n"
                     : "set terminal pngcairo noenhanced size %d,%d font 'sans-serif,11' "
                       "background rgb 'white'\n",
                 p->width, p->height);
  vs_gnuplot_code(&script, p->script.text.text ? p->script.text.text : "");
  vs_status status = vs_gnuplot_picture(script.text.text, &d->bytes, &d->size, err);
  vs_gnuplot_free(&script);
  return status;
}

/* Writes a file under a temporary name; it gets its own when it is committed. */
static vs_status prepare_folder(vs_file *file, const char *folder, const char *name,
                                const drawing *d, vs_error *err) {
  vs_status status = vs_file_open(file, folder, name, err);
  if (!status && fwrite(d->bytes, 1, d->size, file->stream) != d->size)
    status = vs_fail(err, VS_RUN, "%s: cannot be written: %s", file->path, strerror(errno));
  return status;
}

static vs_status appear(vs_file *file, bool quiet, vs_error *err) {
  vs_status status = vs_file_commit(file, err);
  if (!status && !quiet) printf("%s\n", file->path);
  return status;
}

static vs_status write_one(const report *r, const vs_plot_options *o, vs_error *err) {
  size_t n = strlen(o->output);
  vs_file file = {0};
  drawing d = {0};
  if (!r->album.count)
    return vs_fail_at(err, (vs_where){r->table.path, 1, 1}, "holds nothing to draw");
  vs_status status =
      draw_album(&r->album.item[0], n > 4 && !strcmp(o->output + n - 4, ".svg"), &d, err);
  if (!status) status = prepare_folder(&file, "", o->output, &d, err);
  if (!status) status = appear(&file, o->quiet, err);
  vs_file_discard(&file);
  free(d.bytes);
  return status;
}

/* Draws all pictures, makes the page, and then gives all files their names. */
static vs_status write_report(const report *r, const vs_plot_options *o, vs_error *err) {
  size_t n = r->album.count;
  vs_file *files = vs_alloc(n + 1, sizeof *files);
  char **svg = vs_alloc(n + 1, sizeof *svg), name[300];
  vs_status status = VS_OK;
  for (size_t k = 0; k < n && !status; k++) {
    drawing vector = {0}, pixels = {0};
    status = draw_album(&r->album.item[k], true, &vector, err);
    svg[k] = vector.bytes;
    if (!status) status = draw_album(&r->album.item[k], false, &pixels, err);
    snprintf(name, sizeof name, "%s.png", r->album.item[k].name);
    if (!status) status = prepare_folder(&files[k], o->folder, name, &pixels, err);
    free(pixels.bytes);
  }
  vs_html html = {0};
  if (!status) vs_study_page_write(&r->table, &r->survey, &r->album, svg, &html);
  const drawing page = {html.text.text, html.text.length};
  if (!status) status = prepare_folder(&files[n], o->folder, "report.html", &page, err);
  for (size_t k = 0; k <= n && !status; k++) status = appear(&files[k], o->quiet, err);
  for (size_t k = 0; k <= n; k++) {
    vs_file_discard(&files[k]);
    free(svg[k]);
  }
  vs_html_free(&html);
  free(svg);
  free(files);
  return status;
}

vs_status vs_report_command(const vs_plot_options *o, const vs_method *const *methods,
                            vs_error *err) {
  report *r = vs_alloc(1, sizeof *r);
  vs_status status = vs_plot_check(o, err);
  if (!status && o->overlay)
    status = vs_fail(err, VS_INPUT, "--overlay %s: goes over a run; %s holds a study", o->overlay,
                     o->folder);
  if (!status) status = vs_folder_open(&r->table, o->folder, methods, err);
  if (!status) status = vs_study_results_take(&r->table, &r->survey, err);
  if (!status) status = vs_study_pictures_make(&r->table, &r->survey, &r->album, err);
  if (!status) status = o->output ? write_one(r, o, err) : write_report(r, o, err);
  vs_study_pictures_free(&r->album);
  vs_study_results_free(&r->table, &r->survey);
  vs_folder_close(&r->table);
  free(r);
  return status;
}
