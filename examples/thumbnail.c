/* Draws a .sgi picture into a window's pixels, BGRA with alpha multiplied in, as cairo, Qt and Windows have them, and
 * writes them as BMP, which has them, too: thumbnail IN.sgi OUT.bmp [LONGER-SIDE]
 * cc thumbnail.c -o thumbnail $(pkg-config --cflags --libs sgi) */
#include <sgi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned char *read_all(const char *name, size_t *size) {
  FILE *in = fopen(name, "rb");
  unsigned char *bytes = NULL;
  size_t room = 0, found;
  if (!in) return NULL;
  for (*size = 0; (bytes = realloc(bytes, room += 1 << 20)); *size += found)
    if (!(found = fread(bytes + *size, 1, room - *size, in))) break;
  fclose(in);
  return bytes;
}

static int stop(const char *name) { return fprintf(stderr, "%s: %s\n", name, sgi_error()), 1; }

static void put(unsigned char *at, uint32_t number) {
  for (int i = 0; i < 4; ++i) at[i] = (unsigned char)(number >> 8 * i);
}

int main(int count, char **names) {
  const uint32_t most = count > 3 ? (uint32_t)atoi(names[3]) : 256;
  size_t size;
  unsigned char *bytes = count > 2 && most ? read_all(names[1], &size) : NULL;
  if (!bytes) return fprintf(stderr, "usage: thumbnail IN.sgi OUT.bmp [LONGER-SIDE]\n"), 2;

  sgi_info info = SGI_INFO_INIT; /* the first bytes of a download are enough for a frame of the right size */
  if (sgi_probe(bytes, size < 4096 ? size : 4096, &info) != SGI_OK) return stop(names[1]);
  printf("%u×%u pixels\n", info.width, info.height);

  sgi_options options = SGI_OPTIONS_INIT;
  options.threads = 1; /* in a program that has threads of its own */
  sgi_stream *stream;
  if (sgi_open_memory(bytes, size, &options, &stream) != SGI_OK) return stop(names[1]);

  sgi_view view = SGI_VIEW_INIT;
  const uint32_t longer = info.width > info.height ? info.width : info.height;
  const double scale = longer > most ? (double)most / longer : 1;
  view.width = info.width, view.height = info.height;
  view.columns = (uint32_t)(info.width * scale + 0.5), view.rows = (uint32_t)(info.height * scale + 0.5);
  view.columns += !view.columns, view.rows += !view.rows;
  view.pixels = SGI_PIXELS_BGRA, view.premultiplied = 1;
  const size_t stride = (size_t)view.columns * 4, head = 14 + 40;
  unsigned char *file = calloc(head + stride * view.rows, 1);
  if (!file || sgi_draw(stream, &view, file + head, stride) != SGI_OK) return stop(names[1]);
  sgi_close(stream);
  free(bytes);

  memcpy(file, "BM", 2); /* the header of a BMP of 32 bits, the first row on top */
  put(file + 2, (uint32_t)(head + stride * view.rows)), put(file + 10, (uint32_t)head), put(file + 14, 40);
  put(file + 18, view.columns), put(file + 22, 0u - view.rows), put(file + 26, 1 | 32 << 16);
  FILE *out = fopen(names[2], "wb");
  if (!out) return perror(names[2]), 1;
  fwrite(file, 1, head + stride * view.rows, out);
  free(file);
  return fclose(out) ? (perror(names[2]), 1) : 0;
}
