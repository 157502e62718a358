/* Draws a .sgi picture as PPM or PGM, or half of it: decode IN.sgi OUT.ppm 0.5
 * cc decode.c -o decode $(pkg-config --cflags --libs sgi) */
#include <sgi.h>
#include <stdio.h>
#include <stdlib.h>

static int64_t read_file(void *file, uint64_t offset, void *buffer, size_t count) {
  if (fseek(file, (long)offset, SEEK_SET)) return -1;
  size_t found = fread(buffer, 1, count, file);
  return ferror((FILE *)file) ? -1 : (int64_t)found;
}

static void stop_at(sgi_status status, const char *name) {
  if (status == SGI_OK) return;
  fprintf(stderr, "%s: %s\n", name, sgi_error());
  exit(1);
}

int main(int count, char **names) {
  FILE *in = count > 2 ? fopen(names[1], "rb") : NULL;
  if (!in || fseek(in, 0, SEEK_END)) return fprintf(stderr, "usage: decode IN.sgi OUT.ppm [SCALE]\n"), 2;
  double scale = count > 3 ? atof(names[3]) : 1;

  sgi_stream *stream;
  stop_at(sgi_open(read_file, in, (uint64_t)ftell(in), NULL, &stream), names[1]);
  sgi_info info = SGI_INFO_INIT;
  stop_at(sgi_get_info(stream, &info), names[1]);

  sgi_view view = SGI_VIEW_INIT;
  view.width = info.width, view.height = info.height; /* the region: all of it */
  view.columns = (uint32_t)(info.width * scale + 0.5), view.rows = (uint32_t)(info.height * scale + 0.5);
  view.sample = SGI_SAMPLE_U8;
  size_t stride = (size_t)view.columns * info.channels;
  unsigned char *samples = malloc(stride * view.rows + 1);
  if (!samples) return fprintf(stderr, "no memory\n"), 1;
  stop_at(sgi_draw(stream, &view, samples, stride), names[1]);
  sgi_close(stream);

  FILE *out = fopen(names[2], "wb");
  if (!out) return perror(names[2]), 1;
  unsigned colours = info.channels < 3 ? 1 : 3; /* what else there is has no place in a PPM */
  fprintf(out, "P%d\n%u %u\n255\n", colours == 3 ? 6 : 5, view.columns, view.rows);
  for (size_t pixel = 0; pixel < (size_t)view.columns * view.rows; ++pixel)
    fwrite(samples + pixel * info.channels, 1, colours, out);
  return fclose(out) ? (perror(names[2]), 1) : 0;
}
