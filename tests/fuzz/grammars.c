/* SPDX-License-Identifier: GPL-3.0-or-later
 * What decks, parts, netlists of other programs and YAML files are made of. The first form of each
 * rule needs no other rule, or few, as it ends what has grown too deep. */
#include "target.h"

#define FORMS(...) ((const char *const[]){__VA_ARGS__, NULL})
#define RULES(table)                                                                               \
  { table, sizeof table / sizeof *table }

/* ---- common to netlists: n a node, N a name, q a number, e a formula, x an expression ---- */

#define NODE FORMS("0", "a", "b", "g", "c1p", "src", "1", "k", "n001", "x1.a", "xeva.z", "xeva.vz")
#define NAME                                                                                       \
  FORMS("r1", "c1", "thyristor", "v_ak", "i_thyristor", "latch", "dut", "Vmains", "Vgate", "Xeva", \
        "u_rms", "l_source", "varistor_1", "a_b", "BT151-800R", "time", "sub", "m1", "N@q")
#define NUMBER                                                                                     \
  FORMS("1", "0", "-1", "1e-3", "100n", "4k7", "1meg", "1e308", "-0", "1e-400", ".5", "3.",        \
        "1mil", "1e", "0x10", "nan", "inf", "2.5u", "1.2.3", "99999999999999999999")
#define FORMULA                                                                                    \
  FORMS("@q", "v(@n)", "v(@n,@n)", "i(@N)", "{@N}", "@N", "(@e)", "-@e", "@e+@e", "@e-@e",         \
        "@e*@e", "@e/@e", "@e^@e", "abs(@e)", "pow(@e,@e)", "pwr(@e,@e)", "min(@e,@e)",            \
        "sqrt(@e)", "sgn(@e)", "tanh(@e)", "ln(@e)", "v( @n )", "{@e}")
#define EXPRESSION                                                                                 \
  FORMS("@q", "@N", "v(@n)", "v(@n,@n)", "i(@N)", "(@x)", "-@x", "!@x", "@x+@x", "@x*@x", "@x/@x", \
        "@x**@x", "@x^@x", "@x>@x", "@x<=@x", "@x==@x", "@x&&@x", "@x||@x", "@x?@x:@x",            \
        "if(@x,@x,@x)", "limit(@x,@x,@x)", "table(@x,@q,@q,@q,@q)", "ddt(@x)", "sdt(@x)",          \
        "idt(@x)", "buf(@x)", "uramp(@x)", "u(@x)", "abs(@x)", "pwrs(@x,@x)", "delay(@x,@q)",      \
        "{@x}", "'@x'", "white(@x)", "time", "temper", "atan2(@x,@x)", "ceil(@x)", "@N(@x,@x)")
#define ELEMENT                                                                                    \
  FORMS("R@q @n @n @q", "R1 @n @n {@x}", "C1 @n @n @q ic=@q", "L1 @n @n @q ic=@q",                 \
        "R2 @n @n R={@x}", "C2 @n @n Q={@x}", "L2 @n @n Flux={@x}", "K1 L1 L2 @q",                 \
        "V@N @n @n external", "Vmains @n @n external", "V1 @n @n @q", "V1 @n @n dc @q ac @q",      \
        "V2 @n @n sin(@q @q @q @q @q)", "I1 @n @n pulse(@q @q @q @q @q @q @q)",                    \
        "V3 @n @n PWL(@q @q @q @q) r=@q", "V4 @n @n exp(@q @q @q @q)", "V5 @n @n {@x}",            \
        "B1 @n @n V = @x", "B2 @n @n I = @x", "B3 @n @n R=@x", "B4 @n @n @x", "E1 @n @n @n @n @q", \
        "E2 @n @n vol='@x'", "E3 @n @n value={@x}", "E4 @n @n table {@x} = (@q,@q) (@q,@q)",       \
        "E5 @n @n poly(2) @n @n @n @n @q @q @q", "G1 @n @n @n @n @q", "G2 @n @n value {@x}",       \
        "F1 @n @n @N @q", "H1 @n @n @N @q", "G3 @n @n laplace {@x} = {@x}",                        \
        "S1 @n @n @n @n sw1 on", "W1 @n @n @N sw1", "D1 @n @n @N @q off", "Q1 @n @n @n @N",        \
        "M1 @n @n @n @n @N w=@q l=@q", "J1 @n @n @n @N", "Z1 @n @n @n @N",                         \
        "T1 @n @n @n @n Z0=@q TD=@q", "A1 [@n] [@n] @N", "A1 %v(@n) @n @N",                        \
        "A1 @n @n @n @n @n @n @n @n SCHMITT Vt=@q", "X1 @n @n @n @N", "X2 @n @n @N @N={@x}",       \
        "X3 @n @n @N params: @N=@q", "Xeva @n @n eva", "O1 @n @n @n @n @N", "U1 @n @n @n @N",      \
        "N1 @n @n @N", "P1 @n @n @n @n @N", "Y1 @n 0 @n 0 @N", "R1")
#define STATEMENT                                                                                  \
  FORMS(".include a.inc", ".include \"b.inc\"", ".lib c.lib", ".lib c.lib tt", ".inc 'd.inc'",     \
        ".include latch.inc", ".param @N=@q", ".param @N = {@x} @N=@q", ".param @N='@x'",          \
        ".param @N(@N,@N) = {@x}", ".func @N(@N) {@x}", ".func @N(a,b)={@x}", ".global @n",        \
        ".model @N D(is=@q n=@q)", ".model sw1 SW(vt=@q vh=@q ron=@q)", ".model @N VDMOS(rg=@q)",  \
        ".model @N ako: @N D(rs=@q)", ".model @N d_cosim(simulation=\"x\")", ".subckt @N @n @n",   \
        ".subckt @N @n @n params: @N=@q", ".subckt @N @n @n @N={@x}", ".ends", ".ends @N", ".end", \
        ".endl", ".ic v(@n)=@q", ".nodeset v(@n)=@q", ".options reltol=@q method=gear",            \
        ".option @N", ".tran @q @q uic", ".ac dec 10 1 1k", ".dc V1 0 1 1", ".op", ".save all",    \
        ".probe v(@n)", ".print tran v(@n)", ".meas tran @N max v(@n)", ".step param @N 1 2 1",    \
        ".temp 27", ".if (@x)", ".elseif (@x)", ".else", ".endif", ".control", "run",              \
        "shell touch x", ".endc", ".backanno", ".four @q v(@n)", ".net i(@N)", ".machine",         \
        ".csparam @N={@x}", ".title @N", ".lib tt", "+ @q @q", "+ @N=@q", "+", "* @N", "; @N",     \
        "$ @N", "// @N", "*#@N", "")
#define UNIT                                                                                       \
  FORMS("V", "A", "ohm", "nF", "uH", "V/us", "A/us", "A2.s", "degC", "K/W", "W", "J", "us", "s",   \
        "1", "%", "kg", "m", "", "mohm", "Hz", "A*us", "V.s", "parsec", "µF")
#define TEXT FORMS("\"@N\"", "", "\"", "assumed", "assumed \"x\"", "\"@N\" @N", "\"\\\"\"")
#define KIND                                                                                       \
  FORMS("thyristor", "diode", "varistor", "fuse", "resistor", "capacitor", "mosfet", "igbt",       \
        "triac", "electrolytic", "gate_drive", "coil", "transformer")
#define PORT                                                                                       \
  FORMS("gate", "gate+180deg", "gate + 60 deg", "burst", "pwm", "pwm+180deg", "mains", "mains+@q", \
        "gate-@q deg", "pwm_complement", "burst+@q", "@N")
#define LIMIT                                                                                      \
  FORMS("v_drm", "v_rrm", "i_t_rms", "i_tsm", "i2t", "di_dt", "dv_dt", "t_q", "t_j_max", "energy", \
        "power", "v_r", "i_f", "i_rms", "v_ds", "@N")
#define CONTRACT                                                                                   \
  FORMS("title @N", "param @N = @q @u @q..@q @t", "param @N = @q @u ..@q", "param @N = @q",        \
        "param @N = @N part @k @t", "param @N = @N part", "port mains = @N", "port @p = @N",       \
        "port @p=", "line @n", "line @n @n", "probe @N = v(@n,@n) @u @t", "probe @N = -i(@N) @u",  \
        "probe @N=v(@n)", "loss @N = @e", "store @N = @e", "rating @N @q..@q @u @t",               \
        "rating @N -@N.@l..@N.@l @u", "rating @N ..@q @u", "require @e < @e @t",                   \
        "require @e <= @e", "device @N = @e, @e", "device @N @k = @e, @e @t",                      \
        "device @N @N @p @p = @e, @e, @e", "device @N @k protects @N = @e, @e", "compat ps",       \
        "compat @N", "part @k @t", "part @N", "limit @l = @q @u @t", "limit @l = none @t",         \
        "limit @l = @q", "zth @q @u @q @u @t", "zth @q K/W @q s", "@N @N")
#define LINE                                                                                       \
  FORMS("* @N", "*$ @c", "*$ @c", "*$ @c", "*$@c", "@d", "@d", "@d", "@s", "@s",                   \
        ".subckt @N @n @n", ".ends")
#define WORD                                                                                       \
  FORMS("@q", "@n", "@N", "@u", "@q@u", "@q @u", "@e", "@x", "{@x}", "@k", "@p", "@l", "@t",       \
        "@q..@q", "external", "=", ",", "(", ")", "\"", "@N=@q")

/* What decks and parts have alike. */
#define LETTERS                                                                                    \
  {'N', NAME}, {'q', NUMBER}, {'e', FORMULA}, {'x', EXPRESSION}, {'d', ELEMENT}, {'s', STATEMENT}, \
      {'u', UNIT}, {'t', TEXT}, {'k', KIND}, {'p', PORT}, {'l', LIMIT}, {                          \
    'c', CONTRACT                                                                                  \
  }

static const fuzz_rule DECK[] = {{'L', LINE},
                                 {'W', WORD},
                                 {'F', FORMS("%%% a.inc", "%%% b.inc", "%%% c.lib", "%%% d.inc")},
                                 {'n', NODE},
                                 LETTERS};
const fuzz_grammar fuzz_grammar_deck = RULES(DECK);

/* ---- a part's file has lines of its own more often ---- */

static const fuzz_rule PART[] = {
    {'L', FORMS("* @N", "*$ limit @l = @q @u @t", "*$ zth @q K/W @q ms @t", "*$ @c",
                "*$ param @N = @q @u @q..@q @t", ".subckt dut @n @n @n", ".ends dut",
                ".subckt @N @n @n @n @n", ".ends", "@d", "@s", "*$ part @k @t",
                "* anode cathode gate", "* Connections: A K G")},
    {'W', WORD},
    {'F', FORMS("%%% a.inc", "%%% b.lib")},
    {'n',
     FORMS("a", "k", "g", "0", "anode", "cathode", "gate", "mt1", "mt2", "c", "e", "d", "s", "1")},
    LETTERS};
const fuzz_grammar fuzz_grammar_part = RULES(PART);

static const fuzz_rule NETLIST[] = {
    {'L', FORMS("* @N", "@d", "@d", "@d", "@s", "V1 @n 0 SINE(0 325 50)",
                "V2 @n @n PULSE(0 5 {@x} 1u 1u 100u 20m)", "L1 @n @n @q Rser=@q",
                "XU1 @n @n @n scr", "XQ1 @n @n @n BT151", "§L1 @n @n @q", "R_R1 @n @n @q",
                "C_C1 $N_0001 @n @q", "* C:\\users\\me\\x.asc", "*PSpice netlist",
                ".title KiCad schematic", "L1 Net-_D1-K_ /out @q", ".lib standard.dio",
                ".include \"D:\\x\\a.lib\"", "XTH1 @n @n @n @N", ".aliases", ".endaliases")},
    {'W', WORD},
    {'F', FORMS("%%% a.lib", "%%% b.inc")},
    {'n',
     FORMS("0", "N001", "a", "b", "g", "/out", "Net-_D1-K_", "gnd", "1", "k", "$N_0001", "VCC")},
    {'N',
     FORMS("scr", "BT151", "D1N4007", "alpha", "freq", "L1", "V1", "R1", "TYN1212", "a", "MOV")},
    {'q', NUMBER},
    {'e', FORMULA},
    {'x', EXPRESSION},
    {'d', ELEMENT},
    {'s', STATEMENT},
    {'u', UNIT},
    {'t', TEXT},
    {'k', KIND},
    {'p', PORT},
    {'l', LIMIT},
    {'c', CONTRACT}};
const fuzz_grammar fuzz_grammar_netlist = RULES(NETLIST);

/* ---- YAML: scenes, studies, fits, machines. v a value, Q a number with a unit, K a key ---- */

static const fuzz_rule YAML[] = {
    {'L', FORMS("# x", "@S: @v", "  @K: @v", "@S: {@K: @v, @K: @v}", "@S.@K: @v", "  - @v",
                "@S:", "    @K: @v", "  @S.@K: @v", "  @I: {@K: @v, @K: @v, @K: @v}", "- @v",
                "  @K: [@v, @v]", "%%% table.csv", "@Q,@Q,@Q", "--- ", "t_s,p_m,i_a", "  @I: @f",
                "  @I:")},
    {'W', FORMS("@v", "@K", "@S", "@Q", "@q", "@U", "@f", "@M", "@A", "@I", "~", "|", ">", "&a",
                "*a", "!t", "?", "\"@v\"", "'@v'", "{", "}", "[", "]", ",", ":", "<<")},
    {'F', FORMS("%%% table.csv", "%%% machine.yaml", "%%% deck.cir", "%%% scene.yaml",
                "%%% points.csv", "%%% data.csv")},
    {'v', FORMS("@Q", "@q", "@w", "[@v, @v]", "{@K: @v}", "@f", "@A", "\"@f\"", "[@Q, @Q]",
                "@Q uniform", "@Q normal within 3 sigma", "{lin: [@Q, @Q], n: @q}",
                "{log: [@Q, @Q], n: @q}", "[[@Q, @Q], [@Q, @Q]]", "@Q .. @Q", "", "@M",
                "[@A, @A, 0.5]", "{@I: {@K: @v, @K: @v}}", "max @M", "table.csv", "points.csv")},
    {'Q', FORMS("1 m", "@q @U", "@q@U", "@q", "@q %")},
    {'q', FORMS("1", "0", "-1", "2", "1e-3", "100", "50", "0.5", "1e300", "-0", "1e9", "nan", "inf",
                "1e-320", "3", "64", "100000000", "1.5", "0x1p3", "18446744073709551616")},
    {'U', FORMS("m", "mm", "s", "ms", "us", "deg", "rad", "Hz", "V", "A", "ohm", "H", "mH", "N",
                "N/m", "N.s/m", "kg", "kg.m2", "g/cm3", "cm3", "cycles", "%", "degC", "W", "nF",
                "Wb", "deg/mm.s", "m/s2", "kN/m", "furlong", "/", "m^2", "m2.s-1", "degree")},
    {'w', FORMS("auto", "once", "none", "all", "true", "paper", "steady", "switched", "analytic",
                "circuit", "thyristor", "reluctance", "moving_coil", "formula", "derived", "step",
                "sine", "climb", "stay", "always", "never", "gear", "trap", "grid", "sobol",
                "corners", "random", "halton", "lhs", "amplitude", "phase", "object", "pipe", "lqr",
                "sag", "notch", "surge", "interruption", "jam", "load", "misfire", "series",
                "halfwave_snubbed", "halfwave_paper", "chopper", "TYN1212", "two_mass", "solenoid",
                "lds_v203", "conveyor_bodies", "machine.yaml", "deck.cir", "scene.yaml")},
    {'S',
     FORMS("machine", "actuator", "load", "supply", "firing", "circuit", "run", "record", "events",
           "instruments", "control", "pwm", "start", "measure", "measured", "quality", "scene",
           "set", "vary", "sample", "find", "snubber", "steady", "report", "measures", "data",
           "runs", "free", "starts", "profile", "title", "coordinates", "parameters", "let", "mass",
           "damping", "stiffness", "bodies", "springs", "forces", "gap", "probes")},
    {'K', FORMS("model", "gap", "inductance", "resistance", "stop", "law", "saturation", "leakage",
                "voltage", "frequency", "phase", "angle", "every", "first_cycle", "pulse_width",
                "valve", "deck", "tier", "until", "sample", "tolerance", "kind", "at", "cycle",
                "duration", "level", "density", "volume", "fraction", "stiffness", "damping",
                "from", "to", "last", "unit", "text", "default", "range", "open", "of", "along",
                "adds", "up", "forward", "x", "y", "method", "n", "seed", "spread", "correlation",
                "lin", "log", "worst", "margin", "ratings", "error", "value", "file", "columns",
                "prior", "sensor", "setpoint", "gain", "integral", "observer", "estimates", "rate",
                "noise", "bits", "lowpass", "inertia", "on", "moves", "turn", "com", "current",
                "energy", "force", "trough_mass", "spring_angle", "mount_3", "m14", "set",
                "thyristor", "r1", "c1", "duty", "carrier", "flux", "exponent", "q", "r")},
    {'A', FORMS("firing.angle", "actuator.gap", "supply.voltage", "circuit.r1", "circuit.c1",
                "machine.trough_mass", "events.dip.at", "load.density", "control.setpoint",
                "run.until", "instruments.p.noise", "start.p", "pwm.duty")},
    {'M', FORMS("i_peak", "p_min", "gap_max", "thyristor.v_reverse", "margin_least", "r1.power",
                "force_peak", "i_thd", "p_first_peak", "power_in", "tau_p", "t_fire")},
    {'I', FORMS("p", "u", "w", "phi", "dip", "notch1", "x", "y", "trough", "base", "k", "i", "v_ak",
                "trough_mass", "spring")},
    {'f', FORMS("@q", "x", "trough_mass", "(@f)", "-@f", "@f + @f", "@f*@f", "@f/@f", "@f^2",
                "sqrt(@f)", "sin(@f)", "spring", "mount_3.x", "lambda", "z", "i", "force", "pi",
                "lambda*z/(2*5e-3)", "@Q")}};
const fuzz_grammar fuzz_grammar_yaml = RULES(YAML);
