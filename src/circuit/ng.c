/* SPDX-License-Identifier: GPL-3.0-or-later
 * The circuit seam over libngspice, by its documented shared-library interface only.
 *
 * ngspice calls back in this order for each step: source values at the candidate time, once per
 * Newton iteration; then, once the step is accepted, SendData. Steps it rejects it repeats by
 * itself. Its return codes say nothing: whether a run was good is seen from the time it reached and
 * from its log. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ngspice/sharedspice.h>

#include "base/text.h"
#include "circuit/circuit.h"

enum { LOG_LINE = 256 };

/* libngspice is one global instance in a process; so is what its callbacks need. */
static struct {
  const vs_circuit_job *job;
  const vs_circuit_host *host;
  int *vector; /* per signal: its index in SendData, -1 for ground */
  double *values;
  int time_vector;
  double reached_s, edge_s;
  vs_status status; /* other than VS_OK: the run is to end */
  vs_error *err;
  char failure[LOG_LINE]; /* what the log says best of what went wrong */
  int expected;           /* lines of it still to come */
  bool initialised,
      ended; /* ended: ngspice asked to be unloaded; this process cannot use it again */
} ng;

/* Keeps what the log says went wrong: the line that gives up in the end, else the first complaint.
 * Of a netlist line that ngspice refuses it says "Error on line N or its substitute:" (N counts
 * lines it has made itself), then the line, then the reason; the last two are kept. */
static int on_text(char *line, int id, void *user) {
  (void)id, (void)user;
  static const char *const SIGNS[] = {
      "Timestep too small", "singular matrix", "rror",    "nknown",
      "ndefined",           "not parsed",      "no such", "aborted"};
  const char *stream = strchr(line, ' '); /* "stderr text" */
  const char *text = stream ? stream + 1 : line;
  text += strspn(text, " \t");
  size_t used = strlen(ng.failure);
  if (ng.expected > 0 && *text) {
    ng.expected--;
    snprintf(ng.failure + used, sizeof ng.failure - used, "%s%s", used ? ": " : "", text);
    return 0;
  }
  for (size_t k = 0; k < sizeof SIGNS / sizeof *SIGNS; k++) {
    if (!strstr(text, SIGNS[k])) continue;
    if (!used && strstr(text, "or its substitute"))
      ng.expected = 2;
    else if (!used || k == 0)
      snprintf(ng.failure, sizeof ng.failure, "%s", text);
    break;
  }
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

static void stop_with(vs_status status) {
  if (ng.status == VS_OK) ng.status = status;
}

/* "v(a)" is vector "a", "i(vth)" is "vth#branch" */
static int find_vector(const vecinfoall *all, const char *signal) {
  char name[256];
  snprintf(name, sizeof name, "%.*s%s", (int)strlen(signal) - 3, signal + 2,
           signal[0] == 'i' ? "#branch" : "");
  for (int k = 0; k < all->veccount; k++)
    if (!strcmp(all->vecs[k]->vecname, name)) return k;
  return -1;
}

static void set_edge(double t_s) {
  double edge = ng.host->edge(ng.host->ctx, t_s);
  if (edge != ng.edge_s && edge < ng.job->until_s) ngSpice_SetBkpt(edge);
  ng.edge_s = edge;
}

static int on_vectors(pvecinfoall all, int id, void *user) {
  (void)id, (void)user;
  if (!ng.job) return 0;
  ng.time_vector = -1;
  for (int k = 0; k < all->veccount; k++)
    if (!strcmp(all->vecs[k]->vecname, "time")) ng.time_vector = k;
  for (size_t s = 0; s < ng.job->n_signals; s++) {
    const char *signal = ng.job->signals[s];
    ng.vector[s] = strcmp(signal, "v(0)") ? find_vector(all, signal) : -1;
    if (ng.vector[s] < 0 && strcmp(signal, "v(0)"))
      stop_with(vs_fail(ng.err, VS_INPUT, "the circuit has no %s", signal));
  }
  if (ng.time_vector >= 0) set_edge(0);
  return 0;
}

static int on_accepted(pvecvaluesall all, int count, int id, void *user) {
  (void)count, (void)id, (void)user;
  if (!ng.job || ng.time_vector < 0 || ng.status) return 0;
  double t = all->vecsa[ng.time_vector]->creal;
  if (t <= ng.reached_s) return 0;
  for (size_t s = 0; s < ng.job->n_signals; s++)
    ng.values[s] = ng.vector[s] < 0 ? 0 : all->vecsa[ng.vector[s]]->creal;
  ng.reached_s = t;
  stop_with(ng.host->accept(ng.host->ctx, t, ng.values, ng.err));
  if (!ng.status) set_edge(t);
  return 0;
}

static int on_voltage(double *value, double t, char *name, int id, void *user) {
  (void)id, (void)user;
  *value = 0;
  for (size_t p = 0; ng.job && p < ng.job->n_ports; p++)
    if (!strcmp(name, ng.job->ports[p])) *value = ng.host->source(ng.host->ctx, p, t);
  return 0;
}

static int on_current(double *value, double t, char *name, int id, void *user) {
  (void)t, (void)name, (void)id, (void)user;
  *value = 0; /* the netlist contract has voltage ports only */
  return 0;
}

/* A step length of zero is how a host makes ngspice end a run; it stays usable. */
static int on_sync(double t, double *step, double old_step, int redo, int id, int place,
                   void *user) {
  (void)t, (void)old_step, (void)redo, (void)id, (void)place, (void)user;
  if (ng.status) *step = 0;
  return 0;
}

/* ngspice reads .spiceinit from the working directory, else from the user's home; an empty one in a
 * folder of its own keeps the user's out, so that a scene gives the same result for everyone. */
static vs_status initialise(vs_error *err) {
  if (ng.ended)
    return vs_fail(err, VS_RUN, "ngspice ended itself in an earlier run of this process");
  if (ng.initialised) return VS_OK;
  char *home = getcwd(NULL, 0), folder[] = "/tmp/vibrospice.XXXXXX";
  FILE *empty = NULL;
  if (home && mkdtemp(folder) && !chdir(folder)) empty = fopen(".spiceinit", "w");
  if (!empty) {
    free(home);
    return vs_fail(err, VS_RUN, "no private folder for ngspice below /tmp: %s", strerror(errno));
  }
  fclose(empty);
  int id = 0;
  ngSpice_Init(on_text, on_status, on_exit_wanted, on_accepted, on_vectors, on_thread, NULL);
  ngSpice_Init_Sync(on_voltage, on_current, on_sync, &id, NULL);
  unlink(".spiceinit");
  bool back = chdir(home) == 0;
  rmdir(folder);
  free(home);
  ng.initialised = true;
  return back ? VS_OK : vs_fail(err, VS_RUN, "the working directory is gone: %s", strerror(errno));
}

enum { LOAD_SECONDS = 20 }; /* a deck takes a millisecond */

/* Loads the circuit in a child process first: an undefined parameter makes ngspice end the process
 * it is in, other nonsense crashes it or keeps it for ever. What the child says comes back by a
 * pipe. */
static vs_status try_in_child(char **lines, vs_error *err) {
  int ends[2];
  char reason[LOG_LINE] = "";
  if (pipe(ends)) return vs_fail(err, VS_RUN, "no pipe: %s", strerror(errno));
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) {
    alarm(LOAD_SECONDS);
    ngSpice_Circ(lines);
    ssize_t told = ng.ended ? write(ends[1], ng.failure, strlen(ng.failure)) : 0;
    _exit(ng.ended || told < 0);
  }
  close(ends[1]);
  ssize_t n = child > 0 ? read(ends[0], reason, sizeof reason - 1) : -1;
  close(ends[0]);
  if (child < 0) return vs_fail(err, VS_RUN, "no child process: %s", strerror(errno));
  int how = 0;
  while (waitpid(child, &how, 0) < 0 && errno == EINTR) {
  }
  reason[n > 0 ? n : 0] = '\0';
  if (WIFSIGNALED(how) && WTERMSIG(how) == SIGALRM)
    return vs_fail(err, VS_INPUT,
                   "ngspice cannot load the circuit: it did not come back from it in %d s",
                   LOAD_SECONDS);
  if (WIFSIGNALED(how))
    return vs_fail(err, VS_INPUT, "ngspice cannot load the circuit: it died of it (signal %d)",
                   WTERMSIG(how));
  if (how)
    return vs_fail(err, VS_INPUT, "ngspice cannot load the circuit: %s",
                   *reason ? reason : "it gave no reason");
  return VS_OK;
}

/* The dialect is a setting of ngspice's that lasts; it says what a netlist's words mean. */
static void set_dialect(const char *dialect) {
  char command[64];
  snprintf(command, sizeof command, *dialect ? "set ngbehavior=%sa" : "unset ngbehavior", dialect);
  ngSpice_Command(command);
}

static vs_status load(const vs_circuit_job *job, void **circuit, vs_error *err) {
  *circuit = NULL;
  vs_status status = initialise(err);
  if (status) return status;
  vs_text tail = {0};
  /* .save none keeps one point in memory; SendData still gives all vectors. */
  vs_text_add(&tail,
              ".options method=%s reltol=%.17g abstol=%.17g\n.save none\n"
              ".tran %.17g %.17g 0 %.17g uic\n.end",
              job->gear ? "gear" : "trap", job->relative_tolerance, job->current_tolerance_a,
              job->max_step_s, job->until_s, job->max_step_s);
  char **lines = vs_alloc(job->lines + 5, sizeof *lines);
  size_t n = 0;
  for (; n < job->lines; n++) lines[n] = job->netlist[n];
  char *rest = tail.text;
  for (char *line; (line = strsep(&rest, "\n"));) lines[n++] = line;
  *ng.failure = '\0';
  ng.expected = 0;
  ng.job = NULL; /* the load itself asks for nothing */
  set_dialect(job->dialect);
  status = try_in_child(lines, err);
  if (!status) ngSpice_Circ(lines);
  free(lines);
  vs_text_free(&tail);
  if (status) return status;
  ng.job = job;
  ng.vector = vs_alloc(job->n_signals, sizeof *ng.vector);
  ng.values = vs_alloc(job->n_signals, sizeof *ng.values);
  *circuit = &ng;
  return VS_OK;
}

static vs_status run(void *circuit, const vs_circuit_host *host, vs_error *err) {
  (void)circuit;
  ng.host = host;
  ng.err = err;
  ng.status = VS_OK;
  ng.reached_s = 0;
  ng.edge_s = INFINITY;
  ng.time_vector = -1;
  char command[] = "run";
  ngSpice_Command(command);
  if (ng.status) return ng.status;
  if (ng.time_vector < 0)
    return vs_fail(err, VS_INPUT, "ngspice cannot run the circuit: %s",
                   *ng.failure ? ng.failure : "it gave no reason");
  if (ng.reached_s < ng.job->until_s * (1 - 1e-9))
    return vs_fail(err, VS_RUN, "t = %.9g s: ngspice gave up: %s", ng.reached_s,
                   *ng.failure ? ng.failure : "it gave no reason");
  return VS_OK;
}

static void release(void *circuit) {
  if (!circuit) return;
  free(ng.vector);
  free(ng.values);
  ng.vector = NULL;
  ng.values = NULL;
  ng.job = NULL;
  if (ng.ended) return;
  char destroy[] = "destroy all", remove[] = "remcirc";
  ngSpice_Command(destroy);
  ngSpice_Command(remove);
}

const vs_circuit_kind vs_ngspice = {"ngspice", load, run, release};

const char *vs_ngspice_version(void) {
  return NGSPICE_PACKAGE_VERSION;
}
