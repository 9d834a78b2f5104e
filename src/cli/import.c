/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `import`: another program's netlist becomes a deck. */
#include "import/import.h"
#include "commands.h"
#include "options.h"

typedef struct import_line {
  vs_arguments common;
  vs_import_options o;
} import_line;

static vs_status import_command(const void *given, vs_error *err) {
  const import_line *line = given;
  vs_import_options o = line->o;
  o.name = vs_command_name(&line->common);
  o.output = line->common.output;
  o.json = line->common.json;
  o.quiet = line->common.quiet;
  return vs_import_command(&o, err);
}

static const vs_option IMPORT_OPTIONS[] = {
    VS_OPTIONS_OUTPUT("FILE.cir", "writes the deck there"),
    VS_OPTIONS_WORD(import_line, o.asked.mains, "mains", "V1",
                    "the source that is the mains, or none (default: the only SIN)"),
    VS_OPTIONS_WORD(import_line, o.asked.gate, "gate", "V3[,V4]",
                    "the sources that fire thyristors, or none (default: the only PULSE); their "
                    "levels are kept"),
    VS_OPTIONS_WORD(import_line, o.asked.coil, "coil", "L1[+R4]",
                    "the inductor that is the EVA's coil, and its resistance in series (default: "
                    "the only inductor)"),
    VS_OPTIONS_FILE(import_line, o.pins, "pins", "X1=akg,...",
                    "what an element is, by its pins in their order, as akg of a thyristor, or by "
                    "its kind, as varistor, or none"),
    VS_OPTIONS_FILE(import_line, o.library, "library", "FILE",
                    "a file of models besides the netlist's"),
    VS_OPTIONS_FILE(import_line, o.scene, "scene", "FILE.yaml",
                    "also writes a scene with the netlist's own mains, firing and coil"),
    VS_OPTIONS_FLAG(vs_arguments, json, "json", "what was done as JSON on standard output"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "does not say what was done"),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_import_cli = {
    .name = "import",
    .argument = "NETLIST",
    .text = "makes a deck of a netlist that LTspice, KiCad, PSpice or a person wrote for SPICE",
    .examples = "  vibrospice import drawing.net -o my.cir --scene my.yaml\n"
                "  vibrospice import drawing.net --mains V1 --gate V3 --coil L1+R4 -o my.cir\n",
    .options = IMPORT_OPTIONS,
    .size = sizeof(import_line),
    .run = import_command};
