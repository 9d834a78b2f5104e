/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of control that is a functional mock-up unit, as tools for PLCs export them: FMI 2.0 or
 * 3.0, co-simulation.
 *
 *   control: {law: fmu, file: ./pi.fmu, connect: "swing = p_meas_m_largest, ref = 1e-3"}
 *
 * The unit is unpacked into a folder of its own and loaded into a child process (object.h). Each
 * decision sets its inputs, lets it step from the decision before up to now, and takes an angle
 * from its output. */
#include <ctype.h>
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

#include "base/alloc.h"
#include "base/hash.h"
#include "base/text.h"
#include "base/units.h"
#include "control/fmu_machine.h"
#include "control/regulators.h"
#include "object.h"

/* Says in one line why the file is of no use, and returns false. The unit's names may be anything.
 */
static bool no_use(char trouble[VS_OBJECT_TROUBLE], const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static bool no_use(char trouble[VS_OBJECT_TROUBLE], const char *format, ...) {
  va_list list;
  va_start(list, format);
  vsnprintf(trouble, VS_OBJECT_TROUBLE, format, list);
  va_end(list);
  char *wrong = (char *)(uintptr_t)vs_text_not_utf8(trouble, strlen(trouble));
  if (wrong) *wrong = '\0';
  for (char *c = trouble; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 127) *c = ' ';
  return false;
}

/* ---- an archive: ZIP ---- */

enum { NAME = 512 };
/* Bytes of a file that is unpacked: of a description, which is read of strangers' units, too; and
 * of others. */
static const size_t LARGEST_XML = 1 << 24, LARGEST = 1 << 29;

typedef struct entry {
  char name[NAME];
  const char *bytes; /* bytes[packed] in the archive */
  size_t packed, size;
  unsigned method, sum;
} entry;

/* Where a reader of the directory is. */
typedef struct cursor {
  const vs_text *zip;
  size_t at, left; /* left: how many entries are to come */
} cursor;

/* A number of so many bytes, the lowest first; 0 beyond the end. */
static size_t number_at(const vs_text *t, size_t at, size_t bytes) {
  size_t value = 0;
  if (at > t->length || t->length - at < bytes) return 0;
  for (size_t k = bytes; k-- > 0;) value = value << 8 | (unsigned char)t->text[at + k];
  return value;
}

/* The directory's end is within the last 64 KB, as a comment may follow it. No entry: no archive.
 */
static cursor begin_entries(const vs_text *zip) {
  for (size_t at = zip->length; at-- > 0 && zip->length - at < 65557 + 22;)
    if (zip->length - at >= 22 && !memcmp(zip->text + at, "PK\5\6", 4))
      return (cursor){zip, number_at(zip, at + 16, 4), number_at(zip, at + 10, 2)};
  return (cursor){zip, 0, 0};
}

/* False: there are no more, or, where some are left, the archive is damaged. */
static bool next_entry(cursor *c, entry *e) {
  const vs_text *z = c->zip;
  if (!c->left || number_at(z, c->at, 4) != 0x02014b50) return false;
  const size_t length = number_at(z, c->at + 28, 2), head = number_at(z, c->at + 42, 4);
  const size_t from = head + 30 + number_at(z, head + 26, 2) + number_at(z, head + 28, 2);
  *e = (entry){.method = (unsigned)number_at(z, c->at + 10, 2),
               .sum = (unsigned)number_at(z, c->at + 16, 4),
               .packed = number_at(z, c->at + 20, 4),
               .size = number_at(z, c->at + 24, 4)};
  if (length >= NAME || c->at + 46 + length > z->length) return false;
  if (from > z->length || e->packed > z->length - from) return false;
  memcpy(e->name, z->text + c->at + 46, length);
  e->bytes = z->text + from;
  c->at += 46 + length + number_at(z, c->at + 30, 2) + number_at(z, c->at + 32, 2);
  c->left--;
  return true;
}

static bool inflate_entry(const entry *e, vs_text *out) {
  z_stream z = {.next_in = (Bytef *)(uintptr_t)e->bytes, .avail_in = (uInt)e->packed};
  vs_text_add(out, "%*s", (int)e->size, ""); /* room */
  z.next_out = (Bytef *)out->text;
  z.avail_out = (uInt)e->size;
  if (inflateInit2(&z, -MAX_WBITS) != Z_OK) return false;
  const bool good = inflate(&z, Z_FINISH) == Z_STREAM_END && z.total_out == e->size;
  inflateEnd(&z);
  return good;
}

/* The file as a whole, to be freed. False: it is damaged, packed in another way, or too large. */
static bool unpack(const entry *e, size_t most, vs_text *out) {
  out->length = 0;
  vs_text_put(out, "", 0);
  if (e->size > most) return false;
  if (e->method == 0 && e->packed == e->size)
    vs_text_put(out, e->bytes, e->size);
  else if (e->method != 8 || !inflate_entry(e, out))
    return false;
  return vs_hash_crc32(out->text, out->length) == e->sum;
}

/* ---- the description: XML ---- */

/* The next tag, from behind its '<'; *at becomes where it ends. NULL: there is none. */
static const char *next_tag(const char **at) {
  for (const char *c = *at; (c = strchr(c, '<'));) {
    const char *skip = !strncmp(c, "<!--", 4) ? "-->" : !strncmp(c, "<![CDATA[", 9) ? "]]>" : NULL;
    if (skip) {
      c = strstr(c, skip);
      if (!c) return NULL;
      continue;
    }
    const char *tag = ++c;
    for (char quote = '\0'; *c && (quote || *c != '>'); c++)
      quote = quote ? (*c == quote ? '\0' : quote) : *c == '"' || *c == '\'' ? *c : '\0';
    *at = c;
    return *c ? tag : NULL;
  }
  return NULL;
}

static bool is_tag(const char *tag, const char *name) {
  const size_t n = strlen(name);
  return !strncmp(tag, name, n) && (isspace((unsigned char)tag[n]) || strchr("/>", tag[n]));
}

/* Puts the characters that a text of XML stands for in the place of it. */
static void resolve(char *text) {
  static const struct {
    const char *coded;
    char plain;
  } CODES[] = {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}};
  for (char *c = text; (c = strchr(c, '&')); c++)
    for (size_t k = 0; k < sizeof CODES / sizeof *CODES; k++)
      if (!strncmp(c, CODES[k].coded, strlen(CODES[k].coded))) {
        *c = CODES[k].plain;
        memmove(c + 1, c + strlen(CODES[k].coded), strlen(c + strlen(CODES[k].coded)) + 1);
        break;
      }
}

/* An attribute of the tag, cut to the size of value; "": it has none. */
static void attribute(const char *tag, const char *name, char *value, size_t size) {
  const char *c = tag + strcspn(tag, " \t\r\n/>");
  *value = '\0';
  for (;;) {
    c += strspn(c, " \t\r\n");
    const size_t length = strcspn(c, " \t\r\n=/>");
    const char *quote = c + length + strspn(c + length, " \t\r\n=");
    const char *end =
        length && (*quote == '"' || *quote == '\'') ? strchr(quote + 1, *quote) : NULL;
    if (!end) return;
    if (length == strlen(name) && !strncmp(c, name, length)) {
      snprintf(value, size, "%.*s", (int)(end - quote - 1), quote + 1);
      resolve(value);
      return;
    }
    c = end + 1;
  }
}

/* What values the standard has: they are set and got by functions of that name. */
typedef struct type {
  int version;
  const char *tag, *name;
  size_t size;
  char kind; /* real, signed, boolean */
} type;
static const type TYPES[] = {
    {2, "Real", "Real", 8, 'r'},         {2, "Integer", "Integer", 4, 's'},
    {2, "Boolean", "Boolean", 4, 'b'},   {2, "Enumeration", "Integer", 4, 's'},
    {2, "String", NULL, 0, 0},           {3, "Float64", "Float64", 8, 'r'},
    {3, "Float32", "Float32", 4, 'r'},   {3, "Int8", "Int8", 1, 's'},
    {3, "UInt8", "UInt8", 1, 's'},       {3, "Int16", "Int16", 2, 's'},
    {3, "UInt16", "UInt16", 2, 's'},     {3, "Int32", "Int32", 4, 's'},
    {3, "UInt32", "UInt32", 4, 's'},     {3, "Int64", "Int64", 8, 's'},
    {3, "UInt64", "UInt64", 8, 's'},     {3, "Boolean", "Boolean", 1, 'b'},
    {3, "Enumeration", "Int64", 8, 's'}, {3, "String", NULL, 0, 0},
    {3, "Binary", NULL, 0, 0},           {3, "Clock", NULL, 0, 0}};

typedef struct variable {
  char name[128], causality[24], unit[32], declared[128]; /* declared: the type's name; "": none */
  unsigned reference;
  const type *type; /* NULL: it has none that is known */
  /* Where its value comes from. */
  bool connected;
  const double *from; /* in the view; NULL: it is the constant */
  double constant;
} variable;

typedef struct unit {
  int version; /* of the standard */
  char identifier[128], token[256];
  struct declaration {
    char name[128], unit[32];
  } * declared; /* the types, from which variables have their unit: [declarations]; owned */
  size_t declarations;
  variable *variable; /* variable[count]; owned */
  size_t count;
} unit;

static variable *add_variable(unit *u, const char *tag) {
  char reference[24];
  u->variable = vs_alloc_grow(u->variable, u->count, sizeof *u->variable);
  variable *v = &u->variable[u->count++];
  *v = (variable){0};
  attribute(tag, "name", v->name, sizeof v->name);
  attribute(tag, "causality", v->causality, sizeof v->causality);
  attribute(tag, "valueReference", reference, sizeof reference);
  v->reference = (unsigned)strtoul(reference, NULL, 10);
  return v;
}

/* The variable's unit, or that of its type; "": none. */
static const char *unit_of(const unit *u, const variable *v) {
  for (size_t k = 0; k < u->declarations && !*v->unit && *v->declared; k++)
    if (!strcmp(u->declared[k].name, v->declared)) return u->declared[k].unit;
  return v->unit;
}

/* Takes a tag that declares a type, or, in FMI 2.0, one that lies within and has the unit. */
static bool take_declaration(unit *u, const char *tag) {
  struct declaration d = {"", ""},
                     *last = u->declarations ? &u->declared[u->declarations - 1] : NULL;
  attribute(tag, "unit", d.unit, sizeof d.unit);
  if (is_tag(tag, "SimpleType") || is_tag(tag, "Float64Type") || is_tag(tag, "Float32Type")) {
    attribute(tag, "name", d.name, sizeof d.name);
    u->declared = vs_alloc_grow(u->declared, u->declarations, sizeof d);
    u->declared[u->declarations++] = d;
    return true;
  }
  if (u->version != 2 || u->count || !last || !is_tag(tag, "Real")) return false;
  return memcpy(last->unit, d.unit, sizeof d.unit), true;
}

/* Takes a tag apart that begins a value; *open: the variable of FMI 2.0 that it lies in. */
static void take_value(unit *u, const char *tag, variable **open) {
  for (size_t k = 0; k < sizeof TYPES / sizeof *TYPES; k++) {
    if (TYPES[k].version != u->version || !is_tag(tag, TYPES[k].tag)) continue;
    variable *v = u->version == 2 ? *open : add_variable(u, tag);
    if (v) {
      v->type = TYPES[k].name ? &TYPES[k] : NULL;
      attribute(tag, "unit", v->unit, sizeof v->unit);
      attribute(tag, "declaredType", v->declared, sizeof v->declared);
    }
    *open = NULL;
  }
}

static bool read_description(const char *xml, unit *u, char trouble[VS_OBJECT_TROUBLE]) {
  char version[16] = "";
  variable *open = NULL;
  for (const char *tag, *at = xml; (tag = next_tag(&at));) {
    if (is_tag(tag, "fmiModelDescription")) {
      attribute(tag, "fmiVersion", version, sizeof version);
      u->version = atoi(version);
      attribute(tag, u->version == 2 ? "guid" : "instantiationToken", u->token, sizeof u->token);
    } else if (is_tag(tag, "CoSimulation"))
      attribute(tag, "modelIdentifier", u->identifier, sizeof u->identifier);
    else if (is_tag(tag, "ScalarVariable"))
      open = add_variable(u, tag);
    else if (is_tag(tag, "Dimension") && u->count)
      u->variable[u->count - 1].type = NULL; /* an array */
    else if (!take_declaration(u, tag))
      take_value(u, tag, &open);
  }
  if (u->version != 2 && u->version != 3)
    return no_use(trouble, "is of FMI version '%s'; 2.0 and 3.0 can be taken", version);
  if (!*u->identifier)
    return no_use(trouble, "is not for co-simulation; export it as FMI 2.0 or 3.0 Co-Simulation");
  return true;
}

/* ---- the unit ---- */

static void binary_of(const unit *u, char name[NAME]) {
  snprintf(name, NAME, "binaries/%s/%s.so", vs_fmu_machine(u->version), u->identifier);
}

/* Looks for a file; has (may be NULL): whose folders below binaries/ are listed. */
static bool find_entry(const vs_text *zip, const char *name, entry *e, vs_text *has) {
  static const char BELOW[] = "binaries/";
  cursor c = begin_entries(zip);
  while (next_entry(&c, e)) {
    char *rest = e->name + sizeof BELOW - 1;
    if (!strcmp(e->name, name)) return true;
    if (!has || strncmp(e->name, BELOW, sizeof BELOW - 1) != 0) continue;
    rest[strcspn(rest, "/")] = '\0';
    if (*rest && !(has->length && strstr(has->text, rest)))
      vs_text_add(has, "%s%s", has->length ? ", " : "", rest);
  }
  return false;
}

static const variable *find_variable(const unit *u, const char *name) {
  for (size_t k = 0; k < u->count; k++)
    if (!strcmp(u->variable[k].name, name)) return &u->variable[k];
  return NULL;
}

/* Is the output an angle in degrees? */
static bool check_output(const unit *u, const char *name, char trouble[VS_OBJECT_TROUBLE]) {
  const variable *v = find_variable(u, name);
  if (!v || strcmp(v->causality, "output") != 0)
    return no_use(trouble,
                  "has no output '%s', which is to be the angle; control.output names another",
                  name);
  if (!v->type || v->type->kind != 'r')
    return no_use(trouble, "its output '%s' is no real number", name);
  const char *in = unit_of(u, v);
  return !*in || !strcmp(in, "deg") ||
         no_use(trouble, "its output '%s' is in %s; an angle in deg is wanted", name, in);
}

/* Reads the archive's description. The unit is to be freed also after an error. */
static bool read_unit(const vs_text *zip, const char *output, unit *u,
                      char trouble[VS_OBJECT_TROUBLE]) {
  entry e;
  char name[NAME];
  vs_text xml = {0}, has = {0};
  if (!find_entry(zip, "modelDescription.xml", &e, NULL))
    return no_use(trouble,
                  "is not a functional mock-up unit: no archive with modelDescription.xml");
  bool good =
      unpack(&e, LARGEST_XML, &xml) || no_use(trouble, "is damaged, or too large: %s", e.name);
  good = good && read_description(xml.text, u, trouble);
  vs_text_free(&xml);
  if (!good || !check_output(u, output, trouble)) return false;
  binary_of(u, name);
  if (!find_entry(zip, name, &e, &has))
    good = no_use(trouble, "is for other machines: it has no %s; its binaries: %.200s", name,
                  has.length ? has.text : "none");
  vs_text_free(&has);
  return good;
}

static bool read_file(const char *path, vs_text *zip, vs_error *err) {
  char part[1 << 16];
  FILE *f;
  if (vs_hash_open(path, &f, err) || !f) return false;
  for (size_t n; (n = fread(part, 1, sizeof part, f)) > 0;) vs_text_put(zip, part, n);
  fclose(f);
  return true;
}

/* ---- unpacking it ---- */

/* Writes a file below the folder, whose name leads nowhere else. */
static bool write_below(const char *folder, const char *name, const vs_text *bytes) {
  char path[VS_PATH_SIZE + NAME];
  if (*name == '/' || strstr(name, "..") || strchr(name, '\\')) return false;
  const int length = snprintf(path, sizeof path, "%s/%s", folder, name);
  for (char *c = path + strlen(folder) + 1; (c = strchr(c, '/')); *c++ = '/') {
    *c = '\0';
    mkdir(path, 0700);
  }
  if (path[length - 1] == '/') return true;
  FILE *f = fopen(path, "wb");
  if (!f) return false;
  const bool good = fwrite(bytes->text, 1, bytes->length, f) == bytes->length;
  return !fclose(f) && good;
}

static bool unpack_all(const vs_text *zip, const char *folder, char trouble[VS_OBJECT_TROUBLE]) {
  cursor c = begin_entries(zip);
  vs_text bytes = {0};
  bool good = true;
  entry e;
  while (good && next_entry(&c, &e)) {
    errno = 0;
    good =
        unpack(&e, LARGEST, &bytes) || no_use(trouble, "is damaged, or too large: %.200s", e.name);
    if (good && !write_below(folder, e.name, &bytes))
      good = no_use(trouble, "cannot be unpacked: %.200s: %s", e.name,
                    errno ? strerror(errno) : "a name that leads elsewhere");
  }
  vs_text_free(&bytes);
  return good && (!c.left || no_use(trouble, "is damaged"));
}

/* ---- its inputs ---- */

/* The regulator. */
typedef struct fmu {
  vs_object object;
  char folder[VS_PATH_SIZE];
  const vs_control_values *v;
  /* In the child: */
  unit unit;
  const variable *output;
  void *library, *instance;
  double t_s, first_s, number; /* number, first_s: what the view has in another type or place */
  bool begun;
  char said[200]; /* the unit's last message */
  struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
  } callbacks; /* of FMI 2.0 */
} fmu;

/* What a variable may be connected with, by name, and the ending of its unit; NULL: none. */
static const double *find_source(fmu *f, const char *name, char ending[64]) {
  static const char *const PART[] = {"", "_least", "_largest"};
  vs_law_input *view = &f->object.view;
  *ending = '\0';
  if (!strcmp(name, "t_s")) return strcpy(ending, "s"), &view->firing.t_s;
  if (!strcmp(name, "last_angle_deg")) return strcpy(ending, "deg"), &view->firing.last_angle_deg;
  if (!strcmp(name, "firing")) return &f->number;
  for (int k = 0; k < view->firing.count; k++) {
    vibrospice_channel *c = &view->channel[k];
    const double *value[] = {&c->now, &c->least, &c->largest};
    const size_t length = strlen(c->name);
    for (int n = 0; n < 3; n++)
      if (!strncmp(name, c->name, length) && !strcmp(name + length, PART[n]))
        return snprintf(ending, 64, "%s", c->name), value[n];
  }
  return NULL;
}

static bool has_same_unit(const char *wanted, const char *ending) {
  char suffix[40];
  if (!*wanted || !strcmp(wanted, "1")) return true;
  vs_units_suffix(wanted, suffix, sizeof suffix);
  const size_t n = strlen(suffix), m = strlen(ending);
  return m >= n && !strcmp(ending + m - n, suffix) && (m == n || ending[m - n - 1] == '_');
}

static bool fits(const type *t, double value) {
  const bool natural = *t->name == 'U' || t->kind == 'b';
  const int bits = t->kind == 'b' ? 1 : t->size == 8 ? 53 : 8 * (int)t->size - !natural;
  const double end = ldexp(1, bits);
  return t->kind == 'r' || (value == floor(value) && value < end && value >= (natural ? 0 : -end));
}

static bool connect(fmu *f, variable *v, const char *source, char trouble[VS_OBJECT_TROUBLE]) {
  char ending[64], *rest;
  if (!v->type) return no_use(trouble, "its variable '%s' is no number", v->name);
  v->connected = true;
  v->from = find_source(f, source, ending);
  v->constant = strtod(source, &rest);
  if (!v->from && (rest == source || *rest || !isfinite(v->constant)))
    return no_use(trouble,
                  "its variable '%s' is to be connected with '%s', which is neither a number nor a "
                  "channel; see docs/control.md",
                  v->name, source);
  if (v->from ? v->type->kind != 'r' && v->from != &f->number : !fits(v->type, v->constant))
    return no_use(trouble, "its variable '%s' is of type %s, and %s is not", v->name, v->type->tag,
                  source);
  if (v->from && !has_same_unit(unit_of(&f->unit, v), ending))
    return no_use(trouble, "its variable '%s' is in %s, and %s is not", v->name,
                  unit_of(&f->unit, v), source);
  return true;
}

/* Does what control.connect says: NAME = SOURCE, ... */
static bool connect_as_told(fmu *f, char trouble[VS_OBJECT_TROUBLE]) {
  char text[VS_NAME_SIZE], name[VS_NAME_SIZE], source[VS_NAME_SIZE], *rest = text;
  snprintf(text, sizeof text, "%s", f->v->connect);
  if (!strcmp(text, "auto")) return true;
  for (char *item; (item = strsep(&rest, ","));) {
    int end = 0;
    if (sscanf(item, " %[^= ] = %[^ ] %n", name, source, &end) != 2 || item[end])
      return no_use(trouble,
                    "cannot be connected by '%s'; control.connect wants NAME = CHANNEL, ...", item);
    variable *v = (variable *)(uintptr_t)find_variable(&f->unit, name);
    if (!v || (strcmp(v->causality, "input") != 0 && strcmp(v->causality, "parameter") != 0))
      return no_use(trouble, "has no input or parameter '%s', which control.connect names", name);
    if (!connect(f, v, source, trouble)) return false;
  }
  return true;
}

static bool connect_all(fmu *f, char trouble[VS_OBJECT_TROUBLE]) {
  char ending[64];
  if (!connect_as_told(f, trouble)) return false;
  for (size_t k = 0; k < f->unit.count; k++) {
    variable *v = &f->unit.variable[k];
    if (v->connected || strcmp(v->causality, "input") != 0) continue;
    if (!find_source(f, v->name, ending))
      return no_use(trouble,
                    "has an input '%s' that nothing is connected with; write control.connect: "
                    "\"%s = CHANNEL\"",
                    v->name, v->name);
    if (!connect(f, v, v->name, trouble)) return false;
  }
  return true;
}

/* ---- the child: calling it ---- */

static void take_message_2(void *environment, const char *instance, int status,
                           const char *category, const char *format, ...) {
  fmu *f = environment;
  va_list list;
  (void)instance, (void)status, (void)category;
  va_start(list, format);
  vsnprintf(f->said, sizeof f->said, format, list);
  va_end(list);
}

static void take_message_3(void *environment, int status, const char *category,
                           const char *message) {
  fmu *f = environment;
  (void)status, (void)category;
  snprintf(f->said, sizeof f->said, "%s", message);
}

/* A function of the standard's; NULL: the unit has none of that name. */
static void *function(const fmu *f, const char *name) {
  char whole[64];
  snprintf(whole, sizeof whole, "fmi%d%s", f->unit.version, name);
  return dlsym(f->library, whole);
}

/* Calls one that returns a status; false: it failed, and error says so. */
#define CALL(f, name, types, ...)                                                                  \
  passes(f, name, ((int(*) types)(uintptr_t)function(f, name))(__VA_ARGS__), error)

static bool passes(const fmu *f, const char *name, int status, char *error) {
  static const char *const STATUS[] = {"discard", "error", "fatal"};
  if (status >= 0 && status < 2) return true; /* a warning at most */
  snprintf(error, VIBROSPICE_LAW_TEXT, "fmi%d%s: %s%s%s", f->unit.version, name,
           status > 1 && status < 5 ? STATUS[status - 2] : "no status", *f->said ? ": " : "",
           f->said);
  return false;
}

static bool set_value(fmu *f, const variable *v, char *error) {
  const double value = v->from ? *v->from : v->constant;
  const float small = (float)value;
  unsigned char bytes[8];
  char name[24];
  if (isnan(value)) return true; /* no sample yet: it keeps its start */
  if (!fits(v->type, value))
    return snprintf(error, VIBROSPICE_LAW_TEXT, "%s: %g is too large", v->name, value), false;
  const int64_t whole = v->type->kind == 'b' ? value != 0 : llround(value);
  memcpy(bytes,
         v->type->kind != 'r' ? (const void *)&whole
         : v->type->size == 4 ? (const void *)&small
                              : (const void *)&value,
         v->type->size);
  snprintf(name, sizeof name, "Set%s", v->type->name);
  return f->unit.version == 2
             ? CALL(f, name, (void *, const unsigned *, size_t, const void *), f->instance,
                    &v->reference, 1, bytes)
             : CALL(f, name, (void *, const unsigned *, size_t, const void *, size_t), f->instance,
                    &v->reference, 1, bytes, 1);
}

static bool set_all(fmu *f, const char *causality, char *error) {
  for (size_t k = 0; k < f->unit.count; k++) {
    const variable *v = &f->unit.variable[k];
    if (v->connected && !strcmp(v->causality, causality) && !set_value(f, v, error)) return false;
  }
  return true;
}

static bool get_angle(fmu *f, double *angle_deg, char *error) {
  const variable *v = f->output;
  float small;
  void *to = v->type->size == 4 ? (void *)&small : (void *)angle_deg;
  char name[24];
  snprintf(name, sizeof name, "Get%s", v->type->name);
  const bool good = f->unit.version == 2
                        ? CALL(f, name, (void *, const unsigned *, size_t, void *), f->instance,
                               &v->reference, 1, to)
                        : CALL(f, name, (void *, const unsigned *, size_t, void *, size_t),
                               f->instance, &v->reference, 1, to, 1);
  if (good && v->type->size == 4) *angle_deg = small;
  return good;
}

/* Its initialization, at the first decision. */
static bool begin_unit(fmu *f, char *error) {
  f->begun = true;
  if (!set_all(f, "parameter", error)) return false;
  if (f->unit.version == 2) {
    if (!CALL(f, "SetupExperiment", (void *, int, double, double, int, double), f->instance, 0, 0.0,
              f->t_s, 0, 0.0) ||
        !CALL(f, "EnterInitializationMode", (void *), f->instance))
      return false;
  } else if (!CALL(f, "EnterInitializationMode", (void *, bool, double, double, bool, double),
                   f->instance, false, 0.0, f->t_s, false, 0.0))
    return false;
  return set_all(f, "input", error) && CALL(f, "ExitInitializationMode", (void *), f->instance);
}

static bool step_unit(fmu *f, double step_s, char *error) {
  bool events = false, ends = false, early = false;
  double last_s;
  if (!set_all(f, "input", error)) return false;
  if (f->unit.version == 2)
    return CALL(f, "DoStep", (void *, double, double, int), f->instance, f->t_s, step_s, 1);
  if (!CALL(f, "DoStep", (void *, double, double, bool, bool *, bool *, bool *, double *),
            f->instance, f->t_s, step_s, true, &events, &ends, &early, &last_s))
    return false;
  if (ends) snprintf(error, VIBROSPICE_LAW_TEXT, "the unit has ended the simulation");
  return !ends;
}

static double decide_by_unit(void *law, const vibrospice_firing *firing, char *error) {
  fmu *f = law;
  const double step_s = firing->t_s - f->t_s;
  double angle_deg = NAN;
  f->number = (double)firing->number;
  *f->said = '\0';
  if (!f->begun) f->t_s = firing->t_s;
  const bool good = !f->begun    ? begin_unit(f, error)
                    : step_s > 0 ? step_unit(f, step_s, error)
                                 : true;
  f->t_s = firing->t_s;
  if (good) get_angle(f, &angle_deg, error);
  return angle_deg;
}

static void end_unit(void *law) {
  fmu *f = law;
  char error[VIBROSPICE_LAW_TEXT];
  if (f->begun) CALL(f, "Terminate", (void *), f->instance);
  ((void (*)(void *))(uintptr_t)function(f, "FreeInstance"))(f->instance);
}

/* ---- the child: loading it ---- */

/* All that is called later is there. */
static bool check_functions(const fmu *f, char trouble[VS_OBJECT_TROUBLE]) {
  static const char *const NAMES[] = {"EnterInitializationMode", "ExitInitializationMode", "DoStep",
                                      "Terminate", "FreeInstance"};
  char name[24];
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++)
    if (!function(f, NAMES[k]))
      return no_use(trouble, "has no function fmi%d%s", f->unit.version, NAMES[k]);
  for (size_t k = 0; k < f->unit.count; k++) {
    const variable *v = &f->unit.variable[k];
    if (!v->connected && v != f->output) continue;
    snprintf(name, sizeof name, "%s%s", v == f->output ? "Get" : "Set", v->type->name);
    if (!function(f, name))
      return no_use(trouble, "has no function fmi%d%s", f->unit.version, name);
  }
  return true;
}

/* The folder with a URI's marks, where `coded`, and its last slash where not. */
static void resources_of(const fmu *f, bool coded, char uri[3 * VS_PATH_SIZE]) {
  char path[VS_PATH_SIZE + 16], *to = uri;
  snprintf(path, sizeof path, "%s/resources%s", f->folder, coded ? "" : "/");
  if (coded) to += sprintf(to, "file://");
  for (const char *c = path; *c && to - uri < 3 * VS_PATH_SIZE - 8; c++)
    if (!coded || isalnum((unsigned char)*c) || strchr("/._-~", *c))
      *to++ = *c;
    else
      to += sprintf(to, "%%%02X", (unsigned char)*c);
  *to = '\0';
}

static bool instantiate(fmu *f, char trouble[VS_OBJECT_TROUBLE]) {
  char resources[3 * VS_PATH_SIZE];
  resources_of(f, f->unit.version == 2, resources);
  if (f->unit.version == 2) {
    void *make = function(f, "Instantiate");
    f->callbacks.logger = take_message_2;
    f->callbacks.allocate = calloc;
    f->callbacks.release = free;
    f->callbacks.environment = f;
    if (make && function(f, "SetupExperiment"))
      f->instance =
          ((void *(*)(const char *, int, const char *, const char *, const void *, int, int))(
              uintptr_t)make)("law", 1, f->unit.token, resources, &f->callbacks, 0, 0);
  } else {
    void *make = function(f, "InstantiateCoSimulation");
    if (make)
      f->instance = ((void *(*)(const char *, const char *, const char *, bool, bool, bool, bool,
                                const unsigned *, size_t, void *,
                                void (*)(void *, int, const char *, const char *), void *))(
          uintptr_t)make)("law", f->unit.token, resources, false, false, false, false, NULL, 0, f,
                          take_message_3, NULL);
  }
  return f->instance ||
         no_use(trouble, "cannot be instantiated%s%s", *f->said ? ": " : "", f->said);
}

static void *load_unit(vs_object *o, char trouble[VS_OBJECT_TROUBLE]) {
  fmu *f = (fmu *)(void *)o; /* of which it is the first member */
  char name[NAME], path[VS_PATH_SIZE + NAME];
  vs_text zip = {0};
  vs_error changed = {0};
  bool good = read_file(o->named, &zip, &changed) || no_use(trouble, "has changed");
  good = good && read_unit(&zip, f->v->output, &f->unit, trouble) && connect_all(f, trouble) &&
         unpack_all(&zip, f->folder, trouble);
  vs_text_free(&zip);
  if (!good) return NULL;
  f->output = find_variable(&f->unit, f->v->output);
  binary_of(&f->unit, name);
  snprintf(path, sizeof path, "%s/%s", f->folder, name);
  f->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!f->library) return no_use(trouble, "cannot be loaded: %s", dlerror()), NULL;
  return check_functions(f, trouble) && instantiate(f, trouble) ? f : NULL;
}

/* ---- the regulator ---- */

#define AT(member) offsetof(vs_control_values, member)
static const vs_field KEYS[] = {
    {"file", VS_NAME, "", "NAME", .offset = AT(file),
     .text = "the unit, FILE.fmu: FMI 2.0 or 3.0, co-simulation"},
    {"connect", VS_NAME, "", "auto", .offset = AT(connect),
     .text = "its inputs and parameters, \"NAME = CHANNEL, NAME = NUMBER\"; auto: by their names"},
    {"output", VS_NAME, "", "angle_deg", .offset = AT(output),
     .text = "which of its outputs is the angle, deg"},
    {"timeout", VS_REAL, "s", "5 s", 0, 86400, true, AT(timeout_s),
     .text = "wall-clock time within which it must answer"}};
#undef AT

static vs_status check_fmu(const vs_control_values *v, vs_where where, vs_error *err) {
  char path[VS_PATH_SIZE], trouble[VS_OBJECT_TROUBLE] = "";
  vs_text zip = {0};
  vs_error none = {0};
  unit u = {0};
  vs_status status = vs_object_check(v, where, err);
  if (status) return status;
  vs_object_file(v, where, 0, path);
  status = vs_path_check_plain(path, where, err); /* another one might be waited for */
  if (status) return status;
  if (!read_file(path, &zip, &none) || !read_unit(&zip, v->output, &u, trouble))
    status =
        vs_fail_at(err, where, "control.file: %s %s", path, *trouble ? trouble : "cannot be read");
  vs_text_free(&zip);
  free(u.variable);
  free(u.declared);
  return status;
}

static vs_status begin_fmu(void *self, const vs_control_input *sight, vs_error *err) {
  fmu *f = self;
  const char *temporary = getenv("TMPDIR");
  vs_status status = check_fmu(sight->v, sight->where, err);
  if (status) return status;
  f->v = sight->v;
  snprintf(f->folder, sizeof f->folder, "%.4000s/vibrospice-unit.XXXXXX",
           temporary && *temporary ? temporary : "/tmp");
  if (!mkdtemp(f->folder)) {
    status = vs_fail(err, VS_RUN, "no folder for the unit: %s: %s", f->folder, strerror(errno));
    *f->folder = '\0';
    return status;
  }
  f->object.remote.folder = f->folder;
  f->object.load = load_unit;
  f->object.decide = decide_by_unit;
  f->object.end = end_unit;
  return vs_object_begin(&f->object, sight, err);
}

const vs_regulator vs_fmu_regulator = {
    .name = "fmu",
    .text = "a law of your own: a functional mock-up unit (FMI); wants --allow-code",
    .fields = KEYS,
    .n_fields = sizeof KEYS / sizeof *KEYS,
    .code = "file",
    .size = sizeof(fmu),
    .check = check_fmu,
    .file = vs_object_file,
    .begin = begin_fmu,
    .tick = vs_object_tick,
    .decide = vs_object_decide,
    .end = vs_object_end};
