/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lacks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/kinds.h"

/* Adds a name to a list, unless it is there. */
static void add_once(vs_text *list, const char *device, const char *name) {
  char own[2 * VS_DECK_NAME + 8];
  snprintf(own, sizeof own, "%s%s%s", device, *device ? "." : "", name);
  const size_t n = strlen(own);
  for (const char *at = list->text; list->length && (at = strstr(at, own)); at += n)
    if ((at == list->text || at[-1] == ' ') && (!at[n] || at[n] == ',')) return;
  vs_text_add(list, "%s%s", list->length ? ", " : "", own);
}

static void add_params(const vs_deck *deck, unsigned lack, const vs_device *d, const char *element,
                       vs_text *list) {
  size_t k = 0;
  for (const char *key; (key = vs_deck_lacking(deck, lack, d, element, &k));)
    add_once(list, "circuit", key);
}

/* The limit, or what else the judgement is marked for; not where a parameter alone is. */
static void add_own(const vs_deck *deck, const vs_judgement *of, unsigned lack, vs_text *list) {
  char name[VS_JUDGED_NAME];
  const bool by_param = of->device && vs_deck_lacking(deck, lack, of->device, NULL, &(size_t){0});
  if ((of->unsure & lack) && of->limit && of->device) {
    if (!by_param || (of->limit->unsure & lack)) add_once(list, of->device->name, of->limit->name);
  } else if (of->unsure & lack)
    add_once(list, "", vs_verdict_name(of, name));
  if (of->device && (of->unsure & lack)) add_params(deck, lack, of->device, NULL, list);
}

/* The limits of the part that the share comes from, as far as its model is made of them. */
static void add_model(const vs_deck *deck, const vs_device *of, const char *share, vs_text *list) {
  const size_t length = strlen(of->name);
  if (strncmp(share, of->name, length) || (share[length] && share[length] != '\'') ||
      of->part < 0 || !deck->parts[of->part].file)
    return;
  for (size_t m = 0; m < deck->n_limits; m++) {
    const vs_limit *l = &deck->limits[m];
    if ((l->unsure & VS_ASSUMED) && l->where.file == deck->parts[of->part].file &&
        vs_kinds_is_hung_on(of->kind->name, l->name, NULL))
      add_once(list, of->name, l->name);
  }
}

void vs_lacks_list(const vs_branches *b, const vs_deck *deck, const vs_judgement *of,
                   const vs_shares *shares, size_t most, unsigned lack, vs_text *list) {
  add_own(deck, of, lack, list);
  for (size_t n = 0; n < shares->count && n < most; n++) {
    const char *share = shares->item[n].of;
    for (size_t d = 0; d < deck->n_devices && lack == VS_ASSUMED; d++)
      add_model(deck, &deck->devices[d], share, list);
    for (size_t t = 0; t < b->n_tops; t++)
      if (!strcmp(b->top[t].label, share)) add_params(deck, lack, NULL, b->top[t].name, list);
  }
}

void vs_lacks_json(const char *key, const char *list, vs_json *json) {
  vs_json_array(json, key, VS_JSON_ROW);
  for (const char *name = list; name && *name; name += strspn(name, ", ")) {
    char *own = vs_alloc_part(name, strcspn(name, ","));
    vs_json_text(json, NULL, own);
    free(own);
    name += strcspn(name, ",");
  }
  vs_json_end(json);
}
