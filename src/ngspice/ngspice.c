/* SPDX-License-Identifier: GPL-3.0-or-later
 * Runs circuits (ngspice/circuit.h) on libngspice, by its documented shared-library interface only.
 *
 * ngspice calls back in this order for each step: source values at the candidate time, once per
 * Newton iteration; then, once the step is accepted, SendData. Steps it rejects it repeats by
 * itself. Its return codes say nothing: whether a run was good is seen from the time it reached and
 * from its log. */
#include "ngspice/ngspice.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/jail.h"
#include "base/text.h"
#include "library.h"
#include "netlist/cards.h"
#include "netlist/words.h"
#include "ngspice/child.h"
#include "ngspice/crash_guard.h"
#include "ngspice/sandbox.h"
#include "rawfile.h"
#include "trial.h"
#include "versions.h"

/* ---- does a run make progress? ---- */

/* A circuit may have an instant that ngspice
 * neither gets past nor gives up at: it shrinks its step until one converges, doubles it until one
 * fails, and so on. */

/* Start from {0} with each run. */
typedef struct stretch {
  double from_s; /* where the stretch that is looked at began */
  long tries;    /* steps in that stretch, failed ones too */
} stretch;

/* So many steps in one stretch are too many. */
enum { PROGRESS_TRIES = 100000 };

/* A run makes no progress when it takes PROGRESS_TRIES steps, failed ones too, for PROGRESS_S or
 * for one largest step. At such instants steps of 1e-12 s on average were measured, which is 1e7
 * steps for PROGRESS_S; a junction that rings undamped takes 3e3 at its worst. Steps are counted
 * and not seconds, so that every computer ends the run at the same step. */
static const double PROGRESS_S = 1e-5;

/* Counts a step that was tried, from where the run has reached reached_s. False: no progress has
 * been made since from_s. */
static bool progress_made(stretch *progress, double reached_s, double max_step_s) {
  progress->tries++;
  if (reached_s - progress->from_s >= fmin(max_step_s, PROGRESS_S))
    *progress = (stretch){.from_s = reached_s};
  return progress->tries < PROGRESS_TRIES;
}

/* ---- does a netlist need code models? ---- */

/* ngspice's code models: types of devices that it loads from files beside its library, among them
 * the one that it makes a source with POLY of. Results are the same to the bit with and without
 * them, so that they are loaded for the first circuit that may need one (library.h). */

/* What turns a line E, F, G or H, or one that continues it, into a code model. */
static bool has_form(const char *line) {
  static const char *const FORMS[] = {"poly", "table", "laplace", "freq", "and(", "or("};
  bool found = false;
  for (size_t k = 0; k < sizeof FORMS / sizeof *FORMS && !found; k++)
    found = strcasestr(line, FORMS[k]);
  return found;
}

/* A polynomial need not be called one: ngspice knows it by the number of words, too. What an
 * .include brings is not seen here. */
static bool may_need(const char *line) {
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(line, w);
  if (count == 0) return false;
  switch (tolower((unsigned char)*w[0].at)) {
  case 'a':
  case 'n':
  case 'u':
    return true;
  case 'e':
  case 'g':
    return count != 6 || strchr(line, '=') || has_form(line);
  case 'f':
  case 'h':
    return count != 5 || strchr(line, '=') || has_form(line);
  case '+':
    return has_form(line);
  case '.':
    return !strncasecmp(w[0].at, ".inc", 4) || !strncasecmp(w[0].at, ".lib", 4);
  default:
    return false;
  }
}

/* True where ngspice may make a code model of a line of the netlist. In another dialect it may do
 * so with almost any line. The first line is the title. */
static bool code_models_needed(char *const *netlist, size_t lines, const char *dialect) {
  bool needed = *dialect;
  for (size_t k = 1; k < lines && !needed; k++) needed = may_need(netlist[k]);
  return needed;
}

/* ---- the one libngspice of a process, and its callbacks ---- */

/* In the place of a vector's index: of a signal that is 0, and of one that the circuit has not. */
enum { GROUND = -1, MISSING = -2 };

/* libngspice is one global instance in a process, and so is what its callbacks need. */
static struct {
  const vs_library *library;
  const vs_circuit_job *job;
  const vs_circuit_host *host;
  int *vector; /* per signal: its index in SendData, GROUND or MISSING */
  double *values;
  int time_vector;
  vs_rawfile raw;  /* its stream is NULL where none is wanted */
  int *raw_vector; /* per vector of the rawfile: its index in SendData */
  double *raw_values;
  double reached_s, edge_s;
  stretch progress;
  bool truncated; /* the last step was rejected for its truncation error, not by Newton's iteration
                   */
  vs_last_steps ending;
  vs_status status;   /* the run ends once it is not VS_OK */
  bool enough;        /* the host has seen enough: the run ends with VS_OK */
  const char **asked; /* per port: where ngspice has its name; NULL: not known yet */
  size_t last_port;   /* the one that ngspice asked for last */
  size_t *behind;     /* per port: the one that ngspice asked for behind it */
  vs_error *err;
  vs_solver_errors complaints; /* of the present load or run */
  bool trial;       /* this is the child process, which ends with the first accepted step */
  vs_text loaded;   /* all that was given to ngspice for the circuit it has; empty: it has none */
  bool sound;       /* that circuit has run well */
  char version[16]; /* of the library; empty: not known yet */
  bool initialised, ended; /* ngspice asked to be unloaded; this process cannot use it again */
} ng;

/* ngspice begins with "** ngspice-39 shared library". */
static int on_text(char *line, int id, void *user) {
  (void)id, (void)user;
  if (!*ng.version) sscanf(line, "stdout ** ngspice-%15s shared library", ng.version);
  vs_solver_errors_hear(&ng.complaints, line, ng.reached_s > 0);
  return 0;
}

static int on_status(char *text, int id, void *user) {
  (void)text, (void)id, (void)user;
  return 0;
}

static int on_exit_wanted(int status, NG_BOOL at_once, NG_BOOL by_quit, int id, void *user) {
  (void)status, (void)at_once, (void)by_quit, (void)id, (void)user;
  ng.ended = true;
  return 0;
}

static int on_thread(NG_BOOL running, int id, void *user) {
  (void)running, (void)id, (void)user;
  return 0;
}

/* What the host calls the instant t. */
static double clock_at(double t_s) {
  return ng.host->clock ? ng.host->clock(ng.host->ctx, t_s) : t_s;
}

static void stop_with(vs_status status) {
  if (ng.status == VS_OK) ng.status = status;
}

/* Finds the vector of a signal: "v(a)" is vector "a", "i(vth)" is "vth#branch". Only a node whose
 * name begins with a digit has a vector with brackets, "V(1)". A quantity of an element has its own
 * name. */
static int find_vector(const vecinfoall *all, const char *signal) {
  char name[256];
  int n = (int)strlen(signal) - 3;
  bool number = signal[0] == 'v' && isdigit((unsigned char)signal[2]);
  snprintf(name, sizeof name, "%s%.*s%s", number ? "V(" : "", n, signal + 2,
           signal[0] == 'i' ? "#branch"
           : number         ? ")"
                            : "");
  const char *sought = *signal == '@' ? signal : name;
  for (int k = 0; k < all->veccount; k++)
    if (!strcmp(all->vecs[k]->vecname, sought)) return k;
  return MISSING;
}

static void set_edge(double t_s) {
  double edge = ng.host->edge(ng.host->ctx, t_s);
  if (edge != ng.edge_s && edge < ng.job->until_s) ng.library->set_breakpoint(edge);
  ng.edge_s = edge;
}

static vs_status no_signal(const char *signal) {
  vs_status status = vs_fail(ng.err, VS_INPUT, "the circuit has no %s", signal);
  vs_solver_errors_place(ng.job, 0, ng.err);
  return vs_error_keep(ng.err, status);
}

/* Writes the step into the rawfile. */
static vs_status add_raw(const vecvaluesall *all, double t) {
  vs_status status = vs_rawfile_room(&ng.raw, t, ng.err);
  if (status) return status;
  for (size_t k = 0; k < ng.raw.vectors; k++)
    ng.raw_values[k] = all->vecsa[ng.raw_vector[k]]->creal;
  ng.raw_values[0] = clock_at(t);
  return vs_rawfile_point(&ng.raw, ng.raw_values, ng.err);
}

/* Begins the rawfile: the time first, then the other vectors in the order of ngspice's equations,
 * which it lists backwards. */
static void begin_raw(const vecinfoall *all) {
  size_t n = (size_t)all->veccount, at = 0;
  const char **names = vs_alloc(n, sizeof *names);
  ng.raw_vector = vs_alloc(n, sizeof *ng.raw_vector);
  ng.raw_values = vs_alloc(n, sizeof *ng.raw_values);
  ng.raw_vector[at++] = ng.time_vector;
  for (int k = all->veccount; k-- > 0;)
    if (k != ng.time_vector) ng.raw_vector[at++] = k;
  for (size_t k = 0; k < n; k++) names[k] = all->vecs[ng.raw_vector[k]]->vecname;
  ng.raw = vs_rawfile_begin(ng.job->raw, all->title, names, n);
  free(names);
  ng.raw.most_bytes = ng.job->raw_most;
  stop_with(
      vs_rawfile_expect(&ng.raw, ng.job->until_s / ng.job->max_step_s, ng.job->raw_where, ng.err));
}

static int on_vectors(pvecinfoall all, int id, void *user) {
  (void)id, (void)user;
  if (!ng.job) return 0;
  ng.time_vector = -1;
  vs_solver_errors_clear(&ng.complaints); /* those of the load, which went well */
  for (int k = 0; k < all->veccount; k++)
    if (!strcmp(all->vecs[k]->vecname, "time")) ng.time_vector = k;
  for (size_t s = 0; s < ng.job->n_signals; s++) {
    const char *signal = ng.job->signals[s];
    ng.vector[s] = strcmp(signal, "v(0)") ? find_vector(all, signal) : GROUND;
    if (ng.vector[s] == MISSING && s + ng.job->n_wanted < ng.job->n_signals)
      stop_with(no_signal(signal));
  }
  if (ng.time_vector >= 0) set_edge(0);
  if (ng.time_vector >= 0 && ng.job->raw && !ng.raw.stream && !ng.trial) begin_raw(all);
  return 0;
}

static int on_accepted(pvecvaluesall all, int count, int id, void *user) {
  (void)count, (void)id, (void)user;
  if (!ng.job || ng.time_vector < 0 || ng.status || ng.enough) return 0;
  double t = all->vecsa[ng.time_vector]->creal;
  if (t <= ng.reached_s || vs_versions_at_end(ng.job->until_s - ng.reached_s, ng.job->max_step_s))
    return 0;
  if (ng.trial) vs_child_finish();
  vs_crash_guard_end();
  for (size_t s = 0; s < ng.job->n_signals; s++)
    ng.values[s] = ng.vector[s] >= 0        ? all->vecsa[ng.vector[s]]->creal
                   : ng.vector[s] == GROUND ? 0
                                            : NAN;
  ng.reached_s = t;
  stop_with(ng.host->accept(ng.host->ctx, t, ng.values, ng.err));
  bool hidden = ng.host->hides && ng.host->hides(ng.host->ctx);
  if (!ng.status && ng.raw.stream && !hidden) stop_with(add_raw(all, t));
  ng.enough = !ng.status && ng.host->enough && ng.host->enough(ng.host->ctx);
  if (!ng.status) set_edge(t);
  return 0;
}

/* Returns the port of this name; n_ports: there is none. Within a run ngspice has each name at one
 * address, which is compared before the name is. */
static size_t find_port(const char *name) {
  size_t p = 0;
  while (p < ng.job->n_ports && name != ng.asked[p]) p++;
  if (p < ng.job->n_ports) return p;
  for (p = 0; p < ng.job->n_ports; p++)
    if (!strcmp(name, ng.job->ports[p])) break;
  if (p < ng.job->n_ports) ng.asked[p] = name;
  return p;
}

/* ngspice asks for its sources in the same order each time, which need not be that of the ports. So
 * the port is tried first that followed the last one in the round before. */
static int on_source(double *value, double t, char *name, int id, void *user) {
  (void)id, (void)user;
  *value = 0;
  if (!ng.job || !ng.job->n_ports) return 0;
  size_t p = ng.behind[ng.last_port];
  if (name != ng.asked[p]) p = find_port(name);
  if (p == ng.job->n_ports) return 0;
  ng.behind[ng.last_port] = p;
  ng.last_port = p;
  *value = ng.host->source(ng.host->ctx, p, t);
  return 0;
}

static vs_status guard_progress(void) {
  if (ng.job->tries) ++*ng.job->tries;
  if (progress_made(&ng.progress, ng.reached_s, ng.job->max_step_s)) return VS_OK;
  vs_fail(ng.err, VS_RUN, "t = %.9g s: ngspice makes no progress: %d steps for %.2g s",
          clock_at(ng.reached_s), PROGRESS_TRIES, ng.reached_s - ng.progress.from_s);
  ng.err->gave_up = true;
  return VS_RUN;
}

/* After an iteration without an end ngspice takes an eighth of the step; any other part follows
 * from the truncation error, but for the shortest step that it takes, 1e-11 of the longest. */
static bool is_truncation(double step_s, double old_step_s) {
  if (step_s <= 1.001e-11 * ng.job->max_step_s) return ng.truncated;
  return fabs(old_step_s / step_s - 8) > 1e-6;
}

/* Limits the next step to what the host allows. A step of zero makes ngspice end the run; it stays
 * usable. */
static int on_sync(double t, double *step, double old_step, int redo, int id, int place,
                   void *user) {
  (void)id, (void)user;
  if (ng.job && place == 1 && redo) ng.truncated = is_truncation(*step, old_step);
  if (ng.job && place == 1 && !ng.status && !ng.enough) stop_with(guard_progress());
  if (ng.job && place == 0 && !ng.status)
    *step = fmin(vs_versions_step(&ng.ending, ng.job->until_s - t, *step),
                 ng.host->longest(ng.host->ctx, t));
  if (ng.status || ng.enough) *step = 0;
  return 0;
}

static void init_ngspice(const vs_library *library) {
  int id = 0;
  ng.library = library;
  library->init(on_text, on_status, on_exit_wanted, on_accepted, on_vectors, on_thread, NULL);
  library->init_sync(on_source, on_source, on_sync, &id, NULL);
}

/* Initialises ngspice once in a process. */
vs_status vs_ngspice_begin(vs_error *err) {
  if (ng.ended)
    return vs_fail(err, VS_RUN, "ngspice ended itself in an earlier run of this process");
  if (ng.initialised) return VS_OK;
  vs_status status = vs_library_open(init_ngspice, err);
  ng.initialised = !status;
  if (ng.initialised && vs_jail_is_on()) vs_sandbox_process(VS_SANDBOX_NETWORK);
  return status;
}

static void take_job(const vs_circuit_job *job, const vs_circuit_host *host) {
  ng.job = job;
  ng.host = host;
  ng.vector = vs_alloc(job->n_signals, sizeof *ng.vector);
  ng.values = vs_alloc(job->n_signals, sizeof *ng.values);
  ng.asked = vs_alloc(job->n_ports, sizeof *ng.asked);
  ng.behind = vs_alloc(job->n_ports, sizeof *ng.behind);
}

static void step_through(vs_error *err) {
  ng.err = err;
  ng.status = VS_OK;
  ng.enough = false;
  ng.last_port = 0;
  ng.edge_s = INFINITY;
  ng.time_vector = -1;
  ng.reached_s = 0;
  ng.truncated = false;
  ng.progress = (stretch){0};
  ng.ending = (vs_last_steps){0};
  ng.raw = (vs_rawfile){0};
  char command[] = "run";
  ng.library->command(command);
  vs_crash_guard_end();
}

/* In the child: loads the circuit and runs it up to its first accepted step, where on_accepted ends
 * the child. What goes wrong without harm to the process is left to the parent to find. */
static vs_child_end attempt_first_step(const vs_trial *t) {
  vs_error err = {0};
  ng.library->circuit(t->lines);
  if (ng.ended) return VS_CHILD_BAD_LOAD;
  ng.trial = true;
  take_job(t->job, t->host);
  step_through(&err);
  return ng.ended ? VS_CHILD_BAD_RUN : VS_CHILD_GOOD;
}

static vs_trial trial_of(const vs_circuit_job *job, const vs_circuit_host *host, char **lines) {
  return (vs_trial){attempt_first_step, job, host, lines, &ng.complaints};
}

/* Sets the dialect, which says what a netlist's words mean. In ngspice it is a setting that lasts.
 * ngspice 46 asks the system at every step whether there is memory for the run's vectors, and ends
 * the process where it finds none; as it keeps one point of them (".save none"), the question is
 * switched off. */
static void set_dialect(const char *dialect) {
  char command[64], unasked[] = "set no_mem_check";
  snprintf(command, sizeof command, *dialect ? "set ngbehavior=%sa" : "unset ngbehavior", dialect);
  ng.library->command(command);
  ng.library->command(unasked);
}

static void forget_circuit(void) {
  char remove[] = "remcirc";
  if (ng.loaded.length && !ng.ended) ng.library->command(remove);
  ng.loaded.length = 0;
  ng.sound = false;
}

/* True where ngspice has this netlist loaded and it has run well. It then need not be loaded again:
 * a run starts from its initial conditions, whatever was before, and gives the same to the bit
 * (tests/study/test_study.c). */
static bool is_loaded(const vs_text *netlist) {
  return ng.sound && ng.loaded.length == netlist->length &&
         !memcmp(ng.loaded.text, netlist->text, netlist->length);
}

/* Loads a netlist in the place of the one that ngspice has, after a trial. Owns *netlist from then
 * on. */
static vs_status load_anew(const vs_circuit_job *job, const vs_circuit_host *host, char **lines,
                           vs_text *netlist, vs_error *err) {
  char place[VS_SOLVER_ERRORS_LINE];
  vs_status status = VS_OK;
  forget_circuit();
  if (code_models_needed(job->netlist, job->lines, job->dialect)) status = vs_library_complete(err);
  if (status) return status;
  set_dialect(job->dialect);
  vs_trial trial = trial_of(job, host, lines);
  status = vs_trial_first(&trial, err);
  if (status) return status;
  ng.library->circuit(lines);
  if (ng.ended) {
    vs_trial_place(&ng.complaints, job, place, sizeof place);
    if (!*place)
      vs_crash_guard_retry(); /* a process whose ngspice has not ended looks for the line */
    vs_crash_guard_end();
    return vs_solver_errors_tell(&ng.complaints, job, "load", err);
  }
  vs_text_free(&ng.loaded);
  ng.loaded = *netlist;
  *netlist = (vs_text){0};
  return VS_OK;
}

/* Makes vectors of the elements' quantities that are wanted; ngspice has none of them otherwise. */
static void save_quantities(const vs_circuit_job *job, vs_text *tail) {
  for (size_t s = job->n_signals - job->n_wanted; s < job->n_signals; s++)
    if (*job->signals[s] == '@') vs_text_add(tail, ".save %s\n", job->signals[s]);
}

static vs_status load_circuit(const vs_circuit_job *job, const vs_circuit_host *host,
                              void **circuit, vs_error *err) {
  *circuit = NULL;
  vs_status status = vs_ngspice_begin(err);
  if (status) return status;
  vs_text tail = {0}, netlist = {0};
  save_quantities(job, &tail);
  /* .save none keeps one point in memory; SendData gives all vectors nevertheless. */
  vs_text_add(&tail,
              ".options method=%s reltol=%.17g abstol=%.17g vntol=%.17g chgtol=%.17g trtol=%.17g "
              "pivrel=%.17g\n.save none\n"
              ".tran %.17g %.17g 0 %.17g%s\n.end",
              job->gear ? "gear" : "trap", job->relative_tolerance, job->current_tolerance_a,
              job->voltage_tolerance_v > 0 ? job->voltage_tolerance_v : 1e-6,
              job->charge_tolerance_c > 0 ? job->charge_tolerance_c : 1e-14,
              job->truncation_factor > 0 ? job->truncation_factor : 7,
              job->pivot_threshold > 0 ? job->pivot_threshold : 1e-3, job->max_step_s, job->until_s,
              job->max_step_s, job->stands ? "" : " uic");
  char **lines = vs_alloc(job->lines + job->n_wanted + 5, sizeof *lines);
  size_t n = 0;
  for (; n < job->lines; n++) lines[n] = job->netlist[n];
  vs_versions_complete(lines, n, job->until_s);
  char *rest = tail.text;
  for (char *line; (line = strsep(&rest, "\n"));) lines[n++] = line;
  vs_solver_errors_clear(&ng.complaints);
  ng.reached_s = 0; /* on_text() asks */
  ng.job = NULL;    /* the load itself asks for nothing */
  vs_text_add(&netlist, "%s\n", job->dialect);
  for (size_t k = 0; k < n; k++) vs_text_add(&netlist, "%s\n", lines[k]);
  status = is_loaded(&netlist) ? VS_OK : load_anew(job, host, lines, &netlist, err);
  vs_text_free(&netlist);
  vs_versions_free(lines, job->netlist, job->lines);
  free(lines);
  vs_text_free(&tail);
  if (status) return status;
  take_job(job, host);
  *circuit = &ng;
  return VS_OK;
}

/* A run that had no first step. What was loaded is cut into its lines again; the first one is the
 * dialect. */
static vs_status tell_of_run(vs_error *err) {
  char *text = vs_copy(ng.loaded.text), *rest = text, *line;
  size_t n = 0, room = 1;
  for (const char *c = text; *c; c++) room += *c == '\n';
  char **lines = vs_alloc(room + 1, sizeof *lines);
  strsep(&rest, "\n");
  while ((line = strsep(&rest, "\n")) && rest) lines[n++] = line;
  vs_trial trial = trial_of(ng.job, ng.host, lines);
  if (n >= ng.job->lines) vs_trial_blame(&trial);
  free(lines);
  free(text);
  return vs_solver_errors_tell(&ng.complaints, ng.job, "run", err);
}

/* ---- which element sets the time step ---- */

/* The charges and fluxes whose truncation errors ngspice looks at, of all elements that its
 * language has for decks, and their rates, by the names that it has for them. A capacitor's charge
 * follows from its power. */
static const struct storage {
  char letter;
  const char *held, *rate;
} STORAGES[] = {{'c', "p", "i"},      {'l', "flux", "volt"}, {'d', "charge", "capcur"},
                {'q', "qbe", "cqbe"}, {'q', "qbc", "cqbc"},  {'m', "qgs", "cqgs"},
                {'m', "qgd", "cqgd"}, {'m', "qbd", "cqbd"},  {'m', "qbs", "cqbs"},
                {'j', "qgs", "cqgs"}, {'j', "qgd", "cqgd"}};

/* The element that would change fastest of all, of which least is allowed. */
typedef struct fastest {
  const vs_cards *cards;
  double time_s; /* what it holds over its rate */
  char name[VS_SOLVER_ERRORS_LINE / 2];
} fastest;

static double ask(const char *element, const char *what) {
  char name[VS_SOLVER_ERRORS_LINE];
  snprintf(name, sizeof name, "@%s[%s]", element, what);
  const vector_info *v = ng.library->vector(name);
  return v && v->v_realdata ? v->v_realdata[0] : NAN;
}

/* Less than chgtol counts as nothing held. The values are those of the step that was rejected. */
static int look_at_storage(void *ctx, const vs_instance *in, size_t k) {
  fastest *f = ctx;
  const vs_netlist_card *card = &f->cards->card[k];
  if (card->letter == 'x') return VS_CARDS_ENTER;
  for (size_t n = 0; n < sizeof STORAGES / sizeof *STORAGES; n++) {
    vs_text name = {0};
    if (STORAGES[n].letter != card->letter) continue;
    if (in->outer) vs_text_add(&name, "%c.", card->letter);
    vs_cards_add_name(in, card->name, &name);
    double rate = ask(name.text, STORAGES[n].rate), held = ask(name.text, STORAGES[n].held);
    if (card->letter == 'c') held *= ask(name.text, "capacitance") / rate;
    double time_s = fmax(fabs(held), fmax(ng.job->charge_tolerance_c, 1e-14)) / fabs(rate);
    if (time_s < f->time_s) {
      f->time_s = time_s;
      snprintf(f->name, sizeof f->name, "%s", name.text);
    }
    vs_text_free(&name);
  }
  return VS_CARDS_PASS;
}

/* ngspice names the node at which Newton's iteration last had no end. Where it is the truncation
 * error that shortens the steps, that node has nothing to do with it: the element then takes its
 * place that holds least for its rate of change. */
static void blame_storage(void) {
  char *node = ng.complaints.count ? strstr(ng.complaints.item[0], "trouble with node") : NULL;
  if (!node || !ng.truncated) return;
  const vs_solver_errors kept = ng.complaints; /* to ask for what is not there is a complaint */
  vs_line *lines = vs_alloc(ng.job->lines + 1, sizeof *lines);
  vs_cards cards = {0};
  fastest f = {&cards, INFINITY, ""};
  for (size_t k = 0; k < ng.job->lines; k++) lines[k].text = ng.job->netlist[k];
  lines[0].text = "*";
  vs_cards_read(&cards, lines, ng.job->lines);
  vs_cards_expand(&cards, look_at_storage, &f);
  vs_cards_free(&cards);
  free(lines);
  ng.complaints = kept;
  if (*f.name)
    snprintf(node, VS_SOLVER_ERRORS_LINE - (size_t)(node - ng.complaints.item[0]),
             "the truncation error of instance %s sets the step", f.name);
}

/* How the run went, once ngspice has come back from it. */
static vs_status outcome_of_run(vs_error *err) {
  if (ng.status || ng.enough) return ng.status;
  if (ng.time_vector < 0 || ng.reached_s == 0) {
    vs_status status = tell_of_run(err);
    err->gave_up = status && vs_solver_errors_of_iteration(&ng.complaints);
    return status;
  }
  if (ng.reached_s >= ng.job->until_s * (1 - 1e-9)) return VS_OK;
  char place[VS_SOLVER_ERRORS_LINE];
  blame_storage();
  vs_trial_place(&ng.complaints, ng.job, place, sizeof place);
  vs_fail(err, VS_RUN, "t = %.9g s: ngspice gave up: %s%s", clock_at(ng.reached_s),
          vs_solver_errors_first(&ng.complaints), place);
  err->gave_up = true;
  return VS_RUN;
}

static vs_status run_circuit(void *circuit, vs_error *err) {
  (void)circuit;
  step_through(err);
  vs_status status = outcome_of_run(err);
  ng.sound = !status;
  vs_error second = {0};
  if (ng.raw.stream && vs_rawfile_end(&ng.raw, status ? &second : err) && !status) return VS_RUN;
  return status;
}

static void release_circuit(void *circuit) {
  if (!circuit) return;
  vs_crash_guard_end();
  free(ng.vector);
  free(ng.values);
  free(ng.asked);
  free(ng.behind);
  free(ng.raw_vector);
  free(ng.raw_values);
  ng.asked = NULL;
  ng.behind = NULL;
  ng.vector = ng.raw_vector = NULL;
  ng.values = ng.raw_values = NULL;
  ng.job = NULL;
  if (ng.ended) return;
  char destroy[] = "destroy all";
  ng.library->command(destroy);
  if (!ng.sound) forget_circuit();
}

const vs_circuit_kind vs_ngspice_kind = {
    .name = "ngspice", .load = load_circuit, .run = run_circuit, .free = release_circuit};

bool vs_ngspice_usable(void) {
  return !ng.ended;
}

const char *vs_ngspice_version(void) {
  return NGSPICE_PACKAGE_VERSION;
}

const char *vs_ngspice_running(void) {
  return *ng.version ? ng.version : NGSPICE_PACKAGE_VERSION;
}
