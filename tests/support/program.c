/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "program.h"

#include <errno.h>
#include <fcntl.h>
#include <libfyaml.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

double measure_in(const char *json, const char *name) {
  char key[100];
  snprintf(key, sizeof key, "\"%s\": {\"value\": ", name);
  const char *at = strstr(json, key);
  return at ? strtod(at + strlen(key), NULL) : NAN;
}

double json_measure(const char *json, const char *name, const char *end) {
  char whole[96];
  snprintf(whole, sizeof whole, "%s%s", name, end);
  double value = measure_in(json, whole);
  EXPECT(!isnan(value), "there is no measure %s", whole);
  return value;
}

double number_in(const char *json, const char *key) {
  static const char VALUE[] = "{\"value\": ";
  char name[100], *end = NULL;
  snprintf(name, sizeof name, "\"%s\": ", key);
  const char *at = json ? strstr(json, name) : NULL;
  if (!at) return NAN;
  at += strlen(name);
  if (!strncmp(at, VALUE, strlen(VALUE))) at += strlen(VALUE);
  const double value = strtod(at, &end);
  return end > at ? value : NAN;
}

char *read_file(const char *path) {
  vs_text all = {0};
  FILE *f = fopen(path, "rb");
  char part[4096];
  vs_text_add(&all, "%s", "");
  while (f && fgets(part, sizeof part, f)) vs_text_add(&all, "%s", part);
  if (f) fclose(f);
  return all.text;
}

static char *skip_number(char *at) {
  return at + strspn(at, "-+.eE0123456789");
}

void make_shape(char *json) {
  char *to = json;
  bool quoted = false;
  while (*json) {
    if (*json == '"') quoted = !quoted; /* no name or text of ours has a quote in it */
    if (quoted || !strchr("-0123456789", *json)) {
      *to++ = *json++;
      continue;
    }
    json = skip_number(json);
    while (!strncmp(json, ", ", 2) && json[2] && strchr("-0123456789", json[2]))
      json = skip_number(json + 2);
    *to++ = '#';
  }
  *to = '\0';
}

int count_lines(const char *text) {
  int lines = 0;
  for (; *text; text++) lines += *text == '\n';
  return lines;
}

int count_words(const char *text, const char *word) {
  int n = 0;
  for (const char *s = text; (s = strstr(s, word)); s += strlen(word)) n++;
  return n;
}

void same_content(const char *a, const char *b, int line) {
  char *x = read_file(a), *y = read_file(b);
  size_t k = 0;
  while (x[k] && x[k] == y[k]) k++;
  expect(*x && x[k] == y[k], line, "%s and %s differ at byte %zu: '%.80s' and '%.80s'", a, b, k,
         x + k, y + k);
  free(x), free(y);
}

void same_study(const char *a, const char *b, int line) {
  static const char *const FILES[] = {"study.csv", "failures.csv", "manifest.json"};
  for (size_t k = 0; k < COUNT(FILES); k++) {
    char x[256], y[256];
    snprintf(x, sizeof x, "%s/%s", a, FILES[k]);
    snprintf(y, sizeof y, "%s/%s", b, FILES[k]);
    same_content(x, y, line);
  }
}

void expect_exit(const char *words, int status, int line) {
  ran r = run("%s", words);
  expect(r.status == status, line, "%s: exit status %d: %s", words, r.status, r.err);
  free_ran(&r);
}

double event_s(const char *events, const char *what) {
  const char *at = strstr(events, what);
  if (!at) return NAN;
  while (at > events && at[-1] != '\n') at--;
  return strtod(at, NULL);
}

enum { MOST_SECONDS = 120, MOST_SECONDS_LONG = 3600 };

/* A child in which another program is to run; 0: this is the child. Its standard output and error
 * land beside the work folder, so that this holds what the program made. */
static pid_t begin_child(void) {
  fflush(NULL);
  pid_t child = fork();
  if (child) return child;
  int out = open("../stdout", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  int err = open("../stderr", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) _exit(126);
  close(out);
  close(err);
  /* outlives exec: a program that hangs ends by SIGALRM */
  alarm(getenv("VS_LONG") ? MOST_SECONDS_LONG : MOST_SECONDS);
  return 0;
}

pid_t spawn_other(const char *program, const char *const *argv, char *const *environment) {
  pid_t child = begin_child();
  if (child) return child;
  execve(program, (char *const *)(size_t)argv, environment);
  _exit(127);
}

pid_t spawn(const char *const *argv) {
  return spawn_other(VS_PROGRAM, argv, environ);
}

pid_t spawn_prepared(const char *words, void (*prepare)(void *ctx), void *ctx) {
  char copy[2048];
  const char *argv[MOST_WORDS];
  snprintf(copy, sizeof copy, "%s", words);
  split(copy, argv);
  pid_t child = begin_child();
  if (child) return child;
  if (prepare) prepare(ctx);
  execv(VS_PROGRAM, (char *const *)(size_t)argv);
  _exit(127);
}

/* The signals that a process catches, as bits from 0, of the line "SigCgt:" of /proc/PID/status. */
static unsigned long long caught(pid_t process) {
  char path[64], line[256];
  unsigned long long set = 0;
  snprintf(path, sizeof path, "/proc/%d/status", (int)process);
  FILE *in = fopen(path, "r");
  while (in && fgets(line, sizeof line, in))
    if (!strncmp(line, "SigCgt:", 7)) set = strtoull(line + 7, NULL, 16);
  if (in) fclose(in);
  return set;
}

pid_t spawn_ready(const char *const *argv) {
  const struct timespec nap = {0, 5000000};
  pid_t child = spawn(argv);
  for (int n = 0; n < 4000 && !(caught(child) >> (SIGTERM - 1) & 1); n++) nanosleep(&nap, NULL);
  return child;
}

ran collect(pid_t child) {
  int how = 0;
  while (waitpid(child, &how, 0) < 0 && errno == EINTR) {
  }
  return (ran){WIFEXITED(how) ? WEXITSTATUS(how) : 1000 + WTERMSIG(how), read_file("../stdout"),
               read_file("../stderr")};
}

/* The command line cut at its blanks, but for what stands 'in quotes'. */
size_t split(char *words, const char **argv) {
  size_t n = 0;
  argv[n++] = "vibrospice";
  for (char *s = words; *s && n < MOST_WORDS - 1;) {
    bool quoted = *s == '\'';
    argv[n++] = s += quoted;
    s += strcspn(s, quoted ? "'" : " ");
    if (*s) *s++ = '\0';
    s += strspn(s, " ");
  }
  argv[n] = NULL;
  return n;
}

/* What is printed as JSON is JSON, as strict as the standard. */
static void expect_json(const char *text, const char *what) {
  static const struct fy_parse_cfg STRICT = {.flags = FYPCF_QUIET | FYPCF_JSON_FORCE};
  struct fy_document *doc = fy_document_build_from_string(&STRICT, text, FY_NT);
  EXPECT(doc != NULL, "%s: this is no JSON: %s", what, text);
  fy_document_destroy(doc);
}

ran run(const char *format, ...) {
  char words[2048];
  const char *argv[MOST_WORDS];
  va_list args;
  va_start(args, format);
  vsnprintf(words, sizeof words, format, args);
  va_end(args);
  bool json = strstr(words, "--json") != NULL;
  split(words, argv);
  ran r = collect(spawn(argv));
  if (json && (r.status == 0 || r.status == 3)) expect_json(r.out, words);
  return r;
}

void free_ran(ran *r) {
  free(r->out);
  free(r->err);
}

void expect_good(const ran *r, const char *what, int line) {
  static const char NOTE[] = "vibrospice: note: replaced in "; /* a second run in its folder */
  const char *err = r->err;
  if (!strncmp(err, NOTE, sizeof NOTE - 1)) err += strcspn(err, "\n") + 1;
  expect(r->status == 0, line, "%s: exit status %d: %s", what, r->status, r->err);
  expect(!*err, line, "%s: standard error: %s", what, r->err);
}

void run_good(const char *words, int line) {
  ran r = run("%s", words);
  expect_good(&r, words, line);
  free_ran(&r);
}

static void expect_refused(const ran *r, const char *what, const char *at, const char *const *says,
                           int line) {
  char start[256];
  snprintf(start, sizeof start, "vibrospice: %s", at);
  expect(r->status == 2, line, "%s: exit status %d", what, r->status);
  expect(!*r->out, line, "%s: standard output: %s", what, r->out);
  expect(count_lines(r->err) == 1, line, "%s: not one line: %s", what, r->err);
  expect(!strncmp(r->err, *at ? start : "vibrospice", strlen(*at ? start : "vibrospice")), line,
         "%s: does not begin with '%s': %s", what, start, r->err);
  for (int k = 0; k < 2 && says[k]; k++)
    expect(strstr(r->err, says[k]) != NULL, line, "%s: does not say '%s': %s", what, says[k],
           r->err);
}

void refuse(const char *words, const char *what, const char *at, const char *const *says,
            int line) {
  char *before = listing(".");
  ran r = run("%s", words);
  expect_refused(&r, what, at, says, line);
  expect_files(".", before, line);
  if (!strstr(before, "out ")) remove_tree("out"); /* one failure is enough */
  free_ran(&r);
  free(before);
}

int program_suite(const char *name, const vs_test *tests, size_t count) {
  const char *temporary = getenv("TMPDIR");
  char folder[VS_PATH_SIZE], work[VS_PATH_SIZE + 8];
  snprintf(folder, sizeof folder, "%s/vibrospice.XXXXXX", temporary ? temporary : "/tmp");
  if (!mkdtemp(folder)) return 1;
  snprintf(work, sizeof work, "%s/work", folder);
  const char *leaks = getenv("LSAN_OPTIONS");
  if (leaks) { /* its list of what it suppressed would count as words of the program */
    char more[VS_PATH_SIZE];
    snprintf(more, sizeof more, "%s:print_suppressions=0", leaks);
    setenv("LSAN_OPTIONS", more, 1);
  }
  unsetenv("VIBROSPICE_PATH"); /* its scenes would come before the shipped ones */
  int failed = mkdir(work, 0777) || chdir(work) || vs_suite(name, tests, count);
  if (chdir("/") == 0) remove_tree(folder);
  return failed;
}

/* A part that conducts through 50 ohm while its gate is on: nothing that wants short steps. */
static const char GATED_PART[] =
    "* SPDX-License-Identifier: GPL-3.0-or-later\n"
    "*$ part thyristor \"a resistor that its gate switches\"\n"
    "*$ limit i_t_rms = 12 A \"as if\"\n"
    ".subckt gated a k g\nRg g k 1k\nBk a k I=v(a,k)*v(g,k)*20m\n.ends gated\n";
static const char GATED_DECK[] =
    "*$ param thyristor = gated.inc part thyristor\n*$ port mains = Vm\n"
    "*$ port gate = Vg\n*$ probe v_ak = v(a,b) V\n"
    "*$ device thyristor = v(a,b), i(Vt)\nVm a 0 external\n"
    "Vg g b external\nVt a t 0\nXt t b g thyristor\nRb b 0 1k\n"
    "Xeva b 0 eva\n";

void write_gated_deck(void) {
  write_file("gated.inc", GATED_PART);
  write_file("gated.cir", GATED_DECK);
}

void waive_the_rest(const char *device, const char *kind, const char *lines, vs_text *text) {
  const vs_kind *k = vs_kinds_find(kind);
  for (size_t n = 0; n < k->n_measures; n++) {
    const vs_device_measure *m = &k->measures[n];
    char stated[96];
    if (!m->limit || !vs_kinds_decides(kind, m->limit)) continue;
    snprintf(stated, sizeof stated, "limit %s ", m->limit);
    if (!strstr(lines, stated))
      vs_text_add(text, "%s%s.%s", text->length ? "," : "", device, m->name);
  }
}
