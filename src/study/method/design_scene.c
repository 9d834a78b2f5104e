/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/design_scene.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/path.h"

/* Adds a text in double quotes, which YAML reads as JSON has it. One that names a file beside the
 * one that it stands in, or in the working folder, becomes the file's whole path, also with a row
 * of a table behind it: FILE#NAME. */
static void add_word(const vs_node *node, vs_text *text) {
  char path[2 * VS_PATH_SIZE];
  const char *file = node->where.file, *slash = file ? strrchr(file, '/') : NULL;
  const char *row = strchr(node->text, '#');
  const int length = row ? (int)(row - node->text) : (int)strlen(node->text);
  char *whole = NULL;
  if (strchr(node->text, '.') && *node->text != '/') {
    const int n =
        snprintf(path, sizeof path, "%.*s", slash ? (int)(slash + 1 - file) : 0, slash ? file : "");
    if (n < (int)sizeof path)
      snprintf(path + n, sizeof path - (size_t)n, "%.*s", length, node->text);
    whole = realpath(path, NULL);
    if (!whole && n < (int)sizeof path) whole = realpath(path + n, NULL);
  }
  if (whole && access(whole, R_OK)) {
    free(whole);
    whole = NULL;
  }
  vs_text named = {0};
  vs_text_add(&named, "%s%s", whole ? whole : node->text, whole && row ? row : "");
  vs_json_string(text, named.text);
  vs_text_free(&named);
  free(whole);
}

static void add_node(const vs_node *node, vs_text *text) {
  const bool map = node->kind == VS_NODE_MAP;
  if (node->kind == VS_NODE_TEXT) {
    if (*node->text) add_word(node, text);
    return;
  }
  vs_text_add(text, "%s", map ? "{" : "[");
  for (const vs_node *n = node->child; n; n = n->next) {
    if (map) vs_json_string(text, n->key);
    if (map) vs_text_add(text, ": ");
    add_node(n, text);
    if (n->next) vs_text_add(text, ", ");
  }
  vs_text_add(text, "%s", map ? "}" : "]");
}

static vs_status add_scene(const vs_plan *plan, const double *point, vs_text *text, vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_plan_scene(plan, scene, err);
  if (!status) vs_plan_put(plan, point, &scene->tree);
  for (const vs_node *n = status ? NULL : scene->tree.root->child; n; n = n->next) {
    vs_text_add(text, "%s: ", n->key);
    add_node(n, text);
    vs_text_add(text, "\n");
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}

static vs_status write_scene(const vs_plan *plan, const vs_results *results, const char *folder,
                             uint64_t run, vs_error *err) {
  char name[64];
  vs_text text = {0};
  const int status_of_run = results->status[run];
  snprintf(name, sizeof name, "%llu.yaml", (unsigned long long)run);
  vs_text_add(&text, "# case %llu of a design: vibrospice run ends with status %d there\n",
              (unsigned long long)run, status_of_run);
  vs_status status = add_scene(plan, &results->points[run * plan->n_axes], &text, err);
  if (!status) status = vs_file_write(folder, name, text.text, err);
  vs_text_free(&text);
  return status;
}

/* Removes the scenes of an earlier answer. */
static void clear_scenes(const char *folder) {
  DIR *all = opendir(folder);
  for (const struct dirent *e; all && (e = readdir(all));) {
    const size_t n = strspn(e->d_name, "0123456789");
    if (n && !strcmp(e->d_name + n, ".yaml")) vs_file_remove(dirfd(all), e->d_name);
  }
  if (all) closedir(all);
}

vs_status vs_design_scene_write(const vs_plan *plan, const vs_results *results, const uint64_t *run,
                                size_t n, const char *folder, vs_error *err) {
  char cases[VS_PATH_SIZE + 8];
  int made;
  snprintf(cases, sizeof cases, "%s/cases", folder);
  vs_status status = vs_file_folder_make(cases, &made, err);
  if (!status) clear_scenes(cases);
  for (size_t k = 0; k < n && !status; k++) status = write_scene(plan, results, cases, run[k], err);
  return status;
}

/* Adds the limits of the deck's parts that lack this: VS_ASSUMED, VS_TYPICAL. */
static void add_limits(const vs_deck *deck, unsigned lack, const char *title, vs_text *text) {
  const char *between = title;
  for (size_t k = 0; k < deck->n_devices; k++)
    for (size_t m = 0; deck->devices[k].kind && m < deck->devices[k].kind->n_measures; m++) {
      const size_t held = deck->devices[k].held[m];
      if (!held || !(deck->limits[held - 1].unsure & lack)) continue;
      vs_text_add(text, "%s%s.%s", between, deck->devices[k].name,
                  deck->devices[k].kind->measures[m].name);
      between = ", ";
    }
  if (between != title) vs_text_add(text, ".");
}

void vs_design_scene_unsure(const vs_plan *plan, const double *point, vs_text *text) {
  static const char *const TITLE[] = {"", " Assumed limits: ", " Typical limits, not guaranteed: "};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error none = {0};
  vs_status status = vs_plan_scene(plan, scene, &none);
  if (!status) vs_plan_put(plan, point, &scene->tree);
  if (!status) status = vs_scene_read_sections(scene, NULL, &none);
  for (unsigned lack = VS_ASSUMED; !status && lack <= VS_TYPICAL; lack <<= 1)
    add_limits(&scene->setup.deck, lack, TITLE[lack], text);
  vs_scene_free(scene);
  free(scene);
}

/* True for a device whose limits the list of prices has. */
static bool is_priced(const vs_design *d, const char *name, size_t n) {
  for (size_t c = 0; c < d->n_choices; c++)
    if (d->choice[d->choice[c].leader].n_limits && strlen(d->choice[c].device) == n &&
        !strncmp(d->choice[c].device, name, n))
      return true;
  return false;
}

void vs_design_scene_group(const vs_design *d, const char *group, size_t length, vs_text *text) {
  const char *reason = memchr(group, '(', length), *between = "";
  const char *end = reason ? reason - 1 : group + length;
  const size_t before = text->length;
  vs_text_add(text, "%s", text->length ? "; " : "");
  for (const char *s = group; s < end;) {
    size_t n = strcspn(s, ",(");
    if (s + n > end) n = (size_t)(end - s);
    if (!is_priced(d, s, n)) {
      vs_text_add(text, "%s%.*s", between, (int)n, s);
      between = ", ";
    }
    s += n;
    s += strspn(s, ", ");
  }
  if (!*between) {
    text->length = before;
    return;
  }
  if (reason) vs_text_add(text, " %.*s", (int)(group + length - reason), reason);
}
