/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/sections.h"

#include <assert.h>
#include <string.h>

#define NAME(name, fields, member) #name,
#define OTHER_NAME(name, none) #name,
const char *const vs_section_keys[VS_SECTION_KEYS] = {VS_SECTION_LIST(NAME, OTHER_NAME)};
#undef NAME
#undef OTHER_NAME

typedef struct row {
  const char *name;
  const vs_section *fields; /* NULL: those of the machine or the deck */
  size_t offset, size;      /* of the values in vs_setup, bytes */
} row;

#define ROW(name, fields, member)                                                                  \
  {#name, fields, offsetof(vs_setup, member), sizeof(((vs_setup *)0)->member)},
#define NOTHING(name, none)
static const row ROWS[VS_SECTIONS] = {VS_SECTION_LIST(ROW, NOTHING)};
#undef ROW
#undef NOTHING

static const vs_section *fields_of(int index, const vs_machine *machine, const vs_deck *deck) {
  const row *r = &ROWS[index];
  const vs_section *fields = r->fields                             ? r->fields
                             : index == VS_SECTION_NUMBER_machine  ? &machine->section
                             : index == VS_SECTION_NUMBER_start    ? &machine->start
                             : index == VS_SECTION_NUMBER_actuator ? &machine->actuator
                             : index == VS_SECTION_NUMBER_supply   ? &machine->supply
                             : index == VS_SECTION_NUMBER_firing   ? &machine->firing
                                                                   : &deck->section;
  assert(!fields->name || !strcmp(fields->name, r->name)); /* a deck that was not read has none */
  return fields;
}

bool vs_section_is_named(int index) {
  return !ROWS[index].fields && index != VS_SECTION_NUMBER_actuator &&
         index != VS_SECTION_NUMBER_supply && index != VS_SECTION_NUMBER_firing;
}

bool vs_section_key_is_named(int key) {
  for (int s = 0; s < VS_SECTIONS; s++)
    if (!strcmp(ROWS[s].name, vs_section_keys[key])) return vs_section_is_named(s);
  return true;
}

vs_filled_section vs_section_at(const vs_setup *s, int index) {
  const row *r = &ROWS[index];
  return (vs_filled_section){fields_of(index, s->model.machine, &s->deck),
                             (const char *)s + r->offset, r->size};
}

bool vs_section_counts(const vs_setup *s, int index) {
  if (index == VS_SECTION_NUMBER_limits) return false;
  return index != VS_SECTION_NUMBER_pwm || vs_deck_has_port(&s->deck, vs_port_is_modulated);
}

const vs_section *vs_section_fields(const vs_machine *machine, const vs_deck *deck, int index) {
  return fields_of(index, machine, deck);
}
