/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist contract: an ngspice netlist whose lines that start with "*$" say what the program
 * must know.
 *
 *   *$ title  TEXT
 *   *$ param  NAME = VALUE UNIT  MIN..MAX [assumed] "TEXT"   becomes .param NAME; scene key
 *                                    circuit.NAME
 *   *$ param  NAME = PART part [KIND] "TEXT"           a part by name: its file is included, and
 *                                    subcircuit NAME in the deck means the one of that part
 *   *$ port   mains = SOURCE                           "SOURCE n m external" has the mains voltage
 *   *$ port   gate[+ANGLE] = SOURCE                    1 V while the (delayed) gate pulse is there
 *   *$ port   burst[+ANGLE] = SOURCE                   1 V during each of its sub-pulses
 *   *$ line   NODE [NODE]                              the mains' terminals, where surges couple in
 *   *$ probe  NAME = [-]v(n) | v(n,m) | i(Vx)  UNIT  "TEXT"   a channel; i_thyristor is the anode
 *                                                             current
 *   *$ loss   NAME = FORMULA                           power that leaves the circuit, W
 *   *$ store  NAME = FORMULA                           energy held in the circuit, J
 *   *$ rating PROBE MIN..MAX UNIT  "TEXT"              allowed for a probe; enters the verdict.
 * Each end is a number or a limit of a part: -thyristor.v_rrm. An end of 0 says which sign the
 * probe may have, and is no margin while it is kept
 *   *$ require A <= B  "TEXT"                          a condition between parameters (or A < B)
 *   *$ device NAME [PART or KIND] [gate+ANGLE] [protects DEVICE] = FORMULA, FORMULA [, FORMULA]
 * "TEXT"                             its voltage and current, and its core's flux linkage, V.s (of
 * a gate drive); measures are NAME.what, and enter the
 * verdict against the limits of the part of that name (deck/devices.h). gate+ANGLE: the port its
 * gate pulses go by; else the deck's first. protects: what it lets through is held against that
 * device's limit
 *   *$ compat ps                                       the netlist is read as PSpice's dialect
 *   Xeva n m eva                                       the actuator, once
 *
 * The file of a part says besides what it is and what its maker allows:
 *
 *   *$ part   KIND "TEXT"                              thyristor, varistor, fuse, ...
 *   *$ limit  NAME = VALUE UNIT [assumed] "TEXT"       by the field's names: v_drm, i2t, ...;
 * assumed: read in no source
 *   *$ limit  NAME = none "TEXT"                       an ideal part has none
 *   *$ zth    R K/W  TAU s [assumed] "TEXT"            a term of its junction's transient thermal
 * impedance, sum of R (1 - exp(-t/TAU)) (a Foster network)
 *
 * FORMULA: formula.h. Parameters every deck may use: u_rms, f_mains, phase (rad), r_source,
 * l_source. */
#ifndef VS_DECK_DECK_H
#define VS_DECK_DECK_H

#include <stddef.h>

#include "base/error.h"
#include "base/field.h"
#include "base/path.h"
#include "deck/formula.h"
#include "drive/timeline.h"

enum {
  VS_DECK_NAME = 64,
  VS_DECK_TEXT = 160,
  VS_DECK_FILES = 32,
  VS_DECK_MOST = 64, /* of params, ports, probes, terms, losses, stores, ratings each */
  VS_DECK_PARTS = 16,
  VS_DECK_DEVICES = 32,
  VS_DECK_LIMITS = 128,
  VS_PART_ZTH = 8
};

/* Kinds of lines of which one could not be read. A check carries on without it, and then says
 * nothing of what may only seem to be missing. */
enum {
  VS_LOST_PARAM = 1,
  VS_LOST_PORT = 2,
  VS_LOST_PROBE = 4,
  VS_LOST_ELEMENT = 8,
  VS_LOST_ALL = 15
};

/* A line of the netlist with what goes on with it ('+'), end-of-line comments left out. */
typedef struct vs_line {
  char *text;
  size_t first; /* bytes of it that stand in the line of `where`; the others stand below */
  vs_where where;
} vs_line;

typedef struct vs_port {
  vs_signal signal;
  char source[VS_DECK_NAME]; /* lower case */
  vs_where where;
} vs_port;

/* What probes and formulas are made of: the difference of two of the circuit's signals. */
typedef struct vs_term {
  char plus[VS_DECK_NAME], minus[VS_DECK_NAME]; /* "v(a)", "i(vth)", "v(0)" */
  vs_where where;                               /* where it is first named */
} vs_term;

typedef struct vs_probe {
  char name[VS_DECK_NAME], unit[16], text[VS_DECK_TEXT];
  double sign;
  int term;
} vs_probe;

/* A loss or a store. */
typedef struct vs_account {
  char name[VS_DECK_NAME];
  vs_formula formula; /* W or J, of the terms */
} vs_account;
typedef struct vs_accounts {
  vs_account item[VS_DECK_MOST];
  size_t count;
} vs_accounts;

/* An end of a rating: a number, or a limit of a part. */
typedef struct vs_bound {
  double value;                                 /* in the rating's unit */
  char part[VS_DECK_NAME], limit[VS_DECK_NAME]; /* empty: the number */
  double sign;                                  /* of the limit */
} vs_bound;
typedef struct vs_rating {
  int probe;
  double min, max; /* SI, once the parts are read; one of them may be infinite; shown in `unit` */
  char unit[16], text[VS_DECK_TEXT];
  vs_bound bounds[2];
  vs_where where;
} vs_rating;

/* Of a part's file. */
typedef struct vs_part_file {
  char kind[VS_DECK_NAME], text[VS_DECK_TEXT];
  vs_where where;
} vs_part_file;
typedef struct vs_limit {
  char name[VS_DECK_NAME], unit[16], text[VS_DECK_TEXT];
  char written[VS_DECK_NAME + 18]; /* "800 V", "none" */
  double value;                    /* SI; infinite: none */
  bool assumed;
  vs_where where;
} vs_limit;

/* left < right, of parameters */
typedef struct vs_requirement {
  vs_formula left, right;
  bool equal; /* is enough */
  char written[VS_DECK_TEXT], text[VS_DECK_TEXT];
  vs_where where;
} vs_requirement;

/* A term of a part's transient thermal impedance. */
typedef struct vs_zth {
  double k_per_w, tau_s;
  bool assumed;
  vs_where where;
} vs_zth;

/* A device whose stress is measured (deck/devices.h). */
typedef struct vs_device {
  char name[VS_DECK_NAME], of[VS_DECK_NAME], text[VS_DECK_TEXT]; /* of: its part or kind, as said */
  vs_formula voltage, current, flux;                             /* V, A, V.s of a core */
  bool has_flux;
  const struct vs_kind *kind; /* once the parts are read, as the part and the gate */
  int part;                   /* of the deck's; -1: none */
  double gate_rad;            /* delay of its gate pulses; NaN: the deck has none */
  char ward[VS_DECK_NAME];    /* the device it protects, as said; empty: none */
  int protects;               /* its number; -1: none */
  vs_where where, where_of, where_gate, where_ward, where_flux;
} vs_device;

/* A parameter that formulas name. */
typedef struct vs_named {
  char name[VS_DECK_NAME];
  vs_where where;
} vs_named;

/* A parameter whose value is a part: a file that defines a subcircuit of the file's name. */
typedef struct vs_part {
  const char *name;              /* the parameter's; the field's own */
  char kind[VS_DECK_NAME];       /* wanted; empty: any */
  char subcircuit[VS_DECK_NAME]; /* of the part taken; empty: none yet */
  const char *file;              /* of the part taken, one of the deck's; NULL: none yet */
} vs_part;

/* The scene's section circuit: the deck's name, that deck's parameters in SI and its parts' names,
 * each in its order. */
typedef struct vs_circuit_values {
  char deck[VS_NAME_SIZE];
  double params[VS_DECK_MOST];
  char parts[VS_DECK_PARTS][VS_NAME_SIZE];
} vs_circuit_values;
extern const vs_field vs_deck_key; /* "deck"; the first field of every deck's section */

typedef struct vs_deck {
  char *files[VS_DECK_FILES]; /* the deck and what it includes, for messages */
  size_t n_files;
  unsigned lost; /* VS_LOST_... */
  char title[VS_DECK_TEXT];
  char compat[8]; /* ngspice's name of a dialect; empty: its own */
  vs_line *lines; /* the files', comments and blank lines left out */
  size_t n_lines;
  vs_section
      section; /* "circuit": the key deck, then params and parts; fills a vs_circuit_values */
  vs_port ports[VS_DECK_MOST];
  size_t n_ports;
  vs_term terms[VS_DECK_MOST];
  size_t n_terms;
  vs_probe probes[VS_DECK_MOST];
  size_t n_probes;
  vs_accounts losses, stores;
  vs_named names[VS_DECK_MOST];
  size_t n_names;
  vs_rating ratings[VS_DECK_MOST];
  size_t n_ratings;
  vs_part_file part_files[VS_DECK_PARTS];
  size_t n_part_files;
  vs_limit limits[VS_DECK_LIMITS];
  size_t n_limits;
  vs_requirement requirements[VS_DECK_MOST];
  size_t n_requirements;
  vs_device devices[VS_DECK_DEVICES];
  size_t n_devices;
  vs_zth zth[VS_DECK_LIMITS];
  size_t n_zth;
  vs_part parts[VS_DECK_PARTS];
  size_t n_parts;
  const char *eva_file;       /* of the program's, that an event has put in the place of the EVA's
                                 own; NULL: none has */
  bool eva_led;               /* the EVA's own file is eva_led.inc, which can be led, not eva.inc */
  char line[2][VS_DECK_NAME]; /* nodes at which surges couple in; empty: not said */
  int subcircuits;            /* open ones, while it is read */
  bool own_clock;             /* a source or formula of its own knows the time */
  char eva[VS_DECK_NAME], eva_plus[VS_DECK_NAME],
      eva_minus[VS_DECK_NAME]; /* instance, its two nodes */
} vs_deck;

extern const vs_shelf vs_deck_shelf, vs_parts_shelf;

/* Reading a deck takes three calls: its own files; then, once the scene has named its parts,
 * theirs; then, once the parameters have values, the formulas. vs_deck_free even after an error. */

/* Errors, each with file:line: a line of the contract that cannot be read, a name declared twice,
 * an unknown port, no or a second EVA, a statement that is the program's own. */
vs_status vs_deck_read(const char *path, vs_deck *deck, vs_error *err);

/* Takes in the files of the parts the scene's section circuit names (NULL: none), else of the
 * defaults; they may add to the contract. */
vs_status vs_deck_read_parts(vs_deck *deck, const vs_node *section, vs_error *err);

/* The file of one part alone, to see what it says of itself. vs_deck_free even after an error. */
vs_status vs_deck_read_part(const char *path, vs_deck *part, vs_error *err);

/* Parameters of the program's, for every deck to use; the last two are the EVA's own. */
enum { VS_STANDARD = 7 };
extern const char *const vs_deck_standard_names[VS_STANDARD];

typedef struct vs_deck_value {
  const char *name;
  double value;
} vs_deck_value;

/* Gives the formulas their parameters. standard: the program's. Error: a name nobody declared. */
vs_status vs_deck_bind(vs_deck *deck, const vs_circuit_values *values,
                       const vs_deck_value *standard, size_t n_standard, vs_error *err);

/* The conditions between parameters, once formulas are bound. section: the scene's, for the place
 * of what breaks one; may be NULL. */
vs_status vs_parts_require_hold(const vs_deck *deck, const vs_circuit_values *values,
                                const vs_node *section, vs_error *err);

/* Do the mains alone, of this rms value, exceed what part number `part` of the deck allows? Then
 * text says so. */
bool vs_parts_below_mains(const vs_deck *deck, size_t part, double rms_v, char *text, size_t size);
/* Is limit number `limit` of a name that nothing is held against, neither a measure of its part's
 * kind nor a rating of the deck? Then text says so, and which name may be meant. */
bool vs_parts_limit_is_idle(const vs_deck *deck, size_t limit, char *text, size_t size);
/* Does device number `device` of the deck protect another, and may it, by its maker's figures, let
 * more through than that one bears? Then text says so. */
bool vs_devices_fails_ward(const vs_deck *deck, size_t device, char *text, size_t size);
void vs_deck_free(vs_deck *deck);

/* The netlist ready to load: title, .param lines, the deck's own lines, the EVA's subcircuit.
 * Free with vs_netlist_free. */
vs_status vs_netlist_make(const vs_deck *deck, const vs_circuit_values *values,
                          const vs_deck_value *standard, size_t n_standard, char ***lines,
                          size_t *count, vs_error *err);
void vs_netlist_free(char **lines, size_t count);

/* Is there a capacitor or an inductor in the deck's own file, as opposed to parts, at no node that
 * a probe, a loss, a store or a device names? What it holds nobody sees. */
bool vs_netlist_hides_state(const vs_deck *deck);

/* Puts the place in the deck before what the solver said of its circuit, if it can be found: of a
 * signal that is not there, of an undefined parameter (ngspice says "[name]"), of an element. */
void vs_netlist_locate(const vs_deck *deck, vs_error *err);

#endif
