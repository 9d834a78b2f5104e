/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `help`: of the program, of a command, of a topic; the source of the manual page. */

#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "default_models.h"
#include "list.h"
#include "measure/expect.h"
#include "netlist/kinds.h"
#include "options.h"
#include "run/sections.h"

/* ---- topics with words of their own ---- */

static void print_exit(void) {
#define EXIT_ROW(name, status, text) printf("%3d  %s\n", status, text);
  VS_STATUS_LIST(EXIT_ROW)
#undef EXIT_ROW
}

static void print_units(void) {
  puts(
      "A quantity is a number and its unit: 6 mm, 95deg, 0.1 N.s/m, 3.86e-3 kg.m2. Only 0 and "
      "pure\n"
      "numbers stand alone. Units: m g s A V W J N Hz ohm H F Wb rad deg K degC % min cycles.\n"
      "Prefixes: f p n u m c k M G. Products have '.' or '*', one '/' divides, powers follow: m2.");
}

static void print_scene(void) {
  puts("A scene is a YAML file. Each section is a map of keys, each key has a default:");
  for (int k = 0; k < VS_SECTION_KEYS; k++) printf("  %s\n", vs_section_keys[k]);
  puts("vibrospice help SECTION tells its keys; vibrospice new my.yaml writes them all to a file.");
}

static void print_quality(void) {
  puts("quality: the probes of currents whose period is compared with the mains' sine, as\n"
       "quality: [i]. What is then told of each: vibrospice steady --help, docs/power.md.");
}

static void print_expect(void) {
  puts("expect: what may happen to the deck's devices, and has to, as expect: [fuse_2 opens].\n"
       "Without an entry it breaks the verdict; an entry that does not come breaks it, too.");
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++)
    for (size_t k = 0; k < kind->n_measures; k++)
      if (kind->measures[k].held == VS_NEVER)
        printf("  %-12s %s\n", kind->name, vs_kinds_happening(&kind->measures[k])->verb);
  puts("A criterion is an entry, too: what may happen to any device, and does not have to.");
  for (int k = 0; k < VS_CRITERIA; k++)
    printf("  %-12s %s\n", vs_expect_criteria[k].name, vs_expect_criteria[k].text);
}

static void print_waive(void) {
  puts("waive: limits of the deck's devices that the verdict leaves out, as\n"
       "waive: [varistor_1.power, thyristor.t_q]\n"
       "Each is a device and one of its measures or limits, or a device alone. A waived line\n"
       "stays in the table and breaks nothing. A part whose file states limits, but not all that\n"
       "decide, leaves the verdict undecided unless they are waived. What decides:");
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++)
    for (size_t k = 0; k < kind->n_measures; k++) {
      const vs_device_measure *m = &kind->measures[k];
      if (m->limit && m->held != VS_WARD_AT_MOST && vs_kinds_decides(kind->name, m->limit))
        printf("  %-12s %-12s limit %s\n", kind->name, m->name, m->limit);
    }
}

static void print_spread(void) {
  puts(
      "spread: what of the scene is not known exactly, each key with its tolerance, as\n"
      "spread: {supply.voltage: 10 %, circuit.varistor_1_scale: tolerance and ageing, circuit.r1: "
      "2 "
      "ohm}\n"
      "A tolerance is a part of the key's value, or in its unit, or what the part's file states "
      "of\n"
      "the device: tolerance, ageing, or both. vibrospice run --corners runs the scene at all ends "
      "of\n"
      "up to 6 keys, or pairs as supply.voltage with circuit.line_voltage, and breaks where one "
      "of\n"
      "them breaks. More keys, and more processes: a study with sample: {method: corners, spread:\n"
      "{...}}. More: docs/verdict.md.");
}

static void print_ratings(void) {
  puts("ratings: what you allow of measures and of probes, as\n"
       "ratings: {stroke: 0.5 mm .. 1.5 mm, r1.power: .. 2 W, v_ak: -900 .. 900 V, p_min: -5 mm "
       "..}\n"
       "Each is a line of the verdict. What can be rated: vibrospice list measures, vibrospice "
       "list\n"
       "probes, and what quality tells. More: docs/verdict.md.");
}

static void print_heat(void) {
  puts(
      "ambient and heatsink: what cools the circuit's devices, as\n"
      "ambient: 40 degC\n"
      "heatsink: {thyristor: 12 K/W}\n"
      "The first is 25 degC where a scene does not say it. The second is from a device's heat sink "
      "to\n"
      "the ambient. The device's part states lines zth or r_th_jc, and r_th_cs from case to sink "
      "where\n"
      "that counts; one without a heat sink may state r_th_ja. Told is then t_case, and t_j, which "
      "is\n"
      "held against the part's t_j_max. More: docs/power.md.");
}

static void print_find(void) {
  puts("find: the worst value of a measure over all that a study varies, as in this study file:\n"
       "scene: paper\n"
       "set: {run.until: 60 ms, events: {surge1: {kind: surge, cycle: 2}}}\n"
       "vary: {events.surge1.angle: {from: 0 deg, to: 360 deg}}\n"
       "find: {worst: max thyristor.v_forward, n: 100, restarts: 8, seed: 7, finest: 0.1 %}\n"
       "A range is searched whole, a list only at its values. Keys besides worst may be left out:\n"
       "  n         cases at most (100 for each axis)\n"
       "  restarts  local searches, each from another place, which share them (8)\n"
       "  seed      of the places where it begins\n"
       "  finest    part of each axis: a search ends when its steps are shorter (0.1 %)\n"
       "More: docs/studies.md.");
}

static const struct topic {
  const char *name, *text;
  void (*print)(void);
} OWN[] = {{"scene", "the sections of a scene", print_scene},
           {"units", "how quantities are written", print_units},
           {"exit", "exit statuses", print_exit},
           {"quality", "section of a scene: what a current is to the mains", print_quality},
           {"expect", "key of a scene: what may happen to devices, and has to", print_expect},
           {"waive", "key of a scene: limits that the verdict leaves out", print_waive},
           {"spread", "key of a scene: what is not known exactly", print_spread},
           {"ratings", "section of a scene: what you allow of measures and probes", print_ratings},
           {"find", "section of a study: the worst case, with an example", print_find},
           {"ambient", "key of a scene: the air around a circuit's devices", print_heat},
           {"heatsink", "key of a scene: what cools devices", print_heat}};
enum { N_OWN = sizeof OWN / sizeof *OWN };

static const struct topic *own_topic(const char *name) {
  for (size_t k = 0; k < N_OWN; k++)
    if (!strcmp(OWN[k].name, name)) return &OWN[k];
  return NULL;
}

/* ---- all ---- */

/* Topics whose matter another one has. */
static const struct {
  const char *name, *kind;
} SAME[] = {{"record", "probes"}, {"measured", "measures"}};

enum { MOST = 128 };

static vs_status refuse_topic(const char *topic, const vs_command *const *commands, vs_error *err) {
  const char *names[MOST], *name;
  size_t n = 0;
  for (size_t k = 0; k < N_OWN; k++) names[n++] = OWN[k].name;
  for (int k = 0; k < VS_SECTION_KEYS; k++) names[n++] = vs_section_keys[k];
  for (int k = 0; (name = vs_list_kind(k)) && n < MOST; k++) names[n++] = name;
  for (size_t k = 0; commands[k] && n < MOST; k++) names[n++] = commands[k]->name;
  return vs_fail(err, VS_INPUT,
                 "help: no topic '%s'%s; 'vibrospice list all %s' finds keys, parts and measures "
                 "that have the word",
                 topic, vs_text_hint(topic, names, n, "; see vibrospice help").text, topic);
}

/* Prints what there is to say of a topic that is no command. Error: there is no such topic; the
 * nearest is named. */
static vs_status print_topic(const char *topic, const vs_command *const *commands, vs_error *err) {
  const char *kind = topic;
  if (own_topic(topic)) return own_topic(topic)->print(), VS_OK;
  for (size_t k = 0; k < sizeof SAME / sizeof *SAME; k++)
    if (!strcmp(SAME[k].name, topic)) kind = SAME[k].kind;
  const vs_list_options o = {.kind = kind};
  vs_default_models ground;
  vs_status status = vs_default_models_read(NULL, NULL, &ground, err);
  bool found = !status && vs_list_section(topic, &ground);
  vs_default_models_free(&ground);
  if (status || found) return status;
  return vs_list_has(kind) ? vs_list_command(&o, err) : refuse_topic(topic, commands, err);
}

/* True for a section of a scene; a command may have that name, too. */
static bool is_section(const char *topic) {
  for (int k = 0; k < VS_SECTION_KEYS; k++)
    if (!strcmp(vs_section_keys[k], topic)) return true;
  return false;
}

/* Prints one line for each topic. */
static void list_topics(void) {
  const char *name;
  puts("Topics of vibrospice help TOPIC, besides commands:");
  for (size_t k = 0; k < N_OWN; k++) printf("  %-13s %s\n", OWN[k].name, OWN[k].text);
  for (int k = 0; (name = vs_list_kind(k)); k++) printf("  %-13s %s\n", name, vs_list_heading(k));
  for (int k = 0; k < VS_SECTION_KEYS; k++)
    if (!vs_list_has(vs_section_keys[k]) && !own_topic(vs_section_keys[k]))
      printf("  %-13s section of a scene: its keys\n", vs_section_keys[k]);
}

/* ---- the manual page ---- */

/* Prints a text so that man(7) takes nothing in it for a request: a backslash and a hyphen are
 * escaped, and no line begins with a point or an apostrophe. */
static void print_for_man(const char *text) {
  bool begins = true;
  for (; *text; text++) {
    if (begins && strchr(".'", *text)) fputs("\\&", stdout);
    if (*text == '\\')
      fputs("\\e", stdout);
    else if (*text == '-')
      fputs("\\-", stdout);
    else
      putchar(*text);
    begins = *text == '\n';
  }
}

static void print_option_for_man(const vs_option *o) {
  fputs(".TP\n", stdout);
  if (o->letter) printf("\\fB\\-%c\\fR, ", o->letter);
  fputs("\\fB\\-\\-", stdout);
  print_for_man(o->name);
  fputs("\\fR", stdout);
  if (o->value) fputs("=\\fI", stdout), print_for_man(o->value), fputs("\\fR", stdout);
  putchar('\n');
  print_for_man(o->text);
  putchar('\n');
}

static void print_command_for_man(const vs_command *c) {
  printf(".SS vibrospice %s ", c->name);
  print_for_man(c->argument);
  putchar('\n');
  print_for_man(c->text);
  putchar('\n');
  for (const vs_option *o = c->options; o->name; o++) print_option_for_man(o);
  fputs(".PP\nExamples:\n.PP\n.nf\n", stdout);
  print_for_man(c->examples);
  fputs(".fi\n", stdout);
}

/* Prints vibrospice(1) as a source of man(7) on standard output. */
static void print_manual(const vs_command *const *commands) {
  printf(".TH VIBROSPICE 1 \"\" \"vibrospice %s\" \"User Commands\"\n", VS_VERSION);
  fputs(".SH NAME\nvibrospice \\- electromagnetic machine and the circuit that feeds it, simulated "
        "together\n"
        ".SH SYNOPSIS\n.B vibrospice\n.I COMMAND\n[\\fIOPTION\\fR]... [\\fINAME\\fR]...\n"
        ".SH DESCRIPTION\n"
        "Integrates a machine, as a vibratory feeder, with GSL and its circuit with ngspice, "
        "stepped\n"
        "together at every time step. For sizing snubbers, varistors and fuses.\n"
        ".SH COMMANDS\n",
        stdout);
  for (size_t k = 0; commands[k]; k++) print_command_for_man(commands[k]);
  fputs(".SH EXIT STATUS\n", stdout);
#define EXIT_ROW(name, status, text) printf(".TP\n%d\n%s\n", status, text);
  VS_STATUS_LIST(EXIT_ROW)
#undef EXIT_ROW
  fputs(".SH ENVIRONMENT\n.TP\nVIBROSPICE_PATH\nwhere decks, parts, machines and scenes are looked "
        "for before the shipped ones\n"
        ".TP\nNO_COLOR\nif set, the verdict has no colour on a terminal\n"
        ".SH SEE ALSO\n.BR ngspice (1)\n",
        stdout);
}

/* ---- the command ---- */

static vs_status help_command(const void *given, vs_error *err) {
  const vs_arguments *a = given;
  const vs_command *const *all = a->commands;
  const char *topic = vs_command_name(a);
  if (!topic) {
    vs_command_print_usage(all, stdout);
    list_topics();
    return VS_OK;
  }
  if (!strcmp(topic, "man")) {
    print_manual(all);
    return VS_OK;
  }
  for (size_t k = 0; all[k]; k++) {
    char program[] = "vibrospice", name[32], option[] = "--help",
         *words[] = {program, name, option};
    snprintf(name, sizeof name, "%s", topic);
    if (strcmp(topic, all[k]->name) != 0) continue;
    vs_status status = vs_command_run(all, all[k], 3, words);
    if (status || !is_section(topic)) return status;
    printf("\nThe section %s of a scene:\n", topic);
    break;
  }
  return print_topic(topic, all, err);
}

static const vs_option HELP_OPTIONS[] = {VS_OPTIONS_END};

const vs_command vs_help_cli = {
    .name = "help",
    .argument = "[TOPIC]",
    .text = "tells of a command, of a section of a scene and its keys, of tiers, events, units, "
            "exit statuses; man: the manual page's source; without TOPIC: of the program, and "
            "which topics there are",
    .examples =
        "  vibrospice help firing\n  vibrospice help exit\n  vibrospice help man | man -l -\n",
    .may_be_alone = true,
    .options = HELP_OPTIONS,
    .size = sizeof(vs_arguments),
    .run = help_command};
