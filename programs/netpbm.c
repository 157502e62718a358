/* PGM and PPM, PAM for what has other channels, PFM for floats. */
#include <stdlib.h>

#include "picture_file.h"
#include "program.h"

static void *keep(const picture_facts *facts) {
  picture_facts *kept = malloc(sizeof *kept);
  if (!kept) fail(FAILED, "no memory left");
  *kept = *facts;
  return kept;
}

static size_t row_samples(const picture_facts *facts) { return (size_t)facts->columns * facts->channels; }

static void write_samples(void *state, unsigned char *samples, uint32_t rows) {
  const picture_facts *facts = state;
  const size_t count = row_samples(facts) * rows;
  if (facts->sample == SGI_SAMPLE_U16) make_big_endian(samples, count);
  fwrite(samples, sample_bytes(facts->sample), count, facts->file);
}

static void *begin_pnm(const picture_facts *facts) {
  fprintf(facts->file, "P%d\n%u %u\n%d\n", facts->channels == 3 ? 6 : 5, facts->columns, facts->rows,
          facts->sample == SGI_SAMPLE_U8 ? 255 : 65535);
  return keep(facts);
}

static void *begin_pam(const picture_facts *facts) {
  static const char *const kinds[] = {NULL, "GRAYSCALE", "GRAYSCALE_ALPHA", "RGB", "RGB_ALPHA"};
  fprintf(facts->file, "P7\nWIDTH %u\nHEIGHT %u\nDEPTH %u\nMAXVAL %d\n", facts->columns, facts->rows, facts->channels,
          facts->sample == SGI_SAMPLE_U8 ? 255 : 65535);
  if (kinds[facts->layout]) fprintf(facts->file, "TUPLTYPE %s\n", kinds[facts->layout]);
  fprintf(facts->file, "ENDHDR\n");
  return keep(facts);
}

static void *begin_pfm(const picture_facts *facts) {
  const uint16_t one = 1;
  const char *sign = *(const unsigned char *)&one ? "-" : ""; /* samples are the machine's own */
  fprintf(facts->file, "P%s\n%u %u\n%s1.0\n", facts->channels == 3 ? "F" : "f", facts->columns, facts->rows, sign);
  return keep(facts);
}

#define INTEGERS (1 << SGI_SAMPLE_U8 | 1 << SGI_SAMPLE_U16)
#define OPAQUE (1 << SGI_LAYOUT_GRAY | 1 << SGI_LAYOUT_RGB)
#define ALL (OPAQUE | 1 << SGI_LAYOUT_MULTI | 1 << SGI_LAYOUT_GRAY_ALPHA | 1 << SGI_LAYOUT_RGBA)

const picture_format pnm_format = {"pnm", INTEGERS, OPAQUE, 0, 0, begin_pnm, write_samples, free};
const picture_format pam_format = {"pam", INTEGERS, ALL, 0, 0, begin_pam, write_samples, free};
const picture_format pfm_format = {"pfm", 1 << SGI_SAMPLE_F32, OPAQUE, 1, 0, begin_pfm, write_samples, free};
