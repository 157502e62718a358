/* sgidec: a .sgi stream, or a part of it at any scale, becomes a picture. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"
#include "picture_file.h"
#include "program.h"
#include "views.h"

#define BAND_SAMPLES (1 << 25) /* that are in memory at once, or 16 rows */

typedef struct decode_options {
  const char *in, *out, *format;
  view_options view;
  int depth; /* bits; 0: the stream's */
  int threads, force, exact, lossy, no_dither, no_metadata;
} decode_options;

static const char usage[] =
    "Usage: sgidec [OPTIONS] IN.sgi OUT\n"
    "\n"
    "Decodes stream IN into picture OUT, whose extension is one of %s;\n"
    "- stands for stdin or stdout.\n"
    "\n"
    "  --region X,Y,W,H  only these pixels, cut where the picture ends\n"
    "  --boundless       pad a region that reaches over the picture instead\n"
    "  --scale F         enlarge or shrink, such as 2, 1/4 or 50%%\n"
    "  --size WxH        scale to fit into this size; 512x, x512; 512x512! is exact\n"
    "  --depth 8|16|32   bits per sample (32: float); default: the stream's\n"
    "  --format NAME     format; default: by OUT's extension, of stdout the simplest\n"
    "  --exact           draw small views from all that the stream holds\n"
    "  --lossy           leave a residual layer aside: faster\n"
    "  --no-dither       round 8 bits of what had more\n"
    "  --no-metadata     leave ICC profile, EXIF and XMP out of a PNG\n"
    "  -j, --threads N   threads; 0 is one per core\n"
    "  -f, --force       overwrite OUT\n"
    "  -h, --help        show this\n"
    "  --version         show the version of the library\n";

enum { REGION = 256, SCALE, SIZE, DEPTH, FORMAT, VERSION };

static int depth_of(const char *text) {
  for (int bits = 8; bits <= 32; bits *= 2) {
    char name[4];
    snprintf(name, sizeof name, "%d", bits);
    if (!strcmp(text, name)) return bits;
  }
  fail(WRONG_USAGE, "Invalid value for '--depth': '%s' is not 8, 16 or 32", text);
  return 0;
}

/* Takes an option with a value, or one that tells something. */
static void take(decode_options *options, int option) {
  switch (option) {
    case REGION: parse_region(&options->view, optarg); return;
    case SCALE: parse_scale(&options->view, optarg); return;
    case SIZE: parse_size(&options->view, optarg); return;
    case DEPTH: options->depth = depth_of(optarg); return;
    case FORMAT: options->format = optarg; return;
    case 'j': options->threads = (int)whole_number("--threads", optarg, 1024); return;
    case 'f': options->force = 1; return;
    case 'h': printf(usage, format_names()); exit(DONE);
    case VERSION: printf("sgidec, libsgi %s\n", sgi_version()); exit(DONE);
  }
}

static decode_options parse(int count, char **arguments) {
  static decode_options options;
  const struct option known[] = {
      {"region", 1, NULL, REGION},
      {"scale", 1, NULL, SCALE},
      {"size", 1, NULL, SIZE},
      {"depth", 1, NULL, DEPTH},
      {"format", 1, NULL, FORMAT},
      {"threads", 1, NULL, 'j'},
      {"force", 0, NULL, 'f'},
      {"help", 0, NULL, 'h'},
      {"version", 0, NULL, VERSION},
      {"boundless", 0, &options.view.boundless, 1},
      {"exact", 0, &options.exact, 1},
      {"lossy", 0, &options.lossy, 1},
      {"no-dither", 0, &options.no_dither, 1},
      {"no-metadata", 0, &options.no_metadata, 1},
      {NULL, 0, NULL, 0},
  };
  opterr = 0;
  for (int option; (option = getopt_long(count, arguments, ":fhj:", known, NULL)) != -1;) {
    if (option == '?' || option == ':') refuse_option(arguments, option);
    take(&options, option);
  }
  if (count - optind != 2) fail(WRONG_USAGE, "give IN and OUT; see sgidec --help");
  options.in = arguments[optind], options.out = arguments[optind + 1];
  return options;
}

/* The format of OUT: the one that is asked for, or by its extension; of stdout the simplest. */
static const picture_format *format_of(const decode_options *options, const picture_facts *facts) {
  const char *slash = strrchr(options->out, '/'), *dot = strrchr(options->out, '.');
  const char *name = options->format;
  if (!name && !strcmp(options->out, "-")) return simplest_format(facts->layout, facts->sample);
  if (!name && (!dot || dot < slash)) fail(WRONG_USAGE, "%s has no extension that names a format", options->out);
  if (!name) name = dot + 1;
  const picture_format *found = find_format(name);
  if (!found) fail(WRONG_USAGE, "there is no format '%s'; there are %s", name, format_names());
  return found;
}

static void stop_at(sgi_status status, const char *name) {
  if (status == SGI_ERROR_USAGE || status == SGI_ERROR_REGION) fail(code_of(status), "%s", sgi_error());
  if (status != SGI_OK) fail(code_of(status), "%s: %s", name, sgi_error());
}

/* Draws bands of rows and hands them to the format. */
static void draw(sgi_stream *stream, sgi_view view, const picture_format *format, void *state, size_t stride,
                 const char *name) {
  const size_t samples = stride / sample_bytes(view.sample);
  uint32_t band = samples < BAND_SAMPLES / 16 ? (uint32_t)(BAND_SAMPLES / samples) : 16;
  if (band > view.rows) band = view.rows;
  unsigned char *rows = malloc(stride * band);
  if (!rows) fail(FAILED, "no memory left for %u rows", band);
  for (uint32_t done = 0; done < view.rows; done += view.row_count) {
    view.row_count = view.rows - done < band ? view.rows - done : band;
    view.first_row = format->from_below ? view.rows - done - view.row_count : done;
    stop_at(sgi_draw(stream, &view, rows, stride), name);
    if (!format->from_below) {
      format->write(state, rows, view.row_count);
      continue;
    }
    for (uint32_t row = view.row_count; row-- > 0;) format->write(state, rows + row * stride, 1);
  }
  free(rows);
}

static void list(char *names, const char *name) {
  if (*names) strcat(names, ", ");
  strcat(names, name);
}

/* Says where samples are those of the lossy picture. other: what they have that is not the stream's own, or NULL. */
static void tell_loss(const decode_options *options, sgi_stream *stream, const char *other, const char *name) {
  const char *out = strcmp(options->out, "-") ? options->out : "stdout";
  double max_error;
  int exact_views;
  stop_at(sgi_get_max_error(stream, &max_error), name);
  stop_at(sgi_get_exact_views(stream, &exact_views), name);
  if (other && max_error >= 0 && !exact_views && !options->lossy)
    complain("%s: samples are those of the lossy picture: its residual layer has the stream's %s alone", out, other);
}

/* Says what of the stream OUT does not hold beside its samples. */
static void tell_left_out(const decode_options *options, sgi_stream *stream, const sgi_info *info,
                          const picture_format *format) {
  static const char *const kinds[] = {"ICC profile", "EXIF", "XMP", "place"};
  char left_out[64] = "";
  for (int kind = SGI_METADATA_ICC; kind <= SGI_METADATA_PLACE; ++kind) {
    const void *bytes = NULL;
    size_t size;
    if (options->no_metadata || format->metadata >> kind & 1) continue;
    if (sgi_get_metadata(stream, kind, &bytes, &size) == SGI_OK && bytes) list(left_out, kinds[kind]);
  }
  if (info->has_nodata) list(left_out, "nodata value");
  if (*left_out) complain("%s: not kept: %s", strcmp(options->out, "-") ? options->out : "stdout", left_out);
}

static void decode(const decode_options *options, sgi_stream *stream) {
  const char *name = strcmp(options->in, "-") ? options->in : "stdin";
  sgi_info info = SGI_INFO_INIT;
  stop_at(sgi_get_info(stream, &info), name);
  sgi_view view = view_of(&options->view, &info);
  view.exact = options->exact, view.lossy = options->lossy, view.no_dither = options->no_dither;
  view.sample = options->depth == 8    ? SGI_SAMPLE_U8
                : options->depth == 16 ? SGI_SAMPLE_U16
                : options->depth == 32 ? SGI_SAMPLE_F32
                                       : info.sample;
  picture_facts facts = {.name = options->out,
                         .metadata = options->no_metadata ? NULL : stream,
                         .columns = view.columns,
                         .rows = view.rows,
                         .channels = info.channels,
                         .layout = info.layout,
                         .sample = view.sample};
  const picture_format *format = format_of(options, &facts);
  check_format(format, &facts);
  facts.file = begin_output(options->out, options->force);
  void *state = format->begin(&facts);
  draw(stream, view, format, state, (size_t)view.columns * info.channels * sample_bytes(view.sample), name);
  format->end(state);
  finish_output();
  const int scaled = view.columns != view.width || view.rows != view.height;
  tell_left_out(options, stream, &info, format);
  tell_loss(options, stream, view.sample != info.sample ? "depth" : scaled ? "scale" : NULL, name);
}

int main(int count, char **arguments) {
  program_name = "sgidec";
  const decode_options options = parse(count, arguments);
  input opened;
  const int code = open_input(options.in, options.threads, &opened);
  if (code) return code;
  decode(&options, opened.stream);
  close_input(&opened);
  return DONE;
}
