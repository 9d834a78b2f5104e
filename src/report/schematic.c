/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/schematic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "members.h"
#include "netlist/netlist.h"
#include "report/scale.h"
#include "run_pair.h"
#include "schematic_circuit.h"

/* In pixels: the lead of a symbol on either side of its middle, the room of a symbol along and
 * across its branch, margins, letters. */
enum { LEAD = 30, ALONG = 84, ACROSS = 76, SHUNT = 74, EDGE = 24, LETTER = 6, LINE = 13 };

enum { NET_MOST = VS_CIRCUIT_MOST, LABEL = 3 /* lines beside a symbol */, WIRES = 600 };

/* ---- symbols: from x = -30 to 30, the current that counts from left to right ---- */

#define LEADS(half) "M-30,0H-" #half "M" #half ",0H30"
#define BOX "M-16,-9H16V9H-16Z"

static const struct {
  const char *name, *path;
} SYMBOLS[] = {
    {"r", LEADS(18) "M-18,-7H18V7H-18Z"},
    {"c", LEADS(4) "M-4,-12V12M4,-12V12"},
    {"l", "M-30,0H-21a7,7 0 0 1 14,0a7,7 0 0 1 14,0a7,7 0 0 1 14,0H30"},
    {"coil", "M-30,0H-21a7,7 0 0 1 14,0a7,7 0 0 1 14,0a7,7 0 0 1 14,0H30M-21,-11H21M-21,-14H21"},
    {"mains", LEADS(13) "M-13,0a13,13 0 1 1 26,0a13,13 0 1 1 -26,0M-7,0q3.5,-9 7,0t7,0"},
    {"supply", "M-30,0H-4M-4,-7V7M4,-14V14M4,0H30"},
    {"v", LEADS(13) "M-13,0a13,13 0 1 1 26,0a13,13 0 1 1 -26,0M-10,0H-4M-7,-3V3M5,-3V3"},
    {"i", LEADS(13) "M-13,0a13,13 0 1 1 26,0a13,13 0 1 1 -26,0M-7,0H7M3,-4L7,0L3,4"},
    {"controlled", LEADS(14) "M-14,0L0,-13L14,0L0,13ZM-9,0H-3M-6,-3V3M6,-3V3"},
    {"controlled_i", LEADS(14) "M-14,0L0,-13L14,0L0,13ZM-7,0H7M3,-4L7,0L3,4"},
    {"diode", LEADS(9) "M-9,-10L9,0L-9,10ZM9,-10V10"},
    {"thyristor", LEADS(9) "M-9,-10L9,0L-9,10ZM9,-10V10M9,0L17,14"},
    {"triac", LEADS(9) "M-9,-15V15M9,-15V15M-9,-14L9,-7L-9,0ZM9,0L-9,7L9,14ZM9,0L18,16"},
    {"diac", LEADS(9) "M-9,-15V15M9,-15V15M-9,-14L9,-7L-9,0ZM9,0L-9,7L9,14Z"},
    {"varistor", LEADS(18) "M-18,-7H18V7H-18ZM-18,12H-10L12,-12"},
    {"fuse", "M-30,0H30M-18,-7H18V7H-18Z"},
    {"electrolytic", LEADS(4) "M-4,-12V12H-8V-12ZM4,-12V12M-18,-9H-12M-15,-12V-6"},
    {"igbt", LEADS(16) BOX "M-8,0H8M4,-4L8,0L4,4M0,9V18"},
    {"switch", LEADS(12) "M-12,0L11,-10"},
    {"", LEADS(16) BOX},
};

/* What the mains port is called: a deck that begins at its operating point is one for direct
 * voltage.
 */
static const char *supply_of(const vs_deck *deck) {
  return deck->stands ? "supply" : "mains";
}

static const char *symbol_of(const vs_deck *deck, const vs_circuit_element *e) {
  const char letter[2] = {e->card->letter, '\0'};
  const char *name = e->mains                           ? supply_of(deck)
                     : e->coil                          ? "coil"
                     : *letter == 'e'                   ? "controlled"
                     : strchr("gfhb", *letter)          ? "controlled_i"
                     : strchr("sw", *letter)            ? "switch"
                     : e->kind && strchr("xd", *letter) ? e->kind->name
                     : strchr("qmjz", *letter)          ? "igbt"
                                                        : letter;
  if (e->kind && e->kind->driven) name = "igbt";
  const size_t last = sizeof SYMBOLS / sizeof *SYMBOLS - 1;
  for (size_t k = 0; k < last; k++)
    if (!strcmp(SYMBOLS[k].name, name)) return SYMBOLS[k].path;
  return SYMBOLS[last].path;
}

/* ---- what stands beside a symbol ---- */

typedef struct label {
  char line[LABEL][48];
  int lines;
  size_t longest;
  const char *colour; /* of the symbol; NULL: black */
} label;

static void add_line(label *l, const char *text, size_t n) {
  if (!n || l->lines == LABEL) return;
  vs_text shown = {0};
  vs_text_put(&shown, text, n);
  vs_text_shorten(&shown, 16);
  snprintf(l->line[l->lines++], sizeof *l->line, "%s", shown.text);
  n = vs_text_characters(shown.text);
  if (n > l->longest) l->longest = n;
  vs_text_free(&shown);
}

/* Adds the value that the scene, or else the deck, gives the parameter of that name; false: it is
 * none of the deck's. */
static bool add_parameter(const vs_deck *deck, const vs_node *values, vs_word name, label *l) {
  for (size_t k = 0; k < deck->section.count; k++) {
    const vs_field *f = &deck->section.fields[k];
    if (!f->key || !vs_words_is(name, f->key)) continue;
    const vs_node *told = vs_tree_child(values, f->key);
    vs_text text = {0};
    if (told) vs_member_text(told, &text);
    const char *shown = told ? text.text : f->default_text ? f->default_text : "";
    add_line(l, shown, strlen(shown));
    vs_text_free(&text);
    return true;
  }
  return false;
}

/* Adds the value of a resistor, capacitor, inductor or source as the netlist has it, and where that
 * is a parameter, the parameter's. */
static void add_value(const vs_deck *deck, const vs_node *values, vs_word value, label *l) {
  if (value.n > 2 && *value.at == '{' && value.at[value.n - 1] == '}') {
    value.at++;
    value.n -= 2;
  }
  if (!add_parameter(deck, values, value, l)) add_line(l, value.at, value.n);
}

static const char *colour_of(const vs_schematic_mark *m) {
  return m->bad ? vs_scale_colour_bad : m->margin < 0.2 ? "#a06000" : vs_scale_colour_good;
}

static label make_label(const vs_deck *deck, const vs_circuit *c, const vs_circuit_element *e,
                        const vs_node *values, const vs_schematic_mark *marks, size_t n_marks) {
  label l = {0};
  const char letter = e->card->letter;
  add_line(&l,
           e->mains  ? supply_of(deck)
           : e->coil ? "EVA"
                     : e->card->name.at,
           e->mains  ? strlen(supply_of(deck))
           : e->coil ? 3
                     : e->card->name.n);
  if (letter == 'x' && !e->coil) {
    if (!add_parameter(deck, values, e->card->model, &l))
      add_line(&l, e->card->model.at, e->card->model.n);
  } else if (e->card->model.n && !e->coil) {
    add_line(&l, e->card->model.at, e->card->model.n);
  } else if (strchr("rclv", letter) && !e->mains && e->card->words > 2) {
    add_value(deck, values, vs_cards_word(c->cards, e->card, 2), &l);
  }
  for (int k = 0; k < e->n_pins; k++) {
    char pin[48];
    const vs_word net = c->net[e->pin[k]];
    const size_t called = vs_cards_called(c->cards, e->card);
    const vs_netlist_card *head =
        called ? &c->cards->card[c->cards->scope[called].first - 1] : NULL;
    const vs_word name = head ? vs_cards_word(c->cards, head, (size_t)k + 2) : (vs_word){"pin", 3};
    snprintf(pin, sizeof pin, "%.*s: %.*s", (int)name.n, name.at, (int)net.n, net.at);
    add_line(&l, pin, strlen(pin));
  }
  for (size_t k = 0; k < n_marks && e->device >= 0; k++)
    if (!strcmp(marks[k].device, deck->devices[e->device].name)) {
      char margin[VS_DECK_NAME + 16];
      snprintf(margin, sizeof margin, "%s %.3g %%", marks[k].measure, 100 * marks[k].margin);
      l.colour = colour_of(&marks[k]);
      if (!isnan(marks[k].margin)) add_line(&l, margin, strlen(margin));
    }
  return l;
}

/* ---- where things stand ---- */

/* Branches between two columns lie in lanes, the first of which is the lowest; branches to a rail
 * hang below, or stand above, their column, side by side. */
typedef struct layout {
  const vs_deck *deck;
  vs_circuit c;
  label label[VS_CIRCUIT_MOST];
  int column[NET_MOST]; /* nets from left to right */
  int n_columns;
  int place[NET_MOST]; /* of a net: its column; -1: it is a rail, or not drawn */
  int lane[VS_CIRCUIT_MOST], gap[VS_CIRCUIT_MOST], shunt[VS_CIRCUIT_MOST]; /* of a branch */
  int lanes, above, below;          /* lanes; symbols in a branch to the rails */
  int x[NET_MOST], right[NET_MOST]; /* of a column: its net, and the last branch to a rail */
  int pitch, width, hang, y_top,    /* hang: from a column down to its first symbol's room */
      y_base, y_bottom, y_end;
  int wire[WIRES][4]; /* what has been drawn: x and y of both ends, the lesser ones first */
  int wires;
} layout;

static bool is_level(const layout *l, const vs_circuit_branch *b) {
  return l->place[b->end[0]] >= 0 && l->place[b->end[1]] >= 0;
}

static void add_column(layout *l, int net) {
  if (l->place[net] >= 0 || net == l->c.rail[0] || net == l->c.rail[1]) return;
  l->place[net] = l->n_columns;
  l->column[l->n_columns++] = net;
}

static void number_columns(layout *l) {
  for (int k = 0; k < l->n_columns; k++) l->place[l->column[k]] = k;
}

/* The sum of the lengths of all branches between columns. */
static int total_length(layout *l) {
  int sum = 0;
  number_columns(l);
  for (int k = 0; k < l->c.n_branches; k++)
    if (is_level(l, &l->c.branch[k]))
      sum += abs(l->place[l->c.branch[k].end[0]] - l->place[l->c.branch[k].end[1]]);
  return sum;
}

static void move_column(layout *l, int from, int to) {
  const int net = l->column[from], step = to > from ? 1 : -1;
  for (int k = from; k != to; k += step) l->column[k] = l->column[k + step];
  l->column[to] = net;
}

/* Orders the columns as the current from the mains meets them, then moves single ones as long as
 * that makes the branches shorter. The first one stays. */
static void order_columns(layout *l) {
  const vs_circuit *c = &l->c;
  for (int k = 0; k < NET_MOST; k++) l->place[k] = -1;
  for (int k = 0; k < c->n_branches; k++)
    for (int n = 0; n < c->branch[k].count; n++)
      if (c->element[c->branch[k].element[n]].mains)
        for (int m = 0; m < 2 && !l->n_columns; m++) add_column(l, c->branch[k].end[m]);
  for (int done = 0, any = 1; any;) {
    any = 0;
    for (; done < l->n_columns; done++)
      for (int k = 0; k < c->n_branches; k++)
        for (int m = 0; m < 2; m++)
          if (c->branch[k].end[m] == l->column[done]) add_column(l, c->branch[k].end[!m]);
    for (int k = 0; k < c->n_branches && !any; k++) /* behind a rail, or a pin */
      for (int m = 0; m < 2 && !any; m++) {
        const int before = l->n_columns;
        add_column(l, c->branch[k].end[m]);
        any = l->n_columns > before;
      }
  }
  int best = total_length(l);
  for (bool better = true; better;) {
    better = false;
    for (int from = 1; from < l->n_columns; from++)
      for (int to = 1; to < l->n_columns; to++) {
        if (from == to) continue;
        move_column(l, from, to);
        const int now = total_length(l);
        better = better || now < best;
        if (now >= best) move_column(l, to, from);
        if (now < best) best = now;
      }
  }
  number_columns(l);
}

/* The ends of a level branch as columns, the left one first. */
static void span_of(const layout *l, const vs_circuit_branch *b, int span[2]) {
  const int a = l->place[b->end[0]], z = l->place[b->end[1]];
  span[0] = a < z ? a : z;
  span[1] = a < z ? z : a;
}

static bool is_switched(const layout *l, const vs_circuit_branch *b) {
  for (int k = 0; k < b->count; k++) {
    const vs_circuit_element *e = &l->c.element[b->element[k]];
    if (e->kind && (e->kind->switches || e->kind->driven)) return true;
  }
  return false;
}

/* True where a branch may have the lane: none that has it lies over it. */
static bool is_free(const layout *l, int branch, int lane) {
  int a[2], b[2];
  span_of(l, &l->c.branch[branch], a);
  if (!lane && a[1] - a[0] > 1) return false;
  for (int k = 0; k < l->c.n_branches; k++) {
    if (l->lane[k] != lane || k == branch || !is_level(l, &l->c.branch[k])) continue;
    span_of(l, &l->c.branch[k], b);
    if (a[0] < b[1] && b[0] < a[1]) return false;
  }
  return true;
}

/* Gives each level branch a lane, short ones and those with a switch first. */
static void choose_lanes(layout *l) {
  for (int k = 0; k < l->c.n_branches; k++) l->lane[k] = -1;
  l->lanes = 1;
  for (int length = 1; length < NET_MOST; length++)
    for (int turn = 0; turn < 2; turn++)
      for (int k = 0; k < l->c.n_branches; k++) {
        const vs_circuit_branch *b = &l->c.branch[k];
        int span[2], lane = 0;
        if (!is_level(l, b) || l->lane[k] >= 0) continue;
        span_of(l, b, span);
        if (span[1] - span[0] != length || is_switched(l, b) == (turn > 0)) continue;
        while (!is_free(l, k, lane)) lane++;
        l->lane[k] = lane;
        if (lane >= l->lanes) l->lanes = lane + 1;
      }
}

/* The column of a branch that is not level; -1: it goes from rail to rail. */
static int column_of(const layout *l, const vs_circuit_branch *b) {
  return l->place[b->end[l->place[b->end[0]] < 0]];
}

/* Where such a branch stands. */
static int shunt_x(const layout *l, int k) {
  const int column = column_of(l, &l->c.branch[k]);
  return column < 0 ? l->shunt[k] : l->x[column] + l->shunt[k] * l->pitch;
}

/* True for a branch that ends at the top rail. */
static bool is_up(const layout *l, const vs_circuit_branch *b) {
  return b->end[0] == l->c.rail[0] || b->end[1] == l->c.rail[0];
}

/* How wide a branch's symbols are in a lane, with their labels. */
static int width_of(const layout *l, const vs_circuit_branch *b) {
  int width = 0;
  for (int k = 0; k < b->count; k++) {
    const int text = LETTER * (int)l->label[b->element[k]].longest + 12;
    width += text > ALONG ? text : ALONG;
  }
  return width;
}

/* Chooses the gap between two columns that a branch's symbols stand in, the widest on its way, and
 * where all columns stand. */
static void place_columns(layout *l) {
  int gap[NET_MOST] = {0}, shunts[NET_MOST][2] = {{0}};
  const vs_circuit *c = &l->c;
  for (int lane = 0; lane < l->lanes; lane++)
    for (int k = 0; k < c->n_branches; k++) {
      int span[2];
      if (l->lane[k] != lane) continue;
      span_of(l, &c->branch[k], span);
      l->gap[k] = span[0];
      for (int g = span[0]; g < span[1]; g++)
        if (gap[g] > gap[l->gap[k]]) l->gap[k] = g;
      const int width = width_of(l, &c->branch[k]);
      if (width > gap[l->gap[k]]) gap[l->gap[k]] = width;
    }
  /* those to a rail; from rail to rail in a column each */
  for (int k = 0; k < c->n_branches; k++) {
    const vs_circuit_branch *b = &c->branch[k];
    if (is_level(l, b)) continue;
    const int column = column_of(l, b);
    const bool up = is_up(l, b) && column >= 0;
    int *most = up ? &l->above : &l->below;
    if (b->count > *most) *most = b->count;
    for (int n = 0; n < b->count; n++) {
      const int text = LETTER * (int)l->label[b->element[n]].longest + 34;
      if (text > l->pitch) l->pitch = text;
    }
    if (column >= 0) l->shunt[k] = shunts[column][up]++;
  }
  int x = EDGE + 30;
  for (int k = 0; k < l->n_columns; k++) {
    const int n = shunts[k][0] > shunts[k][1] ? shunts[k][0] : shunts[k][1];
    l->x[k] = x;
    l->right[k] = x + (n > 1 ? (n - 1) * l->pitch : 0);
    x = l->right[k] + (gap[k] > l->pitch || !n ? gap[k] + 20 : l->pitch);
  }
  for (int k = 0; k < c->n_branches; k++) {
    const vs_circuit_branch *b = &c->branch[k];
    if (is_level(l, b) || column_of(l, b) >= 0) continue;
    l->shunt[k] = x;
    x += l->pitch;
  }
  l->width = x + EDGE;
}

static void make_layout(layout *l) {
  l->pitch = 60;
  order_columns(l);
  choose_lanes(l);
  place_columns(l);
  l->y_top = EDGE;
  l->y_base = EDGE + 22 + ACROSS * (l->lanes - 1) + (l->lanes > 1 ? 0 : 6);
  if (l->above) l->y_base += SHUNT * l->above + 24;
  l->hang = 24;
  for (int k = 0; k < l->c.n_elements; k++)
    if (l->label[k].lines == LABEL) l->hang = 24 + LINE;
  l->y_bottom = l->y_base + l->hang + 10 + SHUNT * (l->below ? l->below : 1);
}

/* ---- the drawing ---- */

/* True where a wire runs through the point, or away from it to that side. */
static bool runs(const int w[4], int x, int y, int dx, int dy) {
  const int far_x = x + dx, far_y = y + dy;
  return w[0] <= x && x <= w[2] && w[1] <= y && y <= w[3] && w[0] <= far_x && far_x <= w[2] &&
         w[1] <= far_y && far_y <= w[3];
}

/* Draws a level or upright wire, unless one that was drawn before covers it. */
static void draw_wire(vs_html *out, layout *l, int x, int y, int to_x, int to_y) {
  const int w[4] = {x < to_x ? x : to_x, y < to_y ? y : to_y, x < to_x ? to_x : x,
                    y < to_y ? to_y : y};
  bool covered = (x == to_x && y == to_y) || l->wires == WIRES;
  for (int k = 0; k < l->wires && !covered; k++)
    covered = runs(l->wire[k], w[0], w[1], w[2] - w[0], w[3] - w[1]);
  if (covered) return;
  memcpy(l->wire[l->wires++], w, sizeof w);
  vs_html_add(out, "<path d=\"M%d,%dL%d,%d\"/>\n", w[0], w[1], w[2], w[3]);
}

/* Draws a dot at a net's point where wires run to three sides. */
static void draw_dot(vs_html *out, const layout *l, int x, int y) {
  static const int SIDES[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  int sides = 0;
  for (int k = 0; k < 4; k++) {
    bool any = false;
    for (int n = 0; n < l->wires; n++)
      any = any || runs(l->wire[n], x, y, SIDES[k][0], SIDES[k][1]);
    sides += any;
  }
  if (sides > 2) vs_html_add(out, "<circle cx=\"%d\" cy=\"%d\" r=\"3\" fill=\"#000\"/>\n", x, y);
}

static void draw_text(vs_html *out, int x, int y, const char *anchor, const char *colour,
                      const char *text) {
  vs_html_add(out,
              "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\" fill=\"%s\" stroke=\"none\">%s</text>\n",
              x, y, anchor, colour, text);
}

/* Draws an element around a point; turn: 0, 90, 180 or 270 degrees. */
static void draw_element(vs_html *out, const layout *l, int element, int x, int y, int turn) {
  const label *text = &l->label[element];
  const char *colour = text->colour ? text->colour : "#000";
  const bool level = turn % 180 == 0;
  vs_html_add(out,
              "<path transform=\"translate(%d,%d) rotate(%d)\" stroke=\"%s\" "
              "stroke-width=\"%s\" d=\"%s\"/>\n",
              x, y, turn, colour, text->colour ? "2.2" : "1.5",
              symbol_of(l->deck, &l->c.element[element]));
  for (int k = 0; k < text->lines; k++)
    if (level)
      draw_text(out, x, k ? y + 15 + LINE * k : y - 20, "middle", colour, text->line[k]);
    else
      draw_text(out, x + 20, y + 4 + LINE * k - LINE * (text->lines - 1) / 2, "start", colour,
                text->line[k]);
}

/* Draws a branch in its lane, and its ends' ways there. */
static void draw_level(vs_html *out, layout *l, int k) {
  const vs_circuit_branch *b = &l->c.branch[k];
  int span[2];
  span_of(l, b, span);
  const bool forward = l->place[b->end[0]] == span[0];
  const int y = l->y_base - ACROSS * l->lane[k],
            from = l->lane[k] ? l->x[span[0]] : l->right[span[0]], to = l->x[span[1]];
  const int left = l->right[l->gap[k]], right = l->x[l->gap[k] + 1];
  const int each = (right - left) / b->count;
  int x = from;
  for (int n = 0; n < b->count; n++) {
    const int m = forward ? n : b->count - 1 - n, middle = left + each * n + each / 2;
    draw_wire(out, l, x, y, middle - LEAD, y);
    draw_element(out, l, b->element[m], middle, y, b->reversed[m] == forward ? 180 : 0);
    x = middle + LEAD;
  }
  draw_wire(out, l, x, y, to, y);
}

/* Draws a branch from a column to a rail, or from the top rail to the bottom one. */
static void draw_upright(vs_html *out, layout *l, int k) {
  const vs_circuit_branch *b = &l->c.branch[k];
  const bool first = l->place[b->end[0]] >= 0, from_top = is_up(l, b);
  const int net = column_of(l, b), x = shunt_x(l, k);
  const int from = from_top ? l->y_top : l->y_base,
            to = from_top && net >= 0 ? l->y_base : l->y_bottom;
  const bool downward = b->end[0] == l->c.rail[0] || (first && !from_top);
  const int begin = from_top && net < 0 ? l->y_base + l->hang : from + (from_top ? 10 : l->hang);
  int y = from;
  for (int n = 0; n < b->count; n++) {
    const int m = downward ? n : b->count - 1 - n, middle = begin + SHUNT * n + SHUNT / 2;
    draw_wire(out, l, x, y, x, middle - LEAD);
    draw_element(out, l, b->element[m], x, middle, b->reversed[m] == downward ? 270 : 90);
    y = middle + LEAD;
  }
  draw_wire(out, l, x, y, x, to);
}

static void draw_net_name(vs_html *out, const layout *l, int net, int x, int y) {
  vs_text name = {0};
  vs_text_put(&name, l->c.net[net].at, l->c.net[net].n);
  vs_text_shorten(&name, 12);
  draw_text(out, x, y, "end", "#606060", name.text);
  vs_text_free(&name);
}

/* Draws a column: its net from the lowest lane to the highest one that ends there, and the way
 * along the branches to the rails. */
static void draw_column(vs_html *out, layout *l, int column) {
  int highest = 0;
  for (int k = 0; k < l->c.n_branches; k++) {
    int span[2];
    if (!is_level(l, &l->c.branch[k])) continue;
    span_of(l, &l->c.branch[k], span);
    if (span[0] != column && span[1] != column) continue;
    if (l->lane[k] > highest) highest = l->lane[k];
  }
  draw_wire(out, l, l->x[column], l->y_base, l->x[column], l->y_base - ACROSS * highest);
  draw_wire(out, l, l->x[column], l->y_base, l->right[column], l->y_base);
  draw_net_name(out, l, l->column[column], l->x[column] - 5, l->y_base + 14);
}

/* Draws a rail from its first branch to its last. */
static void draw_rail(vs_html *out, layout *l, int rail) {
  const int net = l->c.rail[rail], y = rail ? l->y_bottom : l->y_top;
  int least = l->width, most = 0;
  for (int k = 0; k < l->c.n_branches && net >= 0; k++) {
    const vs_circuit_branch *b = &l->c.branch[k];
    if (b->end[0] != net && b->end[1] != net) continue;
    const int x = shunt_x(l, k);
    if (x < least) least = x;
    if (x > most) most = x;
  }
  if (most < least) return;
  draw_wire(out, l, least, y, most, y);
  draw_net_name(out, l, net, least - 8, y + 4);
  if (net == l->c.ground)
    vs_html_add(out, "<path d=\"M%d,%dv8m-9,0h18m-15,4h12m-9,4h6\"/>\n", least, y);
}

/* Adds lines of text below the picture. */
static void draw_note(vs_html *out, layout *l, const char *what, const vs_text *names) {
  const size_t room = (size_t)(l->width - 2 * EDGE) / LETTER;
  vs_text all = {0};
  if (!names->length) return;
  vs_text_add(&all, "%s: %s.", what, names->text);
  for (char *rest = all.text; *rest;) {
    size_t n = strlen(rest);
    if (n > room)
      for (n = room; n > room / 2 && rest[n] != ' ';) n--;
    vs_text line = {0};
    vs_text_put(&line, rest, n);
    l->y_end += LINE + 2;
    draw_text(out, EDGE, l->y_end, "start", "#404040", line.text);
    vs_text_free(&line);
    rest += n + (rest[n] == ' ');
  }
  vs_text_free(&all);
}

/* Draws the dots: those of the lanes at their columns, and of the branches to the rails. */
static void draw_dots(vs_html *out, const layout *l) {
  for (int k = 0; k < l->c.n_branches; k++) {
    const vs_circuit_branch *b = &l->c.branch[k];
    int span[2];
    if (is_level(l, b)) {
      span_of(l, b, span);
      for (int n = 0; n < 2; n++)
        if (l->lane[k]) draw_dot(out, l, l->x[span[n]], l->y_base - ACROSS * l->lane[k]);
      continue;
    }
    const int net = column_of(l, b), x = shunt_x(l, k);
    const bool top = is_up(l, b);
    if (top) draw_dot(out, l, x, l->y_top);
    if (!top || net < 0) draw_dot(out, l, x, l->y_bottom);
    if (net >= 0 && l->shunt[k]) draw_dot(out, l, x, l->y_base);
  }
  for (int k = 0; k < l->n_columns; k++) draw_dot(out, l, l->x[k], l->y_base);
}

static void draw_all(vs_html *out, layout *l) {
  vs_html body = {0};
  for (int k = 0; k < l->c.n_branches; k++)
    if (is_level(l, &l->c.branch[k]))
      draw_level(&body, l, k);
    else
      draw_upright(&body, l, k);
  for (int k = 0; k < l->n_columns; k++) draw_column(&body, l, k);
  for (int k = 0; k < 2; k++) draw_rail(&body, l, k);
  draw_dots(&body, l);
  l->y_end = l->y_bottom + 24;
  draw_note(&body, l, "Not drawn: meters of current", &l->c.ammeters);
  draw_note(&body, l, "Not drawn: couplings of inductors", &l->c.couplings);
  draw_note(&body, l, "Not drawn: gate drives and what lies outside of the main circuit",
            &l->c.aside);
  vs_html_add(out,
              "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
              "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"11\" fill=\"none\" "
              "stroke=\"#000\" stroke-width=\"1.5\">\n<rect width=\"%d\" height=\"%d\" "
              "fill=\"#fff\" stroke=\"none\"/>\n",
              l->width, l->y_end + 10, l->width, l->y_end + 10, l->width, l->y_end + 10);
  vs_html_markup(out, body.text.text);
  vs_html_markup(out, "</svg>\n");
  vs_html_free(&body);
}

bool vs_schematic_draw(const vs_deck *deck, const vs_node *values, const vs_schematic_mark *marks,
                       size_t n_marks, vs_html *out, vs_text *why) {
  layout *l = vs_alloc(1, sizeof *l);
  l->deck = deck;
  const bool drawn = vs_schematic_circuit_read(deck, &l->c, why);
  for (int k = 0; k < l->c.n_elements && drawn; k++)
    l->label[k] = make_label(deck, &l->c, &l->c.element[k], values, marks, n_marks);
  if (drawn) make_layout(l);
  if (drawn) draw_all(out, l);
  vs_schematic_circuit_free(&l->c);
  free(l);
  return drawn;
}

/* ---- of a deck, and of a run ---- */

static vs_status read_deck(const char *name, const vs_node *section, vs_deck *deck, vs_error *err) {
  char path[VS_PATH_SIZE];
  const size_t n = strlen(name), m = strlen(vs_deck_shelf.ending);
  char shipped[VS_NAME_SIZE];
  snprintf(shipped, sizeof shipped, "%.*s", (int)(n > m ? n - m : n), name);
  const bool own =
      !strchr(name, '/') && access(name, F_OK) && vs_path_own(&vs_deck_shelf, shipped, path);
  vs_status status = own ? VS_OK : vs_path_find(&vs_deck_shelf, name, (vs_where){0}, path, err);
  if (!status) status = vs_netlist_read(path, deck, err);
  return status ? status : vs_netlist_read_parts(deck, section, err);
}

vs_status vs_schematic_of_deck(const char *name, vs_html *out, vs_error *err) {
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_text why = {0};
  vs_status status = read_deck(name, NULL, deck, err);
  if (!status && !vs_schematic_draw(deck, NULL, NULL, 0, out, &why))
    status = vs_fail(err, VS_INPUT, "%.500s: no schematic: %s", name, why.text);
  vs_text_free(&why);
  vs_deck_free(deck);
  free(deck);
  return status;
}

/* The least margin of each device in the verdict; the caller frees the list. */
static vs_schematic_mark *list_marks(const vs_node *verdict, size_t *count) {
  size_t n = 0;
  *count = 0;
  for (const vs_node *m = verdict ? verdict->child : NULL; m; m = m->next) n++;
  vs_schematic_mark *all = vs_alloc(n + 1, sizeof *all);
  for (const vs_node *m = verdict ? verdict->child : NULL; m; m = m->next) {
    const char *device = vs_member_word(m, "device"), *word = vs_run_pair_word(m);
    const double margin = vs_member_number(vs_tree_child(m, "margin"));
    const bool bad = !strncmp(word, "violated", 8) || !strcmp(word, "undecided");
    size_t k = 0;
    while (k < *count && strcmp(all[k].device, device)) k++;
    if (!*device || !strcmp(word, "waived") || (isnan(margin) && !bad)) continue;
    if (k < *count && (all[k].bad > bad || (all[k].bad == bad && !(margin < all[k].margin))))
      continue;
    if (k == *count) ++*count;
    all[k] = (vs_schematic_mark){.margin = margin, .bad = bad};
    snprintf(all[k].device, sizeof all[k].device, "%s", device);
    snprintf(all[k].measure, sizeof all[k].measure, "%s", vs_member_word(m, "measure"));
  }
  return all;
}

void vs_schematic_add(const vs_node *summary, vs_html *html) {
  const char *tier = vs_member_word(summary, "tier");
  const vs_node *circuit = vs_tree_child_map(vs_tree_child(summary, "scene"), "circuit");
  const char *name = vs_member_word(circuit, "deck");
  const vs_node *events = vs_tree_child(vs_tree_child(summary, "scene"), "events");
  char path[VS_PATH_SIZE], found[VS_PATH_SIZE];
  vs_error unread = {0};
  if ((strcmp(tier, "circuit") && strcmp(tier, "compiled")) || !*name ||
      !vs_path_own(&vs_deck_shelf, name, path) ||
      vs_path_find(&vs_deck_shelf, name, (vs_where){0}, found, &unread) || strcmp(found, path))
    return;
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_html picture = {0};
  vs_text why = {0};
  size_t count;
  vs_schematic_mark *marks = list_marks(vs_tree_child(summary, "verdict"), &count);
  if (!vs_netlist_read(path, deck, &unread) && !vs_netlist_read_parts(deck, circuit, &unread) &&
      vs_schematic_draw(deck, circuit, marks, count, &picture, &why)) {
    vs_html_add(html, "<section id=\"schematic\">\n<h2>Schematic</h2>\n<div class=\"wide\">"
                      "<figure style=\"max-width:none\">\n");
    vs_html_markup(html, picture.text.text);
    vs_html_add(html,
                "<figcaption>The deck %s. A device has the colour of its least margin: below "
                "20 %% brown, violated or undecided vermilion, else blue.%s</figcaption>\n"
                "</figure></div>\n</section>\n",
                name, events && events->child ? " What the scene's events add is not drawn." : "");
  }
  free(marks);
  vs_html_free(&picture);
  vs_text_free(&why);
  vs_deck_free(deck);
  free(deck);
}
