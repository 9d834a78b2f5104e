/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `study`, from the study's file to its result. vs_study_command tells it; the parts
 * stand below in the same order. */
#include "study/study.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/shutdown.h"
#include "cleanup.h"
#include "engine/budget.h"
#include "judge.h"
#include "manifest.h"
#include "peers.h"
#include "publish.h"
#include "run/session.h"
#include "study/merge.h"
#include "study/plan.h"
#include "study_file.h"
#include "workers/case.h"
#include "workers/journal.h"
#include "workers/journal_head.h"
#include "workers/platform.h"
#include "workers/row_shape.h"
#include "workers/shared_prefix.h"
#include "workers/worker.h"
#include "workers/worker_pool.h"

/* The cases of a study under way: which point each of them is and, of a search, which cases it
 * has asked for and what has come of them. Begins as zeros but for plan and journal, which are
 * borrowed. cases_free. The arrays are a search's, as vs_results has them. */
typedef struct vs_cases {
  const vs_plan *plan;
  const vs_journal *journal;
  double *points, *values;
  int *status;
  char **words;
  uint64_t room, answered;
} vs_cases;

/* A shard that has waited so long for another one says so. */
static const double PATIENCE_S = 60;

/* A study under way. */
typedef struct session {
  const vs_study_options *o;
  vs_plan plan;
  vs_journal journal;
  vs_cases cases;
  vs_worker_pool *jobs;
  char folder[VS_PATH_SIZE], keep[VS_PATH_SIZE + 8];
  char own[VS_PUBLISH_FILES + 1][VS_PATH_SIZE + 16]; /* without -o: the files in the folder, and
                                                 their journal, to be removed */
  int made;                                          /* how many folders were made for the output */
  bool named;                                        /* the folder has its name */
  uint64_t count;       /* cases of the study; of a search those it has come to in the end */
  uint64_t next, until; /* cases to deal; of a search those of the present generation */
  uint64_t total;       /* cases of this shard, for the progress */
  uint64_t shared;      /* how many had their past from another (study/workers/shared_prefix.h) */
  uint64_t before;      /* how many were done when this process began */
  uint64_t peer, peers; /* of a search in shards: this process among them, from 0 (peers.h) */
  vs_judge judge;
  int way;       /* of VS_JUDGE_WAYS, that judges at present */
  size_t picked; /* the next of judge.picked to deal */
  double began_s, shown_s;
  bool show;     /* progress is shown on a terminal */
  double tell_s; /* without one it is told next so long after began_s */
} session;

/* ---- a study, from top to bottom ---- */

static session *begin_session(const vs_study_options *options);
static vs_status check_options(const vs_study_options *options, vs_error *err);
static vs_status read_plan(session *s, vs_error *err);
static vs_status open_folder(session *s, vs_error *err);
static vs_status run_study(session *s, vs_error *err);
static vs_status judge_cases(session *s, vs_error *err);
static vs_status write_result(session *s, vs_error *err);
static vs_status say_result(const session *s, vs_error *err);
static vs_status judge_study(session *s, vs_error *err);
static vs_status end_session(session *s, vs_status status, vs_error *err);

vs_status vs_study_command(const vs_study_options *o, vs_error *err) {
  session *s = begin_session(o);
  vs_status status = check_options(o, err);

  /* Plan: the study's file says which scene is run, which of its keys are varied by which methods
   * (study/methods.h), and which measures are reported. A plan knows its cases by number: case k is
   * a point, a number for each axis (study/plan.h). The scene of the first case is settled on trial
   * (study_file.c). */
  if (!status) status = read_plan(s, err);

  /* Journal: the record, in the study's folder, of the cases that are done (workers/journal.h).
   * With --resume a study goes on with the one that is there; else a new one is begun. */
  if (!status) status = open_folder(s, err);

  /* Cases and workers: the cases that the journal lacks are dealt out to worker processes
   * (workers/worker_pool.h). A worker puts the case's point over the scene as keys, runs the scene
   * as `run` does, and answers with a row of study.csv (workers/case.h), which is added to the
   * journal. A method that searches is shown these rows, and asks for the next generation of cases.
   */
  if (!status) status = run_study(s, err);

  /* Judge: where the tier solves the circuit without ngspice, some cases are run in it, too
   * (judge.h). */
  if (!status) status = judge_cases(s, err);

  /* Rows: all rows of the journal in the order of the cases, whatever the order in which workers
   * came to their end: study.csv, failures.csv and manifest.json (publish.h). */
  if (!status) status = write_result(s, err);

  /* Report: the counts on standard output; failed cases and violated ratings in the exit status. */
  if (!status) status = say_result(s, err);
  if (!status) status = judge_study(s, err);
  return end_session(s, status, err);
}

/* ---- beginning and end ---- */

/* Errors: options that do not go together. */
static vs_status check_options(const vs_study_options *o, vs_error *err) {
  if (o->resume && o->overwrite)
    return vs_fail(err, VS_INPUT,
                   "--resume goes on with what is there, --overwrite throws it "
                   "away; give one of them");
  if (o->again && !o->resume)
    return vs_fail(err, VS_INPUT,
                   "--again: it says what --resume does besides going on; give both");
  const char *wants_folder = o->format != vs_format_all ? "--format"
                             : o->resume                ? "--resume"
                             : o->overwrite             ? "--overwrite"
                             : o->keep_runs             ? "--keep runs"
                             : o->progress_json         ? "--progress json"
                             : o->shard                 ? "--shard"
                                                        : NULL;
  if (o->folder || !wants_folder) return VS_OK;
  return vs_fail(err, VS_INPUT, "%s: wants a folder; name one with -o DIR", wants_folder);
}

static void cases_free(vs_cases *c) {
  for (uint64_t k = 0; k < c->answered * VS_RESULT_WORDS; k++) free(c->words[k]);
  free(c->words);
  free(c->points);
  free(c->values);
  free(c->status);
  *c = (vs_cases){0};
}

static void discard_folder(const session *s) {
  for (size_t k = 0; k <= VS_PUBLISH_FILES; k++) {
    unlink(s->own[k]);
    vs_shutdown_forget(s->own[k]);
  }
  rmdir(s->folder);
  vs_shutdown_forget(s->folder);
}

static session *begin_session(const vs_study_options *o) {
  session *s = vs_alloc(1, sizeof *s);
  *s = (session){.o = o, .journal = {.fd = -1, .folder = -1}};
  s->cases = (vs_cases){.plan = &s->plan, .journal = &s->journal};
  vs_hash_hold(true); /* before the first file is read */
  return s;
}

/* The first `count` cases, as a method is shown them. */
static vs_results cases_results(const vs_cases *c, uint64_t count) {
  return (vs_results){c->plan, count, c->points, c->values, c->status, c->words};
}

/* Says of a study that a signal ended how to go on, and how far it came. */
static void say_stopped(const session *s, vs_error *err) {
  const vs_plan_stage *stage = s->plan.adaptive;
  const vs_results results = cases_results(&s->cases, s->cases.answered);
  vs_text text = {0};
  vs_text_add(&text, "%llu", (unsigned long long)(s->journal.done + s->journal.failed));
  if (!stage) vs_text_add(&text, " of %llu", (unsigned long long)s->total);
  vs_text_add(&text, " cases are done (rows: %s, behind \" = \")", s->journal.path);
  if (stage && stage->method->say && results.count)
    vs_text_add(&text, "; so far: "), stage->method->say(&s->plan, stage, &results, &text);
  vs_fail(err, VS_SIGNAL, "stopped by a signal; --resume goes on: %s", text.text);
  vs_text_free(&text);
}

static vs_status end_session(session *s, vs_status status, vs_error *err) {
  if (status == VS_SIGNAL && s->o->folder) say_stopped(s, err);
  if (s->named && !s->o->folder) discard_folder(s);
  vs_journal_close(&s->journal);
  vs_plan_free(&s->plan);
  cases_free(&s->cases);
  vs_judge_free(&s->judge);
  free(s);
  vs_hash_hold(false);
  return status;
}

/* ---- plan ---- */

static vs_status read_plan(session *s, vs_error *err) {
  const vs_study_options *o = s->o;
  vs_status status = vs_study_file_read(o->name, o->methods, o->sets, o->n_sets, &s->plan, err);
  if (!status && o->method && (!s->plan.adaptive || s->plan.adaptive->method != o->method))
    return vs_fail_at(err, (vs_where){s->plan.tree.name, 1, 1},
                      "%s: the key %s is wanted; `vibrospice study` runs other studies",
                      o->method->name, o->method->key);
  s->plan.allow_code = o->allow_code;
  s->count = s->plan.count;
  return status ? status : vs_control_allow(&s->plan.first->control, o->allow_code, err);
}

/* ---- cases ---- */

/* Writes the point of case `index`, point[n_axes]. A search must have asked for it. */
static void cases_point(const vs_cases *c, uint64_t index, double *point) {
  const size_t axes = c->plan->n_axes;
  if (c->plan->adaptive)
    memcpy(point, c->points + index * axes, axes * sizeof *point);
  else
    vs_plan_point(c->plan, index, point);
}

/* ---- rows that are there already ---- */

static vs_status check_row_of_case(const vs_cases *c, vs_case *one, uint64_t index, vs_error *err) {
  double point[VS_PLAN_AXES];
  vs_text row = {0};
  char why[256];
  bool failed;
  cases_point(c, index, point);
  vs_status status = vs_journal_row(c->journal, index, &row, &failed, err);
  if (!status && !vs_case_is_row(one, index, point, failed, row.text, why, sizeof why))
    status = vs_fail_at(err, (vs_where){c->journal->path, 1, 1},
                        "case %llu: %s; this record is of another study, or was changed",
                        (unsigned long long)index, why);
  vs_text_free(&row);
  return status;
}

/* Error: the journal has a row of a case from `first` up to before `until` that is not that case's.
 * A journal that is gone on with may have been changed. */
static vs_status cases_check(const vs_cases *c, uint64_t first, uint64_t until, vs_error *err) {
  const vs_journal_head *head = &c->journal->head;
  vs_case *one = vs_case_new(c->plan, NULL);
  vs_status status = VS_OK;
  for (uint64_t k = first; k < until && !status; k++)
    if (k % head->shards + 1 == head->shard && vs_journal_has(c->journal, k))
      status = check_row_of_case(c, one, k, err);
  vs_case_free(one);
  return status;
}

/* ---- what a search asks for, and is told ---- */

static void cases_ask(vs_cases *c, uint64_t count, const vs_generation *g) {
  const size_t axes = c->plan->n_axes, width = 1 + c->plan->n_columns;
  const uint64_t need = count + g->count;
  if (need > c->room) {
    c->room = 2 * need;
    c->points = vs_resize(c->points, c->room * axes, sizeof *c->points);
    c->values = vs_resize(c->values, c->room * width, sizeof *c->values);
    c->status = vs_resize(c->status, c->room, sizeof *c->status);
    c->words = vs_resize(c->words, c->room * VS_RESULT_WORDS, sizeof *c->words);
  }
  memcpy(c->points + count * axes, g->points, g->count * axes * sizeof *c->points);
}

static vs_status read_answer(vs_cases *c, uint64_t index, vs_error *err) {
  const size_t width = 1 + c->plan->n_columns;
  double *value = c->values + index * width;
  char **words = c->words + index * VS_RESULT_WORDS;
  vs_text row = {0};
  bool failed = false;
  vs_status status = vs_journal_row(c->journal, index, &row, &failed, err);
  for (size_t k = 0; k < width; k++) value[k] = NAN;
  for (size_t k = 0; k < VS_RESULT_WORDS; k++) words[k] = NULL;
  c->answered = index + 1;
  c->status[index] = VS_CASE_FAILED;
  if (!status && !failed) vs_case_values(c->plan, row.text, value, &c->status[index], words);
  if (!status && failed) words[VS_RESULT_WHY] = vs_case_why(row.text);
  vs_text_free(&row);
  return status;
}

/* Takes from the journal what has come of those cases, once they are done. Their rows tell it, not
 * their runs, so that a study that goes on has the same. */
static vs_status cases_answer(vs_cases *c, uint64_t first, uint64_t until, vs_error *err) {
  vs_status status = VS_OK;
  for (uint64_t k = first; k < until && !status; k++) status = read_answer(c, k, err);
  return status;
}

/* ---- journal ---- */

/* Error: the folder holds a study's result, which may be hours of work and is not thrown away
 * unasked. */
static vs_status check_folder_is_free(const session *s, bool journal, vs_error *err) {
  const char *result = vs_publish_found(s->folder);
  if (s->o->overwrite || (!journal && !result)) return VS_OK;
  if (!journal)
    return vs_fail(err, VS_INPUT,
                   "%s/%s: the result of a study is here, without a journal to go on with; "
                   "--overwrite replaces it, or take another folder",
                   s->folder, result);
  if (!result)
    return vs_fail(err, VS_INPUT,
                   "%s/journal: a study was broken off here; --resume goes on with it, --overwrite "
                   "throws it away, or take another folder",
                   s->folder);
  return vs_fail(err, VS_INPUT,
                 "%s/%s: the result of a study is here; --overwrite replaces it, --resume does "
                 "what the same study lacks, or take another folder",
                 s->folder, result);
}

/* Lets the cases that failed be run again: after a change of the machine's memory, of
 * --case-timeout, of a library. A scene or a program that has changed makes another study. */
static vs_status run_failed_again(session *s, vs_error *err) {
  uint64_t count = 0;
  vs_status status = vs_journal_call_back(&s->journal, &count, err);
  if (!status && !s->o->quiet)
    fprintf(stderr, "vibrospice: note: %llu case%s that failed run again\n",
            (unsigned long long)count, count == 1 ? "" : "s");
  return status;
}

/* The journal has another identity than the study. */
static vs_status refuse_other(const vs_journal *j, const vs_journal_head *head, vs_error *err) {
  char theirs[160], ours[160];
  if (vs_journal_head_programs(&j->head, head, theirs, ours, sizeof theirs))
    return vs_fail_at(err, (vs_where){j->path, 1, 1},
                      "was begun by %s, and this is %s; rows of two programs are not mixed: go on "
                      "with that one, or take another folder",
                      theirs, ours);
  return vs_fail_at(err, (vs_where){j->path, 1, 1},
                    "is of another study: the study's file, a file it names, a --set or the "
                    "program have changed since; take another folder, or remove this one");
}

/* Warns where the journal lacks cases, and those that it has were made on something else. */
static void warn_of_bits(const vs_journal *j) {
  const vs_journal_head *h = &j->head;
  const bool whole =
      h->cases && j->done + j->failed == (h->cases + h->shards - h->shard) / h->shards;
  vs_text list = {0};
  vs_platform_add(&list, j->bits.text);
  if (list.length) vs_platform_add(&list, vs_platform_here());
  vs_row_shape *shape = vs_row_shape_new(h->columns, h->failures, h->manifest_end);
  if (!whole && vs_platform_differ(&list)) vs_platform_warn(&list, shape, j->path);
  vs_row_shape_free(shape);
  vs_text_free(&list);
}

static vs_status resume_journal(session *s, vs_journal_head *head, vs_error *err) {
  vs_journal *j = &s->journal;
  vs_status status = vs_journal_open(j, s->folder, true, err);
  if (status) return status;
  if (strcmp(j->head.identity, head->identity)) return refuse_other(j, head, err);
  if (j->head.shard != head->shard || j->head.shards != head->shards)
    return vs_fail_at(err, (vs_where){j->path, 1, 1}, "is of shard %llu/%llu: give --shard so",
                      (unsigned long long)j->head.shard, (unsigned long long)j->head.shards);
  const char *differs = vs_journal_head_differs(&j->head, head);
  if (differs)
    return vs_fail_at(err, (vs_where){j->path, 1, 1},
                      "the line %s= of its head is not as this study writes it; this record was "
                      "changed",
                      differs);
  if (j->bad)
    fprintf(stderr,
            "vibrospice: warning: %s: %llu torn or damaged line%s not count; cases that lack their "
            "row are run again\n",
            j->path, (unsigned long long)j->bad, j->bad > 1 ? "s do" : " does");
  if (j->mended)
    fprintf(stderr, "vibrospice: warning: %s: its head was damaged, and is taken from a copy\n",
            j->path);
  status = s->plan.adaptive ? VS_OK : cases_check(&s->cases, 0, s->plan.count, err);
  if (!status && s->o->again) status = run_failed_again(s, err);
  if (!status) warn_of_bits(j);
  return status;
}

static void unlink_in(const char *folder, const char *name) {
  char path[VS_PATH_SIZE + 32];
  snprintf(path, sizeof path, "%.4000s/%s", folder, name);
  unlink(path);
}

/* Begins a new journal, and removes what the folder has of an older study. */
static vs_status begin_journal(session *s, vs_journal_head *head, vs_error *err) {
  vs_journal old;
  const bool known = vs_journal_peek(&old, s->folder);
  vs_status status = vs_journal_create(&s->journal, s->folder, head, err);
  if (!status) vs_cleanup_folder(s->folder, known ? &old : NULL);
  if (!status) vs_publish_remove(s->folder);
  const vs_method *method = s->plan.adaptive ? s->plan.adaptive->method : NULL;
  for (size_t k = 0; !status && method && method->files && method->files[k]; k++)
    unlink_in(s->folder, method->files[k]);
  vs_journal_close(&old);
  return status;
}

static vs_status open_journal(session *s, vs_error *err) {
  vs_journal_head head;
  vs_manifest_head(&s->plan, s->o->name, &head);
  vs_status status = s->o->keep_runs ? vs_case_check_csv(s->plan.first, s->plan.count, err) : VS_OK;
  if (!status && s->o->shard)
    status = vs_merge_shard_read(s->o->shard, &head.shard, &head.shards, err);
  if (!status && s->o->method) { /* each of them has the whole journal */
    s->peer = head.shard - 1;
    s->peers = head.shards;
    head.shard = head.shards = 1;
  }
  if (!status && s->plan.adaptive && head.shards > 1)
    status = vs_fail(err, VS_INPUT,
                     "--shard %s: method %s chooses its cases by the results of others; only "
                     "studies without it can be cut into shards",
                     s->o->shard, s->plan.adaptive->method->name);
  if (!status && s->plan.adaptive && s->o->again)
    status = vs_fail(err, VS_INPUT,
                     "--again: method %s chose later cases by what failed; begin the study anew",
                     s->plan.adaptive->method->name);
  struct stat st;
  if (!status && s->o->keep_runs && !lstat(s->keep, &st) && S_ISLNK(st.st_mode))
    status =
        vs_fail(err, VS_INPUT, "%s: is a link; runs are kept in the study's own folder", s->keep);
  if (!status) status = vs_publish_check(s->folder, s->o->format, err);
  if (!status) status = vs_file_folder_make(s->folder, &s->made, err);
  bool there = !status && vs_journal_exists(s->folder);
  if (!status && there && s->o->resume)
    status = resume_journal(s, &head, err);
  else if (!status)
    status = check_folder_is_free(s, there, err);
  if (!status && !(there && s->o->resume)) status = begin_journal(s, &head, err);
  vs_journal_head_free(&head);
  return status;
}

/* Without -o, makes a folder of this process' own. It is removed when its result has been shown, or
 * when a signal ends the process. */
static vs_status make_own_folder(session *s, vs_error *err) {
  const char *temporary = getenv("TMPDIR");
  sigset_t before;
  snprintf(s->folder, sizeof s->folder, "%.4000s/vibrospice.XXXXXX",
           temporary && *temporary ? temporary : "/tmp");
  vs_shutdown_block_signals(&before);
  bool made = mkdtemp(s->folder) != NULL;
  int why = errno;
  if (made) vs_shutdown_remove(s->folder);
  vs_shutdown_unblock_signals(&before);
  if (!made) return vs_fail(err, VS_RUN, "%s: cannot be made: %s", s->folder, strerror(why));
  for (size_t k = 0; k <= VS_PUBLISH_FILES; k++) {
    snprintf(s->own[k], sizeof s->own[k], "%s/%s", s->folder,
             k < VS_PUBLISH_FILES ? vs_publish_files[k] : "journal");
    vs_shutdown_remove(s->own[k]);
  }
  return VS_OK;
}

static vs_status name_folder(session *s, vs_error *err) {
  if (!s->o->folder) return make_own_folder(s, err);
  snprintf(s->folder, sizeof s->folder, "%.4000s", s->o->folder);
  snprintf(s->keep, sizeof s->keep, "%s/runs", s->folder);
  return VS_OK;
}

static vs_status open_folder(session *s, vs_error *err) {
  vs_status status = name_folder(s, err);
  s->named = !status;
  if (status) return status;
  status = open_journal(s, err);
  if (status) vs_file_folder_unmake(s->folder, s->made);
  return status;
}

/* ---- cases are dealt to workers, and their rows taken ---- */

static bool next_case(void *ctx, vs_task *task) {
  session *s = ctx;
  const vs_journal_head *head = &s->journal.head;
  for (; s->next < s->until; s->next += head->shards) {
    if (vs_journal_has(&s->journal, s->next)) continue;
    if (s->peers && s->next % s->peers != s->peer) continue;
    task->index = s->next;
    cases_point(&s->cases, s->next, task->point);
    s->next += head->shards;
    return true;
  }
  return false;
}

static uint64_t cases_left(void *ctx) {
  const session *s = ctx;
  uint64_t shards = s->journal.head.shards;
  return s->next < s->until ? (s->until - s->next + shards - 1) / shards : 0;
}

static vs_status record_row(void *ctx, const vs_answer *answer, vs_error *err) {
  session *s = ctx;
  s->shared += answer->shared;
  return vs_journal_add(&s->journal, answer->index, answer->status, answer->row, answer->length,
                        err);
}

/* ---- progress ---- */

/* Without a terminal it is told after 10 s, and whenever that has doubled, or 10 minutes later. */
static const double TOLD_S = 10, TOLD_EACH_S = 600;
static void print_progress(session *s, double now) {
  const unsigned long long over = s->journal.done + s->journal.failed, failed = s->journal.failed;
  double rate = (double)(over - s->before) / fmax(now - s->began_s, 1e-9);
  double left = rate > 0 ? (double)(s->total - over) / rate : INFINITY;
  if (s->o->progress_json) {
    vs_text text = {0};
    vs_json json = vs_json_new(&text);
    vs_json_object(&json, NULL, VS_JSON_ROW);
    vs_json_whole(&json, "done", (int64_t)s->journal.done);
    vs_json_whole(&json, "failed", (int64_t)failed);
    vs_json_whole(&json, "total", (int64_t)s->total);
    if (s->shared) vs_json_whole(&json, "shared", (int64_t)s->shared);
    vs_json_number(&json, "per_s", rate, 6);
    vs_json_number(&json, "eta_s", left, 6);
    vs_json_end(&json);
    puts(text.text);
    fflush(stdout);
    vs_text_free(&text);
  } else if (s->show || now - s->began_s >= s->tell_s) {
    char eta[40] = ""; /* a search ends when it has found */
    if (rate > 0 && !s->plan.adaptive) snprintf(eta, sizeof eta, ", %.0f s left", left);
    dprintf(STDERR_FILENO, "%s%llu of %s%llu cases, %llu failed, %.4g a second%s%s",
            s->show ? "\r" : "vibrospice: note: ", over, s->plan.adaptive ? "at most " : "",
            (unsigned long long)s->total, failed, rate, eta, s->show ? " \033[K" : "\n");
    s->tell_s += fmin(s->tell_s, TOLD_EACH_S);
  }
}

/* Shows the progress once a second; what it says is done is on the disk by then. */
static vs_status keep_progress(void *ctx, vs_error *err) {
  session *s = ctx;
  double now = vs_budget_clock_s();
  vs_status status = vs_journal_flush(&s->journal, now - s->shown_s >= 1, err);
  if (status || now - s->shown_s < 1) return status;
  s->shown_s = now;
  print_progress(s, now);
  return VS_OK;
}

/* ---- running ---- */

static vs_status run_cases(session *s, uint64_t first, uint64_t until, vs_error *err) {
  const vs_task_source source = {s, next_case, cases_left, record_row, keep_progress};
  s->next = first;
  s->until = until;
  vs_status status = vs_worker_pool_run(s->jobs, &source, err);
  vs_error second = {0};
  vs_status kept = vs_journal_flush(&s->journal, true, status ? &second : err);
  return status ? status : kept;
}

/* Waits for the cases of a generation that other shards run, for as long as these take. */
static vs_status wait_for_peers(session *s, uint64_t first, uint64_t until, vs_error *err) {
  const double began_s = vs_budget_clock_s();
  struct timespec pause = {0, 10000000}; /* 10 ms, and longer each time */
  uint64_t missing = 0;
  bool said = s->o->quiet;
  vs_status status = vs_peers_take(s->folder, &s->journal, first, until, &missing, err);
  while (!status && missing) {
    if (s->o->stop && *s->o->stop) return VS_SIGNAL;
    nanosleep(&pause, NULL);
    if (pause.tv_nsec < 500000000) pause.tv_nsec += pause.tv_nsec / 2;
    if (!said && vs_budget_clock_s() - began_s > PATIENCE_S) {
      fprintf(stderr,
              "vibrospice: note: this shard waits for %llu cases of the others, whose folders lie "
              "beside %s; --resume without --shard goes on alone\n",
              (unsigned long long)missing, s->folder);
      said = true;
    }
    status = vs_peers_take(s->folder, &s->journal, first, until, &missing, err);
  }
  return status ? status : cases_check(&s->cases, first, until, err);
}

/* Runs generation after generation, as the method asks for them by the results so far. s->count
 * becomes the number of cases it came to. */
static vs_status run_adaptive(session *s, vs_error *err) {
  const vs_plan_stage *stage = s->plan.adaptive;
  vs_status status = VS_OK;
  s->count = 0;
  for (bool more = true; more && !status;) {
    vs_generation g = {.n_axes = s->plan.n_axes};
    const vs_results results = cases_results(&s->cases, s->count);
    status = stage->method->next(&s->plan, stage, &results, &g, err);
    more = !status && g.count;
    if (more) {
      const uint64_t first = s->count, until = first + g.count;
      cases_ask(&s->cases, first, &g);
      if (s->o->resume) status = cases_check(&s->cases, first, until, err);
      if (!status) status = run_cases(s, first, until, err);
      if (!status && s->peers > 1) status = wait_for_peers(s, first, until, err);
      if (!status) status = cases_answer(&s->cases, first, until, err);
      s->count = until;
    }
    free(g.points);
  }
  return status;
}

/* A worker may outlive its killed parent by a moment, in which its case is already run again. What
 * it has left of its run.csv then lies beside the other one. */
static void sweep_runs(const session *s) {
  char folder[VS_PATH_SIZE + 32];
  for (uint64_t k = 0; k < s->count && s->o->keep_runs && s->o->resume; k++) {
    snprintf(folder, sizeof folder, "%s/%llu", s->keep, (unsigned long long)k);
    vs_file_sweep(folder);
  }
}

/* Runs the cases that are not done yet, with the progress shown. */
static vs_status run_study(session *s, vs_error *err) {
  const vs_journal_head *head = &s->journal.head;
  int jobs = s->o->jobs ? s->o->jobs : vs_worker_pool_cores();
  s->total = (s->count + head->shards - head->shard) / head->shards;
  s->before = s->journal.done + s->journal.failed;
  s->began_s = s->shown_s = vs_budget_clock_s();
  s->show = !s->o->quiet && !s->o->progress_json && isatty(STDERR_FILENO);
  s->tell_s = s->o->quiet ? INFINITY : TOLD_S;
  if ((uint64_t)jobs > s->total && s->total) jobs = (int)s->total;
  /* a branch would have no file of its own for run.csv */
  bool share = !s->o->alone && !s->o->keep_runs && vs_shared_prefix_applies(&s->plan);
  const vs_worker_pool_options options = {
      &s->plan, s->o->keep_runs ? s->keep : NULL, share, jobs, s->o->timeout_s, s->o->stop};
  s->jobs = vs_worker_pool_new(&options);
  vs_shutdown_mode heed = vs_shutdown_mode_set(VS_SHUTDOWN_WHEN_KEPT);
  void (*before)(int) = signal(SIGPIPE, SIG_IGN); /* whoever reads the progress may be gone */
  vs_status status =
      s->plan.adaptive ? run_adaptive(s, err) : run_cases(s, head->shard - 1, s->count, err);
  vs_worker_pool_free(s->jobs);
  vs_shutdown_mode_set(heed); /* the rows are in the journal: what follows can be done again */
  if (s->plan.adaptive) s->total = s->count;
  if (s->show) dprintf(STDERR_FILENO, "\r\033[K");
  if (!status) print_progress(s, vs_budget_clock_s());
  if (s->show) dprintf(STDERR_FILENO, "\r\033[K");
  if (s->show && s->shared)
    fprintf(stderr, "shared pasts: %llu of %llu cases\n", (unsigned long long)s->shared,
            (unsigned long long)s->total);
  sweep_runs(s);
  signal(SIGPIPE, before);
  return status;
}

/* ---- the judge ---- */

static bool next_judged(void *ctx, vs_task *task) {
  session *s = ctx;
  for (; s->picked < s->judge.count; s->picked++) {
    task->index = s->judge.picked[s->picked];
    if (vs_journal_has_judged(&s->journal, task->index, s->way)) continue;
    cases_point(&s->cases, task->index, task->point);
    s->picked++;
    return true;
  }
  return false;
}

static uint64_t judged_left(void *ctx) {
  const session *s = ctx;
  return s->judge.count - s->picked;
}

static vs_status record_judged(void *ctx, const vs_answer *answer, vs_error *err) {
  session *s = ctx;
  return vs_journal_add_judged(&s->journal, answer->index, s->way, answer->status, answer->row,
                               answer->length, err);
}

static vs_status keep_judged(void *ctx, vs_error *err) {
  session *s = ctx;
  return vs_journal_flush(&s->journal, false, err);
}

/* Runs the cases that were picked in one of the ways that judge. */
static vs_status judge_by(session *s, vs_error *err) {
  const vs_task_source source = {s, next_judged, judged_left, record_judged, keep_judged};
  vs_judge_way room;
  const vs_plan plan = vs_judge_plan(&s->plan, s->way, &room);
  const vs_worker_pool_options options = {
      &plan,           NULL,      false, s->o->jobs ? s->o->jobs : vs_worker_pool_cores(),
      s->o->timeout_s, s->o->stop};
  s->picked = 0;
  vs_worker_pool *jobs = vs_worker_pool_new(&options);
  vs_status status = vs_worker_pool_run(jobs, &source, err);
  vs_error second = {0};
  const vs_status kept = vs_journal_flush(&s->journal, true, status ? &second : err);
  vs_worker_pool_free(jobs);
  free(room.sets);
  return status ? status : kept;
}

/* The case that a search has found, as its part of the manifest says; UINT64_MAX: none. */
static uint64_t found_by_search(const session *s) {
  static const char FOUND[] = "\"found\": {\"case\": ";
  const vs_plan_stage *stage = s->plan.adaptive;
  const vs_results results = cases_results(&s->cases, s->count);
  vs_text text = {0};
  vs_json json = vs_json_inside(&text);
  if (!stage || !stage->method->json) return UINT64_MAX;
  stage->method->json(&s->plan, stage, &results, &json);
  const char *at = strstr(text.text, FOUND);
  const uint64_t found = at ? strtoull(at + strlen(FOUND), NULL, 10) : UINT64_MAX;
  vs_text_free(&text);
  return found;
}

static vs_status judge_cases(session *s, vs_error *err) {
  if (!vs_judge_applies(&s->plan)) return VS_OK;
  const vs_journals all = {&s->journal, 1, s->count, NULL};
  const uint64_t found = found_by_search(s);
  vs_status status = vs_judge_pick(&all, found, &s->judge, err);
  for (s->way = 0; s->way < VS_JUDGE_WAYS && !status; s->way++) status = judge_by(s, err);
  vs_judge_free(&s->judge);
  return status ? status : vs_judge_find(&all, found, &s->judge, err);
}

/* ---- result ---- */

static vs_status write_result(session *s, vs_error *err) {
  void (*before)(int) = signal(SIGPIPE, SIG_IGN);
  vs_text more = {0};
  const vs_plan_stage *stage = s->plan.adaptive;
  const vs_results results = cases_results(&s->cases, s->count);
  vs_json json = vs_json_inside(&more);
  if (stage && stage->method->json) {
    vs_json_same_row(&json);
    stage->method->json(&s->plan, stage, &results, &json);
  }
  vs_judge_json(&s->judge, &json);
  vs_platform_json(&s->journal.bits, &json);
  const vs_journals all = {&s->journal, 1, s->count, more.text};
  vs_status status = vs_publish_write(&all, s->o->format, s->folder, err);
  if (!status && !s->o->quiet && !s->o->progress_json) vs_publish_warn(&all);
  vs_text_free(&more);
  signal(SIGPIPE, before);
  return status;
}

static vs_status say_result(const session *s, vs_error *err) {
  char method[128];
  const vs_journal *j = &s->journal;
  if (!s->o->folder) { /* even with --quiet, as the result is nowhere else */
    vs_status status = vs_publish_show(s->folder, "study.csv", true, stdout, err);
    if (s->o->quiet || status) return status;
    return vs_publish_show(s->folder, "failures.csv", false, stderr, err);
  }
  if (s->o->quiet || s->o->progress_json || s->o->method) return VS_OK;
  vs_plan_method(&s->plan, method, sizeof method);
  printf("study  %s (%s)\n", s->plan.path, method);
  if (j->head.shards > 1)
    printf("shard  %llu of %llu\n", (unsigned long long)j->head.shard,
           (unsigned long long)j->head.shards);
  printf("cases  %llu done, %llu failed, in %llu a rating is violated or undecided\n"
         "written: %s in %s\n",
         (unsigned long long)j->done, (unsigned long long)j->failed,
         (unsigned long long)j->violated, s->o->format->written, s->folder);
  if (s->plan.adaptive && s->plan.adaptive->method->say) {
    const vs_results results = cases_results(&s->cases, s->count);
    vs_text text = {0};
    s->plan.adaptive->method->say(&s->plan, s->plan.adaptive, &results, &text);
    printf("found  %s\n", text.text);
    vs_text_free(&text);
  }
  vs_judge_say(&s->judge, s->count, stdout);
  return VS_OK;
}

static vs_status judge_study(session *s, vs_error *err) {
  vs_journal *j = &s->journal;
  const vs_plan_stage *stage = s->plan.adaptive;
  if (stage && stage->method->publish) {
    const vs_results results = cases_results(&s->cases, s->count);
    return stage->method->publish(&s->plan, stage, &results, s->o->folder, s->o->quiet, err);
  }
  const vs_status judged = vs_judge_result(&s->judge, err);
  if (judged) return judged;
  if (j->failed)
    return vs_fail(err, VS_RUN, "%llu of %llu cases failed%s%s%s", (unsigned long long)j->failed,
                   (unsigned long long)(j->done + j->failed),
                   s->o->folder ? "; why stands in " : "", s->o->folder ? s->folder : "",
                   s->o->folder ? "/failures.csv" : "");
  const vs_journals rows = {j, 1, s->count, NULL};
  return j->violated ? vs_judge_ratings(&rows, err) : VS_OK;
}
