/* SPDX-License-Identifier: GPL-3.0-or-later
 * A machine as its file declares it: coordinates, parameters, and formulas for everything else
 * (docs/machines.md). Constant once it is read, but for the values that its formulas are bound to
 * (plant/build.h).
 *
 * A machine keeps the tree that it was read from. Places and texts of formulas are borrowed from
 * that tree. */
#pragma once

#include "base/field.h"
#include "base/formula.h"
#include "base/path.h"
#include "base/tree.h"
#include "plant/dimension.h"

enum {
  VS_MACHINE_COORDINATES = 16,
  VS_MACHINE_PARAMETERS = 64,
  VS_MACHINE_LETS = 64,
  VS_MACHINE_PROBES = 16,
  VS_MACHINE_BODIES = 16,
  VS_MACHINE_SPRINGS = 32,
  VS_MACHINE_NAME = 32,
  VS_MACHINE_TEXT = 160,
  VS_MACHINE_NAMES = 2 * VS_MACHINE_PARAMETERS + VS_MACHINE_LETS
};

/* A coordinate, and the names that follow from it: "p", "vp", "ap". */
typedef struct vs_coordinate {
  char name[VS_MACHINE_NAME], unit[16], text[VS_MACHINE_TEXT];
  char rate[VS_MACHINE_NAME], rate_unit[24], rate_text[VS_MACHINE_TEXT];
  char rate2[VS_MACHINE_NAME], rate2_unit[24], rate2_text[VS_MACHINE_TEXT];
  vs_where where;
} vs_coordinate;

/* The values of the scene's section machine: the file's name, and the file's parameters in SI. A
 * pair takes two of them; a choice is a whole number. */
typedef struct vs_machine_values {
  char model[VS_NAME_SIZE];
  double real[2 * VS_MACHINE_PARAMETERS];
  int choice[VS_MACHINE_PARAMETERS];
} vs_machine_values;

/* What a formula may name: a parameter, "NAME.x" and "NAME.y" of a pair, or a let. Its place in
 * vs_machine.names is the index that formulas know it by. Parameters stand first, each where its
 * value has its place in vs_machine_values.real. */
typedef struct vs_machine_name {
  char name[VS_MACHINE_NAME + 2];
  vs_dimension dimension;
  int choice; /* a choice's index in vs_machine_values.choice; -1: it is no choice */
} vs_machine_name;

/* A formula as the file has it. */
typedef struct vs_expression {
  const char *text; /* NULL: the file has none, and its value is 0 */
  vs_where where;
  vs_formula of;
  bool of_gap; /* it has terms, also by a let; of lambda and z these are 0 and 1 */
  vs_dimension dimension;
} vs_expression;

/* A named output beside the coordinates. The terms of its formula are numbered as follows: z,
 * lambda, i, force, then from VS_MACHINE_TERM_Q on the coordinates, their rates q' and q". */
enum {
  VS_MACHINE_TERM_Z,
  VS_MACHINE_TERM_LAMBDA,
  VS_MACHINE_TERM_I,
  VS_MACHINE_TERM_FORCE,
  VS_MACHINE_TERM_Q = 9
};
typedef struct vs_machine_probe {
  char name[VS_MACHINE_NAME], unit[16], text[VS_MACHINE_TEXT];
  vs_formula of; /* gives the probe in its unit */
  vs_where where;
} vs_machine_probe;

/* What formulas may be summed up in: the matrices, and the constant forces. */
enum {
  VS_MACHINE_MASS,
  VS_MACHINE_DAMPING,
  VS_MACHINE_STIFFNESS,
  VS_MACHINE_FORCES,
  VS_MACHINE_SUMS
};
extern const char *const vs_machine_sum_words[VS_MACHINE_SUMS];

/* What a machine's file says of the trough's motion, besides the coordinates: how far it moves
 * along the direction by which the paper's throw coefficient K is taken, upwards, and the way the
 * material goes. */
enum { VS_MACHINE_ALONG, VS_MACHINE_UP, VS_MACHINE_FORWARD, VS_MACHINE_WAYS };

/* The scene's load: its mass is added to a parameter where these sums are evaluated. */
typedef struct vs_machine_load {
  int adds; /* index into names; -1: the machine has no load */
  bool to[VS_MACHINE_SUMS];
  vs_expression way[VS_MACHINE_WAYS]; /* m, linear in the coordinates, which are terms 0, 1, ... */
} vs_machine_load;

/* A rigid body in the plane. Its motion is small, so that it is linear in the coordinates: how its
 * centre of mass moves along x and y, and how it turns, counter-clockwise. */
typedef struct vs_body {
  char name[VS_MACHINE_NAME];
  int on; /* index of the body that it moves with, besides its own motion; -1: it is on the ground
           */
  vs_expression mass, inertia; /* kg; kg m2, about the centre of mass */
  vs_expression at[2];         /* the centre of mass at rest, m */
  vs_expression moves[3];      /* x, y, turn; in the coordinates, which are terms 0, 1, ... */
} vs_body;

/* A spring with its damper between a point of one body and a point of another, at rest without
 * force. It pulls along x and y, each by a stiffness of its own, or along one direction. */
typedef struct vs_spring {
  char name[VS_MACHINE_NAME];
  int body[2];               /* from, to: indices of bodies; -1: the ground */
  vs_expression point[2][2]; /* where they are at rest, m */
  bool apart;                /* along x and y */
  bool directed;             /* along `along`, else along the line between the points */
  vs_expression along[2];    /* a direction of any length */
  vs_expression stiffness[2], damping[2]; /* N/m, N s/m; the second ones where `apart` is true */
  vs_where where;
} vs_spring;

/* Formulas of the law. */
enum { VS_MACHINE_CURRENT, VS_MACHINE_ENERGY, VS_MACHINE_FORCE, VS_MACHINE_LAWS };
extern const char *const vs_machine_law_words[VS_MACHINE_LAWS];

/* Begin with vs_machine_begin; end with vs_machine_free. */
typedef struct vs_machine {
  char path[VS_PATH_SIZE], title[VS_MACHINE_TEXT];
  vs_tree tree;
  bool lost;           /* not all of the file could be read; a check carries on with the rest */
  vs_section section;  /* "machine": the key model, then the parameters. It fills a
                          vs_machine_values. Fields and their texts are owned */
  vs_section actuator; /* vs_actuator_section with the file's values for defaults. Owned likewise */
  vs_section supply, firing; /* those of plant/feed.h, likewise */
  vs_section start; /* "start": the coordinates and their rates at t = 0; it fills an array of as
                       many doubles. Owned */
  int dof;
  vs_coordinate coordinates[VS_MACHINE_COORDINATES];
  vs_machine_name names[VS_MACHINE_NAMES];
  int n_parameters, n_names; /* how many of names are parameters, and how many there are in all */
  vs_expression lets[VS_MACHINE_LETS]; /* names[n_parameters + k] is that of lets[k] */
  vs_expression sums[VS_MACHINE_FORCES][VS_MACHINE_COORDINATES][VS_MACHINE_COORDINATES];
  vs_body bodies[VS_MACHINE_BODIES]; /* if there are some, sums has no text: these make M, B, K */
  int n_bodies;
  vs_spring springs[VS_MACHINE_SPRINGS];
  int n_springs;
  vs_expression forces[VS_MACHINE_COORDINATES], along[VS_MACHINE_COORDINATES];
  vs_where where_along;
  vs_machine_load load;
  vs_expression law[VS_MACHINE_LAWS];
  const vs_node *own_actuator, *own_supply, *own_firing; /* the file's sections of these names;
                                                            NULL: it has none */
  vs_machine_probe probes[VS_MACHINE_PROBES];
  int n_probes;
} vs_machine;

/* Where machines that come with the program are found, and the field "model", which is the first of
 * every machine's section. */
extern const vs_shelf vs_machine_shelf;
extern const vs_field vs_machine_key;

/* Makes an empty machine of zeros. It must be freed, also where filling it failed. */
void vs_machine_begin(vs_machine *machine);
void vs_machine_free(vs_machine *machine);

/* Adds a field to the section; its texts are copied. */
void vs_machine_add_field(vs_section *section, const vs_field *field);

/* True for the name of a coordinate, of one of its rates, or of a probe of the machine. */
bool vs_machine_has_output(const vs_machine *machine, const char *name);
