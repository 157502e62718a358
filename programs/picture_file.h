/* Formats of pictures: a file is begun, takes bands of rows, and is ended. */
#ifndef SGI_PICTURE_FILE_H
#define SGI_PICTURE_FILE_H

#include <sgi.h>
#include <stddef.h>
#include <stdio.h>

typedef struct picture_facts {
  const char *name; /* of OUT, for messages */
  FILE *file;
  sgi_stream *metadata; /* whose metadata are kept; null: none are */
  uint32_t columns, rows, channels;
  int layout, sample; /* sgi_layout, sgi_sample */
} picture_facts;

typedef struct picture_format {
  const char *name;
  int samples;    /* bits: 1 << sgi_sample for each that it holds */
  int layouts;    /* bits: 1 << sgi_layout */
  int from_below; /* whether the last row comes first */
  int metadata;   /* bits: 1 << sgi_metadata for each kind that it holds */
  void *(*begin)(const picture_facts *facts);
  /* Rows of samples in the machine's byte order, which may be changed, in the order in which the format has them. */
  void (*write)(void *state, unsigned char *samples, uint32_t rows);
  void (*end)(void *state);
} picture_format;

/* The format that an extension or a name stands for; null if there is none. */
const picture_format *find_format(const char *name);
/* The simplest one that holds a picture. */
const picture_format *simplest_format(int layout, int sample);
/* Ends the program with 3 if a format cannot hold a picture. */
void check_format(const picture_format *format, const picture_facts *facts);

/* "png pnm pam pfm", as far as they are built. */
const char *format_names(void);

size_t sample_bytes(int sample);
/* Turns samples of 16 bits into big-endian ones. */
void make_big_endian(unsigned char *samples, size_t count);

extern const picture_format pnm_format, pam_format, pfm_format;
#ifdef HAVE_PNG
extern const picture_format png_format;
#endif

#endif
