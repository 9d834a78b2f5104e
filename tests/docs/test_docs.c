/* SPDX-License-Identifier: GPL-3.0-or-later
 * The pages of docs/ about machines, circuits, fits, instruments, control, parts and
 * devices: their files
 * are written, their commands run, and what they say that is printed must be printed. A page's
 * blocks are taken in their order:
 *
 *   yaml, first line "# NAME.yaml"   becomes that file; python, "# NAME.py", likewise
 *   spice, first line "* NAME.EXT: " becomes that file
 *   sh                               each line that begins with "vibrospice " is run and must end
 *                                    well, or with N where its comment is "# exit status N"
 *   text                             each line must stand in what was printed since the last such
 *                                    block */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "program.h"

#define DOCS VS_TEST_FOLDER "/../docs/"

static bool gnuplot_is_here(void) {
  return system("command -v gnuplot >/dev/null 2>&1") == 0;
}

/* What is read of a page, and what its commands printed. */
typedef struct page {
  const char *name;
  vs_text said;
  int files, commands, lines;
} page;

static void take_file(page *p, const char *text) {
  char name[64];
  size_t n = strspn(text + 2, "abcdefghijklmnopqrstuvwxyz_0123456789");
  const char *ending = text + 2 + n;
  if (strncmp(text, "# ", 2) || !n || n > 50) return;
  if (strncmp(ending, ".yaml", 5) && strncmp(ending, ".py", 3)) return;
  snprintf(name, sizeof name, "%.*s%s", (int)n, text + 2, ending[1] == 'y' ? ".yaml" : ".py");
  write_file(name, text);
  p->files++;
}

static void take_netlist(page *p, const char *text) {
  char name[64];
  if (sscanf(text, "* %63[a-z_.]:", name) != 1) return;
  write_file(name, text);
  p->files++;
}

static void run_line(page *p, char *line) {
  const char *wanted = strstr(line, "# exit status ");
  int status = wanted ? atoi(wanted + strlen("# exit status ")) : 0;
  line[strcspn(line, "#>")] = '\0';
  p->commands++;
  if (strstr(line, " plot ") && !gnuplot_is_here()) return;
  ran r = run("%s", line + strlen("vibrospice "));
  EXPECT(r.status == status, "%s: %s: status %d, not %d: %s", p->name, line, r.status, status,
         r.err);
  vs_text_add(&p->said, "%s%s", r.out, r.err);
  free_ran(&r);
}

static void run_lines(page *p, char *text) {
  for (char *line; (line = strsep(&text, "\n"));)
    if (!strncmp(line, "vibrospice ", strlen("vibrospice ")))
      run_line(p, line);
    else if (!strncmp(line, "printf ", strlen("printf "))) /* a file of a few numbers */
      EXPECT(system(line) == 0, "%s: %s", p->name, line);
}

/* True if it was printed as a whole line, blanks at its ends aside. A line of a page is cut off
 * where
 * "... " begins it or " ..." ends it. */
static bool was_said(const char *said, const char *line) {
  static const char CUT[] = " ...", BEGUN[] = "... ";
  size_t n = strlen(line);
  const bool begun = !strncmp(line, BEGUN, strlen(BEGUN));
  if (begun) line += strlen(BEGUN), n -= strlen(BEGUN);
  const bool cut = n > strlen(CUT) && !strcmp(line + n - strlen(CUT), CUT);
  if (cut) n -= strlen(CUT);
  vs_text wanted = {0};
  const size_t blanks = strspn(line, " ");
  vs_text_add(&wanted, "%.*s", (int)(n - blanks), line + blanks);
  bool found = false;
  for (const char *s = said; s && !found && (s = strstr(s, wanted.text)); s++) {
    const char *from = s, *to = s + wanted.length;
    while (from > said && from[-1] == ' ') from--;
    found =
        (begun || from == said || from[-1] == '\n') && (cut || strchr("\n", to[strspn(to, " ")]));
  }
  vs_text_free(&wanted);
  return found;
}

static void expect_lines(page *p, char *text) {
  for (char *line; (line = strsep(&text, "\n"));) {
    if (!*line) continue;
    p->lines++;
    EXPECT(was_said(p->said.text, line), "%s: nothing printed '%s': %s", p->name, line,
           p->said.text ? p->said.text : "");
  }
  vs_text_free(&p->said);
  p->said = (vs_text){0};
}

/* Pictures and pages that it points to must be there. */
static void expect_links(const page *p, const char *text) {
  char to[256], path[VS_PATH_SIZE];
  const char *slash = strrchr(p->name, '/');
  int folder = slash ? (int)(slash + 1 - p->name) : 0;
  for (const char *s = text; (s = strstr(s, "](")); s++) {
    if (sscanf(s, "](%255[^)#]", to) != 1 || strstr(to, "://")) continue;
    snprintf(path, sizeof path, DOCS "%.*s%s", folder, p->name, to);
    EXPECT(!access(path, R_OK), "%s: there is no %s", p->name, to);
  }
}

static void try_page(page *p) {
  char path[VS_PATH_SIZE], kind[8];
  snprintf(path, sizeof path, DOCS "%s", p->name);
  char *text = read_file(path);
  EXPECT(*text, "there is no page %s", path);
  expect_links(p, text);
  for (char *s = text, *end; (s = strstr(s, "\n```")) && s[4]; s = end + 4) {
    char *begin = strchr(s + 4, '\n');
    bool named = sscanf(s + 4, "%7[a-z]", kind) == 1 && begin < s + 4 + sizeof kind;
    end = begin ? strstr(begin, "\n```") : NULL;
    CU_ASSERT_PTR_NOT_NULL_FATAL(end);
    char *block = vs_copy(begin + 1);
    block[end - begin] = '\0';
    if (named && (!strcmp(kind, "yaml") || !strcmp(kind, "python"))) take_file(p, block);
    if (named && !strcmp(kind, "spice")) take_netlist(p, block);
    if (named && !strcmp(kind, "sh")) run_lines(p, block);
    if (named && !strcmp(kind, "text")) expect_lines(p, block);
    free(block);
  }
  vs_text_free(&p->said);
  free(text);
}

static void machines(void) {
  page p = {.name = "machines.md"}, q = {.name = "theory.md"}; /* of the first one's bowl */
  try_page(&p);
  EXPECT(p.files >= 6 && p.commands >= 11 && p.lines >= 11, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
  try_page(&q);
  EXPECT(q.files >= 3 && q.commands >= 4 && q.lines >= 3, "%d files, %d commands, %d lines",
         q.files, q.commands, q.lines);
}

static void machines_that_ship(void) {
  page p = {.name = "machines_shipped.md"};
  try_page(&p);
  EXPECT(p.commands >= 16 && p.lines >= 18, "%d commands, %d lines", p.commands, p.lines);
}

static void fitting(void) {
  page p = {.name = "fitting.md"};
  try_page(&p);
  EXPECT(p.files >= 3 && p.commands >= 7 && p.lines >= 15, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

static void instruments(void) {
  page p = {.name = "instruments.md"};
  try_page(&p);
  EXPECT(p.files >= 4 && p.commands >= 8 && p.lines >= 11, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

static void circuits(void) {
  page p = {.name = "circuits.md"};
  try_page(&p);
  EXPECT(p.files >= 3 && p.commands >= 7 && p.lines >= 6, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

static void netlists(void) {
  page p = {.name = "from_ltspice.md"};
  try_page(&p);
  EXPECT(p.commands >= 6 && p.lines >= 4, "%d commands, %d lines", p.commands, p.lines);
}

static void decks(void) {
  page p = {.name = "decks.md"};
  try_page(&p);
  EXPECT(p.files >= 1 && p.commands >= 5 && p.lines >= 6, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

static void control(void) {
  page p = {.name = "control.md"};
  if (!on_path("python3")) return; /* its law is written in that */
  try_page(&p);
  EXPECT(p.files >= 3 && p.commands >= 7 && p.lines >= 14, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

static void parts(void) {
  page p = {.name = "parts.md"};
  try_page(&p);
  EXPECT(p.files >= 2 && p.commands >= 6 && p.lines >= 18, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

/* Pages that show a thing or two on the way. */
static void other_pages(void) {
  static const struct {
    const char *name;
    int files, commands;
  } PAGES[] = {{"scenes.md", 1, 6},   {"faults.md", 1, 2},          {"accuracy.md", 0, 1},
               {"tutorial.md", 2, 9}, {"strangers.md", 1, 2},       {"hardening.md", 0, 0},
               {"glossary.md", 0, 0}, {"troubleshooting.md", 0, 1}, {"verdict.md", 2, 3}};
  for (size_t k = 0; k < COUNT(PAGES); k++) {
    page p = {.name = PAGES[k].name};
    try_page(&p);
    EXPECT(p.files == PAGES[k].files && p.commands == PAGES[k].commands,
           "%s: %d files, %d commands", p.name, p.files, p.commands);
  }
}

static void studies(void) {
  page p = {.name = "studies.md"};
  try_page(&p);
  EXPECT(p.files >= 3 && p.commands >= 2 && p.lines >= 2, "%d files, %d commands, %d lines",
         p.files, p.commands, p.lines);
}

static void install(void) {
  page p = {.name = "install.md"};
  try_page(&p);
  EXPECT(p.commands >= 7 && p.lines >= 1, "%d commands, %d lines", p.commands, p.lines);
}

static void devices(void) {
  page p = {.name = "devices.md"};
  try_page(&p);
  EXPECT(p.commands >= 2 && p.lines >= 4, "%d commands, %d lines", p.commands, p.lines);
}

static void pictures(void) {
  page p = {.name = "pictures.md"};
  try_page(&p);
  EXPECT(p.commands >= 3 && p.lines >= 3, "%d commands, %d lines", p.commands, p.lines);
}

static const vs_test TESTS[] = {
    {"machines.md", machines}, {"machines_shipped.md", machines_that_ship},
    {"fitting.md", fitting},   {"instruments.md", instruments},
    {"control.md", control},   {"circuits.md", circuits},
    {"from_ltspice.md", netlists}, {"decks.md", decks},
    {"parts.md", parts},       {"other pages", other_pages},
    {"studies", studies},      {"install.md", install},
    {"devices.md", devices},   {"pictures.md", pictures},
};

int main(void) {
  return program_suite("docs", TESTS, COUNT(TESTS));
}
