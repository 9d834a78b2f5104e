/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "flow.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "members.h"
#include "report/html.h"
#include "run/amount.h"

/* What flows where; what stands deeper is a part of what stands above it. */
static const struct {
  const char *key, *text;
  int depth;
} FLOWS[] = {{"source_J", "from the source", 0},
             {"losses_J", NULL, 1},
             {"stores_J", NULL, 1},
             {"eva_J", "into the EVA", 1},
             {"copper_J", "heat in the winding", 2},
             {"magnetic_J", "stored in the field", 2},
             {"work_force_J", "work of the force", 2},
             {"damping_J", "lost in dampers", 3},
             {"stop_J", "lost in stops", 3},
             {"mechanical_J", "stored in motion and springs", 3}};

/* A row, with its share of the largest flow as a bar. What is 0 is left out. */
static void add_row(vs_html *html, const char *text, int depth, double joule, double whole) {
  char amount[VS_AMOUNT_SIZE], part[32] = "< 0.01 %";
  double share = joule / whole;
  if (!(fabs(share) < 1e-4)) snprintf(part, sizeof part, "%.3g %%", 100 * share);
  if (isnan(joule) || joule == 0) return;
  vs_html_add(html, "<tr><td style=\"padding-left:%.1frem\">", 0.5 + 1.2 * depth);
  vs_html_text(html, text);
  vs_html_add(html,
              "</td><td class=\"n\">%s</td><td class=\"n\">%s</td><td class=\"bars\">"
              "<span class=\"bar%s\" style=\"width:%.2f%%\"></span></td></tr>\n",
              vs_amount_text(joule, "J", amount), part, joule < 0 ? " back" : "",
              fmin(100, 100 * fabs(share)));
}

/* Each account of the deck's: "losses_J": {"r1": ...}. */
static void add_accounts(vs_html *html, const vs_node *accounts, const char *what, double whole) {
  for (const vs_node *m = accounts ? accounts->child : NULL; m; m = m->next) {
    vs_text text = {0};
    vs_text_add(&text, "%s %s", what, m->key);
    add_row(html, text.text, 1, vs_member_number(m), whole);
    vs_text_free(&text);
  }
}

void vs_flow_add(vs_html *html, const vs_node *energy) {
  double whole = 0;
  if (!energy) return;
  for (size_t k = 0; k < sizeof FLOWS / sizeof *FLOWS; k++)
    if (FLOWS[k].text)
      whole = fmax(whole, fabs(vs_member_number(vs_tree_child(energy, FLOWS[k].key))));
  vs_html_add(html,
              "<section id=\"energy\">\n<h2>Energy flow</h2>\n<div class=\"wide\"><table>"
              "<tr><th>what</th><th>energy</th><th>share</th><th class=\"bars\"></th></tr>\n");
  for (size_t k = 0; k < sizeof FLOWS / sizeof *FLOWS && whole > 0; k++) {
    const vs_node *node = vs_tree_child(energy, FLOWS[k].key);
    if (FLOWS[k].text)
      add_row(html, FLOWS[k].text, FLOWS[k].depth, vs_member_number(node), whole);
    else
      add_accounts(html, node, !strcmp(FLOWS[k].key, "losses_J") ? "lost in" : "stored in", whole);
  }
  vs_html_add(html,
              "</table></div>\n<p class=\"of\">Shares are of the largest of these. What is 0 is "
              "left out. The audit: ");
  vs_html_text(html, vs_member_word(energy, "audit"));
  vs_html_add(html, ".</p>\n</section>\n");
}
