/* SPDX-License-Identifier: GPL-3.0-or-later
 * A functional mock-up unit as law of control: the same angles as the same law in C, and what is
 * said of units that do not fit. */
#include <dirent.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "program.h"

#if defined __x86_64__
static const char *const MACHINE[] = {"linux64", "x86_64-linux"};
#else
static const char *const MACHINE[] = {"aarch64-linux", "aarch64-linux"};
#endif

#define HEAD2                                                                                      \
  "<?xml version=\"1.0\"?>\n<!-- <CoSimulation modelIdentifier=\"none\"/> -->\n"                   \
  "<fmiModelDescription fmiVersion=\"2.0\" guid=\"{1}\" modelName='a > b'>\n"
#define SLAVE "<CoSimulation modelIdentifier=\"pi\"/>\n"
/* What a type of the same name elsewhere says is no variable's. */
#define TYPES2                                                                                     \
  "<TypeDefinitions><SimpleType name=\"T\"><Real unit=\"mm\"/></SimpleType></TypeDefinitions>\n"
#define INPUTS2                                                                                    \
  "<ScalarVariable name=\"lowest\" valueReference=\"1\" causality=\"input\"><Real unit=\"m\""      \
  " start=\"0\"/></ScalarVariable>\n<ScalarVariable causality='input' valueReference='2' "         \
  "name='p_meas_m_largest'><Real/></ScalarVariable>\n<ScalarVariable name=\"enabled\" "            \
  "valueReference=\"6\" causality=\"input\"><Boolean start=\"true\"/></ScalarVariable>\n"
#define REST2                                                                                      \
  "<ScalarVariable name=\"set&quot;point\" valueReference=\"3\" causality=\"parameter\"><Real/>"   \
  "</ScalarVariable><ScalarVariable name=\"trouble\" valueReference=\"5\" "                        \
  "causality=\"parameter\"><Integer/></ScalarVariable>\n"
#define ANGLE2(unit)                                                                               \
  "<ScalarVariable name=\"angle_deg\" valueReference=\"4\" causality=\"output\"><Real" unit        \
  "/></ScalarVariable>\n"
#define WHOLE2 HEAD2 SLAVE TYPES2 INPUTS2 REST2 ANGLE2(" unit=\"deg\"") "</fmiModelDescription>\n"
#define WHOLE3                                                                                     \
  "<fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"{1}\">\n" SLAVE                    \
  "<Float64 name=\"lowest\" valueReference=\"1\" causality=\"input\" unit=\"m\"/>\n"               \
  "<Float64 name=\"p_meas_m_largest\" valueReference=\"2\" causality=\"input\"/>\n"                \
  "<Float64 name=\"set&quot;point\" valueReference=\"3\" causality=\"parameter\"/>\n"              \
  "<Float64 name=\"angle_deg\" valueReference=\"4\" causality=\"output\" unit=\"deg\"/>\n"         \
  "<Int16 name=\"trouble\" valueReference=\"5\" causality=\"parameter\"/>\n"                       \
  "<Boolean name=\"enabled\" valueReference=\"6\" causality=\"input\"/>\n</fmiModelDescription>"

/* Makes pi.fmu of the unit for that version, deflated or stored. */
static void make_unit(const char *xml, int version, const char *machine, bool stored) {
  char command[2048];
  write_file("modelDescription.xml", xml);
  snprintf(command, sizeof command,
           "rm -rf binaries pi.fmu && mkdir -p binaries/%s && cp '%s/pi%d.so' binaries/%s/pi.so && "
           "python3 -c 'import zipfile\nwith zipfile.ZipFile(\"pi.fmu\", \"w\", zipfile.%s) as z:\n"
           " z.write(\"modelDescription.xml\"); z.write(\"binaries/%s/pi.so\")'",
           machine, VS_LAWS, version, machine, stored ? "ZIP_STORED" : "ZIP_DEFLATED", machine);
  EXPECT(!system(command), "no unit: %s", command);
}

#define CONNECT "lowest = p_meas_m_least, enabled = 1"

static void write_scene(const char *path, const char *control) {
  char text[1024];
  snprintf(text, sizeof text,
           "firing: {every: 1}\ncontrol: {%s}\ninstruments: {}\n"
           "run: {until: 0.1 s, tier: switched}\n",
           control);
  write_file(path, text);
}

static int folders_of_units(void) {
  int count = 0;
  DIR *d = opendir(getenv("TMPDIR"));
  for (const struct dirent *e; d && (e = readdir(d));)
    count += !strncmp(e->d_name, "vibrospice-unit", 15);
  if (d) closedir(d);
  return count;
}

/* The run has the same bytes as with the law in C; nothing is left of the unpacked unit. */
static void same_angles(const char *xml, int version, bool stored) {
  make_unit(xml, version, MACHINE[version - 2], stored);
  RUN_GOOD("run s.yaml --allow-code --quiet -o unit");
  char *one = read_file("unit/run.csv"), *other = read_file("object/run.csv");
  EXPECT(*one && !strcmp(one, other), "FMI %d: other angles", version);
  free(one);
  free(other);
  EXPECT(!system("rm -r unit") && !folders_of_units(), "a unit is left");
}

static void as_in_c(void) {
  write_scene("o.yaml", "law: object, file: " VS_LAWS "/trim.so");
  write_scene("s.yaml", "law: fmu, file: pi.fmu, connect: \"" CONNECT "\"");
  RUN_GOOD("run o.yaml --allow-code --quiet -o object");
  same_angles(WHOLE2, 2, false);
  same_angles(WHOLE3, 3, true);
}

/* Fails with that status and those words. */
static void expect_end(const char *control, int status, const char *says, int line) {
  write_scene("s.yaml", control);
  ran r = run("run s.yaml --allow-code --quiet");
  expect(r.status == status && strstr(r.err, says), line, "status %d: %s", r.status, r.err);
  free_ran(&r);
  expect(!folders_of_units(), line, "a unit is left");
}
#define PI(more) "law: fmu, file: pi.fmu, connect: \"" CONNECT more "\""
#define ENDS(control, status, says) expect_end(control, status, says, __LINE__)

/* Parameters and other inputs reach the unit, and what it says comes back. */
static void at_work(void) {
  for (int version = 2; version < 4; version++) {
    make_unit(version == 2 ? WHOLE2 : WHOLE3, version, MACHINE[version - 2], false);
    ENDS(PI(", trouble = 1"), 1, "t = 0.02 s: control: pi.fmu says: fmi");
    ENDS(PI(", trouble = 1"), 1, "DoStep: error: lost 7");
    ENDS(PI(", trouble = 2"), 1, "t = 0.02 s: control: pi.fmu ended by signal 6");
    write_scene("s.yaml",
                "law: fmu, file: pi.fmu, connect: \"lowest = p_meas_m_least, enabled = 0\"");
    RUN_GOOD("run s.yaml --allow-code --quiet -o still");
    char *csv = read_file("still/run.csv"), *last = strrchr(csv, ',');
    EXPECT(last && fabs(atof(last + 1) - 150 * 3.14159265 / 180) < 1e-6, "it ends at %s", last);
    free(csv);
    EXPECT(!system("rm -r still"), "no folder");
    ENDS(PI(", set\\\"point = 1e9"), 0, "");
  }
  write_scene("s.yaml", PI(""));
  ran r = run("run s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "--allow-code"), "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* A run that is killed leaves no folder either. */
static void killed(void) {
  make_unit(WHOLE2, 2, MACHINE[0], false);
  write_scene("s.yaml", PI(", trouble = 3"));
  char words[] = "run s.yaml --allow-code --quiet";
  const char *argv[MOST_WORDS];
  split(words, argv);
  const pid_t child = spawn(argv);
  for (int k = 0; k < 200 && !folders_of_units(); k++) usleep(20000);
  EXPECT(folders_of_units() == 1, "%d folders", folders_of_units());
  usleep(100000);
  kill(child, SIGKILL);
  ran r = collect(child);
  free_ran(&r);
  for (int k = 0; k < 200 && folders_of_units(); k++) usleep(20000);
  EXPECT(!folders_of_units(), "a unit is left");
}

static void wrong_units(void) {
  make_unit(WHOLE2, 2, "win64", false);
  ENDS(PI(""), 2, "s.yaml:2:27: control.file: pi.fmu is for other machines: it has no binaries/");
  ENDS(PI(""), 2, "pi.so; its binaries: win64");
  make_unit(WHOLE2, 2, MACHINE[0], false);
  ENDS("law: fmu, file: pi.fmu", 2, "has an input 'lowest' that nothing is connected with");
  ENDS(PI(", other = 1"), 2, "has no input or parameter 'other'");
  ENDS(PI(", angle_deg = 1"), 2, "has no input or parameter 'angle_deg'");
  ENDS(PI(", trouble"), 2, "wants NAME = CHANNEL");
  ENDS(PI(", trouble = 0.5"), 2, "'trouble' is of type Integer, and 0.5 is not");
  ENDS(PI(", trouble = 3e9"), 2, "'trouble' is of type Integer, and 3e9 is not");
  ENDS(PI(", trouble = i_meas_a"), 2, "'trouble' is of type Integer, and i_meas_a is not");
  ENDS("law: fmu, file: pi.fmu, connect: \"lowest = q_meas_m\"", 2,
       "neither a number nor a channel");
  ENDS("law: fmu, file: pi.fmu, connect: \"lowest = i_meas_a\"", 2, "is in m, and i_meas_a is not");
  ENDS("law: fmu, file: pi.fmu, output: lowest", 2, "has no output 'lowest'");
  ENDS("law: fmu, file: not_there.fmu", 2, "not_there.fmu cannot be read");
  EXPECT(!mkfifo("queue", 0600), "no pipe");
  ENDS("law: fmu, file: queue", 2, "s.yaml:2:27: queue is a folder, a pipe");
  ENDS("law: fmu, file: s.yaml", 2, "s.yaml is not a functional mock-up unit");
  make_unit(HEAD2 INPUTS2 ANGLE2(""), 2, MACHINE[0], false);
  ENDS(PI(""), 2, "is not for co-simulation");
  make_unit(HEAD2 SLAVE INPUTS2 ANGLE2(" unit=\"rad\""), 2, MACHINE[0], false);
  ENDS(PI(""), 2, "its output 'angle_deg' is in rad; an angle in deg is wanted");
  make_unit(HEAD2 SLAVE TYPES2 INPUTS2 ANGLE2(" declaredType=\"T\""), 2, MACHINE[0], false);
  ENDS(PI(""), 2, "its output 'angle_deg' is in mm; an angle in deg is wanted");
  make_unit("<fmiModelDescription fmiVersion=\"3.0\"><Float64Type name='T' unit='rad'/>" SLAVE
            "<Float64 name=\"angle_deg\" causality=\"output\" declaredType=\"T\"/>",
            2, MACHINE[1], false);
  ENDS("law: fmu, file: pi.fmu", 2, "its output 'angle_deg' is in rad");
  make_unit("<fmiModelDescription fmiVersion=\"1.0\n\">" SLAVE, 2, MACHINE[0], false);
  ENDS(PI(""), 2, "is of FMI version '1.0 '; 2.0 and 3.0 can be taken");
  make_unit(WHOLE3, 2, MACHINE[1], false); /* which has no functions of 3.0 */
  ENDS(PI(""), 2, "has no function fmi3");
}

/* A file that is cut, or in which one byte is another one, is refused or makes the same run. */
static void damaged(void) {
  make_unit(WHOLE2, 2, MACHINE[0], true);
  EXPECT(!rename("pi.fmu", "stored.fmu"), "no unit");
  make_unit(WHOLE2, 2, MACHINE[0], false);
  EXPECT(!rename("pi.fmu", "good.fmu"), "no unit");
  write_scene("s.yaml", PI(""));
  char *at[] = {
      "head -c 2000 good.fmu > pi.fmu",
      "head -c 300 good.fmu > pi.fmu",
      "(head -c 60 good.fmu; printf '\\377\\377'; tail -c +63 good.fmu) > pi.fmu",
      "(head -c 1500 good.fmu; printf '\\125\\252'; tail -c +1503 good.fmu) > pi.fmu",
      "tail -c +9 good.fmu > pi.fmu",
      "mkdir e && : > e/modelDescription.xml && "
      "(cd e && python3 -m zipfile -c ../pi.fmu modelDescription.xml)",
      "python3 -m zipfile -c pi.fmu s.yaml",
      "cp good.fmu pi.fmu && python3 -c 'import zipfile\n"
      "zipfile.ZipFile(\"pi.fmu\", \"a\").writestr(\"../out\", \"x\")'",
      "cp stored.fmu pi.fmu && printf 'X' | dd of=pi.fmu bs=1 seek=9000 conv=notrunc 2>&1"};
  for (size_t k = 0; k < COUNT(at); k++) {
    EXPECT(!system(at[k]), "%s", at[k]);
    ran r = run("run s.yaml --allow-code --quiet");
    EXPECT(r.status == 2 && strstr(r.err, "s.yaml:2:27: control.file: pi.fmu "), "%s: %d: %s",
           at[k], r.status, r.err);
    free_ran(&r);
  }
  EXPECT(!folders_of_units() && access("../out", F_OK), "something is left");
}

int main(void) {
  static const vs_test TESTS[] = {{"as in C", as_in_c},
                                  {"at work", at_work},
                                  {"killed", killed},
                                  {"wrong units", wrong_units},
                                  {"damaged units", damaged}};
  char folder[] = "/tmp/vs_fmu.XXXXXX";
  if (!on_path("python3")) return 77;
  setenv("TMPDIR", mkdtemp(folder) ? folder : "/tmp", 1);
  const int status = program_suite("fmu", TESTS, COUNT(TESTS));
  rmdir(folder);
  return status;
}
