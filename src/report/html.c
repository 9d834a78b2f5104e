/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/html.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"

/* On narrow paper a table scrolls in its own frame (.wide), never the page. */
static const char STYLE[] =
    ":root{color-scheme:light "
    "dark;--paper:#fff;--ink:#1a1a1a;--dim:#555;--line:#ccc;--head:#f2f2f2;--good:#0072b2;--bad:#"
    "d55e00}@media(prefers-color-scheme:dark){:root{--paper:#16181c;--ink:#e6e6e6;--dim:#a8a8a8;--"
    "line:#444;--head:#23262c;--good:#56b4e9;--bad:#e8834a}}body{margin:0;background:var(--paper);"
    "color:var(--ink);font:15px/1.45 system-ui,'Liberation "
    "Sans',Arial,sans-serif}main{max-width:1180px;margin:0 auto;padding:1.2rem 1.1rem "
    "3rem}h1{font-size:1.5rem;margin:.2rem "
    "0;overflow-wrap:anywhere}h2{font-size:1.15rem;margin:2rem 0 .6rem;border-bottom:1px solid "
    "var(--line)}.of{color:var(--dim);margin:0 0 1rem}.verdict{border:1px solid "
    "var(--line);border-left:10px solid #777;padding:.7rem 1.1rem;margin:1rem "
    "0;overflow-wrap:break-word;min-width:0}.good{border-left-color:var(--good)}.bad{border-left-"
    "color:var(--bad)}.big{font-size:1.5rem;font-weight:600;margin:.1rem 0}p{margin:.35rem "
    "0}.two{display:grid;grid-template-columns:1fr "
    "1fr;gap:1rem}.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,"
    "500px),1fr));gap:1.2rem}figure{margin:0;max-width:820px;break-inside:avoid}iframe{box-sizing:"
    "border-box;width:100%;border:1px solid "
    "var(--line);display:block;background:#fff;color-scheme:only "
    "light}figcaption{font-size:.88rem;color:var(--dim);"
    "padding:.3rem "
    ".1rem}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.88rem;margin:.4rem "
    "0}th,td{border:1px solid var(--line);padding:.2rem "
    ".55rem;text-align:left;vertical-align:top}th,.wide td,td.n{white-space:nowrap}.wide "
    "td.text{white-space:normal;min-width:14rem}.prose "
    "td:not(.n){white-space:normal;min-width:5rem}.fold "
    "td{white-space:normal;overflow-wrap:anywhere}th{background:var(--head)}td.n{text-align:right}."
    "bars{min-width:9rem;width:100%}.verdict "
    ".bars{min-width:12rem;width:auto}.bar{display:block;height:.8em;background:var(--good)}.bars "
    ".verdict "
    ".bar{max-width:40vw}.bar{display:block}.back{background:var(--bad)}.group "
    "th{background:none;border-left:0;border-right:0;padding-top:.8rem}figure "
    "svg{background:#fff;color-scheme:only "
    "light}output{color:var(--ink)}@media(max-width:600px){main{padding:.6rem .6rem "
    "2rem}.verdict{padding:.5rem;border-left-width:6px}.verdict "
    "table{font-size:.76rem}.verdict th,.verdict td{padding:.15rem "
    ".25rem}.margins{display:none}."
    "big{font-size:1.25rem}.two{grid-template-columns:1fr;gap:0}#energy td,#energy "
    "th{padding:.15rem .3rem}#energy td:first-child{white-space:normal}#energy .bars,.verdict "
    ".bars{min-width:3.5rem}}@media print{main{max-width:none}.screen{display:none}}";

void vs_html_begin(vs_html *html, const char *what, const char *name) {
  vs_html_add(html,
              "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
              "<meta name=\"viewport\" content=\"width=device-width\">\n<title>%s ",
              what);
  vs_html_text(html, name);
  vs_html_add(html, "</title>\n<style>");
  vs_html_markup(html, STYLE);
  vs_html_add(html, "</style>\n</head>\n<body>\n<main>\n<h1>%s ", what);
  vs_html_text(html, name);
  vs_html_add(html, "</h1>\n");
}

void vs_html_end(vs_html *html) {
  vs_html_add(html, "</main>\n</body>\n</html>\n");
}

vs_status vs_html_write(const vs_html *html, const char *folder, bool quiet, vs_error *err) {
  vs_file file = {0};
  vs_status status = vs_file_open(&file, folder, "report.html", err);
  if (status) return status;
  fwrite(html->text.text, 1, html->text.length, file.stream); /* an error stays in the stream */
  status = vs_file_commit(&file, err);
  if (!status && !quiet) printf("%s\n", file.path);
  return status;
}

void vs_html_markup(vs_html *html, const char *markup) {
  vs_text_add(&html->text, "%s", markup);
}

void vs_html_text(vs_html *html, const char *text) {
  char shown[VS_SHOWN_SIZE];
  while (*text) {
    text += vs_text_next(text, shown);
    vs_html_markup(html, *shown == '&'   ? "&amp;"
                         : *shown == '<' ? "&lt;"
                         : *shown == '>' ? "&gt;"
                         : *shown == '"' ? "&quot;"
                                         : shown);
  }
}

static void write_text(void *html, const char *text) {
  vs_html_text(html, text);
}

void vs_html_add(vs_html *html, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vs_text_add_by(&html->text, write_text, html, format, args);
  va_end(args);
}

void vs_html_free(vs_html *html) {
  vs_text_free(&html->text);
}

void vs_html_cell(vs_html *html, const char *text) {
  vs_html_add(html, "<td>");
  vs_html_text(html, text);
  vs_html_add(html, "</td>");
}

void vs_html_number(vs_html *html, double value) {
  if (isnan(value))
    vs_html_add(html, "<td class=\"n\"></td>");
  else
    vs_html_add(html, "<td class=\"n\">%.6g</td>", value);
}

/* The style and script before each picture. They enlarge the letters where the picture is shown
 * small, keep its colours in a dark page, and let the wheel scroll the page unless Ctrl is pressed.
 */
static const char FRAME[] = "<style>:root{color-scheme:only light}body{margin:0;overflow:hidden}"
                            "svg{display:block;width:100%}polygon{shape-rendering:crispEdges}"
                            "g[font-size='12.00'] text{paint-order:stroke;stroke:#fff;"
                            "stroke-width:3px}"
                            "@media(max-width:480px){g[font-size='15.00']{font-size:18px}g[font-"
                            "size='12.00']{font-size:13px}}"
                            "</style><script>addEventListener('wheel',function(e){"
                            "if(!e.ctrlKey)e.stopImmediatePropagation()},true)</script>";

/* The script of a picture with cursors, behind `var t='UNIT'`. A click sets cursor A, the next one
 * B, in all pictures of the page. Values are read off the curve as it is drawn, to a hundredth of a
 * pixel; the text goes into the caption. */
static const char CURSORS[] =
    ";addEventListener('load',function(){var g=gnuplot_svg,s=document.querySelector('svg'),"
    "f=frameElement,o=f.parentNode.querySelector('output'),u=f.title.split(' / ')[1]||'',"
    "runs=[],names=[],drawn=[],at=[];"
    "document.querySelectorAll('g[id^=gnuplot_plot_]').forEach(function(p){var r=[];"
    "if(!/_\\d+$/.test(p.id))return;names.push("
    "(document.querySelector('#'+p.id+'_keyentry text')||p).textContent);"
    "p.querySelectorAll('path').forEach(function(e){var m,q=[],x=/([ML]) "
    "?(-?[\\d.]+),(-?[\\d.]+)/g;"
    "while(m=x.exec(e.getAttribute('d')))q.push([+m[2],+m[3],m[1]=='M']);"
    /* the legend's sample of the line lies above the frame */
    "if(q.length&&q[0][1]>g.plot_ytop-.5)r=r.concat(q)});runs.push(r)});"
    "function height(r,x){for(var i=1;i<r.length;i++){var a=r[i-1],b=r[i];"
    "if(!b[2]&&a[0]<=x&&x<=b[0])return b[0]>a[0]?a[1]+(b[1]-a[1])*(x-a[0])/(b[0]-a[0]):b[1]}"
    "return NaN}"
    "function value(y){return g.plot_axis_ymin+(g.plot_ybot-y)/(g.plot_ybot-g.plot_ytop)*"
    "(g.plot_axis_ymax-g.plot_axis_ymin)}"
    "function text(v,unit){return isNaN(v)?'none':+v.toPrecision(4)+(unit?' '+unit:'')}"
    "function named(y,n){return(runs.length>1?names[n]+' ':'')+text(y,u)}"
    "function mark(kind,set){var e=document.createElementNS(s.namespaceURI,kind);"
    "for(var k in set)e.setAttribute(k,set[k]);s.appendChild(e);drawn.push(e);return e}"
    "window.cursors=function(list){var said=[],v=[];at=list;"
    "drawn.forEach(function(e){e.remove()});drawn=[];"
    "list.forEach(function(x,k){var colour=k?'#c03000':'#006030',"
    "px=g.plot_xmin+(x-g.plot_axis_xmin)/(g.plot_axis_xmax-g.plot_axis_xmin)*"
    "(g.plot_xmax-g.plot_xmin);v[k]=[];"
    "mark('line',{x1:px,x2:px,y1:g.plot_ytop,y2:g.plot_ybot,stroke:colour});"
    "mark('text',{x:px,y:g.plot_ytop-3,fill:colour,'font-size':14,'text-anchor':'middle'})"
    ".textContent='AB'[k];"
    "runs.forEach(function(r,n){var y=height(r,px);v[k][n]=value(y);"
    "if(!isNaN(y))mark('circle',{cx:px,cy:y,r:3,fill:colour})});"
    "said.push('AB'[k]+' at '+text(x,t)+': '+v[k].map(named).join(', '))});"
    "if(list.length>1)said.push('B - A: '+text(list[1]-list[0],t)+', '+v[1].map(function(y,n){"
    "return named(y-v[0][n],n)}).join(', '));o.textContent=said.join('; ')};"
    "addEventListener('click',function(e){"
    "var p=s.createSVGPoint();p.x=e.clientX;p.y=e.clientY;"
    "p=p.matrixTransform(s.getScreenCTM().inverse());"
    "if(p.x<g.plot_xmin||p.x>g.plot_xmax||p.y<g.plot_ytop||p.y>g.plot_ybot)return;"
    "e.stopImmediatePropagation();"
    "var x=g.plot_axis_xmin+(p.x-g.plot_xmin)/(g.plot_xmax-g.plot_xmin)*"
    "(g.plot_axis_xmax-g.plot_axis_xmin),list=at.length==1?[at[0],x]:[x];"
    "for(var i=0;i<parent.frames.length;i++)"
    "if(parent.frames[i].cursors)parent.frames[i].cursors(list)},true)})</script>";

void vs_html_picture_add(vs_html *html, const vs_html_picture *p) {
  const char *from = strstr(p->svg, "<svg");
  vs_html_add(html, "<figure>\n<iframe title=\"");
  vs_html_text(html, p->title);
  vs_html_add(html, "\" style=\"aspect-ratio:%d/%d\" srcdoc=\"", p->width, p->height);
  vs_html_markup(html, FRAME);
  if (p->time_unit) vs_html_add(html, "<script>var t='%s'", p->time_unit);
  if (p->time_unit) vs_html_markup(html, CURSORS);
  for (from = from ? from : p->svg; *from;) {
    int n = (int)strcspn(from, "&\"");
    vs_text_add(&html->text, "%.*s", n, from);
    from += n;
    if (*from) vs_html_markup(html, *from++ == '&' ? "&amp;" : "&quot;");
  }
  vs_html_add(html, "\"></iframe>\n<figcaption>");
  vs_html_text(html, p->caption ? p->caption : "");
  if (p->time_unit) vs_html_add(html, " <output></output>");
  vs_html_add(html, "</figcaption>\n</figure>\n");
}
