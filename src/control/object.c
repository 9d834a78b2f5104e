/* SPDX-License-Identifier: GPL-3.0-or-later
 * The child process loads the object and says how that went. Then it takes firing after firing, as
 * the bytes of a vs_view, and answers each. As it is a copy of this process, what the view points
 * to has the same address in both. */
#include "control/object.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/path.h"
#include "control/remote.h"
#include "control/view.h"

typedef double (*law)(const vibrospice_firing *firing, char *error);

/* What the child says once, when the object is loaded. */
typedef struct hello {
  char trouble[512]; /* why it is of no use; empty: it is */
} hello;

/* What it answers to each firing. */
typedef struct reply {
  double angle_deg;
  char trouble[VIBROSPICE_LAW_TEXT];
} reply;

_Static_assert(sizeof(hello) <= VS_REMOTE_MOST && sizeof(reply) <= VS_REMOTE_MOST,
               "a remote takes both");

typedef struct object {
  vs_view view;
  vs_remote remote;
  char path[VS_PATH_SIZE]; /* of the object, from the root */
} object;

/* ---- the child ---- */

/* Both end the child where the parent is gone. */
static void read_all(int from, void *data, size_t size) {
  for (char *at = data; size;) {
    ssize_t n = read(from, at, size);
    if (n <= 0) {
      fflush(NULL);
      _exit(0);
    }
    at += n;
    size -= (size_t)n;
  }
}

static void write_all(int to, const void *data, size_t size) {
  if (write(to, data, size) != (ssize_t)size) _exit(1); /* a pipe takes that much at once */
}

/* Loads the object. NULL: it is of no use, and h tells why. */
static law load(const char *path, hello *h) {
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    snprintf(h->trouble, sizeof h->trouble, "cannot be loaded: %s", dlerror());
    return NULL;
  }
  const int *version = dlsym(handle, "vibrospice_law_version");
  void *function = dlsym(handle, "vibrospice_law");
  law found = NULL;
  if (!version)
    snprintf(h->trouble, sizeof h->trouble,
             "has no vibrospice_law_version; compile it with #include <vibrospice/law.h>");
  else if (*version != VIBROSPICE_LAW_VERSION)
    snprintf(h->trouble, sizeof h->trouble,
             "was compiled with version %d of vibrospice/law.h; this program has version %d: "
             "compile it anew",
             *version, VIBROSPICE_LAW_VERSION);
  else if (!function)
    snprintf(h->trouble, sizeof h->trouble, "has no function vibrospice_law");
  else
    memcpy(&found, &function, sizeof found); /* C has no cast from data to a function */
  return found;
}

static void work(void *ctx, int in, int out) {
  object *o = ctx;
  hello h = {{0}};
  law decides = load(o->path, &h);
  write_all(out, &h, sizeof h);
  while (decides) {
    reply r = {0};
    read_all(in, &o->view, vs_view_size(&o->view));
    r.angle_deg = decides(&o->view.firing, r.trouble);
    r.trouble[sizeof r.trouble - 1] = '\0';
    write_all(out, &r, sizeof r);
  }
}

/* ---- the regulator ---- */

#define AT(member) offsetof(vs_control_values, member)
static const vs_field KEYS[] = {
    {"file", VS_NAME, "", "NAME", .offset = AT(file),
     .text = "the shared object, which has the function vibrospice_law"},
    {"timeout", VS_REAL, "s", "5 s", 0, 86400, true, AT(timeout_s),
     .text = "wall-clock time within which it must answer"}};
#undef AT

static bool file(const vs_control_values *v, vs_where where, int k, char path[VS_PATH_SIZE]) {
  return k == 0 && vs_view_path(v->file, where, path);
}

static vs_status check(const vs_control_values *v, vs_where where, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (!file(v, where, 0, path))
    return vs_fail_at(err, where, "control.file: %s: name too long", v->file);
  if (!access(path, R_OK)) return VS_OK;
  return vs_fail_at(err, where, "control.file: %s cannot be read: %s", path, strerror(errno));
}

static vs_status begin(void *self, const vs_sight *sight, vs_error *err) {
  object *o = self;
  const char *name = sight->v->file, *slash = strrchr(name, '/');
  char path[VS_PATH_SIZE];
  hello h;
  o->remote.name = slash ? slash + 1 : name;
  o->remote.timeout_s = sight->v->timeout_s;
  vs_view_begin(&o->view, sight);
  vs_status status = check(sight->v, sight->where, err);
  if (status) return status;
  vs_view_path(name, sight->where, path);
  if (!realpath(path, o->path)) /* dlopen looks elsewhere for a name without a slash */
    return vs_fail_at(err, sight->where, "control.file: %s: %s", path, strerror(errno));
  status = vs_remote_fork(&o->remote, work, o, err);
  if (!status) status = vs_remote_answer(&o->remote, sizeof h, err);
  if (status) return status;
  memcpy(&h, o->remote.in, sizeof h);
  h.trouble[sizeof h.trouble - 1] = '\0'; /* the object may have written into the pipe itself */
  return *h.trouble ? vs_fail_at(err, sight->where, "control.file: %s %s", path, h.trouble) : VS_OK;
}

static void tick(void *self, const vs_sight *sight) {
  object *o = self;
  vs_view_tick(&o->view, sight);
}

static vs_status decide(void *self, const vs_sight *sight, double *angle_rad, vs_error *err) {
  object *o = self;
  reply r;
  vs_view_ask(&o->view, sight);
  vs_status status = vs_remote_ask(&o->remote, sight->t_s, &o->view, vs_view_size(&o->view), err);
  if (!status) status = vs_remote_answer(&o->remote, sizeof r, err);
  if (status) return status;
  memcpy(&r, o->remote.in, sizeof r);
  r.trouble[sizeof r.trouble - 1] = '\0';
  return vs_view_answer(&o->view, o->remote.name, r.angle_deg, r.trouble, angle_rad, err);
}

static void end(void *self) {
  object *o = self;
  vs_remote_end(&o->remote);
}

const vs_regulator vs_object_regulator = {
    .name = "object",
    .text = "a law of your own: a C function in a shared object; wants --allow-code",
    .fields = KEYS,
    .n_fields = sizeof KEYS / sizeof *KEYS,
    .code = "file",
    .size = sizeof(object),
    .check = check,
    .file = file,
    .begin = begin,
    .tick = tick,
    .decide = decide,
    .end = end};
