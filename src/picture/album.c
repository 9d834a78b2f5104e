/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "picture/album.h"

#include <string.h>

#include "picture/charts.h"
#include "picture/map.h"

bool vs_album_is_sampled(const vs_folder *t) {
  return strstr(t->method, "sobol") || strstr(t->method, "lhs") || strstr(t->method, "monte_carlo");
}

/* A map, or where one axis has few words a curve for each of them. */
static vs_sketch_draw two_axes(const vs_sketch *k) {
  const vs_profile *a = &k->s->profile[k->axis[0]], *b = &k->s->profile[k->axis[1]];
  const vs_profile *words = !a->is_number ? a : b, *numbers = !a->is_number ? b : a;
  if (!words->is_number && words->count <= VS_FAMILY && numbers->is_number) return vs_charts_curve;
  return vs_map_fits(k) ? vs_map_draw : vs_charts_cases;
}

static bool is_cloud(const vs_sketch *k) {
  return k->n_axes == 2 && k->s->profile[k->axis[0]].is_number &&
         k->s->profile[k->axis[1]].is_number;
}

static vs_sketch_draw every_column(const vs_sketch *k) {
  const char *method = k->t->method;
  if (vs_album_is_sampled(k->t)) return vs_spread_histogram;
  if (strstr(method, "corners")) return vs_spread_bars;
  if (strstr(method, "snubber"))
    return vs_map_fits(k) ? vs_map_draw : is_cloud(k) ? vs_charts_cloud : vs_charts_cases;
  if (strstr(method, "list") || !k->n_axes) return vs_charts_cases;
  if (k->n_axes == 1) return k->s->profile[k->axis[0]].many ? vs_charts_cases : vs_charts_curve;
  if (k->n_axes == 2) return two_axes(k);
  return vs_map_fits(k) ? vs_map_draw : vs_charts_cases;
}

static vs_picture *next_picture(vs_album *album) {
  if (album->count == VS_ALBUM) {
    album->left_out++;
    return NULL;
  }
  return &album->item[album->count++];
}

static vs_status add(const vs_sketch *k, vs_sketch_draw draw, size_t column, vs_album *album,
                     vs_error *err) {
  vs_picture *p = next_picture(album);
  vs_status status = p ? draw(k, column, p, err) : VS_OK;
  if (p && !*p->name) album->count--; /* there was nothing to draw */
  return status;
}

/* Each axis' own part, where no picture shows it. */
static vs_status add_effects(const vs_sketch *k, size_t lead, vs_album *album, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t a = 0; a < k->n_axes && !status; a++) {
    if (k->s->profile[k->axis[a]].many) continue;
    vs_picture *p = next_picture(album);
    if (p) status = vs_spread_effect(k, k->axis[a], lead, p, err);
  }
  return status;
}

/* Columns that hold something: the one the cases are judged by first. */
static size_t list_columns(const vs_sketch *k, size_t *column) {
  bool largest;
  size_t n = 0, aim = vs_folder_aim(k->t, &largest);
  if (aim && k->s->profile[aim].known) column[n++] = aim;
  for (size_t c = 1; c < k->t->count; c++) {
    vs_folder_role role = k->t->column[c].role;
    if ((role == VS_ROLE_MARGIN || role == VS_ROLE_REPORT) && c != aim && k->s->profile[c].known)
      column[n++] = c;
  }
  return n;
}

vs_status vs_album_make(const vs_folder *t, const vs_survey *s, vs_album *album, vs_error *err) {
  vs_sketch k = {.t = t, .s = s};
  size_t column[VS_STUDY_COLUMNS];
  vs_status status = VS_OK;
  for (size_t c = 0; c < t->count; c++)
    if (t->column[c].role == VS_ROLE_AXIS && (s->profile[c].many || s->profile[c].count > 1))
      k.axis[k.n_axes++] = c;
  size_t n = list_columns(&k, column);
  if (strstr(t->method, "snubber") && n) status = add(&k, vs_feasible_draw, column[0], album, err);
  bool search = strstr(t->method, "worst") != NULL;
  if (search && n && !status) status = add(&k, vs_charts_path, column[0], album, err);
  if (search && n && !status && is_cloud(&k))
    status = add(&k, vs_charts_cloud, column[0], album, err);
  vs_sketch_draw draw = search ? vs_charts_cases : every_column(&k);
  for (size_t i = search; i < n && !status; i++) status = add(&k, draw, column[i], album, err);
  bool sampled = vs_album_is_sampled(t);
  if (!status && n && sampled && k.n_axes)
    status = add(&k, vs_spread_influence, column[0], album, err);
  if (!status && n && strstr(t->method, "grid") && (sampled || k.n_axes > 2))
    status = add_effects(&k, column[0], album, err);
  return status;
}

void vs_album_free(vs_album *album) {
  for (size_t k = 0; k < album->count; k++) {
    vs_text_free(&album->item[k].title);
    vs_text_free(&album->item[k].caption);
    vs_text_free(&album->item[k].script);
  }
  album->count = 0;
}
