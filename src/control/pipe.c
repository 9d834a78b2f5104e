/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own as a process on a pipe, in any language:
 *
 *   control: {law: pipe, command: python3 mylaw.py, timeout: 5 s}
 *
 * The command is started without a shell, in the folder of the file that names it. For each firing
 * it reads one line of JSON from its standard input,
 *
 *   {"t_s": 0.04, "firing": 3, "last_angle_deg": 95, "now": {"p_meas_m": 0.0004, ...},
 *    "least": {...}, "largest": {...}}
 *
 * which has no line break in it, and writes one to its standard output: {"angle_deg": 95},
 * {"angle_deg": null} for no firing, or {"error": "why"}, which ends the run. What is not known is
 * null. */
#include "control/regulators.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/hash.h"
#include "base/json.h"
#include "base/path.h"
#include "base/text.h"
#include "base/tree.h"
#include "child_process.h"
#include "law_input.h"

/* ---- the command's words ---- */

enum { WORDS = 64 };
typedef struct words {
  char text[2 * VS_NAME_SIZE]; /* the words, each with a zero byte behind it */
  char *word[WORDS + 1];       /* NULL behind the last */
  int count;
} words;

/* Cuts the command into words, as a shell does: at blanks, where these are not between 'single
 * quotes' or "double quotes". A backslash takes the next character as it is, except between single
 * quotes. Nothing else has a meaning. Returns what is wrong; NULL: nothing. */
static const char *cut_into_words(const char *command, words *w) {
  char *to = w->text, quote = '\0';
  bool within = false; /* a word has begun */
  w->count = 0;
  for (const char *c = command; *c; c++) {
    if (!quote && strchr(" \t\n", *c)) {
      if (within) *to++ = '\0';
      within = false;
      continue;
    }
    if (!within) {
      if (w->count == WORDS) return "it has more than 64 words";
      w->word[w->count++] = to;
    }
    within = true;
    if (quote ? *c == quote : *c == '\'' || *c == '"') {
      quote = quote ? '\0' : *c;
      continue;
    }
    if (*c == '\\' && quote != '\'' && !*++c) return "it ends with a backslash";
    *to++ = *c;
  }
  *to = '\0';
  w->word[w->count] = NULL;
  if (quote) return "a quotation in it is not closed";
  return w->count ? NULL : "it is empty";
}

/* ---- question and answer ---- */

/* Adds a number with as few digits as give the same number when they are read. */
static void add_json_number(vs_json *json, const char *key, double value) {
  char text[VS_NUMBER_SIZE];
  int digits = 15;
  for (; digits < 17; digits++) {
    vs_text_number(text, value, digits);
    if (strtod(text, NULL) == value) break;
  }
  vs_json_number(json, key, value, digits);
}

static void add_values(vs_json *json, const char *key, const vs_law_input *view, size_t member) {
  vs_json_object(json, key, VS_JSON_ROW);
  for (int k = 0; k < view->firing.count; k++) {
    const vibrospice_channel *c = &view->channel[k];
    double value;
    memcpy(&value, (const char *)c + member, sizeof value);
    add_json_number(json, c->name, value);
  }
  vs_json_end(json);
}

/* Writes the firing as one line. What it has for numbers is exact. */
static void write_question(const vs_law_input *view, vs_text *line) {
  line->length = 0;
  vs_json json = vs_json_new(line);
  vs_json_object(&json, NULL, VS_JSON_ROW);
  add_json_number(&json, "t_s", view->firing.t_s);
  vs_json_whole(&json, "firing", view->firing.number);
  add_json_number(&json, "last_angle_deg", view->firing.last_angle_deg);
  add_values(&json, "now", view, offsetof(vibrospice_channel, now));
  add_values(&json, "least", view, offsetof(vibrospice_channel, least));
  add_values(&json, "largest", view, offsetof(vibrospice_channel, largest));
  vs_json_end(&json);
  vs_text_add(line, "\n");
}

/* The answer's members. */
typedef struct answer {
  const vs_node *angle, *error; /* NULL: it has none */
  const vs_node *other;         /* the first that it should not have */
} answer;

static answer members_of(const vs_node *map) {
  answer a = {NULL, NULL, NULL};
  if (!map || map->kind != VS_NODE_MAP) return a;
  for (const vs_node *n = map->child; n; n = n->next) {
    const vs_node **member = !strcmp(n->key, "angle_deg") ? &a.angle
                             : !strcmp(n->key, "error")   ? &a.error
                                                          : &a.other;
    if (*member || n->kind != VS_NODE_TEXT) member = &a.other;
    *member = n;
  }
  return a;
}

/* The text as it is shown in a message: its beginning, in one line. */
static void shorten_answer(const char *text, char shown[64]) {
  size_t n = strcspn(text, "\r\n"), most = 56;
  const char *wrong = vs_text_not_utf8(text, n);
  if (wrong) n = (size_t)(wrong - text);
  bool cut = n > most || wrong;
  if (n > most)
    for (n = most; n && (text[n] & 0xc0) == 0x80;) n--; /* between two characters */
  snprintf(shown, 64, "%.*s%s", (int)n, text, cut ? "..." : "");
  for (char *c = shown; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 127) *c = ' ';
}

/* Is the value of the line's only member a text? Of its quotes, two are the name's. A text may look
 * like a number, and "nan" is not the null that leaves a firing out. */
static bool is_quoted(const char *line) {
  int quotes = 0;
  for (const char *c = line; *c; c++) quotes += *c == '"';
  return quotes > 2;
}

/* Reads an angle as JSON has it, deg; NaN for null. False: it is none. */
static bool read_angle(const char *text, double *angle_deg) {
  char *end;
  *angle_deg = NAN;
  if (!strcmp(text, "null")) return true;
  *angle_deg = strtod(text, &end);
  return *text && !*end && (isinf(*angle_deg) || !vs_text_out_of_range(text));
}

/* Takes the line apart: an angle, or the law's own trouble. */
static vs_status read_answer(const vs_child_process *r, double *angle_deg, char *trouble,
                             size_t size, vs_error *err) {
  vs_tree tree = {0};
  vs_error none = {0};
  vs_text assignment = {0};
  answer a = {NULL, NULL, NULL};
  bool good = strlen(r->in) + 1 == r->n_in && vs_json_is_whole(r->in);
  vs_text_add(&assignment, "answer=%s", r->in);
  tree.root = vs_alloc(1, sizeof *tree.root);
  tree.root->kind = VS_NODE_MAP;
  good = good && !vs_tree_set(&tree, assignment.text, &none); /* YAML, of which JSON is a part */
  if (good) a = members_of(vs_tree_child(tree.root, "answer"));
  good = good && !a.other && !a.angle == !!a.error && is_quoted(r->in) == !!a.error;
  if (good && a.error) snprintf(trouble, size, "%s", *a.error->text ? a.error->text : "error");
  if (good && a.angle) good = read_angle(a.angle->text, angle_deg);
  vs_tree_free(&tree);
  vs_text_free(&assignment);
  if (good) return VS_OK;
  char shown[64];
  shorten_answer(r->in, shown);
  return vs_fail(err, VS_RUN,
                 "t = %.9g s: control: %s answered '%s'; wanted: one line of JSON, "
                 "{\"angle_deg\": 95}, {\"angle_deg\": null} for no firing, or {\"error\": "
                 "\"why\"}",
                 r->t_s, r->name, shown);
}

/* ---- the regulator ---- */

#define AT(member) offsetof(vs_control_values, member)
static const vs_field KEYS[] = {
    {"command", VS_NAME, "", "NAME", .offset = AT(command),
     .text = "the program and its arguments; it runs in the folder of this file, without a shell"},
    {"timeout", VS_REAL, "s", "5 s", 0, 86400, true, AT(timeout_s),
     .text = "wall-clock time within which it must answer"}};
#undef AT

typedef struct pipe_law {
  vs_law_input view;
  vs_child_process remote;
  words words;
  vs_text question;
  bool answered; /* since it began */
} pipe_law;

static vs_status check_pipe(const vs_control_values *v, vs_where where, vs_error *err) {
  words w;
  const char *wrong = cut_into_words(v->command, &w);
  return wrong ? vs_fail_at(err, where, "control.command: %s", wrong) : VS_OK;
}

/* The words that are files: a script, most likely, and what else it is given. */
static bool file_of_pipe(const vs_control_values *v, vs_where where, int k,
                         char path[VS_PATH_SIZE]) {
  words w;
  if (cut_into_words(v->command, &w)) return false;
  for (int n = 0; n < w.count; n++) {
    struct stat s;
    bool is = vs_law_input_path(w.word[n], where, path) && !stat(path, &s) && S_ISREG(s.st_mode);
    if (is && k-- == 0) return true;
  }
  return false;
}

/* Error: one of the files has changed since the study began. */
static vs_status check_files(const vs_control_input *sight, vs_error *err) {
  char path[VS_PATH_SIZE], sum[VS_HASH_TEXT];
  vs_status status = VS_OK;
  for (int k = 0; !status && file_of_pipe(sight->v, sight->where, k, path); k++)
    status = vs_hash_file(path, sum, err);
  return status;
}

static vs_status begin_pipe(void *self, const vs_control_input *sight, vs_error *err) {
  pipe_law *p = self;
  char folder[VS_PATH_SIZE];
  p->remote.name = sight->v->command;
  p->remote.timeout_s = sight->v->timeout_s;
  vs_law_input_begin(&p->view, sight);
  vs_status status = check_pipe(sight->v, sight->where, err);
  if (!status) status = check_files(sight, err);
  if (status) return status;
  cut_into_words(sight->v->command, &p->words);
  if (!vs_law_input_path("", sight->where, folder)) *folder = '\0';
  return vs_child_process_exec(&p->remote, p->words.word, folder, sight->where, err);
}

static void tick_pipe(void *self, const vs_control_input *sight) {
  pipe_law *p = self;
  vs_law_input_tick(&p->view, sight);
}

static vs_status decide_pipe(void *self, const vs_control_input *sight, double *angle_rad,
                             vs_error *err) {
  pipe_law *p = self;
  vs_child_process *r = &p->remote;
  double angle_deg = NAN;
  char trouble[VIBROSPICE_LAW_TEXT] = "";
  vs_law_input_ask(&p->view, sight);
  write_question(&p->view, &p->question);
  vs_status status = vs_child_process_ask(r, sight->t_s, p->question.text, p->question.length, err);
  if (!status) status = vs_child_process_answer(r, 0, err);
  if (!status && !p->answered) status = check_files(sight, err); /* as it has read them by now */
  p->answered = true;
  if (!status) status = read_answer(r, &angle_deg, trouble, sizeof trouble, err);
  return status ? status
                : vs_law_input_answer(&p->view, r->name, angle_deg, trouble, angle_rad, err);
}

static void end_pipe(void *self) {
  pipe_law *p = self;
  vs_child_process_end(&p->remote);
  vs_text_free(&p->question);
}

const vs_regulator vs_pipe_regulator = {
    .name = "pipe",
    .text = "a law of your own: a process that reads and writes lines of JSON; wants --allow-code",
    .fields = KEYS,
    .n_fields = sizeof KEYS / sizeof *KEYS,
    .code = "command",
    .size = sizeof(pipe_law),
    .check = check_pipe,
    .file = file_of_pipe,
    .begin = begin_pipe,
    .tick = tick_pipe,
    .decide = decide_pipe,
    .end = end_pipe};
