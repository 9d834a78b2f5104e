/* SPDX-License-Identifier: GPL-3.0-or-later
 * Every message of exit status 2 says where the mistake is: the file that has to be mended, its
 * line and column; or the option of the command line. The shipped files are given mistakes, and
 * all commands. A few hundred here; with tools/test --long many more, which writes messages.csv
 * (committed in tests/long). VS_MESSAGES=N tries N of each kind, and lists what has no place. */
#include <ctype.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "mutate.h"
#include "program.h"
#include "spoilt.h"

/* ---- a bench's folder ---- */

static char *read_all(const char *path, size_t *size) {
  FILE *f = fopen(path, "rb");
  char *all = vs_alloc(1 << 22, 1);
  *size = f ? fread(all, 1, (1 << 22) - 1, f) : 0;
  if (f) fclose(f);
  return all;
}

static void write_all(const char *path, const char *text, size_t size) {
  FILE *f = fopen(path, "wb");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  CU_ASSERT_EQUAL(fwrite(text, 1, size, f), size);
  fclose(f);
}

static void copy_shipped(const char *names) {
  char list[512], *rest = list, path[1024];
  snprintf(list, sizeof list, "%s", names);
  for (char *name; (name = strsep(&rest, " "));) {
    if (!*name) continue;
    size_t size;
    snprintf(path, sizeof path, "%s/../spice/%s", VS_TEST_FOLDER, name);
    char *text = read_all(path, &size), *last = strrchr(name, '/');
    if (size) write_all(last ? last + 1 : name, text, size);
    free(text);
  }
}

static void write_texts(const char *texts) {
  while ((texts = strstr(texts, "%%% "))) {
    char name[64];
    size_t n = strcspn(texts += 4, "\n");
    snprintf(name, sizeof name, "%.*s", (int)n, texts);
    texts += n + 1;
    const char *end = strstr(texts, "%%% ");
    write_all(name, texts, end ? (size_t)(end - texts) : strlen(texts));
  }
}

static void open_bench(const spoilt_bench *b) {
  remove_tree("../bench");
  CU_ASSERT_EQUAL_FATAL(mkdir("../bench", 0777), 0);
  CU_ASSERT_EQUAL_FATAL(chdir("../bench"), 0);
  copy_shipped(b->copies);
  write_texts(b->texts);
  for (size_t k = 0; k < COUNT(b->makes) && b->makes[k]; k++) {
    ran r = run("%s", b->makes[k]);
    EXPECT(r.status == 0 || r.status == 3, "%s: %d: %s", b->makes[k], r.status, r.err);
    free_ran(&r);
  }
}

/* ---- what is said ---- */

enum { MOST_SHAPES = 2000, MOST_BENCHES = 100 };
typedef struct shape {
  char text[300], example[500];
  int count;
} shape;

/* What came of the cases of one kind. */
typedef struct count {
  const char *name;
  int tried, refused, no_place, elsewhere, no_remedy, crashed;
  int lines, exact; /* messages about mistakes of one line; those that name that line */
} count;

typedef struct campaign {
  count of[MOST_BENCHES];
  shape *shapes;
  int n_shapes, internals;
  uint64_t state;
} campaign;

/* The bytes before the message: "FILE:LINE:COLUMN: "; 0: it does not begin so. The file's bytes
 * are file_size. */
static size_t place_of(const char *line, size_t *file_size) {
  size_t end = strcspn(line, "\n");
  for (size_t k = 1; k < end; k++) {
    if (line[k] != ':' || !isdigit((unsigned char)line[k + 1])) continue;
    size_t a = k + 1;
    while (isdigit((unsigned char)line[a])) a++;
    if (line[a] != ':' || !isdigit((unsigned char)line[a + 1])) continue;
    size_t c = a + 1;
    while (isdigit((unsigned char)line[c])) c++;
    if (line[c] != ':' || line[c + 1] != ' ') continue;
    *file_size = k;
    return c + 2;
  }
  return 0;
}

static bool says_remedy(const char *line) {
  static const char *const WORDS[] = {";",      "there is",     "there are", "allowed",
                                      "wanted", "write",        "must",      "give ",
                                      "take ",  "did you mean", "expected"};
  for (size_t k = 0; k < COUNT(WORDS); k++)
    if (strstr(line, WORDS[k])) return true;
  return false;
}

static bool speaks_of_internals(const char *line) {
  static const char *const WORDS[] = {"DLL",  "dll",    "fyaml", ".so",    "assert",
                                      "src/", "(null)", "NULL",  "inpcom", "spinit"};
  for (size_t k = 0; k < COUNT(WORDS); k++)
    if (strstr(line, WORDS[k])) return true;
  return false;
}

/* Messages that differ in numbers and names alone have one shape. */
static void note(campaign *all, const char *why, const char *line, const char *what) {
  char text[300];
  size_t n = 0;
  bool quoted = false;
  n += (size_t)snprintf(text, sizeof text, "%s: ", why);
  for (const char *c = line; *c && n < sizeof text - 1; c++) {
    if (*c == '\'') quoted = !quoted;
    if (quoted && *c != '\'') continue;
    if (isdigit((unsigned char)*c)) {
      if (text[n - 1] != '0') text[n++] = '0';
    } else
      text[n++] = *c;
  }
  text[n] = '\0';
  for (int k = 0; k < all->n_shapes; k++)
    if (!strncmp(all->shapes[k].text, text, 60)) {
      all->shapes[k].count++;
      return;
    }
  if (all->n_shapes == MOST_SHAPES) return;
  shape *s = &all->shapes[all->n_shapes++];
  s->count = 1;
  snprintf(s->text, sizeof s->text, "%s", text);
  snprintf(s->example, sizeof s->example, "%s | %s", line, what);
}

/* A case: the file with the mistake, what the mistake is; true where it stands in the command line;
 * how messages of this test call the case. */
typedef struct spoiling {
  const char *file;
  mutation mistake;
  bool is_argument;
  char what[1600];
} spoiling;

/* True if the place's file has the spoilt one's last name. */
static bool is_of(const char *line, size_t file_size, const char *spoilt) {
  const char *slash = strrchr(spoilt, '/'), *name = slash ? slash + 1 : spoilt;
  size_t n = strlen(name);
  return file_size >= n && !strncmp(line + file_size - n, name, n);
}

/* Looks whether a message with a place names the line that is wrong. */
static void judge_line(campaign *all, count *of, const char *line, size_t file_size,
                       const spoiling *s) {
  if (!s->mistake.line) return;
  of->lines++;
  if (atoi(line + file_size + 1) == s->mistake.line)
    of->exact++;
  else
    note(all, "another line", line, s->what);
}

static void judge(campaign *all, count *of, const ran *r, const spoiling *s) {
  const char *what = s->what;
  of->tried++;
  char line[1200];
  const char *said = r->err;
  for (;;) { /* a warning may stand before it */
    if (!strncmp(said, "vibrospice: ", 12)) said += 12;
    if (strncmp(said, "warning: ", 9) != 0 && strncmp(said, "note: ", 6) != 0) break;
    said += strcspn(said, "\n");
    said += *said == '\n';
  }
  snprintf(line, sizeof line, "%.*s", (int)strcspn(said, "\n"), said);
  if (r->status >= 1000 && r->status != 1000 + SIGXCPU && r->status != 1000 + SIGALRM) {
    of->crashed++;
    note(all, "crashed", line, what);
  }
  if (r->status != VS_INPUT) return;
  of->refused++;
  size_t file_size = 0, place = place_of(line, &file_size);
  if (speaks_of_internals(line)) {
    all->internals++;
    note(all, "internals", line, what);
  }
  if (strncmp(line, "--", 2) != 0 && !place) {
    of->no_place++;
    note(all, "no place", line, what);
  } else if (!s->is_argument && place && !is_of(line, file_size, s->file)) {
    of->elsewhere++;
    note(all, "elsewhere", line, what);
  } else if (!s->is_argument && place)
    judge_line(all, of, line, file_size, s);
  if (!says_remedy(line)) {
    of->no_remedy++;
    note(all, "no remedy", line + place, what);
  }
}

/* ---- a case ---- */

static size_t entries(const char *const *list, size_t most) {
  size_t n = 0;
  while (n < most && list[n]) n++;
  return n;
}

/* A line of the file `args` with a mistake, without what would end the argument. */
static void spoil_argument(campaign *all, char *argument, size_t size) {
  size_t n, bytes;
  mutation mistake;
  char *text = read_all("args", &n);
  size_t at = mutate_below(&all->state, n);
  while (at && text[at - 1] != '\n') at--;
  size_t length = strcspn(text + at, "\n");
  char *made = mutate(text + at, length, &all->state, &bytes, &mistake);
  for (size_t k = 0; k < bytes; k++)
    if (made[k] == '\'' || made[k] == '\n' || !made[k]) made[k] = '?';
  snprintf(argument, size, "%s", made);
  free(made);
  free(text);
}

static void command_line(const char *command, const char *file, const char *argument, char *words,
                         size_t size) {
  const char *at = strstr(command, "FILE"), *put = file;
  if (!at && (at = strstr(command, "ARGUMENT"))) put = argument;
  if (!at)
    snprintf(words, size, "%s", command);
  else
    snprintf(words, size, "%.*s%s%s", (int)(at - command), command, put,
             at + (put == file ? strlen("FILE") : strlen("ARGUMENT")));
}

static void one_case(campaign *all, const spoilt_bench *b, count *of) {
  char words[1024], argument[400] = "";
  spoiling s = {.mistake = {"an argument", 0}};
  s.file = b->spoilt[mutate_below(&all->state, entries(b->spoilt, COUNT(b->spoilt)))];
  const char *command =
      b->commands[mutate_below(&all->state, entries(b->commands, COUNT(b->commands)))];
  s.is_argument = strstr(command, "ARGUMENT") != NULL;
  CU_ASSERT_EQUAL_FATAL(system("rm -rf ../case && cp -r ../bench ../case"), 0);
  CU_ASSERT_EQUAL_FATAL(chdir("../case"), 0);
  if (s.is_argument)
    spoil_argument(all, argument, sizeof argument);
  else {
    size_t size, bytes;
    char *text = read_all(s.file, &size);
    char *made = mutate(text, size, &all->state, &bytes, &s.mistake);
    write_all(s.file, made, bytes);
    free(made);
    free(text);
  }
  command_line(command, s.file, argument, words, sizeof words);
  snprintf(s.what, sizeof s.what, "%s:%d: %s: %s", s.file, s.mistake.line, s.mistake.name, words);
  ran r = run("%s", words);
  judge(all, of, &r, &s);
  free_ran(&r);
}

static void too_long(int number) {
  (void)number;
}

static void add_count(count *to, const count *of) {
  to->tried += of->tried;
  to->refused += of->refused;
  to->no_place += of->no_place;
  to->elsewhere += of->elsewhere;
  to->no_remedy += of->no_remedy;
  to->crashed += of->crashed;
  to->lines += of->lines;
  to->exact += of->exact;
}

static void print_count(const count *c, FILE *out) {
  fprintf(out, "%s,%d,%d,%d,%d,%d,%d,%d,%d\n", c->name, c->tried, c->refused, c->no_place,
          c->elsewhere, c->no_remedy, c->crashed, c->lines, c->exact);
}

static int by_count(const void *a, const void *b) {
  return ((const shape *)b)->count - ((const shape *)a)->count;
}

/* The counts of all benches of each name, as a table. Returns those of all. */
static count write_counts(const campaign *all, FILE *out) {
  fprintf(out, "spoilt,tried,refused,no_place,elsewhere,no_remedy,crashed,of_a_line,exact\n");
  count sum = {.name = "all"};
  for (size_t k = 0; spoilt_benches[k].name; k++) {
    count c = {.name = spoilt_benches[k].name};
    bool told = false;
    for (size_t j = 0; spoilt_benches[j].name; j++) {
      if (strcmp(spoilt_benches[j].name, c.name)) continue;
      told = told || j < k;
      add_count(&c, &all->of[j]);
    }
    add_count(&sum, &all->of[k]);
    if (!told) print_count(&c, out);
  }
  print_count(&sum, out);
  return sum;
}

static void tell_shapes(campaign *all) {
  qsort(all->shapes, (size_t)all->n_shapes, sizeof *all->shapes, by_count);
  for (int k = 0; k < all->n_shapes; k++)
    fprintf(stderr, "%5d %s\n      %s\n", all->shapes[k].count, all->shapes[k].text,
            all->shapes[k].example);
}

/* How many messages in a hundred name the very line that is wrong. Of the cases here 63 of 75 did,
 * with tools/test --long 382 of 456; the others name the line that uses what a spoilt line no
 * longer declares, or where something ends that it opens. */
enum { LEAST_EXACT = 80 };

static void every_message_has_its_place(void) {
  const char *asked = getenv("VS_MESSAGES");
  int each = asked ? atoi(asked) : getenv("VS_LONG") ? 100 : 4;
  campaign *all = vs_alloc(1, sizeof *all);
  all->shapes = vs_alloc(MOST_SHAPES, sizeof *all->shapes);
  signal(SIGXCPU, too_long);
  setrlimit(RLIMIT_CPU, &(struct rlimit){20, RLIM_INFINITY}); /* of each program that is run */
  for (size_t k = 0; spoilt_benches[k].name; k++) {
    count *c = &all->of[k];
    all->state = 20261123 + k; /* a run's folder has the program's path in it, of any length */
    open_bench(&spoilt_benches[k]);
    for (int n = 0; n < each; n++) one_case(all, &spoilt_benches[k], c);
    EXPECT(!c->no_place && !c->crashed, "%s: of %d refused %d without a place, %d crashed",
           spoilt_benches[k].name, c->refused, c->no_place, c->crashed);
  }
  EXPECT(!all->internals, "%d messages speak of internals", all->internals);
  if (asked || all->internals)
    tell_shapes(all);
  else
    for (int k = 0; k < all->n_shapes; k++)
      if (!strncmp(all->shapes[k].text, "no place", 8) || !strncmp(all->shapes[k].text, "cra", 3))
        fprintf(stderr, "    %s\n", all->shapes[k].example);
  CU_ASSERT_EQUAL(chdir("../work"), 0);
  FILE *out =
      getenv("VS_LONG") ? fopen(VS_BUILD_TREE "/tests/run/test_messages/messages.csv", "w") : NULL;
  const count sum = write_counts(all, out ? out : stdout);
  if (out) fclose(out);
  EXPECT(sum.exact * 100 >= LEAST_EXACT * sum.lines, "of %d lines that are wrong %d are named",
         sum.lines, sum.exact);
  free(all->shapes);
  free(all);
}

/* ---- by name ---- */

static void refused_at(const char *words, const char *at, const char *says) {
  refuse(words, words, at, (const char *[]){says, NULL}, __LINE__);
}

#define SCENE_OF(deck) "circuit: {deck: " deck "}\nrun: {until: 1 ms, tier: circuit}\n"
#define DECK_HEAD                                                                                  \
  "*$ port mains = Vm\n*$ port gate = Vg\n*$ param thyristor = my.inc part thyristor\n"            \
  "Vm s 0 external\nRs s a 1\nVg g b external\n"
#define PART_HEAD "*$ part thyristor \"mine\"\n"
#define GOOD_PART PART_HEAD ".subckt my a k g\nR1 a k 1k\nR2 g k 1k\n.ends\n"

/* Lines of a circuit that only ngspice finds wrong, or dies of. */
static void a_circuits_lines(void) {
  static const struct {
    const char *deck, *part, *at, *says;
  } ROWS[] = {
      {"X1 a b g thyristor\n", GOOD_PART, "d.cir:1:1: ", "has no EVA"},
      {"X1 a b g thyristor\nXe b 0 evaa\n", GOOD_PART, "d.cir:8:8: ", "did you mean 'eva'"},
      {"X1 a b g thyristor\nXe b 0 eva\n", ".subckt my a k g\nR1 a k 1k\n.ends\n",
       "my.inc:1:1: ", "which circuit.thyristor asks for"},
      {"X1 a b g thyristor\nXe b 0 eva\n", PART_HEAD "R0 a 0 1\n.subckt other a k g\n.ends\n",
       "my.inc:3:1: ", "defines no subcircuit 'my'"},
      {"X1 a b g thyristor\nXe b 0 eva\n",
       PART_HEAD ".subckt my a k g\nR1 a k 1k\nR2 g k 1k\nB1 a k I=pwl(time)\n.ends\n",
       "my.inc:5:1: ", "ngspice died of it"},
      {"X1 a b g thyristor\nXe b 0 eva\n",
       PART_HEAD ".subckt my a k g\nR1 a k 1k\nR1 a k 2k\nR2 g k 1k\n.ends\n",
       "my.inc:3:1: ", "already exists"},
      {".subckt one p\nD1 p 0 da\n.model da d\n.ends\nX1 a b g thyristor\nX2 b one\nXe b 0 eva\n",
       PART_HEAD ".subckt my a k g\nR1 a k 1k\nR2 g k 1k\nD1 a k db\n.ends\n", "my.inc:5:", "'db'"},
      {"X1 a b g thyristor\nXe b 0 eva\n",
       PART_HEAD ".subckt my a k g\nR1 a k 1k\nX2 a k g thyristor\n.ends\n",
       "my.inc:4:1: ", "subcircuit my calls itself"},
      {"X1 a b g thyristor\nB1 b 0 I=\nXe b 0 eva\n", GOOD_PART, "d.cir:8:1: ", "V=... or I=..."},
      {"X1 a b g thyristor\nR7 b 0 {r7\xff}\nXe b 0 eva\n", GOOD_PART,
       "d.cir:8:1: ", "without this line"},
      {"X1 a b g thyristor\nXe b 0 eva\n*$ probe v_ak = v(a,b) V\n"
       "*$ rating v_ak 0..thyristor.v_rrn V\n",
       GOOD_PART, "d.cir:10:1: ", "has no limit 'v_rrn'"},
      {"X1 a b g thyristor\nXe b 0 eva\n*$ probe v_ak = v(a,b) V\n"
       "*$ rating v_ak 0..thyristor.v_rrm V\n",
       GOOD_PART, "my.inc:1:", "has no line '*$ limit v_rrm"}};
  write_file("s.yaml", SCENE_OF("d.cir"));
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text deck = {0};
    vs_text_add(&deck, "%s%s", DECK_HEAD, ROWS[k].deck);
    write_file("d.cir", deck.text);
    write_file("my.inc", ROWS[k].part);
    refused_at("run s.yaml", ROWS[k].at, ROWS[k].says);
    vs_text_free(&deck);
  }
}

#define SA ".subckt sa p q"
#define SB "\n.subckt sb p q\n"
#define EIGHT ".func f1(x) {x*x*x*x*x*x*x*x}\n.func f2(x) {f1(f1(x))}\n.func f3(x) {f2(f2(x))}\n"
#define BOTH "\nX8 a 0 sa\nX9 a 0 sb\n"

/* Lines that are added to the shipped deck of 24 lines: the line that is wrong is named, not
 * another one that looks like it. */
static void the_line_itself(void) {
  static const struct {
    const char *lines, *at, *says;
  } ROWS[] = {
      {SA "\nR1 p q {1k}\n.ends" SB "R1 p q {1k\n.ends" BOTH,
       "t.cir:29:", "is not closed in its line"},
      {SA " x=1k\nR1 p q {x}\n.ends" SB "R1 p q {x}\n.ends" BOTH, "t.cir:29:9: ", "[x]"},
      {SA "\n.param x=1k\nR1 p q {x}\n.ends" SB "R1 p q {x}\n.ends" BOTH, "t.cir:30:9: ", "[x]"},
      {SA " x=1k\n.subckt in p q\nR1 p q {x}\n.ends\nX1 p q in\n.ends" SB "R1 p q {x}\n.ends" BOTH,
       "t.cir:32:9: ", "[x]"},
      {SA "\n.model nom d\nD2 p q nom\n.ends" SB "D2 p q nom\n.ends" BOTH, "t.cir:30:", "'nom'"},
      {SA "\nX9 p q s1\n.ends\n.subckt s1 p q\nV1 p m 0\nR1 m q 1k\n.ends\n.subckt s2 p q\n"
          "V1 p q 1\nV2 p q 2\n.ends\nX8 a 0 sa\nX9 a 0 s2\n",
       "t.cir:33:1: ", "check node v.x9.v1"},
      {"C9 a 0 1u ic=\n", "t.cir:25:13: ", "nothing behind it"},
      {"R9 a 0 1k tc=\n", "t.cir:25:13: ", "nothing behind it"},
      {".model nom d is=1e-14 n=\nD9 a 0 nom\n", "t.cir:25:24: ", "nothing behind it"},
      {".param p1=\n", "t.cir:25:10: ", "nothing behind it"},
      {".param p1={\n", "t.cir:25:11: ", "is not closed in its line"},
      {"B9 q9 0 V=v(a\n", "t.cir:25:12: ", "is not closed in its line"},
      {"B9 q9 0 V=v(a))\n", "t.cir:25:15: ", "is one too many"},
      {".func f9(x) {1+f9(x)}\n", "t.cir:25:16: ", "function f9 calls itself"},
      {".func f9 (x) = {if(x>1, f9 (x), 1)}\n", "t.cir:25:25: ", "function f9 calls itself"},
      {".func f9(x) {max(x,\n+ g9(x))}\n.func g9(y) {f9(y)}\nR9 a 0 1k\n",
       "t.cir:26:3: ", "function f9 calls g9, which calls f9"},
      {".param p9=1 p8={2*p7} p7={p8}\n", "t.cir:25:19: ", "parameter p8 needs p7, which needs p8"},
      {".param p9=1 P8='f9(2)'\n.func f9(x) {x*p8}\n",
       "t.cir:25:17: ", "parameter P8 calls f9, which needs P8"},
      {".param p9={p9+1}\n", "t.cir:25:12: ", "parameter p9 needs itself"},
      {"R9 a 0 1k\n.endif\n", "t.cir:26:1: ", ".endif stands here without an .if"},
      {".if (1)\nR9 a 0 1k\n.endif\n.else\nR8 a 0 1k\n.endif\n",
       "t.cir:28:1: ", ".else stands here without an .if"},
      {".elseif(1)\n", "t.cir:25:1: ", ".elseif stands here without an .if"},
      {".subckt s9 a b\nR1 a b 1\nX1 a b s9\n.ends\nX9 a 0 s9\n",
       "t.cir:27:1: ", "subcircuit s9 calls itself"},
      {".subckt s9 a b\nR1 a b 1\nX1 a b s8\n.ends\nX9 a 0 s9\n.subckt s8 a b\n"
       ".subckt s7 a b\nR1 a b 1\n.ends\nX1 a b s7\nX2 a b S9 m=2\n.ends\n",
       "t.cir:27:1: ", "subcircuit s9 calls s8, which calls s9"},
      {EIGHT ".func f4(x) {f3(f3(x))}\nR9 a 0 1k\n", "t.cir:28:1: ", "characters, and at most"},
      {EIGHT "B9 q9 0 V=f3(f3(v(a)))\n", "t.cir:28:1: ", "characters, and at most"},
      {EIGHT ".param p9={f3(f3(1))}\n", "t.cir:28:1: ", "characters, and at most"},
      {EIGHT SA "\n.func f3(x, y) {y}\nB1 p q I=f3(f3(1,2),v(p))\n.ends\n" SB
                "B1 p q I=f3(f3(v(p)))\n.ends" BOTH,
       "t.cir:34:1: ", "characters, and at most"},
      {".include ./t.cir\n", "t.cir:25:1: ", "t.cir includes itself"},
      {".lib models.lib tt\n", "t.cir:25:1: ", "sections of libraries, as tt, are not read"},
      {".lib\n", "t.cir:25:1: ", "'.include FILE' is wanted"},
      {".model csw(it=0.1)\n", "t.cir:25:1: ", "a model has a name and a type"},
      {".model sw vt = 1\n", "t.cir:25:1: ", "a model has a name and a type"},
      {".model s9\n", "t.cir:25:1: ", "a model has a name and a type"},
      {"G9 a 0 b 0\n", "t.cir:25:1: ", "as many nodes and values as such an element"},
      {"X9 a b g c thyristor\n", "t.cir:25:1: ", "Too many parameters"},
      {"X9 a b thyristor\n", "t.cir:25:1: ", "Too few parameters"}};
  size_t size;
  char *deck = read_all(VS_TEST_FOLDER "/../spice/halfwave_bare.cir", &size);
  write_file("t.yaml", SCENE_OF("t.cir"));
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(&text, "%s%s", deck, ROWS[k].lines);
    write_file("t.cir", text.text);
    refused_at("run t.yaml", ROWS[k].at, ROWS[k].says);
    vs_text_free(&text);
  }
  free(deck);
}

/* A mistake that ngspice does not give a line for, before or behind a thousand cells, is found. */
static void in_a_large_circuit(void) {
  enum { CELLS = 1000 };
  static const struct {
    const char *line, *says;
  } WRONG[] = {{"R9 a 0 {r9\xff}", "without this line"},
               {"B9 a 0 I=pwl(time)", "ngspice died of it"}};
  size_t size;
  char *deck = read_all(VS_TEST_FOLDER "/../spice/halfwave_bare.cir", &size);
  write_file("t.yaml", SCENE_OF("t.cir"));
  for (int n = 0; n < 8; n++) {
    const bool calls = n & 1, last = n & 2;
    const char *line = WRONG[n / 4].line;
    vs_text text = {0};
    char at[32];
    vs_text_add(&text, "%s.subckt cell p q\nR1 p m 1k\nR2 m q 1k\n.ends\n", deck);
    if (!last) vs_text_add(&text, "%s\n", line);
    for (int k = 0; k < CELLS; k++)
      vs_text_add(&text, calls ? "Xc%d a 0 cell\n" : "Rc%d a 0 1k\n", k);
    if (last) vs_text_add(&text, "%s\n", line);
    write_file("t.cir", text.text);
    snprintf(at, sizeof at, "t.cir:%d:1: ", last ? 29 + CELLS : 29);
    refused_at("run t.yaml", at, WRONG[n / 4].says);
    vs_text_free(&text);
  }
  free(deck);
}

/* Writes the shipped part TYN1212 as my.inc, of which `line` (from 1) is `instead`; with another
 * line before it where `before` says so. */
static void write_my_part(int line, const char *instead, bool before) {
  size_t size;
  char *part = read_all(VS_TEST_FOLDER "/../spice/parts/TYN1212.inc", &size), *rest = part;
  vs_text text = {0};
  int n = 0;
  for (char *one; (one = strsep(&rest, "\n")) && rest;) {
    char *name = strstr(one, "tyn1212");
    if (++n == line) vs_text_add(&text, "%s\n", instead);
    if (n == line && !before) continue;
    if (*one != '.' || !name)
      vs_text_add(&text, "%s\n", one);
    else
      vs_text_add(&text, "%.*smy%s\n", (int)(name - one), one, name + strlen("tyn1212"));
  }
  write_file("my.inc", text.text);
  vs_text_free(&text);
  free(part);
}

/* A part of the user's own, in a deck that comes with the program and on the stand of `check`: the
 * place is in the part, the same for both. */
static void a_part_of_ones_own(void) {
  static const struct {
    int line;
    const char *instead, *at, *says;
    bool before;
  } ROWS[] = {
      {45, "B1 a k I=pwl(v(a),0,0,0,1)", "my.inc:45:1: ", "ngspice died of it", true},
      {45, "R1 a k {1k", "my.inc:45:8: ", "is not closed in its line", true},
      {44, ".subckt my a k", "my.inc:44:1: ", "Too many parameters", false},
      {44, ".subckt my a k g h", "my.inc:44:1: ", "Too few parameters", false},
      {45, "X1 a k g a thyristor_two_transistor", "my.inc:45:1: ", "Too many parameters", false},
      {31, "* no on_voltage", "my.inc:43:1: ", "[on_voltage] (thyristor_law.inc:", false}};
  write_file("p.yaml", "circuit: {thyristor: my.inc, deck: halfwave_bare}\n"
                       "run: {tier: circuit, until: 1 ms}\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_my_part(ROWS[k].line, ROWS[k].instead, ROWS[k].before);
    refused_at("run p.yaml", ROWS[k].at, ROWS[k].says);
    ran r = run("check my.inc");
    EXPECT(r.status == VS_INPUT && strstr(r.err, ROWS[k].at) && strstr(r.err, ROWS[k].says) &&
               !strstr(r.err, "Xdut") && !strstr(r.err, "not known"),
           "check: %d: %s", r.status, r.err);
    free_ran(&r);
  }
}

/* What a file that comes with the program misses, who includes it has to give. */
static void an_included_law(void) {
  write_file("my.inc", PART_HEAD ".include thyristor.inc\n.subckt my a k g\n"
                                 "X1 a k g thyristor_two_transistor\n.ends\n");
  write_file("d.cir", DECK_HEAD "X1 a b g thyristor\nXe b 0 eva\n");
  write_file("s.yaml", SCENE_OF("d.cir"));
  refused_at("run s.yaml", "my.inc:2:1: ", "(thyristor");
}

/* A part that comes with the program misses a parameter, which the deck has to give that takes it.
 */
static void a_shipped_part(void) {
  write_file("d.cir", DECK_HEAD "*$ param transformer = autotransformer_ideal part\n"
                                "X1 a b g thyristor\nX2 a 0 0 transformer\nXe b 0 eva\n");
  write_file("my.inc", GOOD_PART);
  write_file("s.yaml", SCENE_OF("d.cir"));
  refused_at("run s.yaml", "d.cir:7:24: ", "[line_voltage] (autotransformer_ideal.inc:");
}

/* What no deck uses is held to its own subcircuits. */
static void a_library(void) {
  write_file("my.lib", ".subckt inner a k r=1k\nR1 a k {r}\n.ends\n"
                       ".subckt outer a k\nX1 a k inner rr=2k\n.ends\n");
  ran r = run("check my.lib");
  EXPECT(r.status == VS_INPUT && strstr(r.err, "my.lib:5:14: ") &&
             strstr(r.err, "has no parameter rr"),
         "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* A key that is not there has its place where it would have to stand. */
static void keys_and_files(void) {
  write_file("s.yaml", "supply:\n  voltage: 200 V\nrun: {until: 5 ms}\n");
  refused_at("steady s.yaml", "s.yaml:1:1: ", "firing.every");
  write_file("s.yaml", "firing: {angle: 95 deg}\nrun: {until: 5 ms}\n");
  refused_at("steady s.yaml", "s.yaml:1:10: ", "write firing.every: 1");
  write_file("s.yaml", "machine: {model: solenoid}\nactuator: {law: t.csv}\n"
                       "supply: {kind: step}\nfiring: {valve: none}\n");
  write_file("t.csv", "z_mm,i_a,lambda_wb\n1,0,0\n1,1,0.5\n2,0,0\n2,1,0.3\n");
  refused_at("run s.yaml", "t.csv:1:1: ", "the number of gaps is 2");
  write_file("s.yaml", "run: {until: 1 s}\nload: {density: 1 \n");
  refused_at("run s.yaml", "s.yaml:3:1: ", "between [ and ]");
}

/* The files of a study's folder. */
static void a_studys_files(void) {
  write_file("y.yaml", "scene: paper\nset: {run.until: 1 ms, run.tier: switched}\n"
                       "vary: {firing.angle: [90 deg, 100 deg]}\n");
  RUN_GOOD("study y.yaml -o d --jobs 1 --quiet");
  RUN_GOOD("study y.yaml -o one --shard 1/2 --jobs 1 --quiet");
  refused_at("merge one -o whole", "merge: ", "shard 2 of 2 is missing");
  write_file("d/study.csv", "");
  refused_at("plot d", "d/study.csv:1:1: ", "the file is empty");
  write_file("one/journal", "nothing\n");
  refused_at("merge one -o whole", "one/journal:1:1: ", "is no journal of a study");
}

int main(void) {
  static const vs_test TESTS[] = {{"lines of a circuit", a_circuits_lines},
                                  {"the line itself", the_line_itself},
                                  {"in a large circuit", in_a_large_circuit},
                                  {"a part of one's own", a_part_of_ones_own},
                                  {"a law that is included", an_included_law},
                                  {"a part that is shipped", a_shipped_part},
                                  {"a library", a_library},
                                  {"keys, and files by lines", keys_and_files},
                                  {"files of a study", a_studys_files},
                                  {"every message has its place", every_message_has_its_place}};
  return program_suite("messages", TESTS, COUNT(TESTS));
}
