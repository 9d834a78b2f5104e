/* SPDX-License-Identifier: GPL-3.0-or-later
 * A deck: an ngspice netlist together with what its "*$" lines say about it. The language of these
 * lines stands in netlist/contract.h, its kinds of lines are read in contract.c, parts.c and
 * devices.c, and the files of a deck in netlist.c. Here is what they fill, the vs_deck, and what is
 * common to all who fill it.
 *
 * A place (vs_where) in these structs borrows the file's name from vs_deck.files; texts in arrays
 * are the struct's own. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/cursor.h"
#include "base/error.h"
#include "base/field.h"
#include "base/formula.h"
#include "base/path.h"
#include "base/text.h"
#include "netlist/line.h"
#include "netlist/port.h"
#include "netlist/statements.h"
#include "netlist/tally.h"
#include "plant/values.h"

/* How much a deck may hold. A line beyond that is refused with its place. */
enum {
  VS_DECK_NAME = 64,  /* bytes of a name, its end included */
  VS_DECK_TEXT = 160, /* bytes of a description, its end included */
  VS_DECK_FILES = 32,
  VS_DECK_MOST = 64, /* of params, ports, probes, terms, losses, stores, ratings each */
  VS_DECK_PARTS = 16,
  VS_DECK_DEVICES = 32,
  VS_DECK_LIMITS = 128,
  VS_DEVICE_PORTS = 4,  /* ports that one device may name */
  VS_DEVICE_MOST = 40,  /* measures of a kind of device */
  VS_DECK_MOTIONS = 33, /* the gap's rate, 16 coordinates and their rates */
  VS_PART_ZTH = 8       /* terms of one part's thermal impedance */
};

/* Kinds of lines of which one could not be read. A check carries on without the line, and then does
 * not complain of things that may only seem to be missing. */
enum {
  VS_LOST_PARAM = 1,
  VS_LOST_PORT = 2,
  VS_LOST_PROBE = 4,
  VS_LOST_ELEMENT = 8,
  VS_LOST_ALL = 15
};

/* ---- what the deck's own lines declare ---- */

typedef struct vs_port {
  vs_signal signal;
  char source[VS_DECK_NAME]; /* the netlist's voltage source that it drives, in lower case */
  vs_where where;
} vs_port;

/* What probes and formulas are made of: the difference of two of the circuit's signals. */
typedef struct vs_term {
  char plus[VS_DECK_NAME], minus[VS_DECK_NAME]; /* "v(a)", "i(vth)", "v(0)" */
  vs_where where;                               /* where it is first named */
} vs_term;

/* A channel of the deck: sign times a term. */
typedef struct vs_probe {
  char name[VS_DECK_NAME], unit[16], text[VS_DECK_TEXT];
  double sign;             /* +1 or -1 */
  int term;                /* index into vs_deck.terms */
  vs_where where, unit_at; /* where its name stands, and its unit */
} vs_probe;

/* A loss (W) or a store (J). */
typedef struct vs_account {
  char name[VS_DECK_NAME];
  vs_formula formula; /* its terms are indices into vs_deck.terms */
} vs_account;
typedef struct vs_accounts {
  vs_account item[VS_DECK_MOST];
  size_t count;
} vs_accounts;

/* A parameter that formulas name. */
typedef struct vs_named {
  char name[VS_DECK_NAME];
  vs_where where; /* where it is first named */
} vs_named;

/* A condition between parameters: left < right, or left <= right. */
typedef struct vs_requirement {
  vs_formula left, right;
  bool equal; /* true for <= */
  char written[VS_DECK_TEXT], text[VS_DECK_TEXT];
  vs_where where;
} vs_requirement;

/* ---- parts, and what is allowed ---- */

/* A parameter whose value is a part: a file that defines a subcircuit of the file's name. */
typedef struct vs_part {
  const char *name;              /* the parameter's; the deck's section owns it */
  char kind[VS_DECK_NAME];       /* the kind of part that is wanted; empty: any */
  char subcircuit[VS_DECK_NAME]; /* of the part chosen; empty: none yet */
  const char *file;              /* of the part chosen, one of vs_deck.files; NULL: none yet */
  vs_where where;                /* of the parameter's line */
} vs_part;

/* What a part's file says it is. */
typedef struct vs_part_file {
  char kind[VS_DECK_NAME], text[VS_DECK_TEXT];
  vs_where where;
} vs_part_file;

/* What a figure lacks, as bits. */
enum {
  VS_ASSUMED = 1, /* no source says it */
  VS_TYPICAL = 2  /* its source calls it typical, and guarantees nothing */
};
/* "", "assumed", "typical", "assumed, typical"; and " (assumed)", as a note */
extern const char *const vs_deck_unsure_words[4], *const vs_deck_unsure_notes[4];

/* A limit that a part's file gives. */
typedef struct vs_limit {
  char name[VS_DECK_NAME], unit[16], text[VS_DECK_TEXT];
  char written[VS_DECK_NAME + 18]; /* "800 V", "none" */
  double value;                    /* SI; infinite for "none" */
  unsigned unsure;                 /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_limit;

/* A row of a fuse's time-current curve: a current that its element melts at no sooner than that. */
typedef struct vs_melting_row {
  double time_s, current_a;
  unsigned unsure; /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_melting_row;

/* A row of what is left of a limit at an ambient temperature. */
typedef struct vs_ambient_row {
  char limit[VS_DECK_NAME];
  double ambient_degc, factor; /* factor: 1 for all of it */
  unsigned unsure;             /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_ambient_row;

/* A term of a part's transient thermal impedance: k_per_w (1 - exp(-t/tau_s)). */
typedef struct vs_zth {
  double k_per_w, tau_s;
  unsigned unsure; /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_zth;

/* The peak current that a part bears in `number` pulses of that width, one of a table. The width is
 * that of the rectangle of the same peak and charge. */
typedef struct vs_derating {
  double width_s, number, current_a;
  unsigned unsure; /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_derating;

/* The peak current that a part bears once in so many consecutive cycles of the mains: I_TSM over n
 * cycles, one of a table. */
typedef struct vs_surge_row {
  double number, current_a;
  unsigned unsure; /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_surge_row;

/* What a limit of the part is at another temperature of the junction than t_j_max, for which the
 * part's line `limit` gives it. */
typedef struct vs_limit_at {
  char name[VS_DECK_NAME]; /* the limit's */
  double at_degc, value;   /* SI */
  unsigned unsure;         /* VS_ASSUMED, VS_TYPICAL */
  vs_where where;
} vs_limit_at;

/* How a part's model does beside its data sheet, by the test stand of `check`. */
typedef struct vs_model_line {
  char figure[VS_DECK_NAME]; /* as the limit of that name: "v_clamp" */
  double deviation;          /* of the model's figure from the sheet's, as a part of the sheet's */
  vs_where where;
} vs_model_line;

/* An end of a rating: a number, or a limit of a part. */
typedef struct vs_bound {
  double value;                                 /* the number, in the rating's unit */
  char part[VS_DECK_NAME], limit[VS_DECK_NAME]; /* empty where the end is a number */
  double sign;                                  /* of the limit, +1 or -1 */
  unsigned unsure;                              /* of the limit; known once the parts are read */
} vs_bound;

/* What a probe may be. */
typedef struct vs_rating {
  int probe;                         /* index into vs_deck.probes */
  double min, max;                   /* SI, known once the parts are read; one may be infinite */
  char unit[16], text[VS_DECK_TEXT]; /* the unit that min and max are shown in */
  vs_bound bounds[2];                /* min and max as the deck gives them */
  vs_where where;
} vs_rating;

/* The gate pulses that a device goes by, those of one gate port or of several: by how much each
 * port delays them against the port `gate`. */
typedef struct vs_gates {
  double rad[VS_DEVICE_PORTS];
  size_t count; /* 0: the deck has no gate port */
} vs_gates;

/* A port that a device's line names. */
typedef struct vs_named_port {
  vs_signal signal;
  vs_where where;
} vs_named_port;

/* A device whose stress is measured (netlist/devices.h). Kind, part, gates and ward are known once
 * the parts are read. */
typedef struct vs_device {
  char name[VS_DECK_NAME], text[VS_DECK_TEXT];
  char of[VS_DECK_NAME];       /* its part or kind as the line says; empty: by its name */
  vs_formula voltage, current; /* V, A */
  vs_formula flux;             /* V.s, of its core; only where has_flux is true */
  bool has_flux;
  const struct vs_kind *kind;           /* NULL: none is known */
  int part;                             /* index into vs_deck.parts; -1: none */
  vs_named_port ports[VS_DEVICE_PORTS]; /* as the line says */
  size_t n_ports;
  vs_gates
      gates; /* those it goes by; of a kind without a gate those of the deck's first gate port */
  size_t scale_at;  /* offset in vs_circuit_values of the factor of its own, the key NAME_scale
                       (netlist/netlist.h); 0: it has none */
  bool doubtful;    /* an event makes its formulas untrue (engine/drive/wiring.h) */
  size_t opened_by; /* number of the event that opens its circuit, from 1; 0: none does */
  double mains_v;   /* rms voltage of the mains that may drive its current; NaN: not known, as for a
                       device that a transformer or a source of the deck's own may drive. Known once
                       the formulas are bound */
  char ward[VS_DECK_NAME];            /* the device it protects, as the line says; empty: none */
  int protects;                       /* index of that device; -1: none */
  unsigned char held[VS_DEVICE_MOST]; /* for each measure of its kind the limit that it is held to,
                                  as its number in vs_deck.limits, from 1; 0: none */
  vs_where where, where_of, where_ward, where_flux;
} vs_device;

/* A node of the EVA that shows the machine's motion besides the gap (netlist/eva.h). It is there
 * only where the deck names it. */
typedef struct vs_motion_node {
  char name[VS_DECK_NAME]; /* within the EVA, in lower case: "vz", "q_NAME", "v_NAME" */
  int state; /* index into the machine's state (q, q'), of which the node has the value in SI; -1:
                it has the gap's rate, m/s */
} vs_motion_node;

/* ---- the deck ---- */

/* The values of the scene's section circuit: the deck's name, the deck's parameters in SI, and the
 * names of its parts; parameters and parts each in the order of their lines. */
typedef struct vs_circuit_values {
  char deck[VS_NAME_SIZE];
  double params[VS_DECK_MOST];
  char parts[VS_DECK_PARTS][VS_NAME_SIZE];
} vs_circuit_values;

/* The field "deck", which is the first of every deck's section. */
extern const vs_field vs_deck_key;

/* Begin with vs_deck_begin; end with vs_deck_free. */
typedef struct vs_deck {
  bool begun, freed;          /* it has had something else than zeros in it, which was freed */
  char *files[VS_DECK_FILES]; /* paths of the deck and of what it includes; owned */
  vs_where included[VS_DECK_FILES]; /* the line that includes each file that comes with the program,
                                       or takes it as a part; no place: for others, and if nothing
                                       includes it */
  bool pspice[VS_DECK_FILES];       /* a line "*$ compat ps" in it, or in what includes it */
  bool isspice[VS_DECK_FILES]; /* a .subckt of it has its parameters in braces, as IsSpice's have */
  size_t n_files;
  bool drive_known, other_drive; /* whether more than the mains drives it; known since the first
                                    vs_deck_bind */
  unsigned lost;                 /* VS_LOST_... of the lines that could not be read */
  vs_skipped skipped;            /* statements that a circuit is not made of, until they are told */
  vs_tally changes;              /* what was changed in lines, until it is told */
  unsigned long
      own_functions;    /* those of netlist/dialect/functions.h that the netlist defines itself */
  vs_findings *remarks; /* warnings of what was skipped, changed or may be meant otherwise, each
                           with its place; owned; NULL: there are none */
  char title[VS_DECK_TEXT];
  bool has_title_line; /* its first line may be its title; false for a part */
  char compat[8];      /* ngspice's name of a dialect; empty: its own */
  vs_line *lines;      /* of all files, comments and blank lines left out; owned */
  size_t n_lines;
  struct vs_library *library; /* what included libraries have that may still be called; owned */
  struct vs_cards *cards;     /* the lines taken apart, once somebody asks (vs_deck_cards); owned */
  vs_section section;         /* "circuit": vs_deck_key, then params and parts. It fills a
                                 vs_circuit_values. Fields and their texts are owned. */
  /* of each param: what its default lacks, VS_ASSUMED or VS_TYPICAL, and what its value does, which
   * the scene may give */
  unsigned char unsure[VS_DECK_MOST][2];
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
  vs_melting_row melting[VS_DECK_LIMITS];
  size_t n_melting;
  vs_ambient_row ambients[VS_DECK_MOST];
  size_t n_ambients;
  vs_zth zth[VS_DECK_LIMITS];
  size_t n_zth;
  vs_derating deratings[VS_DECK_LIMITS];
  size_t n_deratings;
  vs_surge_row surges[VS_DECK_LIMITS];
  size_t n_surges;
  vs_limit_at limits_at[VS_DECK_MOST];
  size_t n_limits_at;
  vs_model_line models[VS_DECK_LIMITS];
  size_t n_models;
  vs_part parts[VS_DECK_PARTS];
  size_t n_parts;
  const char *eva_file; /* of the program's, that an event has put in the place of the EVA's
                           own; NULL: none has */
  bool eva_led;         /* the EVA's own file is eva_led.inc, which can be led, not eva.inc */
  vs_text eva_current, eva_lines; /* the coil's law for the EVA's subcircuit, and the lines that it
                                     needs (netlist/eva.h); empty: the law is the file's own */
  /* the secondaries beside the coil: resistance and inductance, as seen from all its turns */
  double eva_eddy[VS_MOST_RUNGS + 1][2];
  size_t n_eva_eddies;
  double eva_flux_wb;                      /* the EVA's flux linkage at t = 0 */
  vs_motion_node motions[VS_DECK_MOTIONS]; /* those that the deck names */
  size_t n_motions;
  vs_where reads_eva; /* the first line of a circuit element, or of a function, that names a node of
                         the EVA's; no file: none does */
  char line[2][VS_DECK_NAME]; /* nodes at which surges couple in; empty: not said */
  char earth[VS_DECK_NAME];   /* the node of the protective earth; empty: not said */
  const int *column;   /* while a line with cells of a table is read: the column of each byte's cell
                          (netlist/catalogue.h) */
  int subcircuits;     /* how many are open, while the deck is read */
  vs_where subcircuit; /* of the outermost that is open */
  bool own_clock;      /* a source or an expression of the deck's own knows the time */
  bool stands; /* a direct supply was there before t = 0: a run begins at the operating point */
  char eva[VS_DECK_NAME]; /* the EVA's instance, and its two nodes */
  char eva_plus[VS_DECK_NAME], eva_minus[VS_DECK_NAME];
} vs_deck;

/* Where decks and parts that come with the program are found. */
extern const vs_shelf vs_deck_shelf, vs_deck_parts_shelf;

/* Makes an empty deck of zeros, or of a deck that was freed: it has 200 kB, so zeros that are there
 * already are not written again. It must be freed, also where filling it failed. */
void vs_deck_begin(vs_deck *deck);
void vs_deck_free(vs_deck *deck);

/* Adds a warning to deck->remarks. Beyond VS_MOST_FINDINGS of them the last one says that there are
 * more. */
void vs_deck_remark(vs_deck *deck, vs_where where, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* True for a deck or a part that comes with the program. */
bool vs_deck_is_shipped(const char *file);

/* Returns the place that the user has to mend if something is wrong at `where`. In a file that
 * comes with the program, and that another one includes or takes as a part, that is the line that
 * does so; `within` then becomes " (FILE:LINE:COLUMN)" of `where` itself. Else it is `where`, and
 * `within` is empty. */
vs_where vs_deck_mendable(const vs_deck *deck, vs_where where, char *within, size_t size);

/* Adds a line to the netlist. The deck owns what the line owns from then on. */
void vs_deck_add_line(vs_deck *deck, vs_line line);

/* The netlist taken apart, in which the name of a part means the one that is chosen. It stays as
 * long as no line is added or changed: who changes one calls vs_deck_changed. */
const struct vs_cards *vs_deck_cards(const vs_deck *deck);
void vs_deck_changed(vs_deck *deck);

/* Adds a field to the deck's section; its texts are copied. `where` is the place of its line.
 * Error: the key stands there already, or is one of the program's or of ngspice's. */
vs_status vs_deck_add_field(vs_deck *deck, const vs_field *field, vs_where where, vs_error *err);

/* Adds the term of these nodes, quantity 'v' or 'i', unless it is there already. Returns its index,
 * or -1 where there is no room. */
int vs_deck_add_term(vs_deck *deck, vs_where where, char quantity, const char *first,
                     const char *second);

/* Takes the word assumed or typical, where one of them is next, and returns its bit. */
unsigned vs_deck_unsure(vs_cursor *c);

/* The first parameter from number *k on, which becomes the next one's, whose value lacks one of
 * `lack` and that is named in the device's formulas, or in the line of the netlist's element of
 * that name outside of subcircuits; either may be NULL. NULL: there is none. */
const char *vs_deck_lacking(const vs_deck *deck, unsigned lack, const vs_device *device,
                            const char *element, size_t *k);

/* Reads a formula at the cursor; its terms and names are added to the deck. `follow` is a list of
 * the characters that may stand behind it, besides the end of the line. Errors with their place;
 * the formula is empty then. */
vs_status vs_deck_add_formula(vs_deck *deck, vs_cursor *c, const char *follow, vs_formula *formula,
                              vs_error *err);

/* ---- parameters ---- */

/* Parameters that the program gives every deck; the last two are the EVA's own. An index into
 * vs_deck_standard_names. */
enum {
  VS_STANDARD_U_RMS,          /* V */
  VS_STANDARD_F_MAINS,        /* Hz */
  VS_STANDARD_PHASE,          /* rad */
  VS_STANDARD_R_SOURCE,       /* ohm */
  VS_STANDARD_L_SOURCE,       /* H */
  VS_STANDARD_EVA_RESISTANCE, /* ohm */
  VS_STANDARD_EVA_A,          /* a of Eq. 72, H m */
  VS_STANDARD
};
extern const char *const vs_deck_standard_names[VS_STANDARD];

/* True for the name of one of these parameters, in capitals or not. */
bool vs_deck_is_standard(const char *name);

/* True if a port of the deck has a signal of that sort, as vs_port_is_gated tells. */
bool vs_deck_has_port(const vs_deck *deck, bool (*is)(const vs_signal *signal));

/* A parameter's name and value, SI. */
typedef struct vs_deck_value {
  const char *name;
  double value;
} vs_deck_value;

/* Gives all formulas the values of their parameters: the deck's own from `values`, the program's
 * from `standard`; and each device its mains_v. Error: a name that nobody declared. */
vs_status vs_deck_bind(vs_deck *deck, const vs_circuit_values *values,
                       const vs_deck_value *standard, size_t n_standard, vs_error *err);
