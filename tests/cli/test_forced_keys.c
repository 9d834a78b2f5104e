/* SPDX-License-Identifier: GPL-3.0-or-later
 * Every key that `list parameters` prints, on a tier that was asked for: it changes the run's
 * files, or it is refused with its name and the tier's; none is dropped unsaid. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* Another value than the default's; keys that are not here take 1.07 of it, or, where that is 0,
 * what their unit is in ZERO. */
static const struct {
  const char *key, *value;
} OTHER[] = {{"machine.spring_angle", "60 deg"},
             {"machine.base_com", "[190 mm, 80 mm]"},
             {"machine.trough_com", "[90 mm, 120 mm]"},
             {"machine.mount_3", "[30 mm, 10 mm]"},
             {"machine.mount_4", "[200 mm, 10 mm]"},
             {"machine.m14", "derived"},
             {"actuator.stop", "none"},
             {"actuator.stop.kind", "quadratic_clipped"},
             {"actuator.stop.at", "0.4 mm"},
             {"actuator.law", "moving_coil"},
             {"actuator.saturation", "{flux: 0.5 Wb}"},
             {"actuator.saturation.law", "multiplicative"},
             {"actuator.force_constant", "2 N/A"},
             {"supply.kind", "step"},
             {"firing.valve", "none"},
             {"load.fraction", "0.4"},
             {"load.density", "2 g/cm3"},
             {"supply.voltage", "140 V"},
             {"supply.phase", "20 deg"},
             {"firing.pulse_width", "30 ms"}, /* fires a second time */
             {"firing.every", "2"},
             {"firing.first_cycle", "2"},
             {"firing.burst_duty", "50 %"},
             {"circuit.thyristor", "TYN1212"},
             {"run.until", "0.09 s"},
             {"run.tolerance", "1e-10"},
             {"run.max_step", "20 us"},
             {"run.method", "gear"},
             {"run.ladder", "stay"},
             {"run.verify", "always"},
             {"run.leave_circuit", "never"},
             {"run.pivrel", "0.01"},
             {"run.trtol", "9"},
             {"run.first_step", "1e-3"},
             {"start.phi", "0.001 rad"},
             {"measure.from", "0.01 s"},
             {"measure.to", "0.05 s"},
             {"measure.last", "2 cycles"},
             {"instruments.set", "paper"},
             {"instruments.seed", "7"},
             {"instruments.NAME.channel", "u"},
             {"instruments.NAME.range", "[-3 mm, 3 mm]"},
             {"instruments.NAME.bandwidth", "90 Hz"},
             {"instruments.NAME.order", "1"},
             {"instruments.NAME.damping", "0.5"},
             {"instruments.NAME.noise", "2 um"},
             {"instruments.NAME.rate", "4 kHz"},
             {"instruments.NAME.bits", "10"}};

/* The tier itself; what says which machine and which circuit the tiers stand for; and a text. */
static const char *const NO_CONFLICT[] = {"run.tier", "machine.model", "circuit.deck",
                                          "instruments.NAME.text"};

/* What a refusal names where not the tier has no use for the key: another key beside it. */
static const char *const BESIDE[] = {"law reluctance has no use for it", "firing.valve: none"};

/* name, default, range, text, in columns 28 and 18 wide */
static bool other_value(const char *line, char *key, char *value, size_t size) {
  char number[64] = "", unit[32] = "";
  if (sscanf(line, "%95s", key) != 1) return false;
  if (!strncmp(key, "control.", 8)) return false; /* every tier obeys them, once it fires again */
  if (!strncmp(key, "limits.", 7)) return false;  /* every tier obeys them; they change nothing */
  for (size_t k = 0; k < COUNT(NO_CONFLICT); k++)
    if (!strcmp(key, NO_CONFLICT[k])) return false;
  for (size_t k = 0; k < COUNT(OTHER); k++)
    if (!strcmp(key, OTHER[k].key)) {
      snprintf(value, size, "%s", OTHER[k].value);
      return true;
    }
  char shown[20];
  snprintf(shown, sizeof shown, "%.18s", line + 29);
  sscanf(shown, "%63s %31s", number, unit);
  double own = strtod(number, NULL);
  snprintf(value, size, "%.9g %s", own != 0 ? 1.07 * own : 0.05, unit);
  return true;
}

/* The key of the scene's own instrument, `way`, where `key` is one of instruments.NAME. */
static void name_instrument(char *key, size_t size) {
  static const char ANY[] = "instruments.NAME";
  char own[96];
  if (strncmp(key, ANY, sizeof ANY - 1) != 0) return;
  snprintf(own, sizeof own, "instruments.way%s", key + sizeof ANY - 1);
  snprintf(key, size, "%s", own);
}

/* What a run leaves but for the scene it was asked for; free() it. */
static char *result_of(const char *tier, const char *set, ran *r) {
  remove_tree("o");
  *r = run("run s.yaml -o o --reproducible --tier %s%s", tier, set);
  vs_text all = {0};
  char *csv = read_file("o/run.csv"), *events = read_file("o/events.csv");
  char *json = read_file("o/summary.json"), *measures = strstr(json, "\"measures\"");
  vs_text_add(&all, "%s%s%s", csv, events, measures ? measures : "");
  free(csv), free(events), free(json);
  return all.text;
}

static void keys_on(const char *tier) {
  ran list = run("list parameters"), r;
  char named[32], *plain = result_of(tier, "", &r);
  EXPECT(r.status == 0 && *plain, "%s: %d %s", tier, r.status, r.err);
  free_ran(&r);
  snprintf(named, sizeof named, "tier %s", tier);
  int keys = 0;
  for (char *rest = list.out, *line; (line = strsep(&rest, "\n"));) {
    char key[96], value[128], set[256];
    if (strlen(line) < 48 || !other_value(line, key, value, sizeof value)) continue;
    if (strstr(key, "DEVICE")) continue; /* of the deck: test_traps_semis */
    name_instrument(key, sizeof key);
    snprintf(set, sizeof set, " --set '%s=%s'", key, value);
    char *other = result_of(tier, set, &r);
    bool beside = strstr(r.err, BESIDE[0]) || strstr(r.err, BESIDE[1]);
    bool refused = r.status == 2 && strstr(r.err, key) && (strstr(r.err, named) || beside);
    bool acts = r.status < 2 && strcmp(other, plain) != 0; /* 1: it meets the pole cover */
    EXPECT(refused || acts, "%s, %s = %s: %d, %s", tier, key, value, r.status,
           *r.err ? r.err : "ignored");
    keys++;
    free(other);
    free_ran(&r);
  }
  EXPECT(keys > 60, "%d keys", keys);
  free(plain);
  free_ran(&list);
}

/* A scene in which each key has something to act on. */
static void each_key(void) {
  write_file("s.yaml", "actuator: {stop: {damping: 300 N.s/m}}\n"
                       "load: {density: 1 g/cm3, fraction: 0.2}\n"
                       "run: {until: 0.1 s}\n"
                       "supply: {voltage: 150 V}\n"
                       "start: {p: -5.9 mm, vp: -0.6 m/s}\n"
                       "instruments: {set: none, way: {channel: p, range: [-9 mm, 9 mm], "
                       "bandwidth: 100 Hz, order: 2, noise: 1 um}}\n");
  keys_on("switched");
  keys_on("analytic");
}

static const struct {
  const char *key, *value;
} CIRCUITS[] = {{"firing.burst_frequency", "4 kHz"},
                {"firing.burst_duty", "50 %"},
                {"run.ladder", "ideal"},
                {"run.ladder", "climb"},
                {"run.verify", "always"},
                {"measure.last", "2 cycles"}};

/* From the scene as from --set, in check too; tier auto takes the tier that has them. */
static void keys_of_the_circuit(void) {
  for (size_t k = 0; k < COUNT(CIRCUITS); k++) {
    char text[160], words[160];
    const char *key = CIRCUITS[k].key, *dot = strchr(key, '.');
    const char *says[] = {key, "tier switched"};
    snprintf(text, sizeof text, "%.*s:\n  %s: %s\n", (int)(dot - key), key, dot + 1,
             CIRCUITS[k].value);
    write_file("k.yaml", text);
    refuse("run k.yaml --tier switched -o out", key, "k.yaml:2:3: ", says, __LINE__);
    ran r = run("check k.yaml --set run.tier=switched");
    EXPECT(r.status == 2 && strstr(r.err, key), "check, %s: %d %s", key, r.status, r.err);
    free_ran(&r);
    r = run("check k.yaml");
    EXPECT(r.status == 0 && strstr(r.out, "tier circuit") && strstr(r.out, key), "%s: %d %s", key,
           r.status, r.out);
    free_ran(&r);
    snprintf(words, sizeof words, "run paper --set 'run.tier=switched' --set '%s=%s'", key,
             CIRCUITS[k].value);
    refuse(words, key, "--set ", says, __LINE__);
  }
  RUN_GOOD("run paper --tier switched --set run.verify=never --set run.until=20ms --quiet");
  unlink("k.yaml");
}

/* On the circuit tier a deck without a port burst ignores the sub-pulses, and is said to. */
static void no_port_burst(void) {
  ran r = run("check paper --set firing.burst_duty=50%%");
  EXPECT(r.status == 0 && strstr(r.err, "firing.burst_duty: the deck has no port burst"), "%d %s",
         r.status, r.err);
  free_ran(&r);
  r = run("check paper --set firing.burst_duty=50%% --set circuit.deck=halfwave_paper");
  EXPECT(r.status == 0 && !strstr(r.err, "burst"), "%d %s", r.status, r.err);
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"each key acts or is refused", each_key},
      {"keys of the circuit's", keys_of_the_circuit},
      {"no port burst", no_port_burst},
  };
  return program_suite("forced_keys", TESTS, COUNT(TESTS));
}
