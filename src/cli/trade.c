/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "trade.h"

#include <stdio.h>
#include <string.h>

#include "bench/template.h"
#include "export.h"
#include "import/import.h"

/* ---- part ---- */

static vs_status part(const vs_arguments *a, vs_error *err) {
  const vs_template_options o = {vs_command_name(a), a->output, a->wrap, a->overwrite, a->quiet};
  return vs_template_command(&o, err);
}

static const struct argp_option PART_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "NAME.inc", "writes the template there; NAME is the part's"),
    VS_COMMAND_VALUE("wrap", VS_KEY_WRAP, "FILE[:SUBCKT]",
                     "around the subcircuit of a vendor's file, instead of a model of the "
                     "program's own; of a thyristor, triac, diode, MOSFET, IGBT, varistor or fuse"),
    VS_COMMAND_FLAG("overwrite", VS_KEY_OVERWRITE, "replaces a file that is there already"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_HELP,
    {0}};

/* ---- export ---- */

static vs_status export(const vs_arguments *a, vs_error *err) {
  if (!a->output)
    return vs_fail(err, VS_INPUT, "export: wants -o FILE; see vibrospice export --help");
  return vs_export_command(vs_command_name(a), a->sets, a->n_sets, a->output, err);
}

static const struct argp_option EXPORT_OPTIONS[] = {
    VS_COMMAND_SET,  VS_COMMAND_VALUE("output", 'o', "FILE", "writes the netlist there"),
    VS_COMMAND_JAIL, VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP, {0}};

/* ---- import ---- */

static vs_status import(const vs_arguments *a, vs_error *err) {
  const vs_import_options o = {.name = vs_command_name(a),
                               .output = a->output,
                               .scene = a->scene,
                               .pins = a->pins,
                               .library = a->library,
                               .asked = {a->mains, a->gate, a->coil},
                               .json = a->json,
                               .quiet = a->quiet};
  return vs_import_command(&o, err);
}

static const struct argp_option IMPORT_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "FILE.cir", "writes the deck there"),
    VS_COMMAND_VALUE("mains", VS_KEY_MAINS, "V1",
                     "the source that is the mains, or none (default: the only SIN)"),
    VS_COMMAND_VALUE("gate", VS_KEY_GATE, "V3[,V4]",
                     "the sources that fire thyristors, or none (default: the only PULSE); their "
                     "levels are kept"),
    VS_COMMAND_VALUE("coil", VS_KEY_COIL, "L1[+R4]",
                     "the inductor that is the EVA's coil, and its resistance in series (default: "
                     "the only inductor)"),
    VS_COMMAND_VALUE(
        "pins", VS_KEY_PINS, "X1=akg,...",
        "what an element is, by its pins in their order (akg thyristor, 21g triac, dgs "
        "mosfet, cge igbt, ak diode), or varistor, fuse, none"),
    VS_COMMAND_VALUE("library", VS_KEY_LIBRARY, "FILE", "a file of models besides the netlist's"),
    VS_COMMAND_VALUE("scene", VS_KEY_SCENE, "FILE.yaml",
                     "also writes a scene with the netlist's own mains, firing and coil"),
    VS_COMMAND_FLAG("json", VS_KEY_JSON, "what was done as JSON on standard output"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "does not say what was done"),
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

const vs_command vs_trade_part = {
    .name = "part",
    .argument = "[KIND]",
    .text = "writes a template of a part, to be filled in from its data sheet; without KIND: which "
            "kinds there are",
    .examples = "  vibrospice part thyristor -o my.inc && vibrospice check my.inc -o bench\n"
                "  vibrospice part thyristor --wrap vendor.lib:NAME -o my.inc\n",
    .may_be_alone = true,
    .options = PART_OPTIONS,
    .run = part,
    .explain = vs_template_explain};

const vs_command vs_trade_export = {
    .name = "export",
    .argument = "SCENE",
    .text =
        "writes one netlist for plain ngspice: the scene's circuit tier, with the machine in it",
    .examples = "  vibrospice export paper -o paper.cir && ngspice -b paper.cir\n"
                "  vibrospice export my.yaml --set run.until=0.1s -o my.cir\n",
    .options = EXPORT_OPTIONS,
    .run = export};

const vs_command vs_trade_import = {
    .name = "import",
    .argument = "NETLIST",
    .text = "makes a deck of a netlist that LTspice, KiCad, PSpice or a person wrote for SPICE",
    .examples = "  vibrospice import drawing.net -o my.cir --scene my.yaml\n"
                "  vibrospice import drawing.net --mains V1 --gate V3 --coil L1+R4 -o my.cir\n",
    .options = IMPORT_OPTIONS,
    .run = import};
