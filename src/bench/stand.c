/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stand.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "netlist/location.h"
#include "netlist/netlist.h"
#include "netlist/parts.h"
#include "ngspice/child.h"
#include "ngspice/ngspice.h"
#include "ngspice/self_test.h"

static const vs_shelf SHELF = {"test stand", "templates", ".cir"};

/* ---- the part ---- */

/* The mains and the EVA of the stand; nothing is connected to them. */
static const vs_deck_value STANDARD[VS_STANDARD] = {
    {"u_rms", 440},     {"f_mains", 50},        {"phase", 0},     {"r_source", 0.5},
    {"l_source", 5e-4}, {"eva_resistance", 92}, {"eva_a", 5.2e-3}};

/* The stand's own deck, wherever the program's files are; a file of that name in the working
 * directory is none. */
static void take_deck(void *ctx, const char *path) {
  const char *slash = strrchr(path, '/');
  char *deck = ctx;
  if (!*deck && !strcmp(slash ? slash + 1 : path, "stand.cir"))
    snprintf(deck, VS_PATH_SIZE, "%s", path);
}

vs_status vs_stand_open(const char *path, vs_stand *s, vs_error *err) {
  char deck[VS_PATH_SIZE] = "", *whole = realpath(path, NULL);
  vs_node part = vs_tree_word("dut", whole ? whole : path, (vs_where){.file = path});
  const vs_node section = vs_tree_map("circuit", &part);
  s->name = path;
  vs_path_list(&SHELF, take_deck, deck);
  vs_status status = vs_netlist_read(deck, &s->deck, err);
  if (!status) status = vs_netlist_read_parts(&s->deck, &section, err);
  if (!status) status = vs_field_section_read(&s->deck.section, NULL, &s->values, err);
  if (!status) status = vs_deck_bind(&s->deck, &s->values, STANDARD, VS_STANDARD, err);
  if (!status) status = vs_parts_require_hold(&s->deck, &s->values, NULL, err);
  if (!status)
    status =
        vs_netlist_make(&s->deck, &s->values, STANDARD, VS_STANDARD, &s->netlist, &s->lines, err);
  if (s->deck.n_parts > 0) {
    s->subcircuit = s->deck.parts[0].subcircuit;
    s->file = s->deck.parts[0].file;
  }
  free(whole);
  return status;
}

void vs_stand_close(vs_stand *s) {
  vs_netlist_free(s->netlist, s->lines);
  vs_deck_free(&s->deck);
  s->netlist = NULL;
  s->lines = 0;
}

/* ---- in the child ---- */

enum { SIGNALS = 3 };

/* What the child tells before the record. */
typedef struct head {
  vs_status status;
  size_t points;
  vs_error err;
} head;

/* The steps so far: time and signals in turn. */
typedef struct steps {
  double *row;
  size_t count, room;
} steps;

static double gap(void *ctx, size_t port, double t_s) {
  (void)ctx, (void)port, (void)t_s;
  return 6.5e-3; /* m; the EVA's, the only external source */
}

static double no_edge(void *ctx, double t_s) {
  (void)ctx, (void)t_s;
  return INFINITY;
}

/* Steps are gathered outside of ngspice, where its own memory is not in play. */
static vs_status record_step_of_stand(void *ctx, double t_s, const double *signals, vs_error *err) {
  static const size_t MOST = 2000000;
  steps *s = ctx;
  if (s->count == MOST) return vs_fail(err, VS_RUN, "more than %zu steps", MOST);
  if (s->count == s->room) {
    s->room = s->room ? 2 * s->room : 1024;
    s->row = vs_resize(s->row, s->room * (1 + SIGNALS), sizeof *s->row);
  }
  double *row = &s->row[s->count++ * (1 + SIGNALS)];
  row[0] = t_s;
  memcpy(row + 1, signals, SIGNALS * sizeof *row);
  return VS_OK;
}

/* What is wrong in the stand's own deck, or stands nowhere, is the part's doing. A line around the
 * part that ngspice does better without tells a user nothing. */
static void locate_culprit(const void *author, size_t culprit, vs_error *err) {
  const vs_stand *stand = author;
  const char *deck = stand->deck.files[0];
  char *without = strstr(err->text, VS_LOCATION_WITHOUT);
  if (without && culprit >= stand->lines) *without = '\0';
  vs_location_locate(&stand->deck, culprit, err);
  if ((size_t)err->file_size != strlen(deck) || strncmp(err->text, deck, strlen(deck)) != 0) return;
  const vs_error plain = *err;
  vs_fail_at(err, (vs_where){.file = stand->name}, "%s", plain.text + plain.place_size);
}

/* The ladder of a stand: what is tried in turn where ngspice gives a circuit up, the most accurate
 * first. A source that jumps onto an empty capacitor makes a current whose truncation error no step
 * gets down while the charge is below chgtol: there a larger charge counts as none, or ngspice's
 * own tolerances hold, or a larger error passes. A table of straight pieces without any capacitance
 * has no solution that Newton's iteration finds, unless 10 pF stand beside the part: less than a
 * junction has, and of a part of three pins its current is not the one that is recorded. Figures
 * are held to 0.1 % (a varistor's) at the tightest, which a relative tolerance of 1e-3 of the
 * steps' error leaves alone. */
static const struct rung {
  bool trap;
  double charge_c, tolerance, trtol; /* 0: as on the first rung */
  int finer;                         /* divides the longest step */
  bool bare;                         /* without the capacitance */
} RUNGS[] = {{.finer = 1, .bare = true},
             {.finer = 1, .bare = true, .trap = true},
             {.finer = 1},
             {.finer = 1, .charge_c = 1e-11},
             {.finer = 1, .trap = true, .tolerance = 1e-3},
             {.finer = 4, .tolerance = 1e-3, .trtol = 100}};
enum { N_RUNGS = sizeof RUNGS / sizeof *RUNGS };

/* How a circuit is solved: the rung; whether the line of a complaint is searched for. */
typedef struct way {
  const struct rung *rung;
  bool search;
} way;

static vs_status solve_netlist(char *const *netlist, size_t lines, const vs_stand *stand,
                               const vs_stand_circuit *c, way w, steps *seen, vs_error *err) {
  static const char *const PORTS[] = {"v.xeva.vgap"}, *const NAMES[] = {"v(a)", "i(vm)", "v(g)"};
  const vs_circuit_job job = {.netlist = netlist,
                              .lines = lines,
                              .ports = PORTS,
                              .n_ports = 1,
                              .signals = NAMES,
                              .n_signals = SIGNALS,
                              .until_s = c->until_s,
                              .max_step_s = c->step_s / w.rung->finer,
                              .gear = !w.rung->trap,
                              .dialect = stand->deck.compat,
                              .relative_tolerance =
                                  fmax(w.rung->tolerance, c->tolerance > 0 ? c->tolerance : 1e-4),
                              .charge_tolerance_c = w.rung->charge_c,
                              .truncation_factor = w.rung->trtol,
                              .current_tolerance_a = 1e-9,
                              .locate = locate_culprit,
                              .author = stand,
                              .tried = !w.search};
  const vs_circuit_host host = {.ctx = seen,
                                .source = gap,
                                .edge = no_edge,
                                .longest = no_edge,
                                .accept = record_step_of_stand};
  void *circuit = NULL;
  vs_status status = vs_ngspice_kind.load(&job, &host, &circuit, err);
  if (!status) status = vs_ngspice_kind.run(circuit, err);
  vs_ngspice_kind.free(circuit);
  return status;
}

/* A crash ends the child by its signal; nothing is printed, and no core file is written. */
static void live_quietly(void) {
  static const int SIGNALS_OF_CRASHES[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  const struct rlimit none = {0, 0};
  int null = open("/dev/null", O_WRONLY);
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
  setrlimit(RLIMIT_CORE, &none);
  for (size_t k = 0; k < sizeof SIGNALS_OF_CRASHES / sizeof *SIGNALS_OF_CRASHES; k++)
    signal(SIGNALS_OF_CRASHES[k], SIG_DFL);
  vs_child_limit_time();
}

static _Noreturn void solve_in(const vs_child_copy *copy, const vs_stand *stand,
                               const vs_stand_circuit *c, way w) {
  steps seen = {0};
  head h = {0};
  static char beside[] = "Cbeside a 0 10p";
  char **netlist = vs_alloc(stand->lines + strlen(c->text) + 2, sizeof *netlist),
       *rest = vs_copy(c->text);
  size_t lines = stand->lines;
  live_quietly();
  memcpy(netlist, stand->netlist, stand->lines * sizeof *netlist);
  for (char *line; (line = strsep(&rest, "\n"));)
    if (*line) netlist[lines++] = line;
  if (!w.rung->bare) netlist[lines++] = beside;
  h.status = solve_netlist(netlist, lines, stand, c, w, &seen, &h.err);
  h.points = seen.count;
  vs_child_say(copy, &h, sizeof h);
  vs_child_tell(copy, seen.row, seen.count * (1 + SIGNALS) * sizeof *seen.row);
}

/* ---- in the parent ---- */

const char *const vs_stand_late = "ngspice did not come back from it";

/* Reads the rows that the child has written, and sorts them into columns. */
static bool take_record(const vs_child_copy *copy, vs_stand_record *r) {
  size_t n = r->points;
  double *row = vs_alloc(n + 1, (1 + SIGNALS) * sizeof *row), *column[1 + SIGNALS];
  bool whole = vs_child_listen(copy, row, n * (1 + SIGNALS) * sizeof *row);
  r->t_s = vs_alloc(n + 1, (1 + SIGNALS) * sizeof *r->t_s);
  for (size_t c = 0; c < 1 + SIGNALS; c++) column[c] = r->t_s + c * n;
  for (size_t k = 0; k < n; k++)
    for (size_t c = 0; c < 1 + SIGNALS; c++) column[c][k] = row[k * (1 + SIGNALS) + c];
  r->v = column[1], r->i = column[2], r->g = column[3];
  free(row);
  return whole;
}

static vs_status run_on_stand(const vs_stand *stand, const vs_stand_circuit *c, way w,
                              vs_stand_record *r, int *how, vs_error *err) {
  vs_child_copy copy;
  head h = {0};
  *r = (vs_stand_record){0};
  *how = 0;
  vs_status status = vs_child_fork(&copy, err);
  if (status) return status;
  if (copy.pid == 0) solve_in(&copy, stand, c, w);
  bool whole = vs_child_listen(&copy, &h, sizeof h);
  r->points = h.points;
  whole = whole && take_record(&copy, r);
  *how = vs_child_end_of(&copy);
  if (vs_child_is_late(*how))
    return vs_fail(err, VS_RUN, "%s in %d s", vs_stand_late, VS_CHILD_SECONDS);
  if (WIFSIGNALED(*how) && WTERMSIG(*how) == SIGSYS)
    return vs_fail(err, VS_RUN, "the trial of the part was %s", vs_child_forbidden);
  if (WIFSIGNALED(*how))
    return vs_fail(err, VS_RUN, "ngspice died of it (signal %d)", WTERMSIG(*how));
  if (!whole) return vs_fail(err, VS_RUN, "ngspice ended the process it was in");
  if (!h.status) return VS_OK;
  h.err.findings = err->findings;
  *err = h.err;
  return h.status;
}

/* Goes up the ladder until ngspice comes to the end; but not where a circuit chatters for ever,
 * which other settings make no better, and each takes long. The error, and `how` the child ended,
 * are the first rung's. */
static vs_status climb(const vs_stand *stand, const vs_stand_circuit *c, vs_stand_record *r,
                       int *how, vs_error *err) {
  vs_status status = run_on_stand(stand, c, (way){RUNGS, false}, r, how, err);
  bool gave_up = status && err->gave_up && !strstr(err->text, "makes no progress");
  for (int n = 1; gave_up && n < N_RUNGS; n++) {
    vs_error other = {.findings = err->findings};
    int end = 0;
    vs_stand_free(r);
    if (run_on_stand(stand, c, (way){&RUNGS[n], false}, r, &end, &other)) continue;
    *err = other;
    return VS_OK;
  }
  return status;
}

/* Where ngspice refuses the circuit without a line, or dies of it, the same circuit is tried once
 * more, with a search for the line (ngspice/trial.h). */
vs_status vs_stand_run(const vs_stand *stand, const vs_stand_circuit *c, vs_stand_record *r,
                       vs_error *err) {
  int how = 0;
  vs_status status = vs_self_test_find(err);
  if (!status) status = climb(stand, c, r, &how, err);
  bool died = WIFSIGNALED(how) && !vs_child_is_late(how) && WTERMSIG(how) != SIGSYS;
  if (!status || (!died && (status != VS_INPUT || !strstr(err->text, vs_solver_errors_nowhere))))
    return status;
  vs_error found = {.findings = err->findings};
  vs_stand_free(r);
  if (run_on_stand(stand, c, (way){RUNGS, true}, r, &how, &found) == VS_INPUT) {
    *err = found;
    status = VS_INPUT;
  }
  return status;
}

void vs_stand_free(vs_stand_record *r) {
  free(r->t_s);
  *r = (vs_stand_record){0};
}

double vs_stand_at(const vs_stand_record *r, const double *column, double t_s) {
  size_t k = 1;
  if (r->points < 2) return NAN;
  while (k + 1 < r->points && r->t_s[k] < t_s) k++;
  double span = r->t_s[k] - r->t_s[k - 1], part = span > 0 ? (t_s - r->t_s[k - 1]) / span : 1;
  return column[k - 1] + (column[k] - column[k - 1]) * fmin(fmax(part, 0), 1);
}

double vs_stand_crosses(const vs_stand_record *r, double from_s, double level_v) {
  for (size_t k = 1; k < r->points; k++)
    if (r->t_s[k] > from_s && (r->v[k] > level_v) != (r->v[k - 1] > level_v)) return r->t_s[k];
  return NAN;
}
