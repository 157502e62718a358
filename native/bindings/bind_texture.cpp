#include <nanobind/stl/string.h>

#include <vector>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "model/texture.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

// What a `Texture` of arrays points to.
struct Pointed {
  std::vector<const float *> amplitudes;
  std::vector<sgi::Waves> waves;
};

sgi::Texture texture_of(const Array<const int32_t, 2> &corner, const Array<const uint8_t, 1> &log_size,
                        const Array<const float, 1> &amplitudes, const Array<const uint8_t, 3> &waves, int64_t width,
                        int64_t height, Pointed &pointed) {
  const size_t count = log_size.shape(0), channels = waves.shape(1);
  require(has_shape(corner, count, 2) && waves.shape(0) == count && waves.shape(2) == 2,
          "corner must be [N, 2], log_size [N], waves [N, C, 2]");
  require(width > 0 && height > 0 && width < (1 << 30) && height < (1 << 30), "a tile must have pixels");
  size_t values = 0;
  for (size_t i = 0; i < count; ++i) {
    const int log = log_size.data()[i];
    require(log >= sgi::kTextureLeast && log <= sgi::kTextureRoot, "log_size must be 3, 4 or 5");
    const int32_t x = corner.data()[2 * i], y = corner.data()[2 * i + 1];
    require(x >= 0 && x < width && y >= 0 && y < height && !((x | y) & ((1 << log) - 1)),
            "corner must be that of a cell of the quadtree that begins in the tile");
    pointed.amplitudes.push_back(amplitudes.data() + values);
    values += channels << 2 * log;
    for (size_t c = 0; c < channels; ++c) {
      const uint8_t *of = waves.data() + 2 * (i * channels + c);
      require(of[0] % 4 == 0 && of[0] <= 1 << log && of[1] <= 1 << log, "waves must be rows, by fours, and columns");
      pointed.waves.push_back({of[0], of[1]});
    }
  }
  require(amplitudes.shape(0) == values, "amplitudes must be [C, n, n] of each cell");
  return {
      corner.data(), log_size.data(), pointed.amplitudes.data(), pointed.waves.data(), int64_t(count), int(channels),
      width,         height};
}

void draw_texture(Array<const int32_t, 2> corner, Array<const uint8_t, 1> log_size, Array<const float, 1> amplitudes,
                  Array<const uint8_t, 3> waves, int threads, const std::string &isa, Array<float, 3> planes) {
  const auto channels = planes.shape(0), height = planes.shape(1), width = planes.shape(2);
  require(channels >= 1 && channels <= 64 && waves.shape(1) == channels, "planes must be [C, h, w], C at most 64");
  Pointed pointed;
  const sgi::Texture texture =
      texture_of(corner, log_size, amplitudes, waves, int64_t(width), int64_t(height), pointed);
  nb::gil_scoped_release release;
  sgi::draw_texture(texture, {0, 1, 0, int64_t(width)}, {0, 1, 0, int64_t(height)}, threads, sgi::choose_isa(isa),
                    planes.data());
}

}  // namespace

void bind_texture(nb::module_ &m) {
  m.def("draw_texture", &draw_texture, "corner"_a, "log_size"_a, "amplitudes"_a, "waves"_a, "threads"_a, "isa"_a,
        "planes"_a);
}
