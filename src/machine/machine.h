/* SPDX-License-Identifier: GPL-3.0-or-later
 * A machine as its file declares it: coordinates, parameters, and formulas for everything else
 * (docs/machines.md). Constant once it is read. */
#ifndef VS_MACHINE_MACHINE_H
#define VS_MACHINE_MACHINE_H

#include "base/path.h"
#include "syntax/field.h"
#include "syntax/formula.h"
#include "syntax/tree.h"

enum {
  VS_MACHINE_COORDINATES = 16,
  VS_MACHINE_PARAMETERS = 64,
  VS_MACHINE_LETS = 64,
  VS_MACHINE_PROBES = 16,
  VS_MACHINE_NAME = 32,
  VS_MACHINE_TEXT = 160
};

/* A coordinate, and the names that follow from it: "p", "vp", "ap". */
typedef struct vs_coordinate {
  char name[VS_MACHINE_NAME], unit[16], text[VS_MACHINE_TEXT];
  char rate[VS_MACHINE_NAME], rate_unit[16], rate_text[VS_MACHINE_TEXT];
  char rate2[VS_MACHINE_NAME], rate2_unit[16], rate2_text[VS_MACHINE_TEXT];
  vs_where where;
} vs_coordinate;

/* The values of the scene's section machine: the file's name, and the file's parameters in SI. A
 * pair takes two of them; a choice is a whole number. */
typedef struct vs_machine_values {
  char model[VS_NAME_SIZE];
  double real[2 * VS_MACHINE_PARAMETERS];
  int choice[VS_MACHINE_PARAMETERS];
} vs_machine_values;

/* A named output beside the coordinates. The terms of its formula are numbered as follows: z,
 * lambda, i, force, then from VS_MACHINE_TERM_Q on the coordinates, their rates q' and q". */
enum {
  VS_MACHINE_TERM_Z,
  VS_MACHINE_TERM_LAMBDA,
  VS_MACHINE_TERM_I,
  VS_MACHINE_TERM_FORCE,
  VS_MACHINE_TERM_Q = 8
};
typedef struct vs_machine_probe {
  char name[VS_MACHINE_NAME], unit[16], text[VS_MACHINE_TEXT];
  vs_formula of;
} vs_machine_probe;

/* Begin with vs_machine_read; end with vs_machine_free. */
typedef struct vs_machine {
  char path[VS_PATH_SIZE], title[VS_MACHINE_TEXT];
  vs_section section; /* "machine": the key model, then the parameters. It fills a
                         vs_machine_values. Fields and their texts are owned */
  vs_section start;   /* "start": the coordinates and their rates at t = 0; it fills an array of as
                         many doubles. Owned */
  int dof;
  vs_coordinate coordinates[VS_MACHINE_COORDINATES];
  vs_machine_probe probes[VS_MACHINE_PROBES];
  int n_probes;
} vs_machine;
extern const vs_machine vs_machine_conveyor;

/* True for the name of a coordinate, of one of its rates, or of a probe of the machine. */
bool vs_machine_has_output(const vs_machine *machine, const char *name);

#endif
