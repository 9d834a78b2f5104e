/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ngspice/self_test.h"

#include <fcntl.h>
#include <link.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/path.h"
#include "ngspice/child.h"
#include "ngspice/crash_guard.h"
#include "ngspice/ngspice.h"
#include "versions.h"

/* ---- the probe ---- */

/* Does a solver do what the program relies on? A small circuit tells, in some milliseconds: a coil
 * behind a latch of 1 Gohm at a sine, and a capacitor that a resistor charges. Both have closed
 * forms, and what went wrong with one version of ngspice or another shows in them. */

/* The circuit. Its source gives U sin(w t). The gate opens the latch at FIRES_S and closes at
 * GATED_S; the latch goes out where its current would reverse. */
static char *const NETLIST[] = {"a coil behind a latch, and a capacitor behind a resistor",
                                "Vs s 0 external",
                                "Vg g 0 external",
                                "Vi s a 0",
                                "Rl a b 10",
                                "Ll b c 10m ic=0",
                                "Bset set 0 V = v(c,0) < 0 ? -0.1 : 0.1*v(g)",
                                "Slatch c 0 set 0 state off",
                                ".model state sw(ron=1e-3 roff=1e18 vt=0 vh=0.09)",
                                "Roff c 0 1e9",
                                "Rc s d 1k",
                                "Cc d 0 1u ic=0"};
static const char *const PORTS[] = {"vs", "vg"};
enum { VOLTAGE, CURRENT, LATCH, CHARGED, SIGNALS };
static const char *const NAMES[SIGNALS] = {"v(s)", "i(vi)", "v(c)", "v(d)"};
static const double U = 100, W = 100 * M_PI;                    /* V, rad/s */
static const double R = 10, R_ON = 1e-3, L = 10e-3, TAU = 1e-3; /* ohm, ohm, H, R C in s */
static const double FIRES_S = 2e-3, GATED_S = 4e-3, UNTIL_S = 19e-3, STEP_S = 50e-6;

/* What is allowed: of the first two, some ten times what ngspice 39 to 47 leave. They obey the rule
 * to 1e-15; Gear's is 1e-7 off. */
static const double OFF = 2.5e-4; /* of currents and voltages, in parts of their peaks */
static const double BOOKS = 5e-5; /* of energy, in parts of what was drawn */
static const double RULE = 1e-9;  /* of the trapezoidal rule, in parts of the source's peak */
static const double NONE = 1e-5;  /* a step of no length, in parts of the largest */
static const double THERE = 1e-9; /* an instant, in parts of the largest step */

typedef struct probe_watch {
  double out_s;              /* when the latch goes out */
  double t_s, at[SIGNALS];   /* of the last step */
  double allowed_s, asked_s; /* the next step's longest; when the source was last asked for */
  double drawn_j, lost_j;    /* what the coil's branch drew; what its resistor and the latch took */
  double shortest_s, most_a, off_a, off_v;     /* least step; peak current; largest errors */
  bool fired_there, too_long, asked_elsewhere; /* a step ended where the latch fires; one was longer
                                                  than allowed; the source was not asked for the
                                                  instant that was then accepted */
  long whole, otherwise; /* steps as long as allowed behind one such; those by another rule */
  bool was_whole;
} probe_watch;

/* The current of R and L from FIRES_S on, until it would reverse. */
static double current_at(double t_s) {
  double r = R + R_ON, z = hypot(r, W * L), phi = atan2(W * L, r);
  double left = exp(-(t_s - FIRES_S) * r / L);
  return U / z * (sin(W * t_s - phi) - sin(W * FIRES_S - phi) * left);
}

/* Where it would reverse, by bisection. */
static double goes_out_s(void) {
  double from = M_PI / W, to = 1.5 * M_PI / W;
  for (int k = 0; k < 60; k++) {
    double middle = (from + to) / 2;
    *(current_at(middle) > 0 ? &from : &to) = middle;
  }
  return from;
}

static double charged_at(double t_s) {
  double z = hypot(1, W * TAU), phi = atan(W * TAU);
  return U / z * (sin(W * t_s - phi) + sin(phi) * exp(-t_s / TAU));
}

static double probe_source(void *ctx, size_t port, double t_s) {
  probe_watch *w = ctx;
  w->asked_s = t_s;
  if (port == 0) return U * sin(W * t_s);
  return t_s > FIRES_S && t_s <= GATED_S ? 1 : 0;
}

static double probe_edge(void *ctx, double t_s) {
  const probe_watch *w = ctx;
  if (t_s < FIRES_S) return FIRES_S;
  return t_s < GATED_S ? GATED_S : t_s < w->out_s ? w->out_s : INFINITY;
}

static double probe_longest(void *ctx, double t_s) {
  probe_watch *w = ctx;
  return w->allowed_s = t_s < FIRES_S ? STEP_S : STEP_S / 2;
}

/* True if the step obeys the trapezoidal rule: v1 - v0 = h (f0 + f1)/2, f = (u - v)/(R C). */
static bool is_trapezoidal(const probe_watch *w, double h, const double *to) {
  double f0 = (w->at[VOLTAGE] - w->at[CHARGED]) / TAU, f1 = (to[VOLTAGE] - to[CHARGED]) / TAU;
  return fabs(to[CHARGED] - w->at[CHARGED] - h * (f0 + f1) / 2) < RULE * U;
}

static void add_energy(probe_watch *w, double h, const double *x) {
  double i = x[CURRENT];
  w->drawn_j += h / 2 * x[VOLTAGE] * i;
  w->lost_j += h / 2 * (R * i + x[LATCH]) * i;
}

static vs_status accept_probe_step(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)err;
  probe_watch *w = ctx;
  double h = t_s - w->t_s, i = signals[CURRENT];
  bool whole = h > w->allowed_s * (1 - THERE);
  w->shortest_s = fmin(w->shortest_s, h);
  w->too_long = w->too_long || h > w->allowed_s * (1 + THERE);
  w->asked_elsewhere = w->asked_elsewhere || fabs(w->asked_s - t_s) > THERE * STEP_S;
  w->fired_there = w->fired_there || fabs(t_s - FIRES_S) < THERE * STEP_S;
  w->whole += whole && w->was_whole;
  w->otherwise += whole && w->was_whole && !is_trapezoidal(w, h, signals);
  w->was_whole = whole;
  add_energy(w, h, w->at);
  add_energy(w, h, signals);
  double expected = t_s > FIRES_S && t_s < w->out_s ? current_at(t_s) : 0;
  w->most_a = fmax(w->most_a, expected);
  w->off_a = fmax(w->off_a, fabs(i - expected));
  w->off_v = fmax(w->off_v, fabs(signals[CHARGED] - charged_at(t_s)));
  w->t_s = t_s;
  memcpy(w->at, signals, sizeof w->at);
  return VS_OK;
}

static void judge_probe(const probe_watch *w, char wrong[VS_SELF_TEST_TEXT]) {
  double stored_j = L * w->at[CURRENT] * w->at[CURRENT] / 2;
  double left = fabs(w->drawn_j - w->lost_j - stored_j) / w->drawn_j;
  *wrong = '\0';
  if (UNTIL_S - w->t_s > THERE * STEP_S)
    snprintf(wrong, VS_SELF_TEST_TEXT, "its last step ends %.2g s before the run's end",
             UNTIL_S - w->t_s);
  else if (!w->fired_there)
    snprintf(wrong, VS_SELF_TEST_TEXT, "it steps over instants where a step must end");
  else if (w->too_long)
    snprintf(wrong, VS_SELF_TEST_TEXT, "it takes steps longer than allowed");
  else if (w->asked_elsewhere)
    snprintf(wrong, VS_SELF_TEST_TEXT,
             "it asks its sources for other instants than its steps end at");
  else if (w->shortest_s < NONE * STEP_S)
    snprintf(wrong, VS_SELF_TEST_TEXT, "it takes steps of %.2g s, which have no length",
             w->shortest_s);
  else if (w->whole < 100 || w->otherwise > w->whole / 10)
    snprintf(wrong, VS_SELF_TEST_TEXT,
             "%ld of its %ld longest steps do not obey the trapezoidal rule", w->otherwise,
             w->whole);
  else if (w->off_a > OFF * w->most_a || w->off_v > OFF * U || isnan(w->off_a + w->off_v))
    snprintf(wrong, VS_SELF_TEST_TEXT,
             "the current of a coil is off by %.2g of its peak, the voltage of a capacitor by %.2g",
             w->off_a / w->most_a, w->off_v / U);
  else if (!(left < BOOKS))
    snprintf(wrong, VS_SELF_TEST_TEXT,
             "the energy books of a coil behind a latch leave %.2g of what was drawn", left);
}

void vs_self_test_probe(const vs_circuit_kind *solver, char wrong[VS_SELF_TEST_TEXT]) {
  probe_watch w = {.out_s = goes_out_s(), .shortest_s = INFINITY, .allowed_s = STEP_S};
  const vs_circuit_job job = {.netlist = NETLIST,
                              .lines = sizeof NETLIST / sizeof *NETLIST,
                              .ports = PORTS,
                              .n_ports = 2,
                              .signals = NAMES,
                              .n_signals = SIGNALS,
                              .until_s = UNTIL_S,
                              .max_step_s = STEP_S,
                              .dialect = "",
                              .relative_tolerance = 1e-4,
                              .current_tolerance_a = 1e-6,
                              .tried = true};
  const vs_circuit_host host = {.ctx = &w,
                                .source = probe_source,
                                .edge = probe_edge,
                                .longest = probe_longest,
                                .accept = accept_probe_step};
  void *circuit = NULL;
  vs_error err = {0};
  vs_status status = solver->load(&job, &host, &circuit, &err);
  if (!status) status = solver->run(circuit, &err);
  solver->free(circuit);
  if (status)
    snprintf(wrong, VS_SELF_TEST_TEXT, "a small circuit fails: %.150s", err.text);
  else
    judge_probe(&w, wrong);
}

/* ---- what is known of the library ---- */

/* libngspice is one in a process, and so is what is known of it. */
static struct {
  bool known;
  char wrong[VS_SELF_TEST_TEXT];
  char library[VS_PATH_SIZE + 2 * VS_SELF_TEST_TEXT]; /* what is told of it; empty: nothing */
  char circuit[2 * VS_SELF_TEST_TEXT];                /* what is told of the circuit it has */
} trust;

/* ---- which library it is ---- */

/* The paths of what the linker has loaded, until one is libngspice's. */
static int find_by_path(struct dl_phdr_info *info, size_t size, void *path) {
  (void)size;
  const char *name = strrchr(info->dlpi_name, '/');
  if (!name || strncmp(name, "/libngspice", 11) != 0) return 0;
  snprintf(path, VS_PATH_SIZE, "%s", info->dlpi_name);
  return 1;
}

/* The path of libngspice; "" where it is no file of its own. */
static void find_library(char path[VS_PATH_SIZE]) {
  *path = '\0';
  dl_iterate_phdr(find_by_path, path);
}

/* What the memory of a library begins with, which no other library or program has; false: a library
 * that is no file has none. */
static bool identify(char *text, size_t size) {
  char path[VS_PATH_SIZE];
  struct stat s;
  find_library(path);
  if (!*path || stat(path, &s)) return false;
  snprintf(text, size, "vibrospice %s\n%s %lld %lld.%09ld\n", VS_VERSION, path,
           (long long)s.st_size, (long long)s.st_mtim.tv_sec, (long)s.st_mtim.tv_nsec);
  return true;
}

/* ---- what is remembered ---- */

static const char END[] = "\nend\n";

/* The folder of the memory, and the name in it; false: the user has none. */
static bool find_memory(const char *identity, char folder[VS_PATH_SIZE], char name[32]) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  vs_hash hash;
  char digits[VS_HASH_TEXT];
  struct stat s;
  bool own = cache && *cache == '/';
  if (!own && (!home || *home != '/' || stat(home, &s))) return false;
  snprintf(folder, VS_PATH_SIZE, "%.4000s%s/vibrospice", own ? cache : home, own ? "" : "/.cache");
  vs_hash_begin(&hash);
  vs_hash_add(&hash, identity, strlen(identity));
  vs_hash_end(&hash, digits);
  snprintf(name, 32, "ngspice-%.16s", digits);
  return true;
}

/* Takes what is remembered of the library; false: nothing, or nothing that is whole. */
static bool recall(const char *identity) {
  char folder[VS_PATH_SIZE], name[32], path[VS_PATH_SIZE + 32];
  char text[2 * VS_PATH_SIZE];
  if (!find_memory(identity, folder, name)) return false;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  ssize_t n = file < 0 ? -1 : read(file, text, sizeof text - 1);
  if (file >= 0) close(file);
  size_t head = strlen(identity), tail = sizeof END - 1;
  if (n < (ssize_t)(head + tail)) return false;
  text[n] = '\0';
  char *end = text + n - tail;
  if (memcmp(text, identity, head) != 0 || strcmp(end, END) != 0) return false;
  *end = '\0';
  snprintf(trust.wrong, sizeof trust.wrong, "%s", text + head);
  return true;
}

/* Whoever cannot remember probes again. */
static void remember(const char *identity) {
  char folder[VS_PATH_SIZE], name[32];
  vs_file file = {0};
  vs_error err = {0};
  int made;
  if (!find_memory(identity, folder, name) || vs_file_folder_make(folder, &made, &err)) return;
  if (vs_file_open(&file, folder, name, &err)) return;
  fprintf(file.stream, "%s%s%s", identity, trust.wrong, END);
  vs_file_commit(&file, &err);
}

/* ---- the library is probed ---- */

/* In the child: what is wrong is its complaint. */
static vs_child_end attempt_probe(void *ctx) {
  vs_solver_errors *complaints = ctx;
  char wrong[VS_SELF_TEST_TEXT] = "";
  vs_self_test_probe(&vs_ngspice_kind, wrong);
  if (!*wrong) return VS_CHILD_GOOD;
  snprintf(complaints->item[0], VS_SOLVER_ERRORS_LINE, "%s", wrong);
  complaints->count = 1;
  return VS_CHILD_BAD_RUN;
}

/* Probes the library. *lasting: what came of it is worth remembering; that a child process died or
 * did not come back may be the fault of the day. Error: VS_SIGNAL. */
static vs_status probe_in_child(bool *lasting, vs_error *err) {
  vs_solver_errors complaints = {0};
  vs_child_end end;
  vs_error why = {0};
  vs_status status = vs_child_try(attempt_probe, &complaints, &complaints, &end, &why);
  *lasting = !status;
  if (status == VS_SIGNAL) *err = why;
  if (status == VS_SIGNAL) return status;
  if (status)
    snprintf(trust.wrong, sizeof trust.wrong, "it was not seen to be right: %.150s", why.text);
  else if (end != VS_CHILD_GOOD)
    snprintf(trust.wrong, sizeof trust.wrong, "%.*s", VS_SELF_TEST_TEXT - 1,
             vs_solver_errors_first(&complaints));
  return VS_OK;
}

static void put_into_words(void) {
  char path[VS_PATH_SIZE];
  if (!*trust.wrong) return;
  for (char *c = trust.wrong; *c; c++) /* the memory is a file; nothing a terminal would obey */
    if (*c < ' ' || *c > '~') *c = ' ';
  find_library(path);
  snprintf(trust.library, sizeof trust.library,
           "ngspice %s (%s) is not to be relied on: %s; what tier circuit computes with it may be "
           "wrong",
           vs_ngspice_running(), *path ? path : "linked into the program", trust.wrong);
  if (!vs_crash_guard_again()) fprintf(stderr, "vibrospice: warning: %s\n", trust.library);
}

vs_status vs_self_test_find(vs_error *err) {
  char identity[VS_PATH_SIZE + 128];
  bool lasting = true;
  if (trust.known) return VS_OK;
  vs_status status = vs_ngspice_begin(err);
  if (status) return status;
  bool file = identify(identity, sizeof identity);
  if (!file || !recall(identity)) {
    status = probe_in_child(&lasting, err);
    if (status) return status;
    if (file && lasting) remember(identity);
  }
  trust.known = true;
  put_into_words();
  return VS_OK;
}

const char *vs_self_test_text(void) {
  return *trust.library ? trust.library : trust.circuit;
}

/* ---- the solver ---- */

/* Tells of a circuit that means another thing in this version than in those before it. */
static void look_at_circuit(const vs_circuit_job *job) {
  static const double SINCE = 47;
  char before[sizeof trust.circuit];
  memcpy(before, trust.circuit, sizeof before);
  *trust.circuit = '\0';
  if (strtod(vs_ngspice_running(), NULL) < SINCE) return;
  for (size_t k = 1; k < job->lines && !*trust.circuit; k++)
    if (vs_versions_differ(job->netlist[k], *job->dialect))
      snprintf(
          trust.circuit, sizeof trust.circuit,
          "%.*s: ngspice %s takes x to the y, or 0, for a power of a negative x, and ngspice up to "
          "46 takes |x|^y: write pow(abs(x),y), or sgn(x)*pow(abs(x),y)",
          (int)strcspn(job->netlist[k], " \t"), job->netlist[k], vs_ngspice_running());
  if (*trust.circuit && strcmp(before, trust.circuit) != 0 && !vs_crash_guard_again())
    fprintf(stderr, "vibrospice: warning: %s\n", trust.circuit);
}

static vs_status load_trusted(const vs_circuit_job *job, const vs_circuit_host *host,
                              void **circuit, vs_error *err) {
  vs_status status = vs_self_test_find(err);
  *circuit = NULL;
  if (!status) look_at_circuit(job);
  return status ? status : vs_ngspice_kind.load(job, host, circuit, err);
}

static vs_status run_trusted(void *circuit, vs_error *err) {
  return vs_ngspice_kind.run(circuit, err);
}

static void release_trusted(void *circuit) {
  vs_ngspice_kind.free(circuit);
}

const vs_circuit_kind vs_self_test_kind = {
    .name = "ngspice", .load = load_trusted, .run = run_trusted, .free = release_trusted};
