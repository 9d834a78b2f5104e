/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "trial.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/times.h>
#include <time.h>
#include <unistd.h>

#include "base/alloc.h"
#include "netlist/location.h"
#include "ngspice/crash_guard.h"

static vs_child_end attempt_netlist(void *ctx) {
  const vs_trial *t = ctx;
  return t->attempt(t);
}

/* Only a child that gets through the first step is good: it ends there. */
static vs_child_end attempt_that_must_step(void *ctx) {
  attempt_netlist(ctx);
  return VS_CHILD_BAD_RUN;
}

/* ---- which line it is ---- */

/* A search is limited by the number of lines that ngspice is given, so that it ends at the same
 * point on a busy machine: those of a trial, and EACH for the process of its own. MOST of them take
 * a few seconds, which is some hundred trials of a circuit of fifty lines. Their processor time is
 * asked too, as ngspice may take far longer for a line. */
enum { MOST = 100000, EACH = 300, MOST_SECONDS = 20 };

/* How a trial ends: the circuit runs; it has the complaint, or the death, that the search is about;
 * another one; there was none, or no more are allowed. */
typedef enum ending { GOOD, SAME, OTHER, OVER } ending;

typedef struct search {
  vs_trial *t;
  vs_solver_errors kept; /* what the search is about */
  bool died;             /* it is about ngspice's death */
  char **all;            /* the lines of t, none of them left out */
  long left;             /* lines that may still be tried */
  time_t end_s;          /* of now_s() */
} search;

static char LEFT_OUT[] = "*";

/* Processor time of all trials so far, s. getrusage() tells nothing here: src/clocks.c stops it. */
static time_t now_s(void) {
  struct tms t = {0};
  times(&t);
  return (t.tms_cutime + t.tms_cstime) / sysconf(_SC_CLK_TCK);
}

/* True where two complaints differ in numbers of lines at most. */
static bool are_alike(const char *a, const char *b) {
  for (;; a++, b++) {
    while (isdigit((unsigned char)*a)) a++;
    while (isdigit((unsigned char)*b)) b++;
    if (*a != *b) return false;
    if (!*a) return true;
  }
}

static ending try_lines(search *s) {
  vs_trial *t = s->t;
  vs_solver_errors *c = t->complaints;
  vs_error why = {0};
  vs_child_end end;
  long cost = EACH;
  if (!s->left) return OVER;
  for (size_t k = 0; k < t->job->lines; k++) cost += t->lines[k] != LEFT_OUT;
  if (s->left < cost || now_s() >= s->end_s) s->left = 0;
  if (s->left < cost) return OVER;
  s->left -= cost;
  vs_solver_errors_clear(c);
  vs_status status = vs_child_try(attempt_that_must_step, t, c, &end, &why);
  if (status && !strstr(why.text, VS_CHILD_DIED)) s->left = 0;
  if (status) return !s->left ? OVER : s->died ? SAME : OTHER;
  if (end == VS_CHILD_GOOD) return GOOD;
  return !s->died && are_alike(vs_solver_errors_first(&s->kept), vs_solver_errors_first(c)) ? SAME
                                                                                            : OTHER;
}

static bool is_statement(const char *line) {
  static const char *const WORDS[] = {".model", ".param", ".func"};
  for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++)
    if (!strncasecmp(line, WORDS[k], strlen(WORDS[k]))) return true;
  return false;
}

/* Leaves these lines out, where the complaint stays the same without them. */
static bool leave_out(search *s, const size_t *line, size_t n) {
  for (size_t k = 0; k < n; k++) s->t->lines[line[k]] = LEFT_OUT;
  if (n && try_lines(s) == SAME) return true;
  for (size_t k = 0; k < n; k++) s->t->lines[line[k]] = s->all[line[k]];
  return false;
}

/* Of some lines, without which the complaint is another one, leaves out all that it does not need:
 * the later half, or the earlier one, or what each of them can spare. */
static void narrow(search *s, const size_t *line, size_t n) {
  const size_t half = n / 2;
  if (n < 2 || !s->left) return;
  if (leave_out(s, line + half, n - half))
    narrow(s, line, half);
  else if (leave_out(s, line, half))
    narrow(s, line + half, n - half);
  else {
    narrow(s, line, half);
    narrow(s, line + half, n - half);
  }
}

/* The lines of a circuit that may be left out: elements of the circuit itself; of subcircuits;
 * models, parameters and functions. */
enum { OUTER, INNER, STATEMENTS, SORTS };

/* Leaves out of the circuit what the complaint does not need. */
static void reduce(search *s) {
  const size_t n = s->t->job->lines;
  size_t *line = vs_alloc(n, sizeof *line);
  for (int sort = 0; sort < SORTS; sort++) {
    size_t count = 0, depth = 0;
    for (size_t k = 1; k < n; k++) {
      const char *text = s->all[k];
      depth += !strncasecmp(text, ".subckt", 7);
      depth -= depth && !strncasecmp(text, ".ends", 5);
      int its = isalpha((unsigned char)*text) ? depth ? INNER : OUTER
                : is_statement(text)          ? STATEMENTS
                                              : SORTS;
      if (its == sort) line[count++] = k;
    }
    if (!leave_out(s, line, count)) narrow(s, line, count);
  }
  free(line);
}

/* Finds the line of a netlist that is wrong where a trial of it was no good. What the complaint
 * does not need is left out first. Each line that stays is then left out of the whole circuit in
 * its turn, from the last line to the first, so that of two lines that do not go together the
 * second one is found. Returns the index of the first line without which the circuit runs, an
 * instance of a subcircuit only where no other line is one; else of the first element without which
 * something else is wrong; 0: there is none, or the search was too long. The complaints stay as
 * they are. */
static size_t find_line(vs_trial *t, bool died) {
  const size_t n = t->job->lines;
  const vs_solver_errors kept = *t->complaints;
  char **all = vs_alloc(2 * n, sizeof *all), **less = all + n, **lines = t->lines;
  search s = {t, kept, died, all, MOST, now_s() + MOST_SECONDS};
  size_t good = 0, call = 0, other = 0;
  memcpy(all, lines, n * sizeof *all);
  try_lines(&s); /* a real run may have complained of more */
  s.kept = *t->complaints;
  reduce(&s);
  memcpy(less, lines, n * sizeof *less);
  memcpy(lines, all, n * sizeof *lines);
  for (size_t k = n; k-- > 1 && !good;) {
    if (less[k] == LEFT_OUT || !(isalpha((unsigned char)*all[k]) || is_statement(all[k]))) continue;
    lines[k] = LEFT_OUT;
    ending end = try_lines(&s);
    lines[k] = all[k];
    if (end == GOOD && tolower((unsigned char)*all[k]) == 'x')
      call = call ? call : k; /* it may be a line of the subcircuit */
    else if (end == GOOD)
      good = k;
    else if (end == OTHER && !other && *all[k] != '.' && t->complaints->count)
      other = k;
  }
  *t->complaints = kept;
  free(all);
  if (!s.left) return good; /* another line may be the better one */
  return good ? good : call ? call : other;
}

/* Finds the line of a complaint that does not name it, or of a death, by leaving lines out. Notes
 * it, and writes its words with VS_LOCATION_WITHOUT before them; nothing where no line is found. */
static void find_culprit(vs_trial *t, bool died, char *text, size_t size) {
  size_t found = find_line(t, died);
  *text = '\0';
  t->complaints->culprit = found;
  if (found) snprintf(text, size, VS_LOCATION_WITHOUT "%s", t->lines[found]);
}

void vs_trial_place(const vs_solver_errors *complaints, const vs_circuit_job *job, char *text,
                    size_t size) {
  vs_error found = {0};
  *text = '\0';
  if (!job->locate) return;
  vs_fail(&found, VS_INPUT, "ngspice: %s", vs_solver_errors_first(complaints));
  job->locate(job->author, 0, &found);
  if (found.line > 0) snprintf(text, size, " (%.*s)", found.place_size - 2, found.text);
}

void vs_trial_blame(vs_trial *t) {
  char text[VS_SOLVER_ERRORS_LINE];
  vs_trial_place(t->complaints, t->job, text, sizeof text);
  if (*text || !t->job->locate) return;
  find_culprit(t, false, text, sizeof text);
  if (*text) vs_solver_errors_add(t->complaints, text);
}

/* Adds to the error of ngspice's death the line that causes it, where one is found. */
static vs_status blame_death(vs_trial *t, vs_error *err) {
  char text[VS_SOLVER_ERRORS_LINE] = "";
  const vs_error plain = *err;
  if (t->job->locate && strstr(plain.text, VS_CHILD_DIED)) find_culprit(t, true, text, sizeof text);
  vs_fail(err, VS_INPUT, "%s%s", plain.text, text);
  vs_solver_errors_place(t->job, t->complaints->culprit, err);
  return VS_INPUT;
}

/* ---- the trial ---- */

/* A process that has begun anew has died of the netlist, and does not take it even if the child
 * survives. */
vs_status vs_trial_first(vs_trial *t, vs_error *err) {
  const vs_circuit_job *job = t->job;
  if (job->tried || (job->unbegun && vs_crash_guard_begin())) return VS_OK;
  vs_child_end end;
  vs_status status = vs_child_try(attempt_netlist, t, t->complaints, &end, err);
  if (!status && end == VS_CHILD_GOOD && job->unbegun && vs_crash_guard_again())
    return vs_fail(err, VS_INPUT, "ngspice cannot take the circuit: it died of it the first time");
  if (status == VS_INPUT) return blame_death(t, err);
  if (status || end == VS_CHILD_GOOD) return status;
  vs_trial_blame(t);
  return vs_solver_errors_tell(t->complaints, job, end == VS_CHILD_BAD_RUN ? "run" : "load", err);
}
