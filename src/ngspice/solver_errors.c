/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ngspice/solver_errors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

const char vs_solver_errors_nowhere[] = "; in which line is not known";

static const char NO_REASON[] = "it gave no reason";

/* From 46 on ngspice puts this line before a complaint, with the numbers of lines that it has made.
 */
static const char HEADING[] = "Error in netlist line no. ";

/* "Error on line N or its substitute": the line that is quoted comes next. N counts lines that
 * ngspice has made. */
static const char QUOTES[] = "or its substitute";

/* What the library says of itself as it gives up: no reason. */
static const char LEAVES[] = "cannot recover and awaits";

/* What the library says of a command for a circuit that it has not made. */
static const char NOTHING[] = "there aren't any circuits loaded";

/* Signs of what went wrong in a line of the log. A line has the first of them that it contains. */
static const struct sign {
  const char *text;
  int more;        /* lines that go on with it */
  bool each;       /* all of these are kept; of others only the first complaint of any kind */
  bool gives_up;   /* in a run it is what ngspice gives up with in the end */
  bool is_preface; /* the complaint is in the lines that follow, not in this one */
} SIGNS[] = {
    {"Timestep too small", 0, false, true, false},
    {QUOTES, 2, true, false, true},
    {"Error on line:", 2, true, false, true}, /* of a name that stands twice */
    {"ndefined parameter [", 0, true, false, false},
    {"can't find model", 1, true, false, false},
    {"unknown subckt", 0, true, false, false},
    {"not enough parameters in line", 1, true, false, false},
    {"singular matrix", 0, false, false, false},
    {"PTerror: syntax error, parsing stopped at", 1, false, false, false},
    {"YYparse error", 1, false, false, false}, /* the same, from 44 on */
    {"xpression err", 0, false, false, false},
    {"oo few parameters", 0, false, false, false},
    {"oo many parameters", 0, false, false, false},
    {"Closing \"", 0, false, false, false}, /* of a bracket */
    {"rror", 0, false, false, false},
    {"nknown", 0, false, false, false},
    {"ndefined", 0, false, false, false},
    {"not parsed", 0, false, false, false},
    {"no such", 0, false, false, false},
    {"aborted", 0, false, false, false},
};

void vs_solver_errors_clear(vs_solver_errors *c) {
  c->count = 0;
  c->expected = 0;
  c->culprit = 0;
}

static bool complained(const vs_solver_errors *c, const char *text) {
  for (size_t k = 0; k < c->count; k++)
    if (strstr(c->item[k], text)) return true;
  return false;
}

/* Does a complaint quote the netlist line of that element? */
static bool complained_of(const vs_solver_errors *c, const char *line) {
  char quoted[64];
  snprintf(quoted, sizeof quoted, ": %.*s", (int)strcspn(line, " ") + 1, line);
  return complained(c, quoted);
}

/* Takes the next line of the last complaint. If another complaint quotes the same netlist line, the
 * last one is dropped. Why an expression cannot be read, ngspice says before it quotes the line:
 * these two become one. */
static void complain_on(vs_solver_errors *c, const char *text) {
  char *last = c->item[c->count - 1], *first = c->item[0];
  size_t used = strlen(last);
  c->expected--;
  if (!used && complained_of(c, text)) {
    c->expected = 0;
    c->count--;
  } else
    snprintf(last + used, VS_SOLVER_ERRORS_LINE - used, "%s%s", used ? ": " : "", text);
  if (c->count == 2 && !strncmp(text, "parameter value out of range", 28) &&
      (!strncmp(first, "no such function", 16) || !strncmp(first, "PTerror", 7))) {
    char why[VS_SOLVER_ERRORS_LINE];
    memcpy(why, first, sizeof why);
    snprintf(last + used, VS_SOLVER_ERRORS_LINE - used, ": %s", why);
    memcpy(first, last, VS_SOLVER_ERRORS_LINE);
    c->count = 1;
  }
}

static void complain(vs_solver_errors *c, const struct sign *sign, const char *text, bool runs) {
  static const char *const RANKS[] = {"Error: ", "Fatal error: ", "Warning: ", "warning, "};
  for (size_t k = 0; k < sizeof RANKS / sizeof *RANKS; k++)
    if (!strncmp(text, RANKS[k], strlen(RANKS[k]))) text += strlen(RANKS[k]);
  if (!strncmp(text, NOTHING, sizeof NOTHING - 1)) text = "it made no circuit, and gave no reason";
  if (sign->gives_up && runs) c->count = 0;
  if (c->count >= VS_SOLVER_ERRORS_MOST || (c->count && !sign->each) ||
      (!sign->more && complained(c, text)))
    return;
  snprintf(c->item[c->count++], VS_SOLVER_ERRORS_LINE, "%s", sign->is_preface ? "" : text);
  c->expected = sign->more;
}

void vs_solver_errors_hear(vs_solver_errors *c, const char *line, bool runs) {
  const char *stream = strchr(line, ' '); /* "stderr text" */
  const char *text = stream ? stream + 1 : line;
  text += strspn(text, " \t");
  if (c->expected > 0 && *text && !strstr(text, QUOTES)) {
    complain_on(c, text);
    return;
  }
  if (!strncmp(text, HEADING, sizeof HEADING - 1) || strstr(text, LEAVES)) return;
  for (size_t k = 0; k < sizeof SIGNS / sizeof *SIGNS; k++)
    if (strstr(text, SIGNS[k].text)) {
      complain(c, &SIGNS[k], text, runs);
      return;
    }
}

const char *vs_solver_errors_first(const vs_solver_errors *c) {
  return c->count ? c->item[0] : NO_REASON;
}

bool vs_solver_errors_of_iteration(const vs_solver_errors *c) {
  const char *first = vs_solver_errors_first(c);
  return strstr(first, "out of range for ") || strstr(first, "Timestep too small");
}

void vs_solver_errors_add(vs_solver_errors *c, const char *words) {
  if (!c->count) snprintf(c->item[c->count++], VS_SOLVER_ERRORS_LINE, "%s", NO_REASON);
  size_t used = strlen(c->item[0]);
  snprintf(c->item[0] + used, VS_SOLVER_ERRORS_LINE - used, "%s", words);
}

void vs_solver_errors_place(const vs_circuit_job *job, size_t culprit, vs_error *err) {
  if (job->locate) job->locate(job->author, culprit, err);
  if (err->line || !err->file_size) return;
  const vs_error plain = *err;
  char *file = vs_alloc_part(plain.text, (size_t)plain.file_size);
  vs_fail_at(err, (vs_where){file, 1, 1}, "%s%s", plain.text + plain.place_size,
             vs_solver_errors_nowhere);
  free(file);
}

vs_status vs_solver_errors_tell(const vs_solver_errors *c, const vs_circuit_job *job,
                                const char *what, vs_error *err) {
  vs_status status = VS_OK;
  size_t k = 0;
  do {
    const char *text = k ? c->item[k] : vs_solver_errors_first(c);
    status = vs_fail(err, VS_INPUT, "ngspice cannot %s the circuit: %s", what, text);
    vs_solver_errors_place(job, k ? 0 : c->culprit, err);
    k++;
    if (k < c->count) status = vs_error_keep(err, status);
  } while (k < c->count && !status);
  return status;
}
