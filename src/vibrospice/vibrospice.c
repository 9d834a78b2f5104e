/* SPDX-License-Identifier: MIT
 * libvibrospice: the other end of `vibrospice serve`. It needs nothing but POSIX, as what hosts it
 * may be anything: it checks every request for memory, takes no signal, and knows a handle by a
 * number, so that one that was freed is told from all others. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* dladdr */
#endif
#include "vibrospice/vibrospice.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "vibrospice/protocol.h"

extern char **environ;

/* ---- errors ---- */

static __thread char last_error[1024];

static vibrospice_status fail(vibrospice_status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static vibrospice_status fail(vibrospice_status status, const char *format, ...) {
  va_list list;
  va_start(list, format);
  vsnprintf(last_error, sizeof last_error, format, list);
  va_end(list);
  return status;
}

static vibrospice_status no_memory(void) {
  return fail(VIBROSPICE_MEMORY, "there is no memory");
}

const char *vibrospice_error(void) {
  return last_error;
}

#define TEXT_OF_(x) #x
#define TEXT_OF(x) TEXT_OF_(x)

const char *vibrospice_version(void) {
  return TEXT_OF(VIBROSPICE_MAJOR) "." TEXT_OF(VIBROSPICE_MINOR) "." TEXT_OF(VIBROSPICE_PATCH);
}

/* ---- handles ---- */

typedef enum phase { BEFORE, UNDER_WAY, FINISHED, OVER } phase;

/* A list that a text was taken apart into: items of one size, which point into the text. */
typedef struct list {
  char *item;
  size_t count, room, size;
} list;

/* What is behind a handle. */
typedef struct engine {
  uint32_t number; /* of the handle; 0: the place is free */
  int busy;        /* a thread is in it */
  int is_state;
  pid_t owner; /* the process that opened it */
  int socket;
  pid_t pid;  /* of the engine; 0: it is a copy, whose end nobody waits for */
  FILE *says; /* what the engine says on its standard error, for when it has died; NULL: nowhere */
  phase phase;
  double t_s, until_s, *value;
  char *described;            /* the description, whole */
  char *description, *result; /* texts that the lists point into */
  list column, input, measure, line, happening, name;
  int held;
  const char *breach, *summary;
} engine;

/* The table of all engines of the process, and its lock. A place is used again, a number is not. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static engine **table;
static size_t places;
static uint32_t last_number;

static void *handle_of(const engine *e) {
  return (void *)(uintptr_t)e->number;
}

/* Enters the engine of a handle, which leave() ends. */
static vibrospice_status enter(const void *handle, int is_state, engine **entered) {
  vibrospice_status status = VIBROSPICE_HANDLE;
  engine *found = NULL;
  pthread_mutex_lock(&lock);
  for (size_t k = 0; k < places && !found && handle; k++)
    if (table[k]->number && handle_of(table[k]) == handle && table[k]->is_state == is_state &&
        table[k]->owner == getpid())
      found = table[k];
  if (found) status = found->busy ? VIBROSPICE_BUSY : VIBROSPICE_OK;
  if (!status) found->busy = 1;
  pthread_mutex_unlock(&lock);
  *entered = found;
  if (status == VIBROSPICE_BUSY) return fail(status, "another thread, or a callback, is in it");
  if (status)
    return fail(status, "no such %s: it was freed, never was one, or is another process's",
                is_state ? "state" : "run");
  return VIBROSPICE_OK;
}

static vibrospice_status leave(engine *e, vibrospice_status status) {
  pthread_mutex_lock(&lock);
  e->busy = 0;
  pthread_mutex_unlock(&lock);
  return status;
}

/* A place with a new number; it is entered. NULL: no memory. */
static engine *take_place(int is_state) {
  engine *e = NULL;
  pthread_mutex_lock(&lock);
  for (size_t k = 0; k < places && !e; k++)
    if (!table[k]->number) e = table[k];
  if (!e) {
    engine **more = realloc(table, (places + 1) * sizeof *table);
    if (more) table = more;
    e = more ? calloc(1, sizeof *e) : NULL;
    if (e) table[places++] = e;
  }
  if (e) {
    *e = (engine){.is_state = is_state, .busy = 1, .owner = getpid(), .socket = -1};
    while (!++last_number) {
    }
    e->number = last_number;
  }
  pthread_mutex_unlock(&lock);
  return e;
}

static void free_texts(engine *e) {
  list *all[] = {&e->column, &e->input, &e->measure, &e->line, &e->happening, &e->name};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    free(all[k]->item);
    *all[k] = (list){0};
  }
  free(e->described);
  free(e->description);
  free(e->result);
  free(e->value);
  e->described = e->description = e->result = NULL;
  e->value = NULL;
}

/* Closes the socket, which ends the engine, and waits for that. */
static void end_process(engine *e) {
  if (e->socket >= 0) close(e->socket);
  if (e->pid > 0)
    while (waitpid(e->pid, NULL, 0) < 0 && errno == EINTR) {
    }
  if (e->says) fclose(e->says);
  e->socket = -1;
  e->pid = 0;
  e->says = NULL;
}

static void free_place(engine *e) {
  end_process(e);
  free_texts(e);
  pthread_mutex_lock(&lock);
  e->number = 0;
  e->busy = 0;
  pthread_mutex_unlock(&lock);
}

/* ---- messages ---- */

/* Says how the engine has ended. */
static vibrospice_status engine_died(engine *e) {
  char says[512] = "";
  int how = 0;
  const pid_t pid = e->pid > 0 ? e->pid : 0;
  if (e->socket >= 0) close(e->socket);
  e->socket = -1;
  if (pid)
    while (waitpid(pid, &how, 0) < 0 && errno == EINTR) {
    }
  e->pid = 0;
  e->phase = OVER;
  if (e->says) {
    rewind(e->says);
    for (char row[512]; fgets(row, sizeof row, e->says);) memcpy(says, row, sizeof says);
  }
  says[strcspn(says, "\n")] = '\0';
  if (*says) return fail(VIBROSPICE_ENGINE, "the engine has ended: %s", says);
  if (pid && WIFSIGNALED(how))
    return fail(VIBROSPICE_ENGINE, "the engine was ended by signal %d", WTERMSIG(how));
  if (pid && WEXITSTATUS(how) == 127)
    return fail(VIBROSPICE_ENGINE, "the program vibrospice cannot be started");
  return fail(VIBROSPICE_ENGINE, "the engine has ended");
}

static int say(int socket, const void *data, size_t size, int beside) {
  const char *at = data;
  union {
    struct cmsghdr head;
    char room[CMSG_SPACE(sizeof(int))];
  } control;
  while (size > 0) {
    struct iovec part = {(void *)(uintptr_t)at, size};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
    if (beside >= 0) {
      memset(&control, 0, sizeof control);
      message.msg_control = control.room;
      message.msg_controllen = sizeof control.room;
      struct cmsghdr *c = CMSG_FIRSTHDR(&message);
      c->cmsg_level = SOL_SOCKET;
      c->cmsg_type = SCM_RIGHTS;
      c->cmsg_len = CMSG_LEN(sizeof beside);
      memcpy(CMSG_DATA(c), &beside, sizeof beside);
    }
    ssize_t n = sendmsg(socket, &message, MSG_NOSIGNAL);
    if (n < 0 && errno != EINTR) return 0;
    if (n > 0) at += n, size -= (size_t)n, beside = -1;
  }
  return 1;
}

static int hear(int socket, void *data, size_t size) {
  char *at = data;
  while (size > 0) {
    ssize_t n = recv(socket, at, size, 0);
    if (n == 0 || (n < 0 && errno != EINTR)) return 0;
    if (n > 0) at += n, size -= (size_t)n;
  }
  return 1;
}

/* Asks: so many bytes, then so many more. beside: a descriptor to pass; -1: none. */
static int ask(int socket, uint32_t kind, const void *data, size_t size, const char *more,
               int beside) {
  const size_t rest = more ? strlen(more) : 0;
  const vibrospice_head head = {kind, (uint32_t)(size + rest)};
  return say(socket, &head, sizeof head, beside) && say(socket, data, size, -1) &&
         say(socket, more, rest, -1);
}

/* Takes an answer: *kind, and what follows as *text, to be freed, with an end behind it. An error
 * of the engine's becomes this one's. */
static vibrospice_status take_answer(engine *e, uint32_t *kind, char **text, size_t *size) {
  vibrospice_head head;
  *text = NULL;
  if (!hear(e->socket, &head, sizeof head)) return engine_died(e);
  *text = malloc((size_t)head.size + 1);
  if (!*text) {
    end_process(e); /* what it says cannot be taken */
    e->phase = OVER;
    return no_memory();
  }
  if (!hear(e->socket, *text, head.size)) {
    free(*text);
    *text = NULL;
    return engine_died(e);
  }
  (*text)[head.size] = '\0';
  *kind = head.kind;
  *size = head.size;
  if (head.kind == VIBROSPICE_OK || head.kind == VIBROSPICE_ROW) return VIBROSPICE_OK;
  fail((vibrospice_status)head.kind, "%s", *text);
  free(*text);
  *text = NULL;
  return (vibrospice_status)head.kind;
}

/* Asks a question that is answered without rows. text may be NULL: nobody wants what follows. */
static vibrospice_status ask_for(engine *e, uint32_t kind, const void *data, size_t size,
                                 const char *more, char **text) {
  char *answer;
  if (e->socket < 0) return fail(VIBROSPICE_ENGINE, "the engine has ended");
  if (!ask(e->socket, kind, data, size, more, -1)) return engine_died(e);
  vibrospice_status status = take_answer(e, &kind, &answer, &size);
  if (text)
    *text = answer;
  else
    free(answer);
  return status;
}

/* ---- taking texts apart ---- */

enum { MOST_CELLS = 16 };

/* Cuts a line into cells, and returns the next line. Cells that are missing are "". */
static char *cut_line(char *at, const char *cell[MOST_CELLS]) {
  size_t length = strcspn(at, "\n");
  char *next = at[length] ? at + length + 1 : at + length, *rest = at;
  at[length] = '\0';
  for (int k = 0; k < MOST_CELLS; k++) {
    char *word = strsep(&rest, "\t");
    cell[k] = word ? word : "";
  }
  return next;
}

/* Room for one more item, zeroed; NULL: no memory. */
static void *add(list *l, size_t size) {
  if (l->count == l->room) {
    size_t room = l->room ? 2 * l->room : 16;
    char *more = realloc(l->item, room * size);
    if (!more) return NULL;
    l->item = more;
    l->room = room;
  }
  return memset(l->item + size * l->count++, 0, size);
}

static double number(const char *text) {
  return strtod(text, NULL);
}

static int take_column(engine *e, const char *const *c) {
  vibrospice_column *to = add(&e->column, sizeof *to);
  if (to) *to = (vibrospice_column){c[1], c[2], c[3], c[4], c[5]};
  return !!to;
}

static int take_input(engine *e, const char *const *c) {
  vibrospice_input *to = add(&e->input, sizeof *to);
  if (to) *to = (vibrospice_input){c[1], c[2], number(c[3]), number(c[4]), number(c[5]), c[6]};
  return !!to;
}

static int take_measure(engine *e, const char *const *c) {
  vibrospice_measure *to = add(&e->measure, sizeof *to);
  if (to)
    *to = (vibrospice_measure){.name = c[1],
                               .unit = c[2],
                               .value = number(c[3]),
                               .at_s = number(c[4]),
                               .limit = number(c[5]),
                               .margin = NAN,
                               .error = NAN,
                               .word = ""};
  return !!to;
}

static int take_verdict_line(engine *e, const char *const *c) {
  vibrospice_line *to = add(&e->line, sizeof *to);
  if (to)
    *to = (vibrospice_line){.name = c[1],
                            .unit = c[2],
                            .value = number(c[3]),
                            .at_s = number(c[4]),
                            .least = number(c[5]),
                            .most = number(c[6]),
                            .margin = number(c[7]),
                            .error = number(c[8]),
                            .failed_at_s = number(c[9]),
                            .word = c[10],
                            .why = c[11]};
  return !!to;
}

static int take_happening(engine *e, const char *const *c) {
  vibrospice_happening *to = add(&e->happening, sizeof *to);
  if (to)
    *to = (vibrospice_happening){
        c[1], c[2], c[3], c[4], number(c[5]), strtol(c[6], NULL, 10), *c[7] == '1'};
  return !!to;
}

static int take_name(engine *e, const char *const *c) {
  const char **to = add(&e->name, sizeof *to);
  if (to) *to = c[1];
  return !!to;
}

static int take_rest(engine *e, const char *const *c) {
  if (*c[0] == 'u') e->until_s = number(c[1]);
  if (*c[0] == 'b') e->held = *c[1] == '1', e->breach = c[2];
  return 1;
}

/* Takes all lines of a text apart. 0: no memory. */
static int take_lines(engine *e, char *text) {
  static const struct {
    char first;
    int (*take)(engine *e, const char *const *cell);
  } KINDS[] = {{'c', take_column},       {'i', take_input},     {'m', take_measure},
               {'v', take_verdict_line}, {'h', take_happening}, {'n', take_name},
               {'\0', take_rest}};
  const char *cell[MOST_CELLS];
  while (*text) {
    size_t k = 0;
    text = cut_line(text, cell);
    if (*cell[0] == 'j') {
      e->summary = text;
      return 1;
    }
    while (KINDS[k].first && KINDS[k].first != *cell[0]) k++;
    if (!KINDS[k].take(e, cell)) return 0;
  }
  return 1;
}

/* The description takes the place of the one before. */
static vibrospice_status take_description(engine *e, char *text) {
  free_texts(e);
  e->described = strdup(text);
  e->description = text;
  e->t_s = 0;
  int good = e->described && take_lines(e, text);
  e->value = good ? malloc((e->column.count + 1) * sizeof *e->value) : NULL;
  for (size_t k = 0; e->value && k < e->column.count; k++) e->value[k] = NAN;
  return e->value ? VIBROSPICE_OK : no_memory();
}

/* Each measure gets what the line of its name has. */
static void join_lines(engine *e) {
  vibrospice_measure *m = (vibrospice_measure *)(void *)e->measure.item;
  const vibrospice_line *line = (const vibrospice_line *)(void *)e->line.item;
  for (size_t k = 0; k < e->measure.count; k++)
    for (size_t n = 0; n < e->line.count; n++)
      if (!strcmp(m[k].name, line[n].name))
        m[k].margin = line[n].margin, m[k].error = line[n].error, m[k].word = line[n].word;
}

/* ---- the process ---- */

/* The program's path: as the environment says, beside the library, in ../bin, or its name. */
static const char *find_program(char path[4096]) {
  static const char *const PLACES[] = {"vibrospice", "../bin/vibrospice", "../../bin/vibrospice"};
  const char *named = getenv("VIBROSPICE_PROGRAM");
  Dl_info self;
  if (named && *named) return named;
  for (size_t k = 0; k < sizeof PLACES / sizeof *PLACES; k++) {
    if (!dladdr((const void *)&lock, &self) || !self.dli_fname) break;
    const char *slash = strrchr(self.dli_fname, '/');
    snprintf(path, 4096, "%.*s%s", slash ? (int)(slash - self.dli_fname) + 1 : 0, self.dli_fname,
             PLACES[k]);
    if (!access(path, X_OK)) return path;
  }
  return "vibrospice";
}

/* Starts the engine with one end of a socket as its standard input. It is in a process group of its
 * own, so that a key of the terminal's does not end it. */
static vibrospice_status spawn(engine *e) {
  char path[4096], word[] = "serve", self[] = "vibrospice", *const argv[] = {self, word, NULL};
  int ends[2];
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
    return fail(VIBROSPICE_MEMORY, "no socket: %s", strerror(errno));
  e->socket = ends[0];
  e->says = tmpfile();
  if (e->says) fcntl(fileno(e->says), F_SETFD, FD_CLOEXEC);
  int wrong = posix_spawn_file_actions_init(&files);
  if (!wrong) wrong = posix_spawnattr_init(&attributes);
  if (wrong) {
    close(ends[1]);
    return no_memory();
  }
  posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", 1, 0);
  if (e->says)
    posix_spawn_file_actions_adddup2(&files, fileno(e->says), STDERR_FILENO);
  else
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", 1, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const char *program = find_program(path);
  wrong = posix_spawnp(&e->pid, program, &files, &attributes, argv, environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  close(ends[1]);
  if (!wrong) return VIBROSPICE_OK;
  e->pid = 0;
  return fail(VIBROSPICE_ENGINE, "the program %s cannot be started: %s", program, strerror(wrong));
}

static vibrospice_status greet(engine *e) {
  char *hello;
  uint32_t kind;
  size_t size;
  vibrospice_status status = take_answer(e, &kind, &hello, &size);
  if (!status && strcmp(hello, VIBROSPICE_PROTOCOL))
    status = fail(VIBROSPICE_ENGINE,
                  "the program is another version: it says '%.100s', and this "
                  "is '%s'",
                  hello, VIBROSPICE_PROTOCOL);
  free(hello);
  return status;
}

/* ---- a scene ---- */

vibrospice_status vibrospice_open(const char *scene, unsigned flags, vibrospice **run) {
  char mark[16], *text = NULL;
  if (!run) return fail(VIBROSPICE_INPUT, "run is NULL");
  *run = NULL;
  if (!scene) return fail(VIBROSPICE_INPUT, "scene is NULL");
  if (flags & ~(unsigned)(VIBROSPICE_TEXT | VIBROSPICE_ALLOW_CODE))
    return fail(VIBROSPICE_INPUT, "flags: %u has a flag that there is not", flags);
  engine *e = take_place(0);
  if (!e) return no_memory();
  vibrospice_status status = spawn(e);
  if (!status) status = greet(e);
  const int length = snprintf(mark, sizeof mark, "%u ", flags);
  if (!status) status = ask_for(e, VIBROSPICE_ASK_OPEN, mark, (size_t)length, scene, &text);
  if (!status) status = take_description(e, text);
  if (status) {
    free_place(e);
    return status;
  }
  *run = handle_of(e);
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_free(vibrospice *run) {
  engine *e;
  if (!run) return VIBROSPICE_OK;
  vibrospice_status status = enter(run, 0, &e);
  if (!status) free_place(e);
  return status;
}

vibrospice_status vibrospice_free_state(vibrospice_state *state) {
  engine *e;
  if (!state) return VIBROSPICE_OK;
  vibrospice_status status = enter(state, 1, &e);
  if (!status) free_place(e);
  return status;
}

/* Enters a run that has not begun. */
static vibrospice_status enter_before(vibrospice *run, engine **e) {
  vibrospice_status status = enter(run, 0, e);
  if (!status && (*e)->phase != BEFORE)
    status = leave(*e, fail(VIBROSPICE_ORDER, "the run has begun"));
  return status;
}

vibrospice_status vibrospice_set(vibrospice *run, const char *key, const char *value) {
  engine *e;
  char *text;
  if (!key || !value) return fail(VIBROSPICE_INPUT, "key or value is NULL");
  if (strchr(key, '=')) return fail(VIBROSPICE_INPUT, "key '%s' has a '=' in it", key);
  vibrospice_status status = enter_before(run, &e);
  if (status) return status;
  const size_t room = strlen(key) + strlen(value) + 2;
  char *assignment = malloc(room);
  if (!assignment) return leave(e, no_memory());
  snprintf(assignment, room, "%s=%s", key, value);
  status = ask_for(e, VIBROSPICE_ASK_SET, NULL, 0, assignment, &text);
  free(assignment);
  if (!status) status = take_description(e, text);
  return leave(e, status);
}

vibrospice_status vibrospice_folder(vibrospice *run, const char *folder) {
  engine *e;
  if (!folder || !*folder) return fail(VIBROSPICE_INPUT, "folder is NULL or empty");
  vibrospice_status status = enter_before(run, &e);
  return status ? status : leave(e, ask_for(e, VIBROSPICE_ASK_FOLDER, NULL, 0, folder, NULL));
}

vibrospice_status vibrospice_set_input(vibrospice *run, const char *name, double value) {
  engine *e;
  char *text = NULL;
  if (!name) return fail(VIBROSPICE_INPUT, "name is NULL");
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY) return leave(e, fail(VIBROSPICE_ORDER, "the run is over"));
  status = ask_for(e, VIBROSPICE_ASK_INPUT, &value, sizeof value, name, &text);
  if (!status && e->phase == BEFORE)
    status = take_description(e, text);
  else
    free(text);
  return leave(e, status);
}

/* ---- lists ---- */

/* Sets the pointers to a list of the handle's. */
static vibrospice_status give(vibrospice *run, size_t list_at, int of_result, const void **item,
                              size_t *count) {
  engine *e;
  if (!item || !count) return fail(VIBROSPICE_INPUT, "a pointer for the result is NULL");
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (of_result && e->phase != FINISHED)
    return leave(e,
                 fail(VIBROSPICE_ORDER, "the run is not finished: vibrospice_finish comes first"));
  const list *l = (const list *)(const void *)((const char *)e + list_at);
  *item = l->item;
  *count = l->count;
  return leave(e, VIBROSPICE_OK);
}

#define GIVE(run, member, of_result, item, count)                                                  \
  give(run, offsetof(engine, member), of_result, (const void **)(void *)(item), count)

vibrospice_status vibrospice_columns(vibrospice *run, const vibrospice_column **column,
                                     size_t *count) {
  return GIVE(run, column, 0, column, count);
}

vibrospice_status vibrospice_inputs(vibrospice *run, const vibrospice_input **input,
                                    size_t *count) {
  return GIVE(run, input, 0, input, count);
}

vibrospice_status vibrospice_measures(vibrospice *run, const vibrospice_measure **measure,
                                      size_t *count) {
  return GIVE(run, measure, 1, measure, count);
}

vibrospice_status vibrospice_happened(vibrospice *run, const vibrospice_happening **happening,
                                      size_t *count) {
  return GIVE(run, happening, 1, happening, count);
}

vibrospice_status vibrospice_not_judged(vibrospice *run, const char *const **name, size_t *count) {
  return GIVE(run, name, 1, name, count);
}

vibrospice_status vibrospice_verdict(vibrospice *run, const vibrospice_line **line, size_t *count,
                                     int *held, const char **breach) {
  engine *e;
  vibrospice_status status = GIVE(run, line, 1, line, count);
  if (!status) status = enter(run, 0, &e);
  if (status) return status;
  if (held) *held = e->held;
  if (breach) *breach = e->breach;
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_summary(vibrospice *run, const char **json) {
  const vibrospice_line *line;
  size_t count;
  engine *e;
  if (!json) return fail(VIBROSPICE_INPUT, "json is NULL");
  vibrospice_status status = GIVE(run, line, 1, &line, &count);
  if (!status) status = enter(run, 0, &e);
  if (status) return status;
  *json = e->summary;
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_time(vibrospice *run, double *t_s, double *until_s) {
  engine *e;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (t_s) *t_s = e->t_s;
  if (until_s) *until_s = e->until_s;
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_values(vibrospice *run, const double **value, size_t *count) {
  engine *e;
  if (!value || !count) return fail(VIBROSPICE_INPUT, "a pointer for the result is NULL");
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  *value = e->value;
  *count = e->column.count;
  return leave(e, VIBROSPICE_OK);
}

/* ---- time ---- */

/* Takes rows until the answer comes. */
static vibrospice_status take_rows(engine *e, vibrospice_step step, void *context, int *halted) {
  vibrospice_status status;
  for (;;) {
    uint32_t kind;
    size_t size;
    char *data;
    status = take_answer(e, &kind, &data, &size);
    if (status) return status;
    const double *row = (const double *)(void *)data;
    const size_t count = size / sizeof *row;
    if (kind == VIBROSPICE_ROW) *halted = step(context, row, count) != 0;
    if (kind == VIBROSPICE_OK && count == e->column.count) {
      memcpy(e->value, row, size);
      e->t_s = row[0];
    }
    free(data);
    if (kind == VIBROSPICE_OK) return VIBROSPICE_OK;
    if (!ask(e->socket, *halted ? VIBROSPICE_HALT : VIBROSPICE_GO, NULL, 0, NULL, -1))
      return engine_died(e);
  }
}

/* After a failure there is no run any more, but the engine may still be there. */
static vibrospice_status end_of_call(engine *e, vibrospice_status status) {
  if (status && status != VIBROSPICE_STOPPED) e->phase = OVER;
  return leave(e, status);
}

static vibrospice_status run_to(vibrospice *run, double t_s, int to_end, vibrospice_step step,
                                void *context) {
  engine *e;
  int halted = 0;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY) return leave(e, fail(VIBROSPICE_ORDER, "the run is over"));
  if (to_end) t_s = e->until_s;
  if (!(t_s > e->t_s))
    return leave(e, fail(VIBROSPICE_TIME, "%.9g s is not behind the run's time, %.9g s%s", t_s,
                         e->t_s, t_s < e->t_s ? "; a saved state goes back" : ""));
  if (t_s > e->until_s)
    return leave(e, fail(VIBROSPICE_TIME, "%.9g s is behind the run's end, run.until = %.9g s", t_s,
                         e->until_s));
  if (e->socket < 0) return leave(e, fail(VIBROSPICE_ENGINE, "the engine has ended"));
  const vibrospice_ask_run question = {t_s, step != NULL, 0};
  e->phase = UNDER_WAY;
  if (!ask(e->socket, VIBROSPICE_ASK_RUN, &question, sizeof question, NULL, -1))
    return leave(e, engine_died(e));
  status = take_rows(e, step, context, &halted);
  if (!status && halted)
    status = fail(VIBROSPICE_STOPPED, "t = %.9g s: stopped by the callback", e->t_s);
  return end_of_call(e, status);
}

vibrospice_status vibrospice_run_to(vibrospice *run, double t_s, vibrospice_step step,
                                    void *context) {
  return run_to(run, t_s, 0, step, context);
}

vibrospice_status vibrospice_run_on(vibrospice *run, vibrospice_step step, void *context) {
  return run_to(run, 0, 1, step, context);
}

vibrospice_status vibrospice_finish(vibrospice *run) {
  engine *e;
  char *text;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY)
    return leave(
        e, fail(VIBROSPICE_ORDER, e->phase == OVER ? "the run is over" : "the run is finished"));
  status = ask_for(e, VIBROSPICE_ASK_FINISH, NULL, 0, NULL, &text);
  if (status) return end_of_call(e, status);
  e->result = text;
  if (!take_lines(e, text)) return end_of_call(e, no_memory());
  join_lines(e);
  e->phase = FINISHED;
  e->t_s = e->until_s;
  return leave(e, VIBROSPICE_OK);
}

/* ---- states ---- */

/* Makes a copy of the engine `of`, as `to`. */
static vibrospice_status copy_engine(engine *of, engine *to) {
  int ends[2];
  uint32_t kind;
  size_t size;
  char *text;
  if (of->socket < 0) return fail(VIBROSPICE_ENGINE, "the engine has ended");
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
    return fail(VIBROSPICE_MEMORY, "no socket: %s", strerror(errno));
  to->socket = ends[0];
  int asked = ask(of->socket, VIBROSPICE_ASK_COPY, NULL, 0, NULL, ends[1]);
  close(ends[1]);
  if (!asked) return engine_died(of);
  vibrospice_status status = take_answer(of, &kind, &text, &size);
  free(text);
  if (!status) {
    status = take_answer(to, &kind, &text, &size); /* the copy's own */
    free(text);
  }
  return status;
}

/* Makes `to`, which begins as zeros, a copy of `of`: the process, and what is known of it. */
static vibrospice_status copy_all(engine *of, engine *to) {
  to->socket = -1;
  char *text = strdup(of->described);
  vibrospice_status status = text ? take_description(to, text) : no_memory();
  if (!status) status = copy_engine(of, to);
  if (status) {
    end_process(to);
    free_texts(to);
    return status;
  }
  memcpy(to->value, of->value, of->column.count * sizeof *of->value);
  to->t_s = of->t_s;
  to->phase = of->phase;
  return VIBROSPICE_OK;
}

/* Puts `from` in the place of what is behind the handle of `e`. */
static void become(engine *e, const engine *from) {
  const engine before = *e;
  end_process(e);
  free_texts(e);
  *e = *from;
  e->number = before.number;
  e->busy = 1;
  e->is_state = before.is_state;
  e->owner = before.owner;
}

vibrospice_status vibrospice_save(vibrospice *run, vibrospice_state **state) {
  engine *e, copy = {0};
  if (!state) return fail(VIBROSPICE_INPUT, "state is NULL");
  *state = NULL;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY)
    return leave(e, fail(VIBROSPICE_ORDER, "the run is over, and there is nothing to save"));
  engine *saved = take_place(1);
  if (!saved) return leave(e, no_memory());
  status = copy_all(e, &copy);
  if (status) {
    free_place(saved);
    return leave(e, status);
  }
  become(saved, &copy);
  *state = handle_of(saved);
  leave(saved, VIBROSPICE_OK);
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_restore(vibrospice *run, vibrospice_state *state) {
  engine *e, *saved, copy = {0};
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  status = enter(state, 1, &saved);
  if (status) return leave(e, status);
  status = copy_all(saved, &copy);
  if (!status) become(e, &copy);
  leave(saved, VIBROSPICE_OK);
  return leave(e, status);
}
