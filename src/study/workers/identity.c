/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/identity.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/json.h"
#include "netlist/catalogue.h"
#include "run/sections.h"

/* A section's values and their sum. */
typedef struct kept {
  void *values; /* a copy; NULL: there is none yet */
  char sum[VS_ID_SIZE];
} kept;

struct vs_identity {
  const vs_plan *plan;
  kept kept[VS_SECTIONS];
  vs_text section; /* the text of a section */
  vs_text whole;   /* the text of all sections' sums and of all else */
};

vs_identity *vs_identity_new(const vs_plan *plan) {
  vs_identity *identity = vs_alloc(1, sizeof *identity);
  identity->plan = plan;
  return identity;
}

void vs_identity_free(vs_identity *identity) {
  for (int p = 0; p < VS_SECTIONS; p++) free(identity->kept[p].values);
  vs_text_free(&identity->section);
  vs_text_free(&identity->whole);
  free(identity);
}

static void sum_of(const vs_text *text, char sum[VS_ID_SIZE]) {
  vs_hash hash;
  char digits[VS_HASH_TEXT];
  vs_hash_begin(&hash);
  vs_hash_add(&hash, text->text, text->length);
  vs_hash_end(&hash, digits);
  memcpy(sum, digits, VS_ID_SIZE - 1);
  sum[VS_ID_SIZE - 1] = '\0';
}

static bool is_key_among(const char *key, const char *const *keys) {
  for (; *keys; keys++)
    if (!strcmp(*keys, key)) return true;
  return false;
}

/* Adds a value without its key, which is known by its place: a section's keys come in its table's
 * order, a deck's in the order of its file, whose contents are in the sum. -0 counts as 0. */
static void add_value_to_id(const vs_field *field, const void *values, vs_text *text) {
  const char *member = (const char *)values + field->offset;
  const bool points =
      field->kind == VS_PROFILE && ((const vs_field_profile *)(const void *)member)->count;
  const size_t n = points ? 0 : vs_field_is_real(field) ? 1 : field->kind == VS_PAIR ? 2 : 0;
  double si[2];
  memcpy(si, member, n * sizeof *si);
  for (size_t k = 0; k < n; k++) {
    vs_text_add_number(text, si[k] + 0.0, 12);
    vs_text_put(text, "\n", 1);
  }
  if (n) return;
  vs_field_json(field, values, text);
  vs_text_add(text, "\n");
}

/* Adds a file by its contents; it may be renamed without another id. */
static vs_status add_file(const vs_plan *plan, const char *path, vs_text *text, vs_error *err) {
  vs_status status = VS_OK;
  char read[VS_HASH_TEXT];
  const char *sum = NULL;
  for (size_t k = 0; k < plan->n_inputs && !sum; k++)
    if (!strcmp(plan->inputs[k].path, path)) sum = plan->inputs[k].sha256;
  if (!sum) status = vs_catalogue_hash(path, read, err);
  if (!status) vs_text_add(text, "%s\n", sum ? sum : read);
  return status;
}

static vs_status add_files(const vs_plan *plan, const vs_deck *deck, vs_text *text, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t f = 0; f < deck->n_files && !status; f++)
    status = add_file(plan, deck->files[f], text, err);
  for (size_t p = 0; p < deck->n_parts; p++)
    for (size_t f = 0; f < deck->n_files; f++)
      if (deck->files[f] == deck->parts[p].file)
        vs_text_add(text, "%s is %zu\n", deck->parts[p].name, f);
  return status;
}

static vs_status add_section(const vs_plan *plan, const vs_filled_section *section,
                             const vs_setup *setup, vs_text *text, vs_error *err) {
  const vs_deck *deck = &setup->deck;
  const vs_machine *own = setup->machine;
  static const char *const OUT[] = {"tier", "sample", "verify", NULL}; /* keys of run */
  const bool run = section->section == &vs_setup_run_keys,
             circuit = section->section == &deck->section,
             machine = section->section == &own->section;
  const vs_coil *coil = &setup->model.coil;
  const char *table =
      section->section == &own->actuator && coil->law->file ? coil->law->file(coil) : NULL;
  for (size_t k = 0; k < section->section->count; k++) {
    const vs_field *field = &section->section->fields[k];
    if (vs_field_is_idle(field, section->values)) continue;
    if (run && is_key_among(field->key, OUT)) continue;
    if ((circuit || machine || table) && field->kind == VS_NAME)
      continue; /* deck, parts, machine and table are known by their files */
    add_value_to_id(field, section->values, text);
  }
  if (machine || table) return add_file(plan, table ? table : own->path, text, err);
  return circuit ? add_files(plan, deck, text, err) : VS_OK;
}

static vs_status update_section_of_id(vs_identity *identity, int index, const vs_scene *scene,
                                      vs_error *err) {
  kept *k = &identity->kept[index];
  const vs_filled_section section = vs_section_at(&scene->setup, index);
  if (k->values && !memcmp(k->values, section.values, section.size)) return VS_OK;
  identity->section.length = 0;
  vs_status status = add_section(identity->plan, &section, &scene->setup, &identity->section, err);
  if (status) return status;
  sum_of(&identity->section, k->sum);
  if (!k->values) k->values = vs_alloc(1, section.size);
  memcpy(k->values, section.values, section.size);
  return VS_OK;
}

static void add_events(const vs_events *events, vs_text *text) {
  static const char *const OUT[] = {"at", "cycle", "angle", NULL};
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    vs_json_string(text, e->name);
    vs_text_add(text, " at %.12g\n", e->start_s);
    for (size_t f = 0; f < e->kind->n_fields; f++)
      if (!is_key_among(e->kind->fields[f].key, OUT))
        add_value_to_id(&e->kind->fields[f], &e->v, text);
  }
}

static void add_instruments_to_id(const vs_instruments *all, vs_text *text) {
  if (all->count) vs_text_add(text, "instruments %d\n", all->v.seed);
  for (int k = 0; k < all->count; k++) {
    const vs_instrument *i = &all->item[k];
    vs_text_add(text, "%s\n", i->name);
    for (size_t f = 0; f < i->section.count; f++)
      add_value_to_id(&i->section.fields[f], &i->v, text);
  }
}

/* The observer's map as it was written. */
static void add_node_to_id(const vs_node *node, vs_text *text) {
  if (node->key) vs_text_add(text, "%s ", node->key);
  vs_text_add(text, "%s\n", node->text ? node->text : "[");
  for (const vs_node *n = node->child; n; n = n->next) add_node_to_id(n, text);
}

static vs_status add_control_to_id(const vs_plan *plan, const vs_control *c, vs_text *text,
                                   vs_error *err) {
  static const char *const OUT[] = {"file", "timeout", NULL};
  char path[VS_PATH_SIZE];
  vs_status status = VS_OK;
  for (size_t k = 0; c->regulator && k < c->section.count; k++) {
    if (is_key_among(c->section.fields[k].key, OUT)) continue;
    vs_text_add(text, "control.%s\n", c->section.fields[k].key);
    add_value_to_id(&c->section.fields[k], &c->v, text);
  }
  for (int k = 0; !status && vs_control_file(c, k, path); k++)
    status = add_file(plan, path, text, err);
  return status;
}

vs_status vs_identity_of(vs_identity *identity, const vs_scene *scene, char id[VS_ID_SIZE],
                         vs_error *err) {
  vs_text *whole = &identity->whole;
  vs_status status;
  whole->length = 0;
  *id = '\0';
  vs_text_add(whole, "%s\n", scene->tier->name);
  for (int p = 0; p < VS_SECTIONS; p++) {
    if (!vs_section_counts(&scene->setup, p)) continue;
    if ((status = update_section_of_id(identity, p, scene, err))) return status;
    vs_text_put(whole, identity->kept[p].sum, VS_ID_SIZE - 1);
    vs_text_put(whole, "\n", 1);
  }
  add_events(&scene->setup.timeline.events, whole);
  add_instruments_to_id(&scene->instruments, whole);
  const vs_expects *expects = &scene->expects;
  for (size_t k = 0; scene->tier->has_circuit && k < expects->count; k++)
    vs_text_add(whole, "expect %s %s\n", expects->item[k].device,
                vs_kinds_happening(expects->item[k].measure)->what);
  if (scene->tier->has_circuit && expects->criterion)
    vs_text_add(whole, "criterion %s\n", vs_expect_criteria[expects->criterion].name);
  for (size_t k = 0; scene->tier->has_circuit && k < expects->n_waivers; k++)
    vs_text_add(whole, "waive %s.%s\n", expects->waiver[k].device, expects->waiver[k].name);
  if ((status = add_control_to_id(identity->plan, &scene->control, whole, err))) return status;
  const vs_node *section = vs_tree_child(scene->tree.root, vs_control_section.name);
  if (scene->control.observing.system) add_node_to_id(vs_tree_child(section, "observer"), whole);
  vs_ratings_identify(&scene->ratings, whole);
  vs_cooling_identify(&scene->setup.cooling, &scene->setup.deck, whole);
  if (scene->setup.steady) vs_text_add(whole, "start steady\n");
  if (identity->plan->periods) vs_text_add(whole, "steady %d\n", identity->plan->periods);
  sum_of(whole, id);
  return VS_OK;
}
