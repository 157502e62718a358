// Does with a stream whatever the C interface allows, and stops where the interface does not hold what it promises.
// For libFuzzer as it is; with -DWITH_MAIN a program that takes files: fuzz_library FILE...
#include <sgi.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

#define EXPECT(condition)                                          \
  do {                                                             \
    if (!(condition)) {                                            \
      std::fprintf(stderr, "line %d: " #condition "\n", __LINE__); \
      std::abort();                                                \
    }                                                              \
  } while (0)

struct Source {
  const uint8_t *data;
  size_t size, most;  // bytes that one call gives
  uint64_t last = 0;
  bool once = false;  // offsets never go back
};

int64_t read_source(void *user, uint64_t offset, void *buffer, size_t count) {
  auto &source = *static_cast<Source *>(user);
  if (source.once) EXPECT(offset >= source.last);
  source.last = offset;
  if (offset >= source.size) return 0;
  const size_t found = std::min({count, source.most, source.size - size_t(offset)});
  std::memcpy(buffer, source.data + offset, found);
  return int64_t(found);
}

// What a call returned, checked against what it says of itself.
sgi_status told(sgi_status status) {
  EXPECT(status >= SGI_OK && status <= SGI_ERROR_STOPPED && status != SGI_ERROR_INTERNAL && status != SGI_ERROR_USAGE);
  const std::string text = sgi_error();
  EXPECT(text.empty() == (status == SGI_OK) && text.find('\n') == std::string::npos);
  return status;
}

// Numbers that follow from the stream, so that a failure can be repeated.
class Numbers {
 public:
  Numbers(const uint8_t *data, size_t size) {
    for (size_t i = 0; i < size; ++i) state_ = (state_ ^ data[i]) * 1099511628211u;
  }
  uint32_t below(uint32_t limit) {
    state_ ^= state_ << 13, state_ ^= state_ >> 7, state_ ^= state_ << 17;
    return uint32_t(state_ >> 32) % limit;
  }

 private:
  uint64_t state_ = 14695981039346656037u;
};

// Draws a region at some scale into a buffer that ends where it must; each row has `padding` bytes that must stay.
void draw(sgi_stream *stream, const sgi_info &info, Numbers &numbers) {
  constexpr size_t kBytes[] = {1, 2, 4};
  sgi_view view = {};
  view.struct_size = sizeof view;
  view.sample = int(numbers.below(3));
  view.exact = int(numbers.below(2)), view.no_dither = int(numbers.below(2)), view.boundless = int(numbers.below(2));
  view.lossy = int(numbers.below(2));
  view.columns = 1 + numbers.below(48), view.rows = 1 + numbers.below(48);
  view.width = 1 + numbers.below(std::min(info.width, 4096u)),
  view.height = 1 + numbers.below(std::min(info.height, 4096u));
  view.x = numbers.below(info.width - uint32_t(view.width) + 1) + (view.boundless ? numbers.below(100) / 8.0 - 6 : 0);
  view.y = numbers.below(info.height - uint32_t(view.height) + 1) + (view.boundless ? numbers.below(100) / 8.0 - 6 : 0);
  if (info.layout != SGI_LAYOUT_MULTI) view.pixels = int(numbers.below(3));
  if (view.pixels) view.premultiplied = int(numbers.below(2));
  view.first_row = numbers.below(view.rows), view.row_count = numbers.below(view.rows - view.first_row + 1);
  const size_t rows = view.row_count ? view.row_count : view.rows - view.first_row;
  const size_t bytes = kBytes[view.sample], row = view.columns * (view.pixels ? 4 : info.channels) * bytes;
  const size_t padding = bytes * numbers.below(5), stride = row + padding;
  std::vector<uint8_t> buffer(stride * (rows - 1) + row, 0xA5);
  if (told(sgi_draw(stream, &view, buffer.data(), stride))) return;
  for (size_t y = 0; y + 1 < rows; ++y)
    for (size_t i = row; i < stride; ++i) EXPECT(buffer[y * stride + i] == 0xA5);
  const bool is_finite = view.sample == SGI_SAMPLE_F32 && info.sample != SGI_SAMPLE_F32;  // of floats some are exact
  for (size_t y = 0; y < rows && is_finite; ++y)
    for (size_t i = 0; i < row; i += 4) {
      float sample;
      std::memcpy(&sample, &buffer[y * stride + i], 4);
      EXPECT(std::isfinite(sample));
    }
}

void use(sgi_stream *stream, Numbers &numbers) {
  sgi_info info = {};
  info.struct_size = sizeof info;
  EXPECT(told(sgi_get_info(stream, &info)) == SGI_OK);
  EXPECT(info.width && info.height && info.channels && info.tiles && info.levels && info.low < info.high);
  for (uint32_t level = 0; level <= info.levels; ++level) {
    uint32_t width, height;
    EXPECT(told(sgi_get_level(stream, level, &width, &height)) == (level < info.levels ? SGI_OK : SGI_ERROR_REGION));
  }
  for (uint32_t channel = 0; channel < info.channels; ++channel) {
    float low, high;
    EXPECT(told(sgi_get_range(stream, channel, &low, &high)) == SGI_OK && low < high);
  }
  double max_error;
  if (told(sgi_get_max_error(stream, &max_error)) == SGI_OK) EXPECT(max_error == -1 || max_error >= 0);
  for (int kind = SGI_METADATA_ICC; kind <= SGI_METADATA_SOFTWARE; ++kind) {
    const void *bytes;
    size_t size;
    EXPECT(told(sgi_get_metadata(stream, sgi_metadata(kind), &bytes, &size)) == SGI_OK);
    if (bytes)
      EXPECT(std::vector<uint8_t>(static_cast<const uint8_t *>(bytes), static_cast<const uint8_t *>(bytes) + size)
                 .size() == size);
  }
  for (int i = 0; i < 4; ++i) draw(stream, info, numbers);
  if (info.tiles <= 64) {
    uint32_t first = 0, again = 1;
    const sgi_status status = told(sgi_verify(stream, &first));
    EXPECT(told(sgi_verify(stream, &again)) == status && (status || first == again));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  Numbers numbers(data, size);
  sgi_options options = {};
  options.struct_size = sizeof options, options.threads = 1 + int(numbers.below(3));
  options.cache_bytes = numbers.below(2) ? 1 : 0, options.tile_bytes = numbers.below(3) ? 0 : 1 << 24;
  sgi_stream *stream;
  const sgi_status status = told(sgi_open_memory(data, size, &options, &stream));
  EXPECT((status == SGI_OK) == (stream != nullptr));
  const std::string text = sgi_error();
  const std::vector<uint8_t> start(data, data + std::min(size, size_t(numbers.below(300))));
  sgi_info probed = SGI_INFO_INIT;
  const sgi_status header = told(sgi_probe(start.data(), start.size(), &probed));
  if (stream) EXPECT(header == SGI_OK || header == SGI_ERROR_SOURCE);
  if (stream) use(stream, numbers);
  sgi_close(stream);

  Source source{data, size, 1 + numbers.below(5000)};
  EXPECT(told(sgi_open(read_source, &source, size, &options, &stream)) == status && text == sgi_error());
  if (stream) use(stream, numbers);
  sgi_close(stream);

  source.once = true, source.last = 0;
  told(sgi_open(read_source, &source, SGI_SIZE_UNKNOWN, &options, &stream));
  if (stream) use(stream, numbers);
  sgi_close(stream);
  return 0;
}

#ifdef WITH_MAIN
int main(int count, char **names) {
  for (int i = 1; i < count; ++i) {
    FILE *file = std::fopen(names[i], "rb");
    EXPECT(file);
    std::vector<uint8_t> data;
    uint8_t block[4096];
    for (size_t found; (found = std::fread(block, 1, sizeof block, file));)
      data.insert(data.end(), block, block + found);
    std::fclose(file);
    LLVMFuzzerTestOneInput(data.data(), data.size());
  }
}
#endif
