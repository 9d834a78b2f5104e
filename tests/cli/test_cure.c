/* SPDX-License-Identifier: GPL-3.0-or-later
 * `cure`: the single change that makes a verdict held, against values by hand. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "program.h"

/* The mains drive r1 and 100 ohm in series: the current's peak is 622.25 V / (r1 + 100 ohm). With
 * 1 kohm that is 0.5657 A. Of E12 1.2 kohm is the first with less than 0.5 A: 0.47866 A, a margin
 * of 4.27 %. c1 beside r1 adds 0.02 % to the current, so that less of it helps and does not hold.
 */
static const char DECK[] = "* a divider\n"
                           "*$ title  a divider\n"
                           "*$ param  r1 = 1000 ohm  1..1e5   \"in series\"\n"
                           "*$ param  c1 = 100 nF    0.1..1e5 \"beside it\"\n"
                           "*$ port   mains = Vmains\n"
                           "*$ probe  i_d = i(Vd)     A\n"
                           "*$ probe  v_1 = v(src,a)  V\n"
                           "*$ device r1 resistor = v(src,a), v(src,a)/{r1}\n"
                           "*$ device c1 capacitor = v(src,a), i(Vd)-v(src,a)/{r1}\n"
                           "Vmains src 0 external\n"
                           "R1     src a {r1}\n"
                           "C1     src a {c1} ic=0\n"
                           "Vd     a b 0\n"
                           "Rd     b 0 100\n"
                           "Xeva   src 0 eva\n";

static void write_scene(const char *ratings) {
  vs_text text = {0};
  vs_text_add(&text, "circuit: {deck: own.cir}\nrun: {until: 8 ms, tier: circuit}\nratings: {%s}\n",
              ratings);
  write_file("own.cir", DECK);
  write_file("s.yaml", text.text);
  vs_text_free(&text);
}

static void says(const ran *r, int status, const char *text, int line) {
  EXPECT(r->status == status, "line %d: %d %s%s", line, r->status, r->out, r->err);
  EXPECT(strstr(r->out, text) || strstr(r->err, text), "line %d: want %s in %s%s", line, text,
         r->out, r->err);
}
#define SAYS(r, status, text) says(r, status, text, __LINE__)

/* Tolerance of the margin: run.tolerance is 1e-4 of the current. */
static void next_value(void) {
  const double complex y = 1. / 1200 + I * 2 * M_PI * 50 * 100e-9; /* of r1 and c1 */
  write_scene("i_d: .. 0.5 A");
  ran r = run("cure s.yaml");
  SAYS(&r, 0, "not held: i_d\nr1 1000 -> 1200 ohm: least margin +4.2");
  SAYS(&r, 0, "(i_d), proved by a run\n1 of ");
  SAYS(&r, 0,
       "r1: 2 tried\nc1: 13 tried\nnot tried: two changes at once, other keys, parts further");
  SAYS(&r, 0,
       "other threats, tolerances, corners and what the scene does not judge were not tried");
  EXPECT(!strstr(r.out, "c1 "), "%s", r.out);
  free_ran(&r);
  r = run("cure s.yaml --all --json -o out");
  SAYS(&r, 0, "{\"set\": \"circuit.r1=1200 ohm\", \"what\": \"r1\", \"from\": \"1000\"");
  CLOSE_OF(number_in(r.out, "margin_least"), 1 - 440 * M_SQRT2 / cabs(100 + 1 / y) / 0.5, 1, 3e-4);
  SAYS(&r, 0, "\"set\": \"circuit.c1=82 nF\"");
  ran never = run("cure s.yaml --set run.verify=never"); /* a proof has the errors all the same */
  EXPECT(strstr(never.out, "(i_d), proved by a run") && !strstr(never.out, "nan"), "%s", never.out);
  free_ran(&never);
  char *file = read_file("out/cure.json");
  CU_ASSERT_STRING_EQUAL(file, r.out);
  free(file);
  free_ran(&r);
  r = run("cure s.yaml --series E3"); /* 1000, 2200 */
  SAYS(&r, 0, "r1 1000 -> 2200 ohm");
  free_ran(&r);
  r = run("cure s.yaml --set 'ratings.i_d=.. 0.4 A'"); /* the next but one: 0.3893 A with c1 */
  SAYS(&r, 0, "r1 1000 -> 1500 ohm: least margin +2.67 %");
  free_ran(&r);
  r = run("cure s.yaml --set circuit.r1=1200ohm");
  SAYS(&r, 0, "the verdict is held: there is nothing to cure");
  free_ran(&r);
}

/* What the list has is tried, and its prices are told: of a value that is listed, against another
 * one, or of any value. */
static void with_prices(void) {
  write_scene("i_d: .. 0.5 A");
  write_file("c.csv", "part,kind,value,price_eur\nRA,resistor,1 kohm,0.02\n"
                      "RB,resistor,1.5 kohm,0.05\nCA,capacitor,,0.30\n");
  ran r = run("cure s.yaml --catalogue c.csv");
  SAYS(&r, 0, "r1 1000 -> 1500 ohm (+0.03 EUR): least margin +22.");
  free_ran(&r);
  r = run("cure s.yaml --catalogue c.csv --all");
  SAYS(&r, 0, "c1 100 -> 82 nF (+0 EUR): does not hold i_d");
  free_ran(&r);
  write_file("bad.csv", "part,value,price_eur\nRA,1 kohm,0.02\n");
  r = run("cure s.yaml --catalogue bad.csv");
  SAYS(&r, 2, "bad.csv:1:1: there is no column 'kind'");
  free_ran(&r);
}

/* A change that breaks another line is no cure: at 1.2 kohm there are 574 V across r1. */
static void another_line_breaks(void) {
  write_scene("i_d: .. 0.5 A, v_1: .. 570 V");
  ran r = run("cure s.yaml --all");
  SAYS(&r, 3, "r1 1000 -> 1200 ohm: does not hold v_1");
  SAYS(&r, 3, "0 of ");
  SAYS(&r, 3, "no single change of a part cures it; nearest is ");
  EXPECT(!strstr(r.out, "proved"), "%s", r.out);
  free_ran(&r);
}

/* Another part of a kind: one with more of the limit that is broken, the cheaper one first. One
 * that states no such limit would hide the line. A varistor for 230 V bears the surge and not the
 * mains of 440 V. */
static void another_part(void) {
  static const struct {
    const char *scene, *parts;
    int status;
    const char *says[4];
  } ROWS[] = {{"circuit: {deck: halfwave_snubbed, thyristor: TYN1012}\nrun: {until: 18 ms}\n",
               "TYN1012,thyristor,,1.1\nTYN1212,thyristor,,1.35\nTYN1225,thyristor,,1.3\n"
               "latch,thyristor,,0.1\n",
               0,
               {"thyristor.v_reverse), proved by a run\nthyristor TYN1012 -> TYN1212 (+0.25 EUR): "
                "least margin +12.",
                "thyristor TYN1012 -> TYN1225 (+0.2 EUR): least margin +12.",
                "thyristor TYN1012 -> latch (-1 EUR): the part states no limit for thyristor."}},
              {"circuit: {deck: halfwave_paper}\nratings: {v_ak: .. 1 V}\nrun: {until: 2 ms}\n",
               "S14K230,varistor,,0.1\n",
               3,
               {"varistor_1 v511da40 -> S14K230 (0.1 EUR): circuit.varistor_1: ",
                "no single change of a part "}}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text list = {0};
    vs_text_add(&list, "part,kind,value,price_eur\n%sR,resistor,10 mohm,0\nC,capacitor,1 uF,0\n",
                ROWS[k].parts);
    write_file("p.yaml", ROWS[k].scene);
    write_file("c.csv", list.text);
    ran r = run("cure p.yaml --catalogue c.csv --all");
    for (size_t n = 0; ROWS[k].says[n]; n++) SAYS(&r, ROWS[k].status, ROWS[k].says[n]);
    free_ran(&r);
    vs_text_free(&list);
  }
}

/* A place whose kind the deck leaves open takes any suppressor, and r_iron is no part: the iron's
 * loss. A Zener diode of 18 V across a relay's switch breaks 20 V no more than the TVS does, whose
 * 24 V break it; a diode across the coil holds it. */
static void suppressors(void) {
  write_file("c.csv", "part,kind,price\nSMBJ24CA,tvs,0.2\n1N4746,zener,0.1\n1N4004,diode,0.02\n"
                      "R,resistor,0.01\n");
  write_file("v.yaml", "machine: {model: relay}\nsupply: {kind: step, voltage: 12 V}\n"
                       "pwm: {off: 50 ms}\ncircuit: {deck: coil_switch, across_coil: SMBJ24CA}\n"
                       "run: {until: 60 ms}\nratings: {v_ds_max: .. 20 V}\n");
  ran r = run("cure v.yaml --catalogue c.csv --all");
  SAYS(&r, 0, "across_coil SMBJ24CA -> 1N4004 (-0.18): least margin +");
  SAYS(&r, 0, "across_switch open -> SMBJ24CA (0.2): does not hold v_ds_max");
  SAYS(&r, 0, "no other part for switch\n");
  EXPECT(!strstr(r.out, "r_iron") && !strstr(r.out, "-> R "), "%s", r.out);
  free_ran(&r);
}

static void refusals(void) {
  write_scene("i_d: .. 0.5 A");
  refuse("cure s.yaml --series E13", "a series that is none", "",
         (const char *const[]){"E13", "E12"}, __LINE__);
  write_file("ideal.yaml", "ratings: {stroke: .. 2 mm}\nrun: {until: 30 ms, tier: switched}\n");
  refuse("cure ideal.yaml", "a tier without a circuit", "",
         (const char *const[]){"cure", "tier switched"}, __LINE__);
  write_file("none.yaml", "circuit: {deck: own.cir}\nrun: {until: 5 ms, tier: circuit}\n");
  refuse("cure none.yaml", "nothing is rated", "",
         (const char *const[]){"nothing is rated", "ratings"}, __LINE__);
}

static const vs_test tests[] = {{"the next value", next_value},
                                {"with prices", with_prices},
                                {"another line breaks", another_line_breaks},
                                {"another part", another_part},
                                {"suppressors", suppressors},
                                {"refusals", refusals}};

int main(void) {
  return program_suite("cure", tests, COUNT(tests));
}
