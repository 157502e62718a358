// What the viewer's workers call (viewer/src/library.js). Numbers cross as doubles and pointers; nothing throws.
#include <emscripten.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "decoder/stream.hpp"

// Reads into the memory at `out`: how many bytes, or -1. JavaScript keeps the reason.
extern "C" int32_t viewer_read(double offset, uint8_t *out, uint32_t count)
    __attribute__((import_module("env"), import_name("viewer_read")));

namespace {

using namespace sgi;

std::string last_error;

// Runs body(): what it returns, or `failed` with the error's text kept, since nothing may throw into JavaScript.
template <class Result, class Body>
Result guarded(Result failed, Body body) {
  try {
    return body();
  } catch (const std::bad_alloc &) {
    last_error = "there is not enough memory for this";
  } catch (const std::exception &error) {
    last_error = error.what();
  }
  return failed;
}

class PageSource : public ByteSource {
 public:
  explicit PageSource(uint64_t size) : size_(size) {}
  std::optional<uint64_t> size() override { return size_; }
  size_t read(uint64_t offset, uint8_t *out, size_t count) override {
    const int32_t found = viewer_read(double(offset), out, uint32_t(count));
    if (found < 0) throw Error(Fault::source, "the file cannot be read");
    return size_t(found);
  }

 private:
  uint64_t size_;
};

// Samples of eight bits [columns, C] as red, green, blue, alpha.
void to_rgba(const uint8_t *samples, int channels, ChannelLayout layout, int64_t pixels, uint8_t *rgba) {
  const bool is_gray = channels < 3;
  const int alpha = layout == ChannelLayout::gray_alpha ? 1 : layout == ChannelLayout::rgba ? 3 : -1;
  for (int64_t i = 0; i < pixels; ++i, samples += channels, rgba += 4) {
    rgba[0] = samples[0];
    rgba[1] = samples[is_gray ? 0 : 1];
    rgba[2] = samples[is_gray ? 0 : 2];
    rgba[3] = alpha < 0 ? 255 : samples[alpha];
  }
}

// Which core of an axis a pixel lies in.
int64_t core_of(const TileAxis &axis, double at) {
  int64_t index = std::min(axis.count - 1, int64_t(std::max(0.0, at) * axis.count / axis.length));
  while (index > 0 && at < axis.edge(index)) --index;
  while (index + 1 < axis.count && at >= axis.edge(index + 1)) ++index;
  return index;
}

// Five numbers: the centre in the picture, the half axes of one standard deviation, and the angle of the first.
void write_ellipse(double x, double y, const float *covariance, float *out) {
  const double xx = covariance[0], xy = covariance[1], yy = covariance[2];
  const double middle = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
  const double found[] = {x, y, std::sqrt(middle + spread), std::sqrt(std::max(0.0, middle - spread)),
                          std::atan2(2 * xy, xx - yy) / 2};
  std::copy(std::begin(found), std::end(found), out);
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char *viewer_error() { return last_error.c_str(); }

EMSCRIPTEN_KEEPALIVE Stream *viewer_open(double size, double cache_bytes) {
  return guarded<Stream *>(nullptr, [&] {
    DecoderSettings settings;
    settings.threads = 1;
    settings.cache_bytes = int64_t(cache_bytes);
    return new Stream(std::make_unique<PageSource>(uint64_t(size)), settings);
  });
}

EMSCRIPTEN_KEEPALIVE void viewer_close(Stream *stream) { delete stream; }

// Width, height, channels, tiles, largest side of a tile, whether there is an overview, levels.
EMSCRIPTEN_KEEPALIVE void viewer_info(Stream *stream, double *facts) {
  const Header &header = stream->header();
  const double found[] = {double(header.width),
                          double(header.height),
                          double(header.spec.channels),
                          double(header.grid().count()),
                          double(header.tile),
                          double(stream->has_overview()),
                          double(levels_of(header.width, header.height).size())};
  std::copy(std::begin(found), std::end(found), facts);
}

// Metadata by the letter of its chunk (docs/format.md): its length, 0 where there is none; `*bytes` is valid until
// `viewer_close`.
EMSCRIPTEN_KEEPALIVE uint32_t viewer_metadata(Stream *stream, int letter, const uint8_t **bytes) {
  const auto &blobs = stream->chunks().blobs();
  const auto found = blobs.find(char(letter));
  if (found == blobs.end()) return 0;
  *bytes = found->second.data();
  return uint32_t(found->second.size());
}

// Draws a region, which may reach over the picture, as columns x rows pixels. 0, or 1 for an error.
EMSCRIPTEN_KEEPALIVE int viewer_draw(Stream *stream, double x, double y, double width, double height, int columns,
                                     int rows, uint8_t *rgba) {
  return guarded(1, [&] {
    const Header &header = stream->header();
    const int channels = header.spec.channels;
    const PictureView view{x, y, columns / width, rows / height, columns, rows};
    std::vector<uint8_t> samples(size_t(columns) * size_t(rows) * size_t(channels));
    // Else a residual layer changes what nobody sees, and takes its time.
    const DrawOptions fast{false, true, !stream->has_exact_views()};
    stream->draw(view, 0, rows, SampleType::u8, fast, samples.data(), int64_t(columns) * channels);
    to_rgba(samples.data(), channels, header.channels, int64_t(columns) * rows, rgba);
    return 0;
  });
}

// The ellipses of the Gaussians whose centres are in a region: writes `most` of them and returns how many there are, or
// -1 for an error.
EMSCRIPTEN_KEEPALIVE int viewer_ellipses(Stream *stream, double x, double y, double width, double height, int most,
                                         float *out) {
  return guarded(-1, [&] {
    const TileGrid grid = stream->header().grid();
    const TileAxis across = grid.across(), down = grid.down();
    int total = 0;
    for (int64_t row = core_of(down, y); row <= core_of(down, y + height); ++row) {
      for (int64_t column = core_of(across, x); column <= core_of(across, x + width); ++column) {
        const TileRenderer &tile = stream->renderer(grid.number(column, row));
        const GaussianSet &all = tile.gaussians();
        for (int64_t i = 0; i < all.count(); ++i) {
          const double at = all.means[size_t(2 * i)] + tile.place().x,
                       along = all.means[size_t(2 * i + 1)] + tile.place().y;
          const bool inside = at >= x && along >= y && at < x + width && along < y + height;
          if (!inside || core_of(across, at) != column || core_of(down, along) != row) continue;
          if (total < most) write_ellipse(at, along, &all.covariances[size_t(3 * i)], out + 5 * int64_t(total));
          ++total;
        }
      }
    }
    return total;
  });
}

// Decodes all tiles: the CRC-32 of their symbols. 0, or 1 for an error.
EMSCRIPTEN_KEEPALIVE int viewer_verify(Stream *stream, uint32_t *crc) {
  return guarded(1, [&] {
    *crc = stream->survey().symbol_crc;
    return 0;
  });
}
}
