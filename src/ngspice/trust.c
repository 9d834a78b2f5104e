/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ngspice/trust.h"

#include <fcntl.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/path.h"
#include "ngspice/child.h"
#include "ngspice/guard.h"
#include "ngspice/ng.h"
#include "probe.h"
#include "versions.h"

/* libngspice is one in a process, and so is what is known of it. */
static struct {
  bool known;
  char wrong[VS_PROBE_TEXT];
  char library[VS_PATH_SIZE + 2 * VS_PROBE_TEXT]; /* what is told of it; empty: nothing */
  char circuit[2 * VS_PROBE_TEXT];                /* what is told of the circuit it has */
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

/* ---- the probe ---- */

/* In the child: what is wrong is its complaint. */
static vs_child_end attempt_probe(void *ctx) {
  vs_complaints *complaints = ctx;
  char wrong[VS_PROBE_TEXT] = "";
  vs_probe_run(&vs_ng_kind, wrong);
  if (!*wrong) return VS_CHILD_GOOD;
  snprintf(complaints->item[0], VS_COMPLAINTS_LINE, "%s", wrong);
  complaints->count = 1;
  return VS_CHILD_BAD_RUN;
}

/* Probes the library. *lasting: what came of it is worth remembering; that a child process died or
 * did not come back may be the fault of the day. Error: VS_SIGNAL. */
static vs_status probe_in_child(bool *lasting, vs_error *err) {
  vs_complaints complaints = {0};
  vs_child_end end;
  vs_error why = {0};
  vs_status status = vs_child_try(attempt_probe, &complaints, &complaints, &end, &why);
  *lasting = !status;
  if (status == VS_SIGNAL) *err = why;
  if (status == VS_SIGNAL) return status;
  if (status)
    snprintf(trust.wrong, sizeof trust.wrong, "it was not seen to be right: %.150s", why.text);
  else if (end != VS_CHILD_GOOD)
    snprintf(trust.wrong, sizeof trust.wrong, "%.*s", VS_PROBE_TEXT - 1,
             vs_complaints_first(&complaints));
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
           vs_ng_running(), *path ? path : "linked into the program", trust.wrong);
  if (!vs_guard_again()) fprintf(stderr, "vibrospice: warning: %s\n", trust.library);
}

vs_status vs_trust_find(vs_error *err) {
  char identity[VS_PATH_SIZE + 128];
  bool lasting = true;
  if (trust.known) return VS_OK;
  vs_status status = vs_ng_begin(err);
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

const char *vs_trust_text(void) {
  return *trust.library ? trust.library : trust.circuit;
}

/* ---- the solver ---- */

/* Tells of a circuit that means another thing in this version than in those before it. */
static void look_at_circuit(const vs_circuit_job *job) {
  static const double SINCE = 47;
  char before[sizeof trust.circuit];
  memcpy(before, trust.circuit, sizeof before);
  *trust.circuit = '\0';
  if (strtod(vs_ng_running(), NULL) < SINCE) return;
  for (size_t k = 1; k < job->lines && !*trust.circuit; k++)
    if (vs_versions_differ(job->netlist[k], *job->dialect))
      snprintf(
          trust.circuit, sizeof trust.circuit,
          "%.*s: ngspice %s takes x to the y, or 0, for a power of a negative x, and ngspice up to "
          "46 takes |x|^y: write pow(abs(x),y), or sgn(x)*pow(abs(x),y)",
          (int)strcspn(job->netlist[k], " \t"), job->netlist[k], vs_ng_running());
  if (*trust.circuit && strcmp(before, trust.circuit) != 0 && !vs_guard_again())
    fprintf(stderr, "vibrospice: warning: %s\n", trust.circuit);
}

static vs_status load_trusted(const vs_circuit_job *job, const vs_circuit_host *host,
                              void **circuit, vs_error *err) {
  vs_status status = vs_trust_find(err);
  *circuit = NULL;
  if (!status) look_at_circuit(job);
  return status ? status : vs_ng_kind.load(job, host, circuit, err);
}

static vs_status run_trusted(void *circuit, vs_error *err) {
  return vs_ng_kind.run(circuit, err);
}

static void release_trusted(void *circuit) {
  vs_ng_kind.free(circuit);
}

const vs_circuit_kind vs_trust_kind = {"ngspice", load_trusted, run_trusted, release_trusted};
