/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/branch.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/leave.h"
#include "drawing.h"
#include "rows.h"

/* ---- files ---- */

static vs_status write_text(const char *folder, const char *name, const char *text, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, name, err);
  if (status) return status;
  fputs(text, file.stream);
  return vs_file_commit(&file, err);
}

static vs_status write_csv(const vs_walk *w, const char *folder, int digits, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, "branch.csv", err);
  if (status) return status;
  vs_rows_csv(w, digits, file.stream);
  return vs_file_commit(&file, err);
}

/* The picture comes last. Where gnuplot is missing the numbers are there all the same; *drawn says
 * so. */
static vs_status write_files(const vs_walk *w, const vs_run_options *o, const char *json,
                             bool *drawn, vs_error *err) {
  int made = 0;
  vs_error why = {0};
  vs_status status = vs_file_folder_make(o->folder, &made, err);
  if (!status) status = write_csv(w, o->folder, o->digits, err);
  if (!status) status = write_text(o->folder, "branch.json", json, err);
  if (status) vs_file_folder_unmake(o->folder, made);
  if (status) return status;
  *drawn = !vs_drawing_write(w, o->folder, &why);
  if (!*drawn) fprintf(stderr, "vibrospice: warning: no branch.png: %s\n", why.text);
  return VS_OK;
}

/* ---- the command ---- */

static vs_status say(const vs_walk *w, const vs_run_options *o, vs_error *err) {
  vs_text json = {0};
  bool drawn = false;
  vs_rows_json(w, &json);
  vs_status status = o->folder ? write_files(w, o, json.text, &drawn, err) : VS_OK;
  if (!status && o->json)
    fputs(json.text, stdout);
  else if (!status && !o->quiet) {
    vs_rows_print(w, stdout);
    if (o->folder)
      printf("written: branch.csv, branch.json%s in %s\n", drawn ? ", branch.png" : "", o->folder);
  }
  vs_text_free(&json);
  if (!status && w->end == VS_WALK_STOPPED)
    status = vs_fail(err, VS_SIGNAL, "stopped by a signal; the branch is told up to %s = %.9g%s%s",
                     w->along->axis.key, w->row[w->count - 1].at.z[w->path.count],
                     *w->along->axis.unit ? " " : "", w->along->axis.unit);
  if (!status && (w->end == VS_WALK_STUCK || w->end == VS_WALK_SPENT))
    status = vs_fail(err, w->end == VS_WALK_SPENT ? VS_BUDGET : VS_RUN,
                     "the branch cannot be followed beyond %s = %.9g%s%s: %s", w->along->axis.key,
                     w->row[w->count - 1].at.z[w->path.count], *w->along->axis.unit ? " " : "",
                     w->along->axis.unit, w->why);
  return status;
}

/* A branch wants the run's exact derivatives. */
static vs_status refuse_tier(const vs_scene *s, vs_error *err) {
  const char *known = vs_tiers_automatic(false)->name;
  if (!s->tier->has_circuit && !s->tier->gap_at_rest) return VS_OK;
  return vs_fail_at(
      err, vs_tree_place(s->tree.root, "run.tier"),
      "steady --along: this is tier %s (%s), and branches are followed on tier %s alone; "
      "write --tier %s, or run.tier: %s",
      s->tier->name, s->why, known, known, known);
}

static vs_status follow(const vs_branch_options *o, vs_scene *scene, vs_error *err) {
  vs_along along = {0};
  vs_walk walk = {0};
  vs_status status = refuse_tier(scene, err);
  if (!status) status = vs_along_read(&along, scene, &o->words, err);
  vs_heed before = vs_leave_heed_set(VS_HEED_SOON);
  if (!status) status = vs_walk_go(&walk, &along, o->periods, o->run->stop, err);
  vs_leave_heed_set(VS_HEED_KEEP);
  if (!status) status = vs_along_move(&along, along.from, err); /* which the files tell of */
  if (!status) status = say(&walk, o->run, err);
  vs_leave_heed_set(before);
  vs_walk_free(&walk);
  vs_along_free(&along);
  return status;
}

vs_status vs_branch_command(const vs_branch_options *o, vs_error *err) {
  const vs_run_options *run = o->run;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  scene->of_period = true;
  vs_status status = vs_scene_read(run->scene, run->sets, run->n_sets, run->tier, scene, err);
  if (!status) vs_scene_hold(scene);
  scene->order.shows = !run->quiet && isatty(STDERR_FILENO);
  if (!status && !run->quiet) vs_scene_warn(scene);
  if (!status) status = follow(o, scene, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}
