/* libsgi: decodes .sgi streams, any region at any scale.
 *
 * A stream is opened from memory or from a callback that reads bytes, and drawn into buffers of the caller. Handles may
 * be used by several threads at once; calls on one handle take turns. Nothing is printed, and no exception leaves the
 * library. Structures begin with their own size, so that later versions can add to them: begin with SGI_INFO_INIT and
 * its like, or set all else to 0.
 */
#ifndef SGI_H
#define SGI_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32) && defined(SGI_BUILDING)
#define SGI_API __declspec(dllexport)
#elif defined(__GNUC__)
#define SGI_API __attribute__((visibility("default")))
#else
#define SGI_API
#endif

/* The version of this interface; `sgi_version` is that of the library that runs. Where the first number changes, the
 * name of the shared library does, too, and programs must be compiled anew. */
#define SGI_VERSION_MAJOR 1
#define SGI_VERSION_MINOR 0

typedef struct sgi_stream sgi_stream;

/* What a call returns. The set is closed: new kinds of failure get one of these. */
typedef enum sgi_status {
  SGI_OK = 0,
  SGI_ERROR_USAGE = 1,       /* an argument that makes no sense */
  SGI_ERROR_REGION = 2,      /* a region or a level that is not in the picture */
  SGI_ERROR_CORRUPT = 3,     /* bytes that no encoder wrote */
  SGI_ERROR_UNSUPPORTED = 4, /* a sound stream that needs another library */
  SGI_ERROR_LIMIT = 5,       /* more than the caps of the format or of the caller; found before memory is taken */
  SGI_ERROR_SOURCE = 6,      /* the callback that reads failed; or `sgi_probe` was given too few bytes */
  SGI_ERROR_MEMORY = 7,      /* the system has no memory left */
  SGI_ERROR_INTERNAL = 8,    /* a defect of this library */
  SGI_ERROR_STOPPED = 9      /* the callback `proceed` said so */
} sgi_status;

typedef enum sgi_sample { SGI_SAMPLE_U8 = 0, SGI_SAMPLE_U16 = 1, SGI_SAMPLE_F32 = 2 } sgi_sample;

typedef enum sgi_layout {
  SGI_LAYOUT_MULTI = 0, /* any number of channels without a meaning that is known here */
  SGI_LAYOUT_GRAY = 1,
  SGI_LAYOUT_GRAY_ALPHA = 2,
  SGI_LAYOUT_RGB = 3,
  SGI_LAYOUT_RGBA = 4 /* alpha is not multiplied into the colours */
} sgi_layout;

/* Reads up to `count` bytes from `offset` of the file on into `buffer`. Returns how many, fewer only at the end of the
 * file, or -1 for a failure. Calls come one at a time, on any thread that uses the stream. */
typedef int64_t (*sgi_read)(void *user, uint64_t offset, void *buffer, size_t count);

/* The size of a file that is not known: then it is read once from its start to its end when it is opened, and its
 * compressed tiles are kept. */
#define SGI_SIZE_UNKNOWN UINT64_MAX

/* Asked between tiles, on the thread that draws; 0 ends the call with SGI_ERROR_STOPPED, all else goes on. */
typedef int (*sgi_proceed)(void *user);

typedef struct sgi_options {
  size_t struct_size;   /* sizeof(sgi_options) */
  int threads;          /* 0: one for each core; more than 1024 count as 1024; negative is SGI_ERROR_USAGE */
  uint64_t cache_bytes; /* what decoded tiles may take between calls; 0: 256 MiB */
  sgi_proceed proceed;  /* may be null */
  void *proceed_user;   /* what it is called with */
  /* What one tile may take while it is decoded, besides 64 MiB: one that may take more is SGI_ERROR_LIMIT before it
   * does. As many tiles as there are threads are decoded at once. 0: the caps of the format. */
  uint64_t tile_bytes;
} sgi_options;

typedef struct sgi_info {
  size_t struct_size; /* sizeof(sgi_info), set by the caller */
  uint32_t width, height, channels;
  int layout;         /* sgi_layout */
  int sample;         /* sgi_sample of the source, and so the one that loses nothing */
  float low, high;    /* the range of channel 0; bands may have others: `sgi_get_range` */
  uint32_t tiles;     /* 1 for a picture in one piece */
  uint32_t tile_size; /* largest side of a tile without its apron; 0 for one tile */
  int has_nodata;     /* whether samples without content are stored as `nodata`, in each channel but alpha by itself */
  double nodata;      /* means something only with `has_nodata` */
  int has_overview;
  uint32_t levels; /* of the pyramid that `sgi_get_level` describes */
  uint64_t file_bytes;
} sgi_info;

typedef enum sgi_metadata {
  SGI_METADATA_ICC = 0,
  SGI_METADATA_EXIF = 1, /* a TIFF structure, without "Exif\0\0" */
  SGI_METADATA_XMP = 2,
  SGI_METADATA_PLACE = 3,   /* a TIFF structure with the tags of GeoTIFF */
  SGI_METADATA_SOFTWARE = 4 /* the program that wrote the stream, in UTF-8; a text of somebody else */
} sgi_metadata;

/* What a pixel of a drawing is. */
typedef enum sgi_pixels {
  SGI_PIXELS_CHANNELS = 0, /* the picture's own channels, in their order */
  SGI_PIXELS_RGBA = 1,     /* four samples; gray is in all three colours, and what has no alpha is opaque */
  SGI_PIXELS_BGRA = 2      /* the same in another order, as cairo, Qt and Windows have it */
} sgi_pixels;

/* What to draw. The region is in pixels of the picture and may be fractional; `columns` x `rows` output pixels show it.
 * Regions may reach over the picture where `boundless` is set: there samples are nodata, else 0. */
typedef struct sgi_view {
  size_t struct_size; /* sizeof(sgi_view) */
  double x, y, width, height;
  uint32_t columns, rows;
  int sample; /* sgi_sample of the buffer */
  int boundless;
  int exact;     /* 1: never from the overview */
  int no_dither; /* 1: eight bits of a deeper source are rounded to nearest */
  int lossy;     /* 1: without the residual layer, which else makes the picture's own pixels exact, or near it */
  /* sgi_pixels. With RGBA and BGRA, pixels outside the picture and those of which all colours are nodata are 0 in all
   * samples. Bands without a meaning (SGI_LAYOUT_MULTI) have no colours: SGI_ERROR_USAGE. */
  int pixels;
  int premultiplied;  /* 1: of RGBA and BGRA, alpha is multiplied into the colours */
  uint32_t first_row; /* draw only the output rows first_row ... first_row + row_count - 1, into a buffer that begins */
  uint32_t row_count; /* with the first of them: a large drawing in bands; 0: all rows from first_row on */
} sgi_view;

/* How a structure begins its life: sgi_info info = SGI_INFO_INIT; */
#ifdef __cplusplus
extern "C++" {
template <class T>
inline T sgi_sized() {
  T made = T();
  made.struct_size = sizeof(T);
  return made;
}
}
#define SGI_SIZED(type) sgi_sized<type>()
#else
#define SGI_SIZED(type) {.struct_size = sizeof(type)}
#endif
#define SGI_OPTIONS_INIT SGI_SIZED(sgi_options)
#define SGI_INFO_INIT SGI_SIZED(sgi_info)
#define SGI_VIEW_INIT SGI_SIZED(sgi_view)

/* "1.0.0"; of the library that runs. */
SGI_API const char *sgi_version(void);

/* 1 if a file begins like a stream, 0 if not; eight bytes are enough. Silicon Graphics' pictures share the suffix. */
SGI_API int sgi_is_stream(const void *bytes, size_t size);
/* What the header says, from the first bytes of a file alone, before the rest is there: `has_overview` and `file_bytes`
 * are 0. The header is at the start of a file: its first 33 to 75 bytes in the golden streams, 2,050 where a stream has
 * a network of its own. SGI_ERROR_SOURCE: these bytes do not hold all of it, come again with more. */
SGI_API sgi_status sgi_probe(const void *bytes, size_t size, sgi_info *info);

/* Opens a stream: `*stream` is its handle, or null with an error, whose text `sgi_error` tells. `options` may be null.
 * The bytes of `sgi_open_memory` must stay until `sgi_close`. `size` is that of the file in bytes. */
SGI_API sgi_status sgi_open_memory(const void *bytes, size_t size, const sgi_options *options, sgi_stream **stream);
SGI_API sgi_status sgi_open(sgi_read read, void *user, uint64_t size, const sgi_options *options, sgi_stream **stream);
/* Frees a stream; null is allowed. */
SGI_API void sgi_close(sgi_stream *stream);

/* One line on the last error of this thread, in UTF-8; "" where the last call succeeded. Valid until the thread's next
 * call. */
SGI_API const char *sgi_error(void);
/* A few words on a status. */
SGI_API const char *sgi_status_text(sgi_status status);

/* What the stream holds. `info->struct_size` is set before the call, as SGI_INFO_INIT does; all else is filled in.
 * Fields that this library does not know are 0. */
SGI_API sgi_status sgi_get_info(sgi_stream *stream, sgi_info *info);
/* The size of a level: level 0 is the picture, each one half of the one before. SGI_ERROR_REGION from `levels` of
 * sgi_info on. */
SGI_API sgi_status sgi_get_level(sgi_stream *stream, uint32_t level, uint32_t *width, uint32_t *height);
/* The range of a channel's samples in the source's type: what 0 and 1 of the model stand for. Few samples may lie
 * outside, as the source has them: dead and hot pixels, not-a-number, nodata. SGI_ERROR_USAGE: there is no such
 * channel. */
SGI_API sgi_status sgi_get_range(sgi_stream *stream, uint32_t channel, float *low, float *high);
/* By how much samples in the source's own type and size may be off the source's: 0 is without loss; -1 where the stream
 * promises nothing, as most do. Floats: in samples, else in levels. */
SGI_API sgi_status sgi_get_max_error(sgi_stream *stream, double *max_error);
/* Whether that counts for views of other sizes and types, too: they are made from the same samples. 1 or 0. Also of
 * streams in which text, alpha or some bands alone are without loss, for these. */
SGI_API sgi_status sgi_get_exact_views(sgi_stream *stream, int *exact_views);
/* Metadata that the stream holds: `*bytes` is null and `*size` 0 where there is none, with SGI_OK. Valid until
 * `sgi_close`. SGI_ERROR_USAGE: a kind that is no sgi_metadata. */
SGI_API sgi_status sgi_get_metadata(sgi_stream *stream, sgi_metadata kind, const void **bytes, size_t *size);

/* Draws into `buffer`: samples by row, then column, then channel; rows are `stride` bytes apart. The buffer holds
 * (rows - 1) * stride + columns * n * size bytes: the rows that are drawn, n samples a pixel (the channels, or 4), and
 * the size of a sample, 1, 2 or 4. Samples are of the machine's own byte order. Those of the source's own type span the
 * range of their channel; in another type that range becomes the whole type, of floats 0 to 1, and nodata what it
 * becomes there, 0 where it has no place in it. After an error nothing can be said of what the buffer holds.
 *
 * SGI_ERROR_REGION: the region is not inside the picture (without `boundless`), has no area, reaches beyond 2^30
 * pixels, or is enlarged more than 2^24 times. SGI_ERROR_USAGE: no columns or no rows; rows to draw that the view
 * lacks; a `sample` or `pixels` that is none; `premultiplied` without RGBA or BGRA; a stride shorter than a row; a
 * buffer or a stride that is no multiple of a sample's size; more than 2^24 columns or rows, or 2^31 samples in one
 * call. */
SGI_API sgi_status sgi_draw(sgi_stream *stream, const sgi_view *view, void *buffer, size_t stride);

/* Decodes all tiles, those of the overview and the residual layer, and throws them away again: whether the whole file
 * is sound. `*crc` (may be null) is the CRC-32 of all symbols of the tiles, equal on every machine. */
SGI_API sgi_status sgi_verify(sgi_stream *stream, uint32_t *crc);

#ifdef __cplusplus
}
#endif

#endif
