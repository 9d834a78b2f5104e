/* SPDX-License-Identifier: GPL-3.0-or-later
 * `vibrospice export SCENE -o x.fmu`: a functional mock-up unit for co-simulation, of FMI 2.0 or
 * 3.0. It is an archive of the model's description, the shim (src/vibrospice/fmu.c, which starts
 * the program), and the scene. */
#include "export_fmu.h"

#include <ctype.h>
#include <fcntl.h>
#include <fts.h>
#include <glob.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "control/fmu_machine.h"
#include "ngspice/ngspice.h"
#include "run/scene.h"
#include "serve.h"
#include "vibrospice/protocol.h"

#ifndef VS_FMU_SHIM
#error "the build names the shim as it is installed, from the folder of the program"
#endif

/* ---- an archive: ZIP ---- */

typedef struct archive {
  FILE *stream;
  vs_text directory; /* what stands at the end */
  unsigned count;
} archive;

static void put_number(vs_text *t, unsigned long value, int bytes) {
  for (; bytes--; value >>= 8) vs_text_put(t, &(char){(char)(value & 255)}, 1);
}

/* What the head of a file and its entry in the directory have alike: version, flags, method, time
 * (1980-01-01, so that the archive is the same each time), checksum, sizes, length of the name. */
static void put_head(vs_text *t, const char *name, const vs_text *whole, const vs_text *packed) {
  put_number(t, 20, 2);
  put_number(t, 0, 2);
  put_number(t, packed->text == whole->text ? 0 : 8, 2);
  put_number(t, 0, 2);
  put_number(t, 0x21, 2);
  put_number(t, vs_hash_crc32(whole->text, whole->length), 4);
  put_number(t, packed->length, 4);
  put_number(t, whole->length, 4);
  put_number(t, strlen(name), 2);
}

/* Deflates the bytes, to be freed; they themselves where they are few or that makes them no less.
 */
static vs_text pack(const vs_text *whole) {
  z_stream z = {0};
  vs_text packed = {0};
  if (whole->length < 4096 || deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8,
                                           Z_DEFAULT_STRATEGY) != Z_OK)
    return *whole;
  vs_text_add(&packed, "%*s", (int)whole->length, ""); /* room */
  z.next_in = (Bytef *)whole->text;
  z.avail_in = (uInt)whole->length;
  z.next_out = (Bytef *)packed.text;
  z.avail_out = (uInt)whole->length;
  const bool good = deflate(&z, Z_FINISH) == Z_STREAM_END;
  packed.length = z.total_out;
  deflateEnd(&z);
  if (good) return packed;
  vs_text_free(&packed);
  return *whole;
}

static void add_file(archive *a, const char *name, const vs_text *whole) {
  vs_text head = {0}, packed = pack(whole);
  const long at = ftell(a->stream);
  vs_text_put(&head, "PK\3\4", 4);
  put_head(&head, name, whole, &packed);
  put_number(&head, 0, 2);
  fwrite(head.text, 1, head.length, a->stream);
  fputs(name, a->stream);
  fwrite(packed.text, 1, packed.length, a->stream);
  vs_text_free(&head);
  vs_text_put(&a->directory, "PK\1\2\24\3", 6); /* made by version 20, on Unix */
  put_head(&a->directory, name, whole, &packed);
  put_number(&a->directory, 0, 8); /* no extra field, comment, disk, inner attributes */
  put_number(&a->directory, 0100755UL << 16, 4);
  put_number(&a->directory, (unsigned long)at, 4);
  vs_text_put(&a->directory, name, strlen(name));
  if (packed.text != whole->text) vs_text_free(&packed);
  a->count++;
}

static void end_archive(archive *a) {
  vs_text end = {0};
  const long at = ftell(a->stream);
  vs_text_put(&end, "PK\5\6\0\0\0\0", 8);
  put_number(&end, a->count, 2);
  put_number(&end, a->count, 2);
  put_number(&end, a->directory.length, 4);
  put_number(&end, (unsigned long)at, 4);
  put_number(&end, 0, 2);
  fwrite(a->directory.text, 1, a->directory.length, a->stream);
  fwrite(end.text, 1, end.length, a->stream);
  vs_text_free(&end);
  vs_text_free(&a->directory);
}

/* ---- the description ---- */

enum { MOST_CELLS = 8, MOST_TERMINALS = 12 };

static void add_escaped(vs_text *t, const char *text) {
  for (; *text; text++)
    if (strchr("<>&\"", *text))
      vs_text_add(t, "&#%d;", *text);
    else
      vs_text_put(t, text, 1);
}

/* A variable. causality: "input" or "parameter", with a start, or "output". */
static void add_variable(vs_text *t, int fmi, const char *name, int reference,
                         const char *causality, const char *unit, const char *start,
                         const char *text) {
  vs_text_add(t, "<%s name=\"%s\" valueReference=\"%d\" causality=\"%s\" ",
              fmi == 2 ? "ScalarVariable" : "Float64", name, reference, causality);
  vs_text_add(t, "variability=\"%s\"%s description=\"", *causality == 'p' ? "fixed" : "continuous",
              *causality == 'o' ? " initial=\"calculated\"" : "");
  add_escaped(t, text);
  vs_text_add(t, fmi == 2 ? "\"><Real" : "\"");
  if (*unit) vs_text_add(t, " unit=\"%s\"", unit);
  if (start) vs_text_add(t, " start=\"%s\"", start);
  vs_text_add(t, fmi == 2 ? "/></ScalarVariable>\n" : "/>\n");
}

/* What of a description becomes variables. */
typedef struct variables {
  int fmi;
  vs_text all, units, outputs, unknowns; /* as XML */
  struct {
    char name[32];
    vs_text members;
  } terminal[MOST_TERMINALS]; /* up to the first without a name */
  int count, inputs, columns;
} variables;

/* Adds a variable to the terminal of that name, which is a bundle of what belongs together. */
static void add_to_terminal(variables *v, const char *terminal, const char *variable) {
  int k = 0;
  while (k < MOST_TERMINALS - 1 && *v->terminal[k].name && strcmp(v->terminal[k].name, terminal))
    k++;
  snprintf(v->terminal[k].name, sizeof v->terminal[k].name, "%s", terminal);
  vs_text_add(&v->terminal[k].members,
              "<TerminalMemberVariable variableName=\"%s\" memberName=\"%s\" "
              "variableKind=\"signal\"/>\n",
              variable, variable);
}

/* The second file, which FMI 3.0 has besides. */
static void write_terminals(variables *v, vs_text *t) {
  vs_text_add(t, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                 "<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n<Terminals>\n");
  for (int k = 0; k < MOST_TERMINALS && *v->terminal[k].name; k++) {
    vs_text_add(t, "<Terminal name=\"%s\" matchingRule=\"bus\">\n%s</Terminal>\n",
                v->terminal[k].name, v->terminal[k].members.text);
    vs_text_free(&v->terminal[k].members);
  }
  vs_text_add(t, "</Terminals>\n</fmiTerminalsAndIcons>\n");
}

static void add_unit(variables *v, const char *unit) {
  char word[64];
  snprintf(word, sizeof word, "<Unit name=\"%s\"/>", unit);
  if (*unit && !(v->units.text && strstr(v->units.text, word))) vs_text_add(&v->units, "%s", word);
}

/* Takes a line of vs_serve_describe. The first column is the time, which is the master's. */
static void take_line(variables *v, char *line) {
  const char *cell[MOST_CELLS];
  for (int k = 0; k < MOST_CELLS; k++) {
    char *word = strsep(&line, "\t");
    cell[k] = word ? word : "";
  }
  if (*cell[0] == 'i') {
    add_unit(v, cell[2]);
    const bool fixed = !strcmp(cell[7], "fixed");
    add_variable(&v->all, v->fmi, cell[1], VIBROSPICE_UNIT_INPUTS + v->inputs++,
                 fixed ? "parameter" : "input", cell[2], cell[5], cell[6]);
    if (!fixed) add_to_terminal(v, "input", cell[1]);
    v->count++;
  }
  if (*cell[0] == 'c' && v->columns++ > 0) {
    add_unit(v, cell[3]);
    const int reference = VIBROSPICE_UNIT_COLUMNS + v->columns - 1;
    add_variable(&v->all, v->fmi, cell[1], reference, "output", cell[3], NULL, cell[4]);
    add_to_terminal(v, cell[4], cell[1]);
    v->count++;
    if (v->fmi == 2)
      vs_text_add(&v->outputs, "<Unknown index=\"%d\"/>", v->count + 1);
    else
      vs_text_add(&v->outputs, "<Output valueReference=\"%d\"/>", reference);
    if (v->fmi == 3)
      vs_text_add(&v->unknowns, "<InitialUnknown valueReference=\"%d\"/>", reference);
  }
}

static void write_description(const vs_scene *s, const vs_export_fmu_options *o,
                              const char *identifier, const char *guid, vs_text *t,
                              vs_text *terminals) {
  const int fmi = o->fmi;
  vs_text lines = {0};
  variables v = {.fmi = fmi};
  vs_serve_describe(s, &lines);
  char *rest = lines.text;
  for (char *line; (line = strsep(&rest, "\n"));) take_line(&v, line);
  vs_text_add(t,
              "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<fmiModelDescription fmiVersion=\"%d.0\" modelName=\"%s\" %s=\"%s\" "
              "generationTool=\"VibroSpice " VS_VERSION "\" variableNamingConvention=\"flat\">\n",
              fmi, identifier, fmi == 2 ? "guid" : "instantiationToken", guid);
  vs_text_add(t,
              "<CoSimulation modelIdentifier=\"%s\" needsExecutionTool=\"%s\" "
              "canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMU%s=\"true\" "
              "canSerializeFMU%s=\"true\"%s/>\n",
              identifier, o->with_program ? "false" : "true", fmi == 2 ? "state" : "State",
              fmi == 2 ? "state" : "State", fmi == 2 ? "" : " mightReturnEarlyFromDoStep=\"true\"");
  if (v.units.length) vs_text_add(t, "<UnitDefinitions>%s</UnitDefinitions>\n", v.units.text);
  vs_text_add(t, "<DefaultExperiment startTime=\"0\" stopTime=\"%.17g\" stepSize=\"%.17g\"/>\n",
              s->setup.run.until_s, s->setup.run.sample_s);
  vs_text_add(t,
              "<ModelVariables>\n<%s name=\"time\" valueReference=\"0\" "
              "causality=\"independent\" variability=\"continuous\"%s\n%s</ModelVariables>\n",
              fmi == 2 ? "ScalarVariable" : "Float64",
              fmi == 2 ? "><Real/></ScalarVariable>" : "/>", v.all.text);
  if (fmi == 2)
    vs_text_add(t, "<ModelStructure><Outputs>%s</Outputs><InitialUnknowns>%s</InitialUnknowns>",
                v.outputs.text, v.outputs.text);
  else
    vs_text_add(t, "<ModelStructure>%s%s", v.outputs.text, v.unknowns.text);
  vs_text_add(t, "</ModelStructure>\n</fmiModelDescription>\n");
  write_terminals(&v, terminals);
  vs_text_free(&lines);
  vs_text_free(&v.all);
  vs_text_free(&v.units);
  vs_text_free(&v.outputs);
  vs_text_free(&v.unknowns);
}

/* ---- the unit ---- */

/* A file as a whole, to be freed. Error: VS_RUN, it cannot be read. */
static vs_status read_whole(const char *path, vs_text *t, vs_error *err) {
  char part[1 << 16];
  FILE *f = fopen(path, "rb");
  for (size_t n; f && (n = fread(part, 1, sizeof part, f)) > 0;) vs_text_put(t, part, n);
  const bool good = f && !ferror(f) && t->length;
  if (f) fclose(f);
  return good ? VS_OK : vs_fail(err, VS_RUN, "%s: cannot be read", path);
}

/* ---- the program, packed ---- */

static vs_status pack_file(archive *a, const char *folder, const char *name, const char *path,
                           vs_error *err) {
  char to[2 * VS_PATH_SIZE];
  vs_text whole = {0};
  vs_status status = read_whole(path, &whole, err);
  snprintf(to, sizeof to, "%s/%s", folder, name);
  if (!status) add_file(a, to, &whole);
  vs_text_free(&whole);
  return status;
}

/* The libraries that the process has loaded, but for those of the C and C++ compilers. */
typedef struct packing {
  archive *archive;
  vs_error *err;
  vs_status status;
} packing;

static int pack_library(struct dl_phdr_info *info, size_t size, void *ctx) {
  static const char *const EVERYWHERE[] = {"ld-linux", "libc.so",       "libm.so",  "libdl.so",
                                           "librt.so", "libpthread.so", "libgcc_s", "libstdc++"};
  packing *p = ctx;
  const char *slash = strrchr(info->dlpi_name, '/');
  (void)size;
  if (!slash || p->status) return 0; /* the program itself, and what the kernel brings */
  for (size_t k = 0; k < sizeof EVERYWHERE / sizeof *EVERYWHERE; k++)
    if (!strncmp(slash + 1, EVERYWHERE[k], strlen(EVERYWHERE[k]))) return 0;
  p->status = pack_file(p->archive, "resources/program/lib", slash + 1, info->dlpi_name, p->err);
  if (p->status || strncmp(slash + 1, "libngspice", 10) != 0) return 0;
  char pattern[VS_PATH_SIZE]; /* its code models lie beside it */
  glob_t found;
  snprintf(pattern, sizeof pattern, "%.*s/ngspice/*.cm", (int)(slash - info->dlpi_name),
           info->dlpi_name);
  if (glob(pattern, 0, NULL, &found)) return 0;
  for (size_t k = 0; k < found.gl_pathc && !p->status; k++)
    p->status = pack_file(p->archive, "resources/program/lib/ngspice",
                          strrchr(found.gl_pathv[k], '/') + 1, found.gl_pathv[k], p->err);
  globfree(&found);
  return 0;
}

static int by_name(const FTSENT **a, const FTSENT **b) {
  return strcmp((*a)->fts_name, (*b)->fts_name);
}

/* What ships with the program: all files of the folder that has this one. */
static vs_status pack_shipped(archive *a, vs_error *err) {
  static const vs_shelf SHELF = {"deck", "", ".cir"};
  char root[VS_PATH_SIZE];
  vs_status status = VS_OK;
  if (!vs_path_own(&SHELF, "halfwave_paper", root))
    return vs_fail(err, VS_RUN, "export: the files that ship with the program are missing");
  *strrchr(root, '/') = '\0';
  const size_t length = strlen(root) + 1;
  FTS *tree = fts_open((char *const[]){root, NULL}, FTS_LOGICAL | FTS_NOCHDIR, by_name);
  for (const FTSENT *f; tree && !status && (f = fts_read(tree));)
    if (f->fts_info == FTS_F && f->fts_statp->st_size)
      status = pack_file(a, "resources/program/share/vibrospice", f->fts_path + length, f->fts_path,
                         err);
  if (tree) fts_close(tree);
  return status;
}

static const char LICENCES[] =
    "The files below resources/program are programs and libraries that run beside this unit as a\n"
    "process of their own: VibroSpice " VS_VERSION
    " (GPL-3.0-or-later) with GSL (GPL-3.0-or-later),\n"
    "libfyaml (MIT), libzstd (BSD) and zlib; libngspice with its code models (BSD); libgomp (GPL\n"
    "with the GCC runtime library exception). Their sources: https://www.gnu.org/software/gsl,\n"
    "https://ngspice.sourceforge.io, https://gcc.gnu.org, and those of VibroSpice from where it\n"
    "came. The unit itself, that is binaries and modelDescription.xml, is under the MIT licence.\n";

static vs_status pack_program(archive *a, vs_error *err) {
  vs_text licences = {0};
  vs_status status = pack_file(a, "resources/program/bin", "vibrospice", "/proc/self/exe", err);
  if (!status) status = vs_ngspice_begin(err);
  packing p = {a, err, status};
  if (!status) dl_iterate_phdr(pack_library, &p);
  status = p.status;
  if (!status) status = pack_shipped(a, err);
  vs_text_add(&licences, "%s", LICENCES);
  add_file(a, "documentation/licenses/license.txt", &licences);
  vs_text_free(&licences);
  return status;
}

/* ---- the unit's own files ---- */

/* The shim lies beside the program, or where it is installed. */
static vs_status read_shim(vs_text *t, vs_error *err) {
  static const char *const PLACES[] = {"vibrospice_fmu.so", VS_FMU_SHIM};
  char self[VS_PATH_SIZE] = "", path[VS_PATH_SIZE + 64];
  const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  char *slash = n > 0 ? strrchr(self, '/') : NULL;
  if (slash) slash[1] = '\0';
  for (size_t k = 0; k < sizeof PLACES / sizeof *PLACES; k++) {
    snprintf(path, sizeof path, "%s%s", self, PLACES[k]);
    if (!access(path, R_OK)) return read_whole(path, t, err);
  }
  return vs_fail(err, VS_RUN, "export: %s is missing; a unit is made from it", path);
}

/* A name of C's, from the output's: "x" of "out/x.fmu". */
static void name_unit(const char *output, char *name, size_t size) {
  const char *slash = strrchr(output, '/'), *from = slash ? slash + 1 : output;
  snprintf(name, size, "%s%.*s", isdigit((unsigned char)*from) ? "_" : "", (int)strlen(from) - 4,
           from);
  for (char *c = name; *c; c++)
    if (!isalnum((unsigned char)*c)) *c = '_';
}

static vs_status write_unit(const vs_scene *s, const vs_export_fmu_options *o, const vs_text *text,
                            const vs_text *sets, const char *output, vs_error *err) {
  char identifier[128], path[256], guid[64];
  vs_text shim = {0}, description = {0}, terminals = {0}, token = {0};
  vs_file file = {0};
  vs_status status = read_shim(&shim, err);
  name_unit(output, identifier, sizeof identifier);
  snprintf(guid, sizeof guid, "{vibrospice-" VS_VERSION "-%08x-%08x}",
           (unsigned)vs_hash_crc32(text->text, text->length),
           (unsigned)vs_hash_crc32(sets->text, sets->length));
  if (!status) status = vs_file_open(&file, "", output, err);
  if (!status) {
    archive a = {.stream = file.stream};
    write_description(s, o, identifier, guid, &description, &terminals);
    add_file(&a, "modelDescription.xml", &description);
    if (o->fmi == 3) add_file(&a, "terminalsAndIcons/terminalsAndIcons.xml", &terminals);
    snprintf(path, sizeof path, "binaries/%s/%s.so", vs_fmu_machine(o->fmi), identifier);
    add_file(&a, path, &shim);
    add_file(&a, "resources/scene.yaml", text);
    add_file(&a, "resources/sets.txt", sets);
    vs_text_add(&token, "%s\n", guid);
    add_file(&a, "resources/token.txt", &token);
    if (o->with_program) status = pack_program(&a, err);
    end_archive(&a);
    if (!status)
      status = vs_file_commit(&file, err);
    else
      vs_file_discard(&file);
  }
  vs_text_free(&shim);
  vs_text_free(&token);
  vs_text_free(&description);
  vs_text_free(&terminals);
  return status;
}

/* The scene as text alone, as it is in the unit: what it names by relative paths is not there. */
static vs_status try_alone(const vs_text *text, char *const *sets, size_t n_sets, vs_error *err) {
  vs_scene *s = vs_alloc(1, sizeof *s);
  const int here = open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool away = here >= 0 && !chdir("/");
  *s = (vs_scene){.opened = true};
  vs_status status = vs_tree_parse(text->text, "the scene in the unit", &s->tree, err);
  for (size_t k = 0; k < n_sets && !status; k++) status = vs_tree_set(&s->tree, sets[k], err);
  if (!status) status = vs_scene_read_sections(s, NULL, err);
  if (away && fchdir(here)) status = vs_fail(err, VS_RUN, "the working folder is gone");
  if (here >= 0) close(here);
  vs_scene_free(s);
  free(s);
  return status;
}

vs_status vs_export_fmu_command(const char *name, char *const *sets, size_t n_sets,
                                const char *output, const vs_export_fmu_options *o, vs_error *err) {
  vs_scene *s = vs_alloc(1, sizeof *s);
  vs_text text = {0}, keys = {0};
  vs_status status = vs_scene_read(name, sets, n_sets, NULL, s, err);
  vs_text_add(&keys, "%s", "");
  for (size_t k = 0; k < n_sets; k++) vs_text_add(&keys, "%s\n", sets[k]);
  if (!status && s->control.regulator && s->control.regulator->code)
    status = vs_fail(err, VS_INPUT, "export: the scene runs code of its own, which a unit may not");
  const char *slash = strrchr(output, '/');
  if (!status && !strcmp(slash ? slash + 1 : output, ".fmu"))
    status = vs_fail(err, VS_INPUT, "export: -o %s: the unit has no name; -o FILE.fmu", output);
  if (!status) vs_scene_warn(s);
  if (!status) status = read_whole(s->path, &text, err);
  if (!status) status = try_alone(&text, sets, n_sets, err);
  if (!status) status = write_unit(s, o, &text, &keys, output, err);
  if (!status) printf("written: %s\n", output);
  vs_text_free(&text);
  vs_text_free(&keys);
  vs_scene_free(s);
  free(s);
  return status;
}
