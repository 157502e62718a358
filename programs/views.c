#include "views.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

#define MAX_SIDE (1 << 24)
#define FARTHEST (1 << 30)

static void refuse(const char *option, const char *text, const char *wanted) {
  fail(WRONG_USAGE, "Invalid value for '%s': '%s' is not %s; see %s --help", option, text, wanted, program_name);
}

void parse_region(view_options *options, const char *text) {
  const char *at = text;
  for (int i = 0; i < 4; ++i) {
    char *end;
    options->region[i] = strtoll(at, &end, 10);
    if (end == at || isspace((unsigned char)*at) || *end != (i < 3 ? ',' : 0) || llabs(options->region[i]) > FARTHEST)
      refuse("--region", text, "X,Y,W,H in pixels");
    at = end + 1;
  }
  options->has_region = 1;
}

void parse_scale(view_options *options, const char *text) {
  char *end;
  const int is_number = isdigit((unsigned char)*text) || *text == '.';
  double scale = strtod(text, &end), below = 1;
  if (*end == '/' && isdigit((unsigned char)end[1]))
    below = strtod(end + 1, &end);
  else if (*end == '%')
    below = 100, ++end;
  scale /= below;
  if (!is_number || *end) refuse("--scale", text, "F, as in 0.5, 1/4 or 50%");
  if (!(scale > 0 && scale <= MAX_SIDE)) refuse("--scale", text, "a positive number");
  options->scale = scale;
}

/* A side; 0 where there is none. */
static unsigned side(const char **at, const char *text) {
  char *end;
  if (!isdigit((unsigned char)**at)) return 0;
  const unsigned long found = strtoul(*at, &end, 10);
  if (!found || found > MAX_SIDE) refuse("--size", text, "a size in pixels");
  *at = end;
  return (unsigned)found;
}

void parse_size(view_options *options, const char *text) {
  const char *at = text;
  options->size[0] = side(&at, text);
  if (*at++ != 'x') refuse("--size", text, "WxH, Wx or xH");
  options->size[1] = side(&at, text);
  options->is_exact_size = *at == '!' && options->size[0] && options->size[1];
  if (at[options->is_exact_size] || !(options->size[0] || options->size[1])) refuse("--size", text, "WxH, Wx or xH");
}

static void cut(long long *region, const sgi_info *info, const char *asked) {
  const long long left = region[0] < 0 ? 0 : region[0], top = region[1] < 0 ? 0 : region[1];
  long long right = region[0] + region[2], bottom = region[1] + region[3];
  if (right > info->width) right = info->width;
  if (bottom > info->height) bottom = info->height;
  const long long found[] = {left, top, right - left, bottom - top};
  if (!memcmp(found, region, sizeof found) || found[2] < 1 || found[3] < 1) return; /* which the library may refuse */
  memcpy(region, found, sizeof found);
  complain(
      "warning: region %s reaches over the picture of %u×%u pixels; it is cut to %lld,%lld,%lld,%lld (--boundless"
      " pads)",
      asked, info->width, info->height, found[0], found[1], found[2], found[3]);
}

/* To nearest, ties to even, as `sgi decode` has it. */
static uint32_t rounded(double side) {
  if (side > MAX_SIDE) fail(WRONG_USAGE, "%.0f pixels are too many; a side has at most %d", side, MAX_SIDE);
  return side < 1 ? 1 : (uint32_t)nearbyint(side);
}

static void set_size(const view_options *options, sgi_view *view) {
  double scale = options->scale ? options->scale : 1;
  if (options->size[0] || options->size[1]) {
    const double across = options->size[0] / view->width, down = options->size[1] / view->height;
    scale = !options->size[1] || (options->size[0] && across < down) ? across : down;
  }
  view->columns = rounded(view->width * scale), view->rows = rounded(view->height * scale);
  if (options->is_exact_size) view->columns = options->size[0], view->rows = options->size[1];
}

sgi_view view_of(const view_options *options, const sgi_info *info) {
  sgi_view view = SGI_VIEW_INIT;
  long long region[4] = {0, 0, info->width, info->height};
  char asked[100];
  if (options->scale && (options->size[0] || options->size[1]))
    fail(WRONG_USAGE, "--scale and --size exclude each other");
  if (options->boundless && !options->has_region) fail(WRONG_USAGE, "--boundless goes with --region");
  if (options->has_region) memcpy(region, options->region, sizeof region);
  snprintf(asked, sizeof asked, "%lld,%lld,%lld,%lld", region[0], region[1], region[2], region[3]);
  if (!options->boundless) cut(region, info, asked);
  view.x = (double)region[0], view.y = (double)region[1];
  view.width = (double)region[2], view.height = (double)region[3];
  view.boundless = options->boundless;
  if (region[2] < 1 || region[3] < 1 ||
      (!options->boundless && (region[0] >= info->width || region[1] >= info->height)))
    fail(WRONG_USAGE, "region %s is not inside the picture of %u×%u pixels", asked, info->width, info->height);
  set_size(options, &view);
  return view;
}
