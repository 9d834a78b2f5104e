/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own as a shared object (vibrospice/law.h):
 *
 *   control: {law: object, file: ./mylaw.so}
 *
 * The object is loaded into a child process, which is asked once for each firing. It
 * loads the object and says how that went. Then it takes firing after firing, as
 * the bytes of a vs_law_input, and answers each. As it is a copy of this process, what the view
 * points to has the same address in both. */
#include "object.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/hash.h"
#include "control/regulators.h"

typedef double (*law)(const vibrospice_firing *firing, char *error);

/* What the child says once, when the object is loaded. */
typedef struct hello {
  char trouble[VS_OBJECT_TROUBLE]; /* why it is of no use; empty: it is */
} hello;

/* What it answers to each firing. */
typedef struct reply {
  double angle_deg;
  char trouble[VIBROSPICE_LAW_TEXT];
} reply;

_Static_assert(sizeof(hello) <= VS_REMOTE_MOST && sizeof(reply) <= VS_REMOTE_MOST,
               "a remote takes both");

/* ---- the child ---- */

/* False: nobody asks any more. */
static bool read_all_of_pipe(int from, void *data, size_t size) {
  for (char *at = data; size;) {
    ssize_t n = read(from, at, size);
    if (n <= 0) return false;
    at += n;
    size -= (size_t)n;
  }
  return true;
}

static void write_all_to_pipe(int to, const void *data, size_t size) {
  if (write(to, data, size) != (ssize_t)size) _exit(1); /* a pipe takes that much at once */
}

/* Copies the object into memory, where nobody changes it while it runs. Returns the copy's
 * descriptor; -1: there is none, or the object asks for libraries that lie beside it, which the
 * loader would not find beside a copy. */
static int copy_object(FILE *from) {
  static const char BESIDE[] = "$ORIGIN";
  char part[4096];
  size_t n = 0;
  int copy = memfd_create("law", 0);
  bool whole = copy >= 0;
  while (whole && (n = fread(part, 1, sizeof part, from)) > 0)
    whole = write(copy, part, n) == (ssize_t)n;
  const off_t size = whole ? lseek(copy, 0, SEEK_CUR) : 0;
  void *bytes = size ? mmap(NULL, (size_t)size, PROT_READ, MAP_PRIVATE, copy, 0) : MAP_FAILED;
  whole = bytes != MAP_FAILED && !memmem(bytes, (size_t)size, BESIDE, sizeof BESIDE - 1);
  if (bytes != MAP_FAILED) munmap(bytes, (size_t)size);
  if (whole || copy < 0) return copy;
  close(copy);
  return -1;
}

/* Opens the object's bytes as the one reader gives them, or, where no copy of them can be loaded,
 * the file, which must then be the same behind that. */
static void *open_object(const vs_object *o, char *trouble) {
  vs_error changed = {0};
  char name[32], sum[VS_HASH_TEXT];
  FILE *f;
  vs_status status = vs_hash_open(o->named, &f, &changed);
  const int copy = f ? copy_object(f) : -1;
  void *handle = NULL;
  if (f) fclose(f);
  snprintf(name, sizeof name, "/proc/self/fd/%d", copy);
  if (copy >= 0) handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (handle) return handle;
  if (!status && !(handle = dlopen(o->path, RTLD_NOW | RTLD_LOCAL))) {
    snprintf(trouble, VS_OBJECT_TROUBLE, "cannot be loaded: %s", dlerror());
    return NULL;
  }
  if (!status && !vs_hash_file(o->named, sum, &changed)) return handle;
  snprintf(trouble, VS_OBJECT_TROUBLE, "has changed as it was loaded");
  return NULL;
}

static void *load_object(vs_object *o, char trouble[VS_OBJECT_TROUBLE]) {
  void *handle = open_object(o, trouble);
  if (!handle) return NULL;
  const int *version = dlsym(handle, "vibrospice_law_version");
  void *function = dlsym(handle, "vibrospice_law");
  if (!version)
    snprintf(trouble, VS_OBJECT_TROUBLE,
             "has no vibrospice_law_version; compile it with #include <vibrospice/law.h>");
  else if (*version != VIBROSPICE_LAW_VERSION)
    snprintf(trouble, VS_OBJECT_TROUBLE,
             "was compiled with version %d of vibrospice/law.h; this program has version %d: "
             "compile it anew",
             *version, VIBROSPICE_LAW_VERSION);
  else if (!function)
    snprintf(trouble, VS_OBJECT_TROUBLE, "has no function vibrospice_law");
  else
    return function;
  return NULL;
}

static double decide_by_function(void *function, const vibrospice_firing *firing, char *error) {
  law decides;
  memcpy(&decides, &function, sizeof decides); /* C has no cast from data to a function */
  return decides(firing, error);
}

static void work(void *ctx, int in, int out) {
  vs_object *o = ctx;
  hello h = {{0}};
  void *loaded = o->load(o, h.trouble);
  write_all_to_pipe(out, &h, sizeof h);
  while (loaded && read_all_of_pipe(in, &o->view, vs_law_input_size(&o->view))) {
    reply r = {0};
    r.angle_deg = o->decide(loaded, &o->view.firing, r.trouble);
    r.trouble[sizeof r.trouble - 1] = '\0';
    write_all_to_pipe(out, &r, sizeof r);
  }
  if (loaded && o->end) o->end(loaded);
}

/* ---- the regulator ---- */

#define AT(member) offsetof(vs_control_values, member)
static const vs_field KEYS[] = {
    {"file", VS_NAME, "", "NAME", .offset = AT(file),
     .text = "the shared object, which has the function vibrospice_law"},
    {"timeout", VS_REAL, "s", "5 s", 0, 86400, true, AT(timeout_s),
     .text = "wall-clock time within which it must answer"}};
#undef AT

bool vs_object_file(const vs_control_values *v, vs_where where, int k, char path[VS_PATH_SIZE]) {
  return k == 0 && vs_law_input_path(v->file, where, path);
}

vs_status vs_object_check(const vs_control_values *v, vs_where where, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (!vs_object_file(v, where, 0, path))
    return vs_fail_at(err, where, "control.file: %s: name too long", v->file);
  if (!access(path, R_OK)) return VS_OK;
  return vs_fail_at(err, where, "control.file: %s cannot be read: %s", path, strerror(errno));
}

vs_status vs_object_begin(vs_object *o, const vs_control_input *sight, vs_error *err) {
  const char *name = sight->v->file, *slash = strrchr(name, '/');
  char *path = o->named, sum[VS_HASH_TEXT];
  hello h;
  o->remote.name = slash ? slash + 1 : name;
  o->remote.timeout_s = sight->v->timeout_s;
  vs_law_input_begin(&o->view, sight);
  vs_status status = vs_object_check(sight->v, sight->where, err);
  if (status) return status;
  vs_law_input_path(name, sight->where, path);
  if (!realpath(path, o->path)) /* dlopen looks elsewhere for a name without a slash */
    return vs_fail_at(err, sight->where, "control.file: %s: %s", path, strerror(errno));
  status = vs_hash_file(path, sum, err); /* which names the file that has changed */
  if (status) return status;
  status = vs_child_process_fork(&o->remote, work, o, err);
  if (!status) status = vs_child_process_answer(&o->remote, sizeof h, err);
  if (status) return status;
  memcpy(&h, o->remote.in, sizeof h);
  h.trouble[sizeof h.trouble - 1] = '\0'; /* the object may have written into the pipe itself */
  return *h.trouble ? vs_fail_at(err, sight->where, "control.file: %s %s", path, h.trouble) : VS_OK;
}

static vs_status begin_object(void *self, const vs_control_input *sight, vs_error *err) {
  vs_object *o = self;
  o->load = load_object;
  o->decide = decide_by_function;
  return vs_object_begin(o, sight, err);
}

void vs_object_tick(void *object, const vs_control_input *sight) {
  vs_object *o = object;
  vs_law_input_tick(&o->view, sight);
}

vs_status vs_object_decide(void *object, const vs_control_input *sight, double *angle_rad,
                           vs_error *err) {
  vs_object *o = object;
  reply r;
  vs_law_input_ask(&o->view, sight);
  vs_status status =
      vs_child_process_ask(&o->remote, sight->t_s, &o->view, vs_law_input_size(&o->view), err);
  if (!status) status = vs_child_process_answer(&o->remote, sizeof r, err);
  if (status) return status;
  memcpy(&r, o->remote.in, sizeof r);
  r.trouble[sizeof r.trouble - 1] = '\0';
  return vs_law_input_answer(&o->view, o->remote.name, r.angle_deg, r.trouble, angle_rad, err);
}

void vs_object_end(void *object) {
  vs_object *o = object;
  vs_child_process_end(&o->remote);
}

const vs_regulator vs_object_regulator = {
    .name = "object",
    .text = "a law of your own: a C function in a shared object; wants --allow-code",
    .fields = KEYS,
    .n_fields = sizeof KEYS / sizeof *KEYS,
    .code = "file",
    .size = sizeof(vs_object),
    .check = vs_object_check,
    .file = vs_object_file,
    .begin = begin_object,
    .tick = vs_object_tick,
    .decide = vs_object_decide,
    .end = vs_object_end};
