/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "batch/page.h"

#include <math.h>
#include <string.h>

#include "base/text.h"

static const char STYLE[] =
    "body{margin:0;background:#fff;color:#1a1a1a;font:15px/1.45 system-ui,'Liberation Sans',Arial,"
    "sans-serif}main{max-width:1180px;margin:0 auto;padding:1.2rem 1.4rem 3rem}"
    "h1{font-size:1.5rem;margin:.2rem 0}h2{font-size:1.15rem;margin:2rem 0 .6rem;border-bottom:1px "
    "solid #ccc}.of{color:#555;margin:0 0 1rem}.verdict{border:1px solid #bbb;border-left:10px "
    "solid #777;padding:.7rem 1.1rem;margin:1rem 0}.good{border-left-color:#0072b2}"
    ".bad{border-left-color:#d55e00}.big{font-size:1.5rem;font-weight:600;margin:.1rem 0}"
    "p{margin:.35rem 0}.pictures{display:flex;flex-wrap:wrap;gap:1.2rem}"
    "figure{margin:0;flex:1 1 520px;max-width:720px;break-inside:avoid}"
    "iframe{width:100%;border:1px solid #ddd;display:block}"
    "figcaption{font-size:.88rem;color:#333;padding:.3rem .1rem}"
    ".wide{overflow-x:auto}table{border-collapse:collapse;font-size:.88rem;margin:.4rem 0}"
    "th,td{border:1px solid #ccc;padding:.2rem .55rem;text-align:left;vertical-align:top;"
    "overflow-wrap:anywhere}"
    "th{background:#f2f2f2}td.n{text-align:right;white-space:nowrap;overflow-wrap:normal}"
    ".wide th,.wide "
    "td{white-space:nowrap;overflow-wrap:normal}.bar{display:inline-block;height:.7em;background:#"
    "0072b2}"
    "@media print{main{max-width:none}a{color:inherit}}";

/* ---- text in HTML ---- */

static void add_escaped(vs_text *html, const char *text) {
  while (*text) {
    int n = (int)strcspn(text, "&<>\"");
    vs_text_add(html, "%.*s", n, text);
    text += n;
    if (*text)
      vs_text_add(html, "%s",
                  *text == '&'   ? "&amp;"
                  : *text == '<' ? "&lt;"
                  : *text == '>' ? "&gt;"
                                 : "&quot;");
    text += *text != '\0';
  }
}

static void add_cell(vs_text *html, const char *text) {
  vs_text_add(html, "<td>");
  add_escaped(html, text);
  vs_text_add(html, "</td>");
}

static void add_number(vs_text *html, double value) {
  if (isnan(value))
    vs_text_add(html, "<td class=\"n\"></td>");
  else
    vs_text_add(html, "<td class=\"n\">%.6g</td>", value);
}

enum { MOST_ITEMS = 24 };

/* What a manifest's node says, on one line. */
static void add_node(vs_text *html, const vs_node *node) {
  if (node->kind == VS_NODE_TEXT) {
    add_escaped(html, node->text);
    return;
  }
  size_t n = 0;
  for (const vs_node *c = node->child; c; c = c->next, n++) {
    if (n >= MOST_ITEMS && c->next) continue;
    vs_text_add(html, n >= MOST_ITEMS ? ", ... " : n ? ", " : "");
    if (c->key) {
      add_escaped(html, c->key);
      vs_text_add(html, ": ");
    }
    bool nested = c->kind != VS_NODE_TEXT;
    if (nested) vs_text_add(html, "(");
    add_node(html, c);
    if (nested) vs_text_add(html, ")");
  }
  if (n > MOST_ITEMS + 1) vs_text_add(html, " (%zu of them)", n);
}

static const char *manifest_text(const vs_study_table *t, const char *key) {
  const vs_node *node = vs_node_child(t->manifest.root, key);
  return node && node->kind == VS_NODE_TEXT ? node->text : "";
}

/* ---- the verdict ---- */

void vs_wilson(double good, double n, double *least, double *largest) {
  const double z = 1.959963984540054; /* of the normal distribution, 2.5 % beyond it */
  double p = good / n, middle = p + z * z / (2 * n);
  double half = z * sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  *least = (middle - half) / (1 + z * z / n);
  *largest = (middle + half) / (1 + z * z / n);
}

double vs_share(long part, long whole) {
  return whole ? floor(1e4 * (double)part / (double)whole) / 100 : 0;
}

static void add_weakest(vs_text *html, const vs_counts *weakest, long judged) {
  if (!weakest->count) return;
  vs_text_add(html, "<p>Weakest part:</p>\n<table><tr><th>part</th><th>cases</th><th>share</th>"
                    "<th></th></tr>\n");
  for (size_t k = 0; k < weakest->count; k++) {
    double share = vs_share(weakest->item[k].times, judged);
    vs_text_add(html, "<tr>");
    add_cell(html, weakest->item[k].name);
    vs_text_add(html,
                "<td class=\"n\">%ld</td><td class=\"n\">%.4g %%</td><td><span class=\"bar\" "
                "style=\"width:%.0fpx\"></span></td></tr>\n",
                weakest->item[k].times, share, 2 * share);
  }
  vs_text_add(html, "</table>\n");
}

static void add_failures(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  if (!t->failed) {
    vs_text_add(html, "<p>No case failed.</p>\n");
    return;
  }
  vs_text_add(html, "<p>Failed, and in no figure here: %ld of %ld cases.</p>\n", t->failed,
              t->done > s->rows ? t->done : s->rows + t->failed);
  if (!s->why.count) {
    vs_text_add(html, "<p>Why is not known: failures.csv is not there.</p>\n");
    return;
  }
  vs_text_add(html, "<table><tr><th>cases</th><th>why</th></tr>\n");
  for (size_t k = 0; k < s->why.count; k++) {
    vs_text_add(html, "<tr><td class=\"n\">%ld</td>", s->why.item[k].times);
    add_cell(html, s->why.item[k].name);
    vs_text_add(html, "</tr>\n");
  }
  vs_text_add(html, "</table>\n");
}

/* The largest or least value that a search came upon. */
static bool add_found(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  bool largest;
  size_t aim = vs_study_aim(t, &largest);
  if (!strstr(t->method, "worst") || !aim || !s->profile[aim].known) return false;
  vs_scale scale = vs_scale_of(&t->column[aim], vs_profile_extent(&s->profile[aim]));
  double found = scale.factor * (largest ? s->profile[aim].largest : s->profile[aim].least);
  vs_text_add(html, "<p class=\"big\">Worst found: ");
  add_escaped(html, t->column[aim].name);
  vs_text_add(html, " %.6g %s, case %s</p>\n", found, scale.unit, s->worst[0].cell[0]);
  return true;
}

static void add_yield(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  double least, largest;
  vs_text_add(html, "<p class=\"big\">Yield %.4g %%</p>\n<p>%ld of %ld cases keep every rating",
              vs_share(s->good, s->judged), s->good, s->judged);
  vs_wilson((double)s->good, (double)s->judged, &least, &largest);
  if (strstr(t->method, "monte_carlo"))
    vs_text_add(html, "; with 95 %%, the true share lies between %.4g %% and %.4g %%", 100 * least,
                100 * largest);
  vs_text_add(html, ".</p>\n");
}

static void add_worst_margin(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  vs_text_add(html, "%.4g %%", 100 * s->profile[t->margin].least);
  if (strstr(t->method, "worst") || !s->n_worst || t->weakest < 0) return;
  vs_text_add(html, ": ");
  add_escaped(html, s->worst[0].cell[t->weakest]);
  vs_text_add(html, ", case %s", s->worst[0].cell[0]);
}

static void add_verdict(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  bool adaptive = strstr(t->method, "worst") || strstr(t->method, "snubber");
  vs_text_add(html, "<section id=\"verdict\" class=\"verdict %s\">\n",
              !s->judged             ? ""
              : s->good == s->judged ? "good"
                                     : "bad");
  bool found = add_found(html, t, s);
  if (!s->rows)
    vs_text_add(html, "<p class=\"big\">No case has a result</p>\n");
  else if (!s->judged)
    vs_text_add(html, "%sNo rating was judged: what ran has none.</p>\n",
                found ? "<p>" : "<p class=\"big\">");
  else if (vs_is_sampled(t)) {
    add_yield(html, t, s);
    vs_text_add(html, "<p>Worst margin ");
    add_worst_margin(html, t, s);
    vs_text_add(html, ".</p>\n");
  } else {
    vs_text_add(html, found ? "<p>Worst margin " : "<p class=\"big\">Worst margin ");
    add_worst_margin(html, t, s);
    vs_text_add(html, "</p>\n<p>%ld of %ld cases keep every rating.</p>\n", s->good, s->judged);
  }
  if (s->judged && s->judged < s->rows)
    vs_text_add(html, "<p>Without a margin: %ld cases.</p>\n", s->rows - s->judged);
  if (t->done < t->cases && !adaptive)
    vs_text_add(html, "<p>Not complete: %ld of %ld cases have been run.</p>\n", t->done, t->cases);
  add_weakest(html, &s->weakest, s->judged);
  add_failures(html, t, s);
  vs_text_add(html, "</section>\n");
}

/* ---- pictures ---- */

/* Each is a document of its own, so that their scripts do not meet. */
static void add_picture(vs_text *html, const vs_picture *p, const char *svg) {
  const char *from = strstr(svg, "<svg");
  vs_text_add(html, "<figure>\n<iframe title=\"");
  add_escaped(html, p->title.text);
  vs_text_add(html,
              "\" style=\"aspect-ratio:%d/%d\" srcdoc=\"<style>body{margin:0;overflow:hidden}"
              "svg{display:block;width:100%%}polygon{shape-rendering:crispEdges}</style>",
              p->width, p->height);
  for (from = from ? from : svg; *from;) {
    int n = (int)strcspn(from, "&\"");
    vs_text_add(html, "%.*s", n, from);
    from += n;
    if (*from) vs_text_add(html, "%s", *from++ == '&' ? "&amp;" : "&quot;");
  }
  vs_text_add(html, "\"></iframe>\n<figcaption>");
  add_escaped(html, p->caption.text ? p->caption.text : "");
  vs_text_add(html, "</figcaption>\n</figure>\n");
}

static void add_pictures(vs_text *html, const vs_album *album, char *const *svg) {
  vs_text_add(html, "<section id=\"pictures\">\n<h2>Pictures</h2>\n");
  if (!album->count) vs_text_add(html, "<p>There is nothing to draw.</p>\n");
  vs_text_add(html, "<div class=\"pictures\">\n");
  for (size_t k = 0; k < album->count; k++) add_picture(html, &album->item[k], svg[k]);
  vs_text_add(html, "</div>\n");
  if (album->left_out)
    vs_text_add(html, "<p>Not drawn, for there is no more room: %zu.</p>\n", album->left_out);
  vs_text_add(html, "</section>\n");
}

/* ---- tables ---- */

static void add_worst(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  bool largest;
  bool ranked = vs_study_aim(t, &largest) != 0;
  if (!s->n_worst) return;
  vs_text_add(html,
              "<section id=\"cases\">\n<h2>The %s cases</h2>\n<div class=\"wide\"><table><tr>",
              ranked ? "worst" : "first");
  for (size_t c = 0; c < t->count; c++) {
    vs_text_add(html, "<th>");
    add_escaped(html, t->column[c].title);
    vs_text_add(html, "</th>");
  }
  vs_text_add(html, "</tr>\n");
  for (size_t k = 0; k < s->n_worst; k++) {
    vs_text_add(html, "<tr>");
    for (size_t c = 0; c < t->count; c++) {
      double value;
      bool number = c && s->profile[c].is_number && vs_study_number(s->worst[k].cell[c], &value);
      if (number)
        add_number(html, value);
      else
        add_cell(html, s->worst[k].cell[c]);
    }
    vs_text_add(html, "</tr>\n");
  }
  vs_text_add(html, "</table></div>\n</section>\n");
}

static void add_axes(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  vs_text_add(html, "<section id=\"axes\">\n<h2>What was varied</h2>\n<table><tr><th>key</th>"
                    "<th>unit</th><th>least</th><th>largest</th><th>asked for</th></tr>\n");
  for (size_t c = 0; c < t->count; c++) {
    if (t->column[c].role != VS_ROLE_AXIS) continue;
    vs_text_add(html, "<tr>");
    add_cell(html, t->column[c].name);
    add_cell(html, t->column[c].unit);
    add_number(html, s->profile[c].least);
    add_number(html, s->profile[c].largest);
    vs_text_add(html, "<td>");
    size_t n = 0;
    for (const vs_node *v = t->column[c].node->child; v; v = v->next) {
      if (!strcmp(v->key, "key") || !strcmp(v->key, "unit")) continue;
      vs_text_add(html, "%s", n++ ? "; " : "");
      add_escaped(html, v->key);
      vs_text_add(html, ": ");
      add_node(html, v);
    }
    vs_text_add(html, "</td></tr>\n");
  }
  vs_text_add(html, "</table>\n</section>\n");
}

static void add_columns(vs_text *html, const vs_study_table *t, const vs_survey *s) {
  vs_text_add(html,
              "<section id=\"columns\">\n<h2>What is reported</h2>\n<table><tr><th>column</th>"
              "<th>unit</th><th>rating</th><th>least</th><th>largest</th><th>cases</th>"
              "<th>what it is</th></tr>\n");
  for (size_t c = 0; c < t->count; c++) {
    vs_study_role role = t->column[c].role;
    if (role != VS_ROLE_REPORT && role != VS_ROLE_MARGIN) continue;
    vs_text_add(html, "<tr>");
    add_cell(html, t->column[c].name);
    add_cell(html, t->column[c].unit);
    add_number(html, role == VS_ROLE_MARGIN ? 0 : t->column[c].rating);
    add_number(html, s->profile[c].least);
    add_number(html, s->profile[c].largest);
    vs_text_add(html, "<td class=\"n\">%ld</td>", s->profile[c].known);
    add_cell(html, role == VS_ROLE_MARGIN && !*t->column[c].text
                       ? "least margin of the verdict, as a part of the limit"
                       : t->column[c].text);
    vs_text_add(html, "</tr>\n");
  }
  vs_text_add(html, "</table>\n</section>\n");
}

/* All else that the manifest says: scene, fixed keys, versions, seed, hashes of the inputs. */
static void add_manifest(vs_text *html, const vs_study_table *t) {
  vs_text_add(html, "<section id=\"manifest\">\n<h2>How it was made</h2>\n<table>\n");
  for (const vs_node *n = t->manifest.root->child; n; n = n->next) {
    if (!n->key || !strcmp(n->key, "axes") || !strcmp(n->key, "report")) continue;
    bool lines = n->kind == VS_NODE_LIST && !strcmp(n->key, "inputs");
    vs_text_add(html, "<tr><th>");
    add_escaped(html, n->key);
    vs_text_add(html, "</th><td>");
    for (const vs_node *c = n->child; lines && c; c = c->next) {
      add_node(html, c);
      vs_text_add(html, "<br>");
    }
    if (!lines && !strcmp(n->key, "command"))
      for (const vs_node *c = n->child; c; c = c->next) {
        add_escaped(html, c->text ? c->text : "");
        vs_text_add(html, " ");
      }
    else if (!lines)
      add_node(html, n);
    vs_text_add(html, "</td></tr>\n");
  }
  vs_text_add(html, "</table>\n</section>\n");
}

void vs_page_write(const vs_study_table *t, const vs_survey *s, const vs_album *album,
                   char *const *svg, vs_text *html) {
  const char *study = manifest_text(t, "study");
  if (!*study) study = "without a name";
  vs_text_add(html, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                    "<meta name=\"viewport\" content=\"width=device-width\">\n<title>Study ");
  add_escaped(html, study);
  vs_text_add(html, "</title>\n<style>%s</style>\n</head>\n<body>\n<main>\n<h1>Study ", STYLE);
  add_escaped(html, study);
  vs_text_add(html, "</h1>\n<p class=\"of\">");
  add_escaped(html, t->method);
  vs_text_add(html, ", %ld cases</p>\n", t->done);
  add_verdict(html, t, s);
  add_pictures(html, album, svg);
  add_worst(html, t, s);
  vs_text_add(html, "<section id=\"parameters\">\n");
  add_axes(html, t, s);
  add_columns(html, t, s);
  add_manifest(html, t);
  vs_text_add(html, "</section>\n</main>\n</body>\n</html>\n");
}
