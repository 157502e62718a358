#include "picture_file.h"

#include <string.h>

#include "program.h"

#ifdef HAVE_PNG
#define PNG_NAME "png, "
#else
#define PNG_NAME ""
#endif

static const struct {
  const char *name;
  const picture_format *format;
} formats[] = {
#ifdef HAVE_PNG
    {"png", &png_format},
#endif
    {"ppm", &pnm_format}, {"pgm", &pnm_format}, {"pnm", &pnm_format}, {"pam", &pam_format}, {"pfm", &pfm_format},
};

const picture_format *find_format(const char *name) {
  for (size_t i = 0; i < sizeof formats / sizeof *formats; ++i)
    if (!strcmp(name, formats[i].name)) return formats[i].format;
  return NULL;
}

static int holds(const picture_format *format, int layout, int sample) {
  return format->layouts >> layout & 1 && format->samples >> sample & 1;
}

const picture_format *simplest_format(int layout, int sample) {
  if (sample == SGI_SAMPLE_F32) return &pfm_format;
  return holds(&pnm_format, layout, sample) ? &pnm_format : &pam_format;
}

void check_format(const picture_format *format, const picture_facts *facts) {
  static const char *const depths[] = {"8 bits", "16 bits", "32-bit float"};
  if (!(format->samples >> facts->sample & 1))
    fail(BAD_PICTURE, "%s: %s cannot hold %s per sample; ask for another --depth or choose another format", facts->name,
         format->name, depths[facts->sample]);
  if (!(format->layouts >> facts->layout & 1))
    fail(BAD_PICTURE, "%s: %s cannot hold %s of %u channels; choose another format", facts->name, format->name,
         layout_name(facts->layout), facts->channels);
}

const char *format_names(void) { return PNG_NAME "ppm, pgm, pnm, pam, pfm"; }

size_t sample_bytes(int sample) { return sample == SGI_SAMPLE_U8 ? 1 : sample == SGI_SAMPLE_U16 ? 2 : 4; }

void make_big_endian(unsigned char *samples, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    uint16_t sample;
    memcpy(&sample, samples + 2 * i, 2);
    samples[2 * i] = (unsigned char)(sample >> 8), samples[2 * i + 1] = (unsigned char)sample;
  }
}
