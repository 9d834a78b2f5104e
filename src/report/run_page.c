/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/run_page.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/field.h"
#include "base/tree.h"
#include "members.h"
#include "report/html.h"
#include "report/margin_bars.h"
#include "report/schematic.h"
#include "run/engineering.h"
#include "run_pair.h"
#include "waveforms.h"

void vs_run_page_head(vs_html *html, const char *folder, const vs_node *summary, double until_s) {
  char until[VS_ENGINEERING_SIZE];
  vs_html_begin(html, "Run", folder);
  vs_html_add(html, "<p class=\"of\">tier ");
  vs_html_text(html, vs_member_word(summary, "tier"));
  vs_html_add(html, ", %s</p>\n", vs_engineering_text(until_s, "s", until));
}

/* ---- the verdict ---- */

/* Adds a cell with an amount; an empty one for NaN. */
static void add_amount(vs_html *html, double value, const char *unit) {
  char text[VS_ENGINEERING_SIZE];
  vs_html_add(html, "<td class=\"n\">%s</td>",
              isnan(value) ? "" : vs_member_amount(value, unit, text));
}

/* "12.4 %" of a part; an empty cell for NaN. */
static void add_percent(vs_html *html, double part) {
  vs_html_add(html,
              isnan(part)                             ? "<td class=\"n\"></td>"
              : fabs(part) >= 100 && fabs(part) < 1e4 ? "<td class=\"n\">%.0f %%</td>"
                                                      : "<td class=\"n\">%.4g %%</td>",
              100 * part);
}

/* Adds a row: stress and limit first, for narrow screens show the first columns only. */
static void add_verdict_line(vs_html *html, const vs_node *line) {
  const char *device = vs_member_word(line, "device"), *unit = vs_member_word(line, "unit"),
             *mark = vs_margin_bars_unsure(line), *says = vs_member_word(line, "text");
  double stress, limit;
  vs_text name = {0};
  if (*device)
    vs_text_add(&name, "%s.%s", device, vs_member_word(line, "measure"));
  else
    vs_text_add(&name, "%s", vs_member_word(line, "rating"));
  vs_html_add(html, "<tr>");
  vs_html_cell(html, name.text);
  vs_text_free(&name);
  vs_margin_bars_stress(line, &stress, &limit);
  add_amount(html, stress, unit);
  add_amount(html, limit, unit);
  add_percent(html, vs_member_number(vs_tree_child(line, "margin")));
  vs_html_cell(html, vs_run_pair_word(line));
  add_percent(html, vs_member_number(vs_tree_child(line, "margin_error")));
  vs_html_add(html, "<td class=\"text\">%s%s%s", *mark ? "limit" : "", mark,
              *mark && *says ? "; " : "");
  vs_html_text(html, says);
  if (*device) vs_html_text(html, vs_member_word(line, "unknown"));
  vs_html_add(html, "</td></tr>\n");
}

/* Adds a line for each thing that happened, or that was expected and did not happen. */
static void add_happenings(vs_html *html, const vs_node *summary) {
  static const char *const LISTS[] = {"happened", "did_not_happen"};
  for (int k = 0; k < 2; k++) {
    const vs_node *list = vs_tree_child(summary, LISTS[k]);
    for (const vs_node *m = list ? list->child : NULL; m; m = m->next) {
      char at[VS_ENGINEERING_SIZE];
      const double at_s = vs_member_number(vs_tree_child(m, "at_s"));
      const bool expected = !strcmp(vs_member_word(m, "expected"), "true");
      vs_html_add(html,
                  "<p class=\"happened\">%s: ", k ? "Did not happen, though expected" : "Happened");
      vs_html_text(html, vs_member_word(m, "what"));
      vs_html_add(html, " of ");
      vs_html_text(html, vs_member_word(m, "device"));
      if (!isnan(at_s)) vs_html_add(html, " at %s (", vs_engineering_text(at_s, "s", at));
      if (!isnan(at_s)) vs_html_text(html, vs_member_word(m, "cause"));
      vs_html_add(html, "%s%s.</p>\n", isnan(at_s) ? "" : ")",
                  !k && expected ? ", as expected" : "");
    }
  }
}

static void add_left_out(vs_html *html, const char *what, const vs_node *list) {
  if (!list || !list->child) return;
  vs_html_add(html, "<p>%s: ", what);
  for (const vs_node *m = list->child; m; m = m->next) {
    vs_html_text(html, m->text ? m->text : "");
    vs_html_add(html, m->next ? ", " : ".</p>\n");
  }
}

static void add_repeated(vs_html *html, const vs_node *verdict) {
  for (const vs_node *m = verdict->child; m; m = m->next) {
    if (!vs_margin_bars_repeats(verdict, m)) continue;
    vs_html_add(html, "<p class=\"of\">The rating of ");
    vs_html_text(html, vs_member_word(m, "rating"));
    vs_html_add(html, " is judged by the same values: %s.</p>\n", vs_run_pair_word(m));
  }
}

/* Adds what an armature did, which people look for first: "pull_in 12.35 ms, release 14.34 ms". */
static void add_armature(vs_html *html, const vs_node *summary) {
  static const char *const NAMES[] = {"pull_in", "release", "bounces", "impact_speed"};
  const vs_node *all = vs_tree_child_map(summary, "measures");
  bool any = false;
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) {
    char amount[VS_ENGINEERING_SIZE];
    const vs_node *m = vs_tree_child(all, NAMES[k]);
    const double value = vs_member_number(vs_tree_child(m, "value"));
    if (!m) continue;
    vs_html_add(html, any ? ", " : "<p>");
    vs_html_add(html, "%s %s", NAMES[k],
                isnan(value) ? "did not occur"
                             : vs_member_amount(value, vs_member_word(m, "unit"), amount));
    any = true;
  }
  if (any) vs_html_add(html, ".</p>\n");
}

/* Adds the verdict: the word of the whole, the weakest line, and all lines. */
static void add_verdict(vs_html *html, const vs_node *summary) {
  const vs_node *verdict = vs_tree_child(summary, "verdict");
  bool any = verdict && verdict->child;
  const char *word = vs_run_pair_whole(verdict), *weakest = vs_member_word(summary, "weakest"),
             *first = vs_member_word(summary, "first_to_fail");
  vs_html_add(html, "<section id=\"verdict\" class=\"verdict %s\">\n<p class=\"big\">%s</p>\n",
              !any                    ? ""
              : !strcmp(word, "held") ? "good"
                                      : "bad",
              word);
  if (any && *weakest && strcmp(weakest, "null") != 0) {
    vs_html_add(html, "<p>Weakest: ");
    vs_html_text(html, weakest);
    if (*first && strcmp(first, "null") != 0) {
      vs_html_add(html, "; first to fail: ");
      vs_html_text(html, first);
    }
    vs_html_add(html, ".</p>\n");
  }
  add_armature(html, summary);
  add_happenings(html, summary);
  if (any) add_left_out(html, "Waived", vs_tree_child(summary, "waived"));
  if (any) add_left_out(html, "Not judged", vs_tree_child(summary, "not_judged"));
  if (any) {
    vs_html_add(html, "<div class=\"wide\"><table><tr><th>what</th><th>stress</th><th>limit</th>"
                      "<th>margin</th><th>word</th><th>its error</th><th></th></tr>\n");
    for (const vs_node *m = verdict->child; m; m = m->next)
      if (!vs_margin_bars_repeats(verdict, m)) add_verdict_line(html, m);
    vs_html_add(html, "</table></div>\n");
    add_repeated(html, verdict);
  }
  const vs_node *warnings = vs_tree_child(summary, "warnings");
  for (const vs_node *m = warnings ? warnings->child : NULL; m; m = m->next) {
    vs_html_add(html, "<p>Warning: ");
    vs_html_text(html, m->text ? m->text : "");
    vs_html_add(html, "</p>\n");
  }
  vs_html_add(html, "</section>\n");
}

/* ---- measures and parameters ---- */

/* An extreme smaller than this part of the opposite one is rounding, and shown as 0. */
static const double ZERO_BESIDE = 1e-6;

/* The measure NAME_max of NAME_min, and vice versa; NULL where there is none. */
static const vs_node *other_end(const vs_node *all, const char *name) {
  char other[VS_NAME_SIZE];
  const size_t n = strlen(name);
  const bool is_min = n > 4 && !strcmp(name + n - 4, "_min");
  if (n >= sizeof other || n < 5 || (!is_min && strcmp(name + n - 4, "_max"))) return NULL;
  snprintf(other, sizeof other, "%.*s%s", (int)n - 4, name, is_min ? "_max" : "_min");
  return vs_tree_child(all, other);
}

/* True for an extreme that a device's v_forward or v_reverse is, too. */
static bool is_repeated(const vs_node *all, const vs_node *extreme) {
  const double value = vs_member_number(vs_tree_child(extreme, "value"));
  bool repeated = false;
  if (strcmp(vs_member_word(extreme, "unit"), "V")) return false;
  for (const vs_node *m = all->child; m && !repeated; m = m->next) {
    const char *dot = m->key ? strchr(m->key, '.') : NULL;
    repeated = dot && (!strcmp(dot, ".v_forward") || !strcmp(dot, ".v_reverse")) &&
               vs_member_number(vs_tree_child(m, "value")) == fabs(value) && value != 0;
  }
  return repeated;
}

/* The group of a measure: its device; "", of what lies between two extremes; else of the machine,
 * the coil and the books. It is `size` bytes of text. */
static const char *group_of(const vs_node *all, const char *name, size_t *size) {
  static const char RUN[] = "machine, coil and energy", EXTREMES[] = "least and largest values";
  const char *dot = strchr(name, '.');
  const char *group = dot ? name : other_end(all, name) ? EXTREMES : RUN;
  *size = dot ? (size_t)(dot - name) : strlen(group);
  return group;
}

static void add_measure(vs_html *html, const vs_node *all, const vs_node *m) {
  char amount[VS_ENGINEERING_SIZE];
  const vs_node *other = other_end(all, m->key);
  double value = vs_member_number(vs_tree_child(m, "value")),
         at = vs_member_number(vs_tree_child(m, "at_s"));
  if (fabs(value) < ZERO_BESIDE * fabs(vs_member_number(vs_tree_child(other, "value")))) value = 0;
  vs_html_add(html, "<tr>");
  vs_html_cell(html, m->key);
  vs_html_add(html, "<td class=\"n\">");
  vs_html_text(html, isnan(value) ? "not known"
                                  : vs_member_amount(value, vs_member_word(m, "unit"), amount));
  vs_html_add(html, "</td><td class=\"n\">%s</td></tr>\n",
              isnan(at) ? "" : vs_engineering_text(at, "s", amount));
}

/* Adds the measures of m's group, with its name above them, if m is the first of it. */
static void add_group(vs_html *html, const vs_node *all, const vs_node *m) {
  size_t size, n;
  const char *group = group_of(all, m->key, &size);
  char title[VS_NAME_SIZE];
  snprintf(title, sizeof title, "%.*s", (int)size, group);
  for (const vs_node *before = all->child; before != m; before = before->next) {
    const char *other = group_of(all, before->key, &n);
    if (n == size && !strncmp(other, group, size)) return;
  }
  vs_html_add(html, "<tr class=\"group\"><th colspan=\"3\">%s</th></tr>\n", title);
  for (; m; m = m->next) {
    const char *other = group_of(all, m->key, &n);
    if (n != size || strncmp(other, group, size)) continue;
    if (!other_end(all, m->key) || !is_repeated(all, m) ||
        !is_repeated(all, other_end(all, m->key)))
      add_measure(html, all, m);
  }
}

static void add_measures(vs_html *html, const vs_node *summary) {
  const vs_node *all = vs_tree_child_map(summary, "measures");
  vs_html_add(html, "<section id=\"measures\">\n<h2>Measures</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>measure</th><th>value</th><th>at</th></tr>\n");
  for (const vs_node *m = all ? all->child : NULL; m; m = m->next) add_group(html, all, m);
  vs_html_add(html, "</table></div>\n</section>\n");
}

static void add_parameter(void *ctx, const char *key, const vs_node *a, const vs_node *b) {
  vs_html *html = ctx;
  vs_text text = {0};
  (void)b;
  vs_member_text(a, &text);
  vs_html_add(html, "<tr>");
  vs_html_cell(html, key);
  vs_html_cell(html, text.text);
  vs_html_add(html, "</tr>\n");
  vs_text_free(&text);
}

/* Adds every effective key of the scene. */
static void add_parameters(vs_html *html, const vs_node *summary) {
  vs_html_add(html, "<section id=\"parameters\">\n<h2>Parameters</h2>\n<div class=\"wide\"><table>"
                    "<tr><th>key</th><th>value</th></tr>\n");
  vs_members_unlike(vs_tree_child_map(summary, "scene"), NULL, add_parameter, html);
  vs_html_add(html, "</table></div>\n</section>\n");
}

/* ---- energy flow: where the energy of a run went, as a table with bars ---- */

/* The flows of energy; an indented one is a part of the one above it. ends: it has no parts. */
static const struct {
  const char *key, *text;
  int depth;
  bool ends;
} FLOWS[] = {{"source_J", "from the source", 0, false},
             {"losses_J", NULL, 1, true},
             {"stores_J", NULL, 1, true},
             {"eva_J", "into the EVA", 1, false},
             {"copper_J", "heat in the winding", 2, true},
             {"magnetic_J", "stored in the field", 2, true},
             {"work_force_J", "work of the force", 2, false},
             {"damping_J", "lost in dampers", 3, true},
             {"stop_J", "lost in stops", 3, true},
             {"mechanical_J", "stored in motion and springs", 3, true}};

/* All that was given: by the source, and by what has less than 0, as a generator or a store has
 * that it came from. */
static double energy_given(const vs_node *energy) {
  double given = fmax(vs_member_number(vs_tree_child(energy, FLOWS[0].key)), 0);
  for (size_t k = 1; k < sizeof FLOWS / sizeof *FLOWS; k++) {
    const vs_node *node = vs_tree_child(energy, FLOWS[k].key);
    if (!node || !FLOWS[k].ends) continue;
    if (FLOWS[k].text) given += fmax(-vs_member_number(node), 0);
    for (const vs_node *m = FLOWS[k].text ? NULL : node->child; m; m = m->next)
      given += fmax(-vs_member_number(m), 0);
  }
  return given;
}

/* Adds a row, with its share of what was given as a bar. A flow of 0 is left out. */
static void add_energy_row(vs_html *html, const char *text, int depth, double joule, double whole) {
  char amount[VS_ENGINEERING_SIZE], part[32] = "< 0.01 %";
  double share = joule / whole;
  if (!(fabs(share) < 1e-4)) snprintf(part, sizeof part, "%.3g %%", 100 * share);
  if (isnan(joule) || joule == 0) return;
  vs_html_add(html, "<tr><td style=\"padding-left:%.1frem\">", 0.5 + 1.2 * depth);
  vs_html_text(html, text);
  vs_html_add(html,
              "</td><td class=\"n\">%s</td><td class=\"n\">%s</td><td class=\"bars\">"
              "<span class=\"bar%s\" style=\"width:%.2f%%\"></span></td></tr>\n",
              vs_engineering_text(joule, "J", amount), part, joule < 0 ? " back" : "",
              fmin(100, 100 * fabs(share)));
}

/* Adds each account of the deck: "losses_J": {"r1": ...}. */
static void add_accounts(vs_html *html, const vs_node *accounts, const char *what, double whole) {
  for (const vs_node *m = accounts ? accounts->child : NULL; m; m = m->next) {
    vs_text text = {0};
    const bool gives = vs_member_number(m) < 0; /* a generator's is what it took, below 0 */
    vs_text_add(&text, "%s %s", gives ? "given by" : what, m->key);
    add_energy_row(html, text.text, 1, vs_member_number(m), whole);
    vs_text_free(&text);
  }
}

/* Adds the section. energy: that member of summary.json; NULL: nothing is added. */
static void add_energy_flow(vs_html *html, const vs_node *energy) {
  if (!energy) return;
  const double whole = energy_given(energy);
  vs_html_add(html,
              "<section id=\"energy\">\n<h2>Energy flow</h2>\n<div class=\"wide\"><table>"
              "<tr><th>what</th><th>energy</th><th>share</th><th class=\"bars\"></th></tr>\n");
  for (size_t k = 0; k < sizeof FLOWS / sizeof *FLOWS && whole > 0; k++) {
    const vs_node *node = vs_tree_child(energy, FLOWS[k].key);
    if (FLOWS[k].text)
      add_energy_row(html, FLOWS[k].text, FLOWS[k].depth, vs_member_number(node), whole);
    else
      add_accounts(html, vs_tree_child_map(energy, FLOWS[k].key),
                   !strcmp(FLOWS[k].key, "losses_J") ? "lost in" : "stored in", whole);
  }
  vs_html_add(
      html, "</table></div>\n<p class=\"of\">Shares are of all that was given: by the source, and "
            "by each that has less than 0. What is 0 is left out. Names behind \"lost in\" and "
            "\"stored in\" are those of the deck's lines *$ loss and *$ store. The audit: ");
  vs_html_text(html, vs_member_word(energy, "audit"));
  vs_html_add(html, ".</p>\n</section>\n");
}

/* ---- the page ---- */

void vs_run_page_verdict(vs_html *html, const vs_node *summary) {
  add_verdict(html, summary);
  add_energy_flow(html, vs_tree_child(summary, "energy"));
}

void vs_run_page_values(vs_html *html, const vs_node *summary) {
  add_measures(html, summary);
  add_parameters(html, summary);
}

vs_status vs_run_page_write(const char *folder, bool quiet, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_tree summary = {0};
  vs_html html = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (access(path, R_OK)) return VS_OK;
  vs_time_window *s = vs_alloc(1, sizeof *s);
  vs_status status = vs_waveforms_open(s, &folder, 1, err);
  if (!status) status = vs_tree_read(path, &summary, err);
  if (!status) {
    vs_run_page_head(&html, folder, summary.root, s->to_s);
    add_verdict(&html, summary.root);
    status = vs_margin_bars_add(summary.root, &html, err);
  }
  if (!status) {
    vs_schematic_add(summary.root, &html);
    add_energy_flow(&html, vs_tree_child(summary.root, "energy"));
    status = vs_waveforms_add(s, &html, err);
    vs_run_page_values(&html, summary.root);
    vs_html_end(&html);
  }
  if (!status) status = vs_html_write(&html, folder, quiet, err);
  vs_tree_free(&summary);
  vs_html_free(&html);
  vs_waveforms_close(s);
  free(s);
  return status;
}
