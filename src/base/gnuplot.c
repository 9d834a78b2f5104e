/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/gnuplot.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"

/* ---- scripts ---- */

void vs_gnuplot_code(vs_script *script, const char *code) {
  vs_text_add(&script->text, "%s", code);
}

void vs_gnuplot_free(vs_script *script) {
  vs_text_free(&script->text);
}

/* gnuplot 5.4 does not read a string that begins with two single quotes as its manual says, and in
 * names of files not at all. In double quotes, what is no plain character stands as its number in
 * octal, so that none ends the string, begins a command of the shell (a backtick) or escapes. */
void vs_gnuplot_quoted(vs_script *script, const char *text) {
  static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              " .,:;/+-=()[]_<>|*#&!?^~";
  char shown[VS_SHOWN_SIZE];
  vs_gnuplot_code(script, "\"");
  while (*text) {
    const bool blank = *text == '\n' || *text == '\t';
    text += vs_text_next(text, shown);
    for (const char *s = blank ? " " : shown; *s; s++)
      vs_text_add(&script->text, (unsigned char)*s >= 0x80 || strchr(PLAIN, *s) ? "%c" : "\\%03o",
                  (unsigned char)*s);
  }
  vs_gnuplot_code(script, "\"");
}

/* A letter of a sans font of that size is 0.68 of it wide in the mean, as measured on a title. */
void vs_gnuplot_caption(vs_script *script, const char *text, int pixels, int size) {
  vs_text caption = {0};
  vs_text_add(&caption, "%s", text);
  vs_text_shorten(&caption, (size_t)fmax(pixels / (0.7 * size), 8));
  vs_gnuplot_quoted(script, caption.text);
  vs_text_free(&caption);
}

void vs_gnuplot_word(vs_script *script, const char *text) {
  vs_gnuplot_code(script, "\"");
  for (const char *s = text; *s; s++) {
    const bool breaks = (unsigned char)*s < 0x20 || *s == 0x7f || *s == '\\';
    vs_text_add(&script->text, "%c", breaks ? ' ' : *s == '"' ? '\'' : *s);
  }
  vs_gnuplot_code(script, "\"");
}

void vs_gnuplot_path(vs_script *script, const char *path) {
  vs_text name = {0};
  vs_text_add(&name, "%s%s", *path == '/' ? "" : "./", path);
  vs_gnuplot_quoted(script, name.text);
  vs_text_free(&name);
}

static void write_text(void *script, const char *text) {
  vs_gnuplot_quoted(script, text);
}

void vs_gnuplot_add(vs_script *script, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vs_text_add_by(&script->text, write_text, script, format, args);
  va_end(args);
}

/* ---- the process ---- */

static void become_gnuplot(FILE *in, FILE *out, FILE *said) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  dup2(fileno(in), STDIN_FILENO);
  dup2(fileno(said), STDERR_FILENO);
  if (out) dup2(fileno(out), STDOUT_FILENO);
  setenv("GNUTERM", "dumb", 1);
  execlp("gnuplot", "gnuplot", "--default-settings", "-", (char *)NULL);
  _exit(127);
}

/* Passes on what gnuplot said on standard error, except its warnings that a range is empty: it
 * gives each curve that is constant a range of its own, and says so for every picture. */
static void hand_on(FILE *said) {
  static const char *const EMPTY[] = {"Warning: empty x range", "Warning: empty y range"};
  char line[1024];
  rewind(said);
  while (fgets(line, sizeof line, said)) {
    const char *word = line + strspn(line, " \t");
    bool empty = *word == '\n';
    for (size_t k = 0; k < sizeof EMPTY / sizeof *EMPTY; k++)
      empty = empty || !strncmp(word, EMPTY[k], strlen(EMPTY[k]));
    if (!empty) fputs(line, stderr);
  }
}

/* Files, not pipes: neither side then waits for the other to read. */
static vs_status run_with_files(const char *script, FILE *in, FILE *out, FILE *said,
                                vs_error *err) {
  if (fputs(script, in) < 0 || fflush(in) || fseek(in, 0, SEEK_SET))
    return vs_fail(err, VS_RUN, "no script for gnuplot: %s", strerror(errno));
  fflush(NULL);
  pid_t child = fork();
  if (child < 0) return vs_fail(err, VS_RUN, "gnuplot cannot be started: %s", strerror(errno));
  if (child == 0) become_gnuplot(in, out, said);
  int how = 0;
  while (waitpid(child, &how, 0) < 0 && errno == EINTR) {
  }
  hand_on(said);
  if (WIFEXITED(how) && WEXITSTATUS(how) == 127)
    return vs_fail(err, VS_RUN, "gnuplot is not installed (Debian package gnuplot-nox)");
  if (WIFSIGNALED(how))
    return vs_fail(err, VS_RUN, "gnuplot ended by signal %d (%s)", WTERMSIG(how),
                   strsignal(WTERMSIG(how)));
  return how ? vs_fail(err, VS_RUN, "gnuplot failed (status %d)", WEXITSTATUS(how)) : VS_OK;
}

/* All of a file from its beginning. */
static vs_status read_whole(FILE *file, char **text, size_t *size, vs_error *err) {
  long length = fseek(file, 0, SEEK_END) ? -1 : ftell(file);
  if (length <= 0) return vs_fail(err, VS_RUN, "gnuplot drew nothing");
  rewind(file);
  *text = vs_alloc((size_t)length + 1, 1);
  *size = fread(*text, 1, (size_t)length, file);
  if (*size == (size_t)length) return VS_OK;
  free(*text);
  *text = NULL;
  return vs_fail(err, VS_RUN, "what gnuplot drew cannot be read: %s", strerror(errno));
}

/* A file in memory, which has no name that somebody else could have taken. */
static FILE *nameless(void) {
  int fd = memfd_create("vibrospice", MFD_CLOEXEC);
  FILE *file = fd < 0 ? NULL : fdopen(fd, "w+");
  if (fd >= 0 && !file) close(fd);
  return file;
}

static vs_status run_gnuplot(const char *script, FILE *out, vs_error *err) {
  FILE *in = nameless(), *said = nameless();
  vs_status status = in && said
                         ? run_with_files(script, in, out, said, err)
                         : vs_fail(err, VS_RUN, "no script for gnuplot: %s", strerror(errno));
  if (in) fclose(in);
  if (said) fclose(said);
  return status;
}

vs_status vs_gnuplot_picture(const char *script, char **picture, size_t *size, vs_error *err) {
  *picture = NULL;
  FILE *out = nameless();
  if (!out) return vs_fail(err, VS_RUN, "no room for a picture: %s", strerror(errno));
  vs_status status = run_gnuplot(script, out, err);
  if (!status) status = read_whole(out, picture, size, err);
  fclose(out);
  return status;
}

vs_status vs_gnuplot_draw(const char *script, const char *folder, const char *name, bool quiet,
                          vs_error *err) {
  vs_file file = {0};
  char *picture = NULL;
  size_t size = 0;
  vs_status status = vs_gnuplot_picture(script, &picture, &size, err);
  if (!status) status = vs_file_open(&file, folder, name, err);
  if (!status) {
    fwrite(picture, 1, size, file.stream); /* an error stays in the stream */
    status = vs_file_commit(&file, err);
  }
  if (!status && !quiet) printf("%s\n", file.path);
  vs_file_discard(&file);
  free(picture);
  return status;
}
