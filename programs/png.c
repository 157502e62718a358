/* PNG by libpng, with ICC profile, EXIF and XMP. */
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "picture_file.h"
#include "program.h"

#ifdef PNG_eXIf_SUPPORTED
#define HELD_EXIF (1 << SGI_METADATA_EXIF)
#else
#define HELD_EXIF 0
#endif

typedef struct png_state {
  picture_facts facts;
  png_structp png;
  png_infop info;
} png_state;

static void fail_png(png_structp png, png_const_charp text) {
  const picture_facts *facts = png_get_error_ptr(png);
  fail(BAD_PICTURE, "%s: %s", facts->name, text);
}

static void warn(png_structp png, png_const_charp text) {
  const picture_facts *facts = png_get_error_ptr(png);
  complain("warning: %s: %s", facts->name, text);
}

static void set_metadata(const png_state *state) {
  sgi_stream *stream = state->facts.metadata;
  const void *bytes;
  size_t size;
  if (!stream) return;
  if (sgi_get_metadata(stream, SGI_METADATA_ICC, &bytes, &size) == SGI_OK && bytes)
    png_set_iCCP(state->png, state->info, "icc", PNG_COMPRESSION_TYPE_BASE, bytes, (png_uint_32)size);
#ifdef PNG_eXIf_SUPPORTED
  if (sgi_get_metadata(stream, SGI_METADATA_EXIF, &bytes, &size) == SGI_OK && bytes) {
    png_bytep copy = png_malloc(state->png, size); /* which libpng wants to write into */
    memcpy(copy, bytes, size);
    png_set_eXIf_1(state->png, state->info, (png_uint_32)size, copy);
    png_free(state->png, copy);
  }
#endif
  if (sgi_get_metadata(stream, SGI_METADATA_XMP, &bytes, &size) == SGI_OK && bytes) {
    char *text = png_malloc(state->png, size + 1);
    memcpy(text, bytes, size), text[size] = 0;
    png_text xmp = {.compression = PNG_ITXT_COMPRESSION_NONE, .key = (char *)"XML:com.adobe.xmp", .text = text};
    png_set_text(state->png, state->info, &xmp, 1);
    png_free(state->png, text);
  }
}

static void *begin(const picture_facts *facts) {
  static const int colours[] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
  png_state *state = calloc(1, sizeof *state);
  if (!state) fail(FAILED, "no memory left");
  state->facts = *facts;
  state->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &state->facts, fail_png, warn);
  state->info = state->png ? png_create_info_struct(state->png) : NULL;
  if (!state->info) fail(FAILED, "no memory left");
  png_set_user_limits(state->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
  png_set_benign_errors(state->png, 1); /* a profile that does not fit is left out, with a warning */
  png_init_io(state->png, facts->file);
  png_set_compression_level(state->png, 2); /* that of `sgi decode` */
  png_set_IHDR(state->png, state->info, facts->columns, facts->rows, facts->sample == SGI_SAMPLE_U8 ? 8 : 16,
               colours[facts->layout], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  set_metadata(state);
  png_write_info(state->png, state->info);
  return state;
}

static void write_rows(void *given, unsigned char *samples, uint32_t rows) {
  png_state *state = given;
  const size_t count = (size_t)state->facts.columns * state->facts.channels;
  if (state->facts.sample == SGI_SAMPLE_U16) make_big_endian(samples, count * rows);
  for (uint32_t row = 0; row < rows; ++row)
    png_write_row(state->png, samples + row * count * sample_bytes(state->facts.sample));
}

static void end(void *given) {
  png_state *state = given;
  png_write_end(state->png, NULL);
  png_destroy_write_struct(&state->png, &state->info);
  free(state);
}

const picture_format png_format = {
    "png",
    1 << SGI_SAMPLE_U8 | 1 << SGI_SAMPLE_U16,
    1 << SGI_LAYOUT_GRAY | 1 << SGI_LAYOUT_GRAY_ALPHA | 1 << SGI_LAYOUT_RGB | 1 << SGI_LAYOUT_RGBA,
    0,
    1 << SGI_METADATA_ICC | HELD_EXIF | 1 << SGI_METADATA_XMP,
    begin,
    write_rows,
    end,
};
