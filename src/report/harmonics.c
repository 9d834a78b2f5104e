/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/harmonics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/gnuplot.h"
#include "base/path.h"
#include "base/text.h"
#include "base/tree.h"
#include "measure/quality.h"
#include "report/scale.h"

enum { MOST_KINDS = 16 /* classes in a panel */ };
enum { PANELS = VS_QUALITY_MOST + 1, WIDTH = 900, HEIGHT = 320 /* of a panel, pixels */ };

/* A current: its harmonics, and the limits of the classes, as summary.json has them. */
typedef struct panel {
  char title[VS_NAME_SIZE + 16];
  const vs_node *harmonics; /* a list */
  const vs_node
      *groups; /* a list of the groups that are compared with the limits; NULL: the harmonics are */
  const vs_node *classes; /* a list; NULL: only class A has limits, */
  const vs_node *limits;  /* namely these */
} panel;

typedef struct panels {
  panel item[PANELS];
  int count;
} panels;

/* ---- what there is ---- */

/* How many numbers of the list are positive, from harmonic 1 on: the others have no place on a
 * logarithmic axis. */
static int count_of(const vs_node *list) {
  int n = 0, count = 0;
  for (const vs_node *item = list ? list->child : NULL; item; item = item->next)
    count += n++ && item->kind == VS_NODE_TEXT && strtod(item->text, NULL) > 0;
  return count;
}

static void add_panel(panels *all, const char *name, panel of) {
  if (!count_of(of.harmonics) || all->count == PANELS) return;
  if (!count_of(of.groups)) of.groups = NULL;
  snprintf(of.title, sizeof of.title, "harmonics of %s", name);
  all->item[all->count++] = of;
}

static void find_panels(const vs_tree *tree, panels *all) {
  const vs_node *own = vs_tree_child(tree->root, "harmonics"),
                *limits = vs_tree_child(tree->root, "harmonic_limits"),
                *quality = vs_tree_child_map(tree->root, "quality");
  add_panel(all, "the mains current on the orbit",
            (panel){.harmonics = own,
                    .groups = vs_tree_child(tree->root, "harmonic_groups"),
                    .limits = vs_tree_child(limits, "limits_A")});
  for (const vs_node *n = quality ? quality->child : NULL; n; n = n->next)
    add_panel(all, n->key,
              (panel){.harmonics = vs_tree_child(n, "harmonics_A"),
                      .groups = vs_tree_child(n, "groups_A"),
                      .classes = vs_tree_child(n, "classes")});
}

/* ---- the picture ---- */

/* Adds these numbers as a data block of this name. */
static void add_block(vs_script *script, const char *name, int number, const vs_node *list) {
  int n = 0;
  vs_gnuplot_code(script, name);
  vs_gnuplot_add(script, "%d << EOD\n", number);
  for (const vs_node *item = list ? list->child : NULL; item; item = item->next, n++) {
    double value = item->kind == VS_NODE_TEXT ? strtod(item->text, NULL) : 0;
    if (n && value > 0) vs_gnuplot_add(script, "%d %.9g\n", n, value);
  }
  vs_gnuplot_add(script, "EOD\n");
}

/* Marks the limits of a class, which are data block $limits of this number. */
static void add_limits(vs_script *script, const char *class, int number, const vs_node *limits,
                       int kind) {
  vs_text title = {0};
  static const char *const COLOURS[] = {"#d1495b", "#e08e1b", "#8e5ea2", "#2a9d6f"};
  const int kinds = sizeof COLOURS / sizeof *COLOURS;
  if (!count_of(limits)) return;
  vs_text_add(&title, "class %s", class);
  vs_gnuplot_add(script, ", $limits%d using 1:2 with points pt %d ps 0.7 lc rgb %s title %s",
                 number, 4 + 2 * (kind % kinds), COLOURS[kind % kinds], title.text);
  vs_text_free(&title);
}

static const char *name_of(const vs_node *class) {
  const vs_node *name = vs_tree_child(class, "class");
  return name && name->text ? name->text : "without a name";
}

static void add_script_of(vs_script *script, const panel *p, int k) {
  int kind = 0, n = p->limits ? 1 : 0;
  add_block(script, "$bars", k, p->harmonics);
  if (p->groups) add_block(script, "$groups", k, p->groups);
  if (p->limits) add_block(script, "$limits", MOST_KINDS * k, p->limits);
  for (const vs_node *c = p->classes ? p->classes->child : NULL; c && n < MOST_KINDS; c = c->next)
    add_block(script, "$limits", MOST_KINDS * k + n++, vs_tree_child(c, "limits_A"));
  vs_gnuplot_add(script, "set title ");
  vs_gnuplot_quoted(script, p->title);
  vs_gnuplot_add(script,
                 "\nplot $bars%d using 1:2 with boxes fs solid 0.45 noborder fc rgb %s notitle", k,
                 vs_scale_colour_good);
  if (p->groups)
    vs_gnuplot_add(script,
                   ", $groups%d using 1:2 with points pt 7 ps 0.6 lc rgb '#404040' title "
                   "'group, held to limits'",
                   k);
  if (p->limits) add_limits(script, "A", MOST_KINDS * k, p->limits, kind++);
  for (const vs_node *c = p->classes ? p->classes->child : NULL; c && kind < n; c = c->next, kind++)
    add_limits(script, name_of(c), MOST_KINDS * k + kind, vs_tree_child(c, "limits_A"), kind);
  vs_gnuplot_add(script, "\n");
}

static void add_harmonics_script(const panels *all, bool svg, vs_script *script) {
  vs_gnuplot_code(script, svg ? "set terminal svg" : "set terminal pngcairo");
  vs_gnuplot_add(
      script,
      " noenhanced size %d,%d font 'sans,%d' background rgb 'white'\nset "
      "multiplot layout %d,1\nset logscale y\nset yrange [1e-5:*]\nset xrange [0.4:40.6]\n"
      "set format y '%%g'\nset xtics 1,2\nset boxwidth 0.7\nset "
      "border 3 lc rgb '#404040'\nset grid y lt 1 lw 0.5 lc rgb '#d0d0d0'\nset xlabel "
      "'harmonic'\nset ylabel 'A rms'\nset key outside right\n",
      WIDTH, HEIGHT * all->count, svg ? 13 : 10, all->count);
  for (int k = 0; k < all->count; k++) add_script_of(script, &all->item[k], k);
  vs_gnuplot_add(script, "unset multiplot\n");
}

static vs_status draw_harmonics(const panels *all, const char *folder, bool svg, bool quiet,
                                vs_error *err) {
  vs_script script = {0};
  add_harmonics_script(all, svg, &script);
  vs_status status = vs_gnuplot_draw(script.text.text, folder,
                                     svg ? "harmonics.svg" : "harmonics.png", quiet, err);
  vs_gnuplot_free(&script);
  return status;
}

vs_status vs_harmonics_draw(const char *folder, bool quiet, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_tree tree = {0};
  panels all = {.count = 0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (access(path, R_OK)) return VS_OK;
  vs_status status = vs_tree_read(path, &tree, err);
  if (!status) find_panels(&tree, &all);
  if (!status && all.count) status = draw_harmonics(&all, folder, false, quiet, err);
  if (!status && all.count) status = draw_harmonics(&all, folder, true, quiet, err);
  vs_tree_free(&tree);
  return status;
}
