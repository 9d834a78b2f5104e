/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tables of the keys of those maps that no struct is filled from: maps of a machine's file and of a
 * study. The function that reads such a map refuses keys that its table does not have; what it
 * takes for each key is told here for schemas. */
#ifndef VS_BASE_OUTLINE_H
#define VS_BASE_OUTLINE_H

#include "base/field.h"

/* What a value may be. A row has one of these or several. */
enum {
  VS_OUTLINE_NOTHING = 1,  /* the key alone */
  VS_OUTLINE_TEXT = 2,     /* a name, a line of text, a formula, a number with or without a unit */
  VS_OUTLINE_WHOLE = 4,    /* a whole number */
  VS_OUTLINE_PART = 8,     /* a pure number, which may be in % */
  VS_OUTLINE_FLAG = 16,    /* true or false */
  VS_OUTLINE_WORD = 32,    /* one of `words` */
  VS_OUTLINE_LIST = 64,    /* a list */
  VS_OUTLINE_MAP = 128,    /* a map of keys */
  VS_OUTLINE_VALUE = 256,  /* one value of the scene's key that it stands under */
  VS_OUTLINE_SPREAD = 512, /* a spread of that value: "5 % normal" */
  VS_OUTLINE_SETTING = 1024, /* whatever a scene may have for that key */
  VS_OUTLINE_SENSORS = 2048, /* instruments, which measure/instruments.h reads */
  VS_OUTLINE_NEEDED = 4096   /* besides others: its map must have the key */
};

/* A table ends with a row that takes nothing. */
typedef struct vs_outline {
  const char *key; /* NULL: the row stands for all names that are the user's own, or for each of a
                      list */
  unsigned takes;  /* VS_OUTLINE_... */
  const struct vs_outline *of; /* of a map: the table of its keys; of a list: one row. NULL: none */
  const char *words;           /* "one|other" */
  int count; /* how many a list or a map must have; 0: a list one or more, a map any; -1: any */
  const vs_section *section;        /* of a map: keys besides; NULL: none */
  const struct vs_outline *instead; /* one row: what else the value may be; NULL: nothing */
} vs_outline;

/* Error: the map has a key that is none of the table's; the nearest is named, and all are. what is
 * the map's own name, for the message. A check carries on. */
vs_status vs_outline_known_keys(const vs_node *map, const char *what, const vs_outline *keys,
                                vs_error *err);

#endif
