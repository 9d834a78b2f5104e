/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tables of the keys that scenes, studies and machine files may have. A row of a table tells of a
 * key what it takes, its unit, its default, what is allowed and what it means; or of a list or a
 * map, which table its own keys have. Reading, messages, lists, schemas and help go by these rows.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/text.h"
#include "base/tree.h"

typedef enum vs_field_kind {
  VS_REAL = 1,         /* double, SI; or (where choices names one) that word, read as NaN */
  VS_FACTOR = 1 << 1,  /* as VS_REAL: it multiplies something else; told only where it is not 1 */
  VS_PROFILE = 1 << 2, /* vs_field_profile: as VS_REAL, or a list of points over time */
  VS_PAIR = 1 << 3,    /* double[2], SI, written [x, y] */
  VS_CHOICE = 1 << 4,  /* int: which of `choices` */
  VS_COUNT = 1 << 5,   /* int: a whole number, or (where choices names one) that word, read as 0 */
  VS_NAME = 1 << 6,    /* char[VS_NAME_SIZE] */
  VS_OPTION = 1 << 7,  /* up to `inside.most` structs in a row, each of which begins with an int: it
                          is 1 for a map, whose keys fill the struct's other members, and for each
                          map of a list. It is 0 behind the last, and in the first for the word
                          `choices` names */
  /* Keys of machine files and of studies, which functions of their own read. A row has one of
   * these, of VS_CHOICE and VS_COUNT, or several: VS_NEEDED | VS_TEXT | VS_LIST. */
  VS_NOTHING = 1 << 8,  /* the key alone */
  VS_TEXT = 1 << 9,     /* a name, a line of text, a formula, a number with or without a unit */
  VS_PART = 1 << 10,    /* a pure number, which may be in % */
  VS_FLAG = 1 << 11,    /* true or false */
  VS_LIST = 1 << 12,    /* a list of what `inside` says */
  VS_MAP = 1 << 13,     /* a map of the keys that `inside` has */
  VS_VALUE = 1 << 14,   /* one value of the scene's key that it stands under */
  VS_SPREAD = 1 << 15,  /* a spread of that value: "5 % normal" */
  VS_SETTING = 1 << 16, /* whatever a scene may have for that key */
  VS_SENSORS = 1 << 17, /* instruments, which measure/instruments.h reads */
  VS_NEEDED = 1 << 18   /* besides others: its map must have the key */
} vs_field_kind;

enum { VS_NAME_SIZE = 256, VS_PROFILE_MOST = 64 };

/* A quantity that may change over time, straight between its points: 100 deg, or [[0 s, 160 deg],
 * [1 s, 100 deg]]. Before the first point it is the first one's, behind the last the last one's.
 * Where two points have the same time it jumps. */
typedef struct vs_field_profile {
  double first; /* the one number, or that of the first point; SI */
  int count;    /* of the points; 0: it is one number */
  double at_s[VS_PROFILE_MOST], value[VS_PROFILE_MOST];
} vs_field_profile;

typedef struct vs_field {
  const char *key; /* NULL: the row stands for all names that are the user's own, or for each of a
                      list */
  vs_field_kind kind;
  const char *unit;         /* as shown and as asked for; "" for a pure number */
  const char *default_text; /* as a user would write it */
  double min, max;          /* the least and the largest value allowed, in `unit` */
  bool open;                /* min and max themselves are not allowed; vs_field_is_idle */
  size_t offset;            /* of the member it fills, in the section's struct */
  const char *text;         /* what it means, one line */
  const char *choices;      /* VS_CHOICE: "paper|derived"; VS_REAL, VS_COUNT, VS_OPTION: a word;
                               VS_NAME: those that there are, FILE.csv of files; NULL: any name */
  const struct vs_inside *inside; /* VS_OPTION, VS_LIST, VS_MAP: what its lists and maps have */
} vs_field;

/* True for a factor that is 1, for a number that is `none`, and for an option that is not there
 * where its row has `open`; listings of a section's values leave it out. */
bool vs_field_is_idle(const vs_field *field, const void *values);

/* The quantity at t, SI. At a jump it is the later value. */
double vs_field_profile_at(const vs_field_profile *profile, double t_s);

/* True if it fills a double, at its offset: a key that can be varied. */
bool vs_field_is_real(const vs_field *field);

/* A map of a scene. */
typedef struct vs_section {
  const char *name; /* its key in the scene */
  const vs_field *fields;
  size_t count;
} vs_section;

/* What lists and maps have. The keys in effect of a VS_OPTION may depend on one of them, a
 * VS_CHOICE. */
typedef struct vs_inside {
  vs_section keys;           /* VS_OPTION: all of them, as lists show them */
  const vs_section *forms;   /* the keys in effect for each word of the chooser; NULL: `keys` */
  size_t chooser;            /* which of keys.fields */
  int most;                  /* how many maps a list of them may have; 1: no list is taken */
  size_t size;               /* of the struct that one map fills, bytes */
  const vs_field *rows;      /* VS_MAP: its keys; VS_LIST: one row. NULL: none */
  const vs_section *besides; /* VS_MAP: more keys; NULL: none */
  int count; /* how many a list or a map must have; 0: a list one or more, a map any; -1: any */
  const vs_field *instead; /* one row: what else the value may be; NULL: nothing */
} vs_inside;

/* Rows, up to one that takes nothing. Tables of it stand outside of functions. */
#define VS_ROWS(...) ((const vs_field[]){__VA_ARGS__, {0}})

/* The keys in effect of one map; values: the struct that it filled. */
const vs_section *vs_field_form(const vs_inside *inside, const void *values);
/* How many maps the field's present value has. member: the first of its structs. */
int vs_field_maps(const vs_field *field, const void *member);

/* Fills every member of out, from the scene's map where that has the key, else from the default.
 * map is NULL where the scene has no such section. Errors, each of which a check carries on from:
 * an unknown key (the nearest is named), a wrong unit, a value out of range. */
vs_status vs_field_section_read(const vs_section *section, const vs_node *map, void *out,
                                vs_error *err);

/* The two steps of vs_field_section_read. Error: the map has a key that the section has not; a
 * check carries on. */
vs_status vs_field_section_keys(const vs_section *section, const vs_node *map, vs_error *err);
/* Fills one key's member of out, from the default where node is NULL. The default stays where the
 * scene's value is refused; a check carries on. */
vs_status vs_field_read_key(const vs_section *section, const vs_field *field, const vs_node *node,
                            void *out, vs_error *err);

/* Error: the map has a key that is none of its rows and keys besides; the nearest is named, and all
 * are. what is the map's own name, for the message. A check carries on. */
vs_status vs_field_map_keys(const vs_node *map, const char *what, const vs_inside *inside,
                            vs_error *err);

/* Error: the map has a key that is none of names[count]; the nearest is named, and all are. what is
 * the map's own name, for the message. A check carries on, but not from a list in its place. */
vs_status vs_field_known_keys(const vs_node *map, const char *what, const char *const *names,
                              size_t count, vs_error *err);

/* Adds the field's present value as JSON: {"value": 6, "unit": "mm"} or "paper". */
void vs_field_json(const vs_field *field, const void *values, vs_text *text);

/* Writes what is allowed, for messages and listings: "6..12 mm", "paper|derived", ... */
void vs_field_range(const vs_field *field, char *text, size_t size);

/* Reads the node's value into the field's member of out, for values that come from elsewhere than a
 * scene's section. On error the member keeps what it had. */
vs_status vs_field_read(const vs_section *section, const vs_field *field, const vs_node *node,
                        void *out, vs_error *err);
