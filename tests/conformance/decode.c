/* The decoder of the conformance suite over libsgi: decode STREAM OUT X Y WIDTH HEIGHT COLUMNS ROWS TYPE writes the
 * samples of a region, row by row, channels interleaved, as the machine has numbers of TYPE u8, u16 or f32. */
#include <sgi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void stop_at(sgi_status status) {
  if (status == SGI_OK) return;
  fprintf(stderr, "%s\n", sgi_error());
  exit(1);
}

static void fail(const char *name) {
  perror(name);
  exit(1);
}

static void *read_file(const char *name, size_t *size) {
  FILE *file = fopen(name, "rb");
  if (!file || fseek(file, 0, SEEK_END)) fail(name);
  *size = (size_t)ftell(file);
  rewind(file);
  void *bytes = malloc(*size + 1);
  if (!bytes || fread(bytes, 1, *size, file) != *size) fail(name);
  fclose(file);
  return bytes;
}

int main(int count, char **names) {
  if (count != 10) return fprintf(stderr, "usage: decode STREAM OUT X Y WIDTH HEIGHT COLUMNS ROWS TYPE\n"), 2;
  static const char *types[] = {"u8", "u16", "f32"};
  static const int samples[] = {SGI_SAMPLE_U8, SGI_SAMPLE_U16, SGI_SAMPLE_F32};
  int type = 0;
  while (type < 3 && strcmp(types[type], names[9])) ++type;
  if (type == 3) return fprintf(stderr, "%s: no type of samples\n", names[9]), 2;

  size_t size;
  void *bytes = read_file(names[1], &size);
  sgi_stream *stream;
  stop_at(sgi_open_memory(bytes, size, NULL, &stream));
  sgi_info info = {sizeof info};
  stop_at(sgi_get_info(stream, &info));
  sgi_view view = {sizeof view, atof(names[3]), atof(names[4]), atof(names[5]), atof(names[6])};
  view.columns = (uint32_t)atoi(names[7]), view.rows = (uint32_t)atoi(names[8]);
  view.sample = samples[type];
  view.exact = view.no_dither = 1;
  size_t stride = (size_t)view.columns * info.channels * (type == 0 ? 1 : type == 1 ? 2 : 4);
  void *out = malloc(stride * view.rows + 1);
  if (!out) return fprintf(stderr, "no memory\n"), 1;
  stop_at(sgi_draw(stream, &view, out, stride));
  sgi_close(stream);

  FILE *file = fopen(names[2], "wb");
  if (!file || fwrite(out, 1, stride * view.rows, file) != stride * view.rows || fclose(file))
    return perror(names[2]), 1;
  return 0;
}
