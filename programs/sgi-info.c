/* sgi-info: what .sgi streams hold, from their headers alone. */
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

static const char usage[] =
    "Usage: sgi-info [OPTIONS] IN.sgi...\n"
    "\n"
    "Prints what streams hold; - stands for stdin. No tile is decoded.\n"
    "\n"
    "  --json      print one JSON object for each\n"
    "  --verify    decode all of each, too: exit code 4 where one is damaged\n"
    "  -h, --help  show this\n"
    "  --version   show the version of the library\n";

/* What there is to tell of a stream. */
typedef struct facts {
  const char *name;
  sgi_info info;
  float low[64], high[64]; /* of each channel */
  int colours;             /* channels that are not alpha */
  int is_one_range;        /* whether all colours have one range */
  double max_error;
  size_t metadata[4]; /* bytes by sgi_metadata */
  const char *encoder;
  int encoder_size, has_crc;
  uint32_t crc;
} facts;

static const char *const metadata_names[] = {"icc", "exif", "xmp", "geo"};

/* Returns the status of the first call that failed. */
static sgi_status find_facts(sgi_stream *stream, int verify, facts *found) {
  const void *bytes;
  size_t size;
  found->info.struct_size = sizeof found->info;
  sgi_status status = sgi_get_info(stream, &found->info);
  const int has_alpha = found->info.layout == SGI_LAYOUT_GRAY_ALPHA || found->info.layout == SGI_LAYOUT_RGBA;
  found->colours = (int)found->info.channels - has_alpha;
  found->is_one_range = 1;
  for (int i = 0; !status && i < found->colours; ++i) {
    status = sgi_get_range(stream, (uint32_t)i, &found->low[i], &found->high[i]);
    if (found->low[i] != found->low[0] || found->high[i] != found->high[0]) found->is_one_range = 0;
  }
  if (!status) status = sgi_get_max_error(stream, &found->max_error);
  for (int i = 0; !status && i < 4; ++i)
    status = sgi_get_metadata(stream, (sgi_metadata)i, &bytes, &found->metadata[i]);
  if (!status) status = sgi_get_metadata(stream, SGI_METADATA_SOFTWARE, &bytes, &size);
  if (!status) found->encoder = bytes, found->encoder_size = (int)size;
  if (!status && verify) status = sgi_verify(stream, &found->crc), found->has_crc = 1;
  return status;
}

static double bits_per_pixel(const sgi_info *info) {
  return 8.0 * (double)info->file_bytes / ((double)info->width * info->height);
}

/* A sixteenth (docs/format.md). */
static uint32_t overview_side(uint32_t side) { return side > 8 ? (uint32_t)nearbyint(side / 16.0) : 1; }

static void print_lines(const facts *told) {
  static const char *const depths[] = {"8 bits", "16 bits", "32-bit float"};
  static const float whole[] = {255, 65535, -1};
  const sgi_info *info = &told->info;
  printf("%s\n  picture     %u×%u, ", told->name, info->width, info->height);
  if (info->layout == SGI_LAYOUT_MULTI)
    printf("%u bands, ", info->channels);
  else
    printf("%s, ", layout_name(info->layout));
  printf("%s", depths[info->sample]);
  if (!told->is_one_range)
    printf(", each band in a range of its own");
  else if (told->low[0] != 0 || told->high[0] != whole[info->sample])
    printf(" from %g to %g", told->low[0], told->high[0]);
  printf("\n  size        %llu bytes, %.3f bpp\n", (unsigned long long)info->file_bytes, bits_per_pixel(info));
  if (info->has_nodata) printf("  nodata      %g\n", info->nodata);
  if (info->tiles > 1) printf("  tiles       %u of up to %u pixels a side\n", info->tiles, info->tile_size);
  if (info->has_overview) printf("  overview    %u×%u\n", overview_side(info->width), overview_side(info->height));
  if (told->max_error == 0) printf("  samples     without loss\n");
  if (told->max_error > 0)
    printf("  samples     at most %g%s off\n", told->max_error, info->sample == SGI_SAMPLE_F32 ? "" : " levels");
  for (int i = 0; i < 4; ++i)
    if (told->metadata[i]) printf("  %-12s%zu bytes\n", metadata_names[i], told->metadata[i]);
  if (told->encoder) printf("  encoder     %.*s\n", told->encoder_size, told->encoder);
  if (told->has_crc) printf("  symbols     sound, CRC %08x\n", told->crc);
}

static void print_text(const char *text, int size) {
  putchar('"');
  for (int i = 0; i < size; ++i) {
    const unsigned char byte = (unsigned char)text[i];
    if (byte == '"' || byte == '\\')
      printf("\\%c", byte);
    else if (byte < 32 || byte == 127)
      printf("\\u%04x", byte);
    else
      putchar(byte);
  }
  putchar('"');
}

/* The shortest text that is this number again; a text where JSON has none. */
static void print_number(double number) {
  char text[40];
  int digits = 1;
  if (isnan(number))
    printf("\"nan\"");
  else if (isinf(number))
    printf(number > 0 ? "\"inf\"" : "\"-inf\"");
  if (!isfinite(number)) return;
  do snprintf(text, sizeof text, "%.*g", digits, number);
  while (digits++ < 17 && strtod(text, NULL) != number);
  printf("%s", text);
}

/* Low and high; lists of both where bands have ranges of their own. */
static void print_ranges(const facts *told) {
  const float *const ends[] = {told->low, told->high};
  for (int i = 0; i < 2; ++i) {
    printf(i ? ", " : "[");
    for (int band = 0; band < (told->is_one_range ? 1 : told->colours); ++band) {
      if (!told->is_one_range) printf(band ? ", " : "[");
      print_number(ends[i][band]);
    }
    if (!told->is_one_range) putchar(']');
  }
  putchar(']');
}

/* Keys that `sgi info --json` has, too, and what they mean there. */
static void print_json(const facts *told) {
  static const char *const types[] = {"uint8", "uint16", "float32"};
  const sgi_info *info = &told->info;
  const char *separator = "";
  printf("{\"schema\": 1, \"input\": ");
  print_text(told->name, (int)strlen(told->name));
  printf(", \"width\": %u, \"height\": %u, \"channels\": \"%s\", \"channel_count\": %u, \"sample_type\": \"%s\"",
         info->width, info->height, layout_name(info->layout), info->channels, types[info->sample]);
  printf(", \"sample_range\": ");
  print_ranges(told);
  printf(", \"bytes\": %llu, \"bpp\": ", (unsigned long long)info->file_bytes);
  print_number(bits_per_pixel(info));
  printf(", \"tiles\": %u, \"overview\": ", info->tiles);
  if (info->has_overview)
    printf("[%u, %u]", overview_side(info->width), overview_side(info->height));
  else
    printf("null");
  printf(", \"max_error\": ");
  if (told->max_error >= 0)
    print_number(told->max_error);
  else
    printf("null");
  printf(", \"nodata\": ");
  if (info->has_nodata)
    print_number(info->nodata);
  else
    printf("null");
  printf(", \"metadata\": {");
  for (int i = 0; i < 4; ++i)
    if (told->metadata[i]) printf("%s\"%s\": %zu", separator, metadata_names[i], told->metadata[i]), separator = ", ";
  printf("}, \"encoder\": ");
  if (told->encoder)
    print_text(told->encoder, told->encoder_size);
  else
    printf("null");
  if (told->has_crc) printf(", \"symbol_crc\": \"%08x\"", told->crc);
  printf("}\n");
}

/* Returns an exit code. */
static int show(const char *name, int as_json, int verify) {
  input opened;
  facts found = {.name = name};
  int code = open_input(name, 0, &opened);
  if (code) return code;
  const sgi_status status = find_facts(opened.stream, verify, &found);
  if (status)
    complain("%s: %s", name, sgi_error());
  else if (as_json)
    print_json(&found);
  else
    print_lines(&found);
  close_input(&opened);
  return code_of(status);
}

int main(int count, char **arguments) {
  static int as_json, verify;
  const struct option known[] = {{"json", 0, &as_json, 1},
                                 {"verify", 0, &verify, 1},
                                 {"help", 0, NULL, 'h'},
                                 {"version", 0, NULL, 'v'},
                                 {NULL, 0, NULL, 0}};
  program_name = "sgi-info";
  opterr = 0;
  for (int option; (option = getopt_long(count, arguments, ":h", known, NULL)) != -1;) {
    if (option == '?' || option == ':') refuse_option(arguments, option);
    if (option == 'h') return fputs(usage, stdout), DONE;
    if (option == 'v') return printf("sgi-info, libsgi %s\n", sgi_version()), DONE;
  }
  if (optind == count) fail(WRONG_USAGE, "give IN; see sgi-info --help");
  int code = DONE;
  for (int i = optind; i < count; ++i) {
    const int found = show(arguments[i], as_json, verify);
    if (found) code = count - optind > 1 ? FAILED : found;
  }
  if (fflush(stdout)) fail(FAILED, "the report cannot be written");
  return code;
}
