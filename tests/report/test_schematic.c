/* SPDX-License-Identifier: GPL-3.0-or-later
 * The schematic of a deck shows the netlist: what its wires connect is read back from the picture,
 * of the decks that ship and of random circuits. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "mutate.h"
#include "netlist/netlist.h"
#include "program.h"
#include "report/schematic.h"
#include "report/schematic_circuit.h"

enum { MOST = 400, LEAD = 30, BODY = 12 };

typedef struct picture {
  int wire[MOST][4], wires;
  int dot[MOST][2], dots;
  int middle[MOST][2], turn[MOST], symbols;
  char name[MOST][64];
  int group[3 * MOST]; /* of each wire, then of both ends of each symbol */
} picture;

/* ---- the picture, read back ---- */

static void read_picture(const char *svg, picture *p) {
  char *all = vs_copy(svg), *rest = all, *line;
  bool named = true;
  memset(p, 0, sizeof *p);
  while ((line = strsep(&rest, "\n"))) {
    int *w = p->wire[p->wires], *d = p->dot[p->dots], *m = p->middle[p->symbols];
    const char *text = strstr(line, "stroke=\"none\">");
    if (sscanf(line, "<path d=\"M%d,%dL%d,%d\"/>", &w[0], &w[1], &w[2], &w[3]) == 4) p->wires++;
    if (sscanf(line, "<circle cx=\"%d\" cy=\"%d\"", &d[0], &d[1]) == 2) p->dots++;
    if (sscanf(line, "<path transform=\"translate(%d,%d) rotate(%d)\"", &m[0], &m[1],
               &p->turn[p->symbols]) == 3) {
      p->symbols++;
      named = false;
    } else if (text && !named && !strncmp(line, "<text", 5)) {
      sscanf(text, "stroke=\"none\">%63[^<]", p->name[p->symbols - 1]);
      named = true;
    }
  }
  free(all);
}

static void end_at(const picture *p, int symbol, int end, int at[2]) {
  static const int COS[4] = {1, 0, -1, 0}, SIN[4] = {0, 1, 0, -1};
  const int quarter = p->turn[symbol] / 90, along = end ? LEAD : -LEAD;
  at[0] = p->middle[symbol][0] + along * COS[quarter];
  at[1] = p->middle[symbol][1] + along * SIN[quarter];
}

static bool lies_on(const int w[4], int x, int y) {
  return fmin(w[0], w[2]) <= x && x <= fmax(w[0], w[2]) && fmin(w[1], w[3]) <= y &&
         y <= fmax(w[1], w[3]);
}

static void join(picture *p, int a, int b) {
  const int from = p->group[a], to = p->group[b];
  for (int k = 0; k < p->wires + 2 * p->symbols; k++)
    if (p->group[k] == from) p->group[k] = to;
}

/* Wires are connected where one ends on the other; where both go on they only cross. */
static void find_groups(picture *p) {
  for (int k = 0; k < p->wires + 2 * p->symbols; k++) p->group[k] = k;
  for (int a = 0; a < p->wires; a++) {
    for (int b = 0; b < p->wires; b++)
      for (int n = 0; n < 4; n += 2)
        if (lies_on(p->wire[b], p->wire[a][n], p->wire[a][n + 1])) join(p, a, b);
    for (int s = 0; s < 2 * p->symbols; s++) {
      int at[2];
      end_at(p, s / 2, s % 2, at);
      if (lies_on(p->wire[a], at[0], at[1])) join(p, a, p->wires + s);
    }
  }
}

/* ---- against the netlist ---- */

static const vs_circuit_element *element_of(const vs_circuit *c, const char *name) {
  for (int k = 0; k < c->n_elements; k++) {
    const vs_circuit_element *e = &c->element[k];
    if (e->drawn && (e->mains  ? !strcmp(name, "mains") || !strcmp(name, "supply")
                     : e->coil ? !strcmp(name, "EVA")
                               : vs_words_is(e->card->name, name)))
      return e;
  }
  return NULL;
}

/* Two ends have one group if and only if they have one net. */
static void expect_nets(const picture *p, const vs_circuit *c, const char *of) {
  for (int a = 0; a < 2 * p->symbols; a++)
    for (int b = 0; b < a; b++) {
      const vs_circuit_element *one = element_of(c, p->name[a / 2]),
                               *other = element_of(c, p->name[b / 2]);
      EXPECT(one && other, "%s: %s or %s is none", of, p->name[a / 2], p->name[b / 2]);
      if (!one || !other) return;
      const bool connected = p->group[p->wires + a] == p->group[p->wires + b];
      EXPECT(connected == (one->end[a % 2] == other->end[b % 2]), "%s: %s.%d and %s.%d %s", of,
             p->name[a / 2], a % 2, p->name[b / 2], b % 2, connected ? "connected" : "apart");
    }
}

/* A dot stands where a wire ends on another one's way, and nowhere on a mere crossing; no wire
 * runs through a symbol. */
static void expect_clear(const picture *p, const char *of) {
  for (int d = 0; d < p->dots; d++) {
    int group = -1;
    for (int a = 0; a < p->wires; a++) {
      if (!lies_on(p->wire[a], p->dot[d][0], p->dot[d][1])) continue;
      EXPECT(group < 0 || group == p->group[a], "%s: a dot at %d,%d joins nets", of, p->dot[d][0],
             p->dot[d][1]);
      group = p->group[a];
    }
  }
  for (int a = 0; a < p->wires; a++) {
    for (int b = 0; b < p->wires; b++)
      for (int n = 0; n < 4; n += 2) {
        const int x = p->wire[a][n], y = p->wire[a][n + 1], *w = p->wire[b];
        bool dotted = false;
        for (int d = 0; d < p->dots; d++)
          dotted = dotted || (p->dot[d][0] == x && p->dot[d][1] == y);
        const bool inside =
            lies_on(w, x, y) && (x != w[0] || y != w[1]) && (x != w[2] || y != w[3]);
        EXPECT(a == b || !inside || dotted, "%s: no dot at %d,%d", of, x, y);
      }
    for (int s = 0; s < p->symbols; s++) {
      const int *w = p->wire[a], x = p->middle[s][0], y = p->middle[s][1];
      EXPECT(fmax(w[0], w[2]) < x - BODY || fmin(w[0], w[2]) > x + BODY ||
                 fmax(w[1], w[3]) < y - BODY || fmin(w[1], w[3]) > y + BODY,
             "%s: a wire through %s", of, p->name[s]);
    }
  }
}

/* Every element of the deck is drawn once, or named below the picture. */
static void expect_all_named(const picture *p, const vs_circuit *c, const char *svg,
                             const char *of) {
  for (size_t k = 0; k < c->cards->count; k = vs_cards_next(c->cards, k)) {
    const vs_netlist_card *card = &c->cards->card[k];
    char name[64], shown[64];
    int count = 0;
    if (card->kind != VS_CARDS_ELEMENT) continue;
    snprintf(name, sizeof name, "%.*s", (int)card->name.n, card->name.at);
    snprintf(shown, sizeof shown, "%s",
             !strcasecmp(name, "vmains") ? "mains"
             : !strcasecmp(name, "xeva") ? "EVA"
                                         : name);
    for (int s = 0; s < p->symbols; s++)
      count += !strcmp(p->name[s], shown) ||
               (!strcmp(shown, "mains") && !strcmp(p->name[s], "supply")); /* direct voltage */
    const char *note = strstr(svg, "Not drawn");
    const char *said = note ? strstr(note, name) : NULL;
    EXPECT(count == 1 || (!count && said), "%s: %s is drawn %d times", of, name, count);
  }
}

/* Draws the deck twice and reads the picture back; false: there is none. */
static bool expect_true_picture(const char *path, picture *p) {
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_circuit *c = vs_alloc(1, sizeof *c);
  vs_error err = {0};
  vs_html svg = {0}, again = {0};
  vs_text why = {0};
  bool drawn = !vs_netlist_read(path, deck, &err) && !vs_netlist_read_parts(deck, NULL, &err);
  EXPECT(drawn, "%s", err.text);
  drawn = drawn && vs_schematic_draw(deck, NULL, NULL, 0, &svg, &why);
  if (drawn) {
    vs_schematic_draw(deck, NULL, NULL, 0, &again, &why);
    EXPECT(!strcmp(svg.text.text, again.text.text), "%s: two pictures", path);
    CU_ASSERT(vs_schematic_circuit_read(deck, c, &why));
    read_picture(svg.text.text, p);
    find_groups(p);
    expect_nets(p, c, path);
    expect_clear(p, path);
    expect_all_named(p, c, svg.text.text, path);
    vs_schematic_circuit_free(c);
  }
  vs_html_free(&svg);
  vs_html_free(&again);
  vs_text_free(&why);
  vs_deck_free(deck);
  free(deck);
  free(c);
  return drawn;
}

static void see_deck(void *ctx, const char *path) {
  picture *p = ctx;
  EXPECT(expect_true_picture(path, p) && p->symbols > 3, "%s has no schematic", path);
}

static void shipped_decks(void) {
  picture *p = vs_alloc(1, sizeof *p);
  vs_path_list(&vs_deck_shelf, see_deck, p);
  CU_ASSERT(p->symbols > 0);
  free(p);
}

/* Circuits of 3 to 9 nets with up to 24 elements between them at random, from a fixed seed. */
static void random_circuits(void) {
  enum { CIRCUITS = 150 };
  picture *p = vs_alloc(1, sizeof *p);
  uint64_t state = 45;
  int drawn = 0;
  for (int n = 0; n < CIRCUITS; n++) {
    vs_text deck = {0};
    vs_text_add(&deck, "*$ port mains = Vmains\nVmains 1 0 external\nXeva 2 0 eva\n"
                       ".subckt box a b c\nR1 a b 1\nR2 b c 1\n.ends\n");
    const int nets = 3 + (int)mutate_below(&state, 7), elements = 3 + (int)mutate_below(&state, 22);
    for (int k = 0; k < elements; k++) {
      const int a = (int)mutate_below(&state, (size_t)nets);
      const int b = (a + 1 + (int)mutate_below(&state, (size_t)nets - 1)) % nets;
      const char letter = "RCLDXV"[mutate_below(&state, 6)];
      if (letter == 'X')
        vs_text_add(&deck, "X%d %d %d %d box\n", k, a, b, (int)mutate_below(&state, (size_t)nets));
      else
        vs_text_add(&deck, letter == 'V' ? "%c%d %d %d 0\n" : "%c%d %d %d 1\n", letter, k, a, b);
    }
    write_file("random.cir", deck.text);
    vs_text_free(&deck);
    drawn += expect_true_picture("random.cir", p);
  }
  EXPECT(drawn > CIRCUITS / 2, "%d of %d drawn", drawn, CIRCUITS);
  free(p);
}

/* What cannot be shown is refused, or told below the picture. */
static void refused(void) {
  static const char HEAD[] =
      "*$ port mains = Vmains\nVmains 1 0 external\nXeva 2 0 eva\nR1 1 2 1\n";
  static const struct {
    const char *more, *says;
  } BAD[] = {
      {"T1 1 0 2 0 z0=50 td=1n\n", "no symbol stands for T1"},
      {".param on=1\n.if (on==1)\nR2 1 2 5\n.endif\n", "(.if)"},
  };
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char text[512];
    snprintf(text, sizeof text, "%s%s", HEAD, BAD[k].more);
    write_file("bad.cir", text);
    ran r = run("plot bad.cir");
    EXPECT(r.status == 2 && strstr(r.err, BAD[k].says), "%d %s", r.status, r.err);
    free_ran(&r);
  }
  char text[512];
  snprintf(text, sizeof text, "%sL1 1 2 1m\nL2 2 0 1m\nK1 L1 L2 0.9\nRsense 2 9 1\n", HEAD);
  write_file("told.cir", text);
  RUN_GOOD("plot told.cir --quiet");
  char *svg = read_file("told.svg");
  EXPECT(strstr(svg, "couplings of inductors: K1.") && strstr(svg, "main circuit: Rsense."), "%s",
         svg);
  free(svg);
  ran r = run("plot triac_feeder.cir -o x.png");
  EXPECT(r.status == 2 && strstr(r.err, "ends in .svg"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* The command writes it, the listing has it, and a run's page colours its parts. */
static void where_it_stands(void) {
  RUN_GOOD("plot triac_feeder.cir --quiet");
  char *svg = read_file("triac_feeder.svg");
  EXPECT(strstr(svg, ">BT137-800<") && strstr(svg, ">47 nF<") && !strstr(svg, "#d55e00"), "%s",
         svg);
  free(svg);
  ran r = run("list decks --json");
  EXPECT(r.status == 0 && strstr(r.out, "\"schematic\": \"<svg "), "%d %.200s", r.status, r.out);
  free_ran(&r);
  if (!on_path("gnuplot")) return;
  RUN_GOOD("run triac_feeder --set run.until=20ms --set circuit.c1=100nF "
           "--set run.verify=never -o t --quiet");
  RUN_GOOD("plot t --quiet");
  char *page = read_file("t/report.html"), *part = strstr(page, "id=\"schematic\"");
  EXPECT(part && strstr(part, ">100 nF<") &&
             strstr(part, "stroke=\"#0072b2\" stroke-width=\"2.2\""),
         "%.900s", part ? part : page);
  EXPECT(!strstr(page, "What the scene's events add"), "events");
  free(page);
  /* of another deck of that name, which stands in its place, there is none */
  write_file("triac_feeder", "* mine\n");
  RUN_GOOD("plot t --quiet");
  page = read_file("t/report.html");
  EXPECT(!strstr(page, "id=\"schematic\""), "a picture of another deck");
  free(page);
  unlink("triac_feeder");
}

/* Each device of the shipped decks that is an element is told as that one. */
static void devices(void) {
  static const struct {
    const char *deck, *device, *element;
  } ROWS_OF[] = {{"triac_feeder", "triac", "Xthy"},
                 {"triac_feeder", "varistor", "Xv1"},
                 {"triac_feeder", "fuse_1", "Xf1"},
                 {"triac_feeder", "r1", "R1"},
                 {"triac_feeder", "c1", "C1"},
                 {"halfwave_paper", "fuse_1", "Xf1"},
                 {"halfwave_paper", "fuse_2", "Xf2"},
                 {"halfwave_paper", "varistor_3", "Xv3"},
                 {"halfwave_snubbed", "varistor_1", "Xv1"},
                 {"halfwave_snubbed", "c2", "C2"},
                 {"fullwave_antiparallel", "t2", "Xt2"},
                 {"bridge_halfcontrolled", "c1_t2", "C1two"},
                 {"chopper", "diode", "Xdiode"},
                 {"chopper", "link", "Xlink"},
                 {"bridge_link", "s3", "X3"},
                 {"bridge_link", "switch", "X2"},
                 {"bridge_link", "r_inrush", "Rinrush"}};
  for (size_t k = 0; k < COUNT(ROWS_OF); k++) {
    vs_deck *deck = vs_alloc(1, sizeof *deck);
    vs_circuit *c = vs_alloc(1, sizeof *c);
    vs_error err = {0};
    vs_text why = {0};
    char path[VS_PATH_SIZE];
    bool found = false;
    CU_ASSERT_FATAL(vs_path_own(&vs_deck_shelf, ROWS_OF[k].deck, path));
    CU_ASSERT(!vs_netlist_read(path, deck, &err) && !vs_netlist_read_parts(deck, NULL, &err));
    CU_ASSERT(vs_schematic_circuit_read(deck, c, &why));
    for (int n = 0; n < c->n_elements; n++) {
      const vs_circuit_element *e = &c->element[n];
      if (e->device < 0 || strcmp(deck->devices[e->device].name, ROWS_OF[k].device)) continue;
      found = vs_words_is(e->card->name, ROWS_OF[k].element);
    }
    EXPECT(found, "%s: %s is not %s", ROWS_OF[k].deck, ROWS_OF[k].device, ROWS_OF[k].element);
    vs_schematic_circuit_free(c);
    vs_deck_free(deck);
    free(deck);
    free(c);
  }
}

int main(void) {
  static const vs_test TESTS[] = {
      {"shipped decks", shipped_decks},
      {"random circuits", random_circuits},
      {"refused", refused},
      {"where it stands", where_it_stands},
      {"devices", devices},
  };
  return program_suite("schematic", TESTS, COUNT(TESTS));
}
