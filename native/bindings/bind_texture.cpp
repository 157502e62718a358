#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <optional>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "model/texture.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

sgi::Texture texture_of(const Array<const int32_t, 2> &corner, const Array<const uint8_t, 1> &log_size,
                        const Array<const float, 1> &amplitudes, size_t channels, int64_t width, int64_t height) {
  const size_t count = log_size.shape(0);
  require(has_shape(corner, count, 2), "corner must be [N, 2], log_size [N]");
  require(width > 0 && height > 0 && width < (1 << 30) && height < (1 << 30), "a tile must have pixels");
  size_t values = 0;
  for (size_t i = 0; i < count; ++i) {
    const int log = log_size.data()[i];
    require(log >= sgi::kTextureLeast && log <= sgi::kTextureRoot, "log_size must be 3, 4 or 5");
    const int32_t x = corner.data()[2 * i], y = corner.data()[2 * i + 1];
    require(x >= 0 && x < width && y >= 0 && y < height && !((x | y) & ((1 << log) - 1)),
            "corner must be that of a cell of the quadtree that begins in the tile");
    values += channels << 2 * log;
  }
  require(amplitudes.shape(0) == values, "amplitudes must be [C, n, n] of each cell");
  return {corner.data(), log_size.data(), amplitudes.data(), int64_t(count), int(channels), width, height};
}

void draw_texture(Array<const int32_t, 2> corner, Array<const uint8_t, 1> log_size, Array<const float, 1> amplitudes,
                  std::optional<Array<const float, 2>> mix, int threads, const std::string &isa,
                  Array<float, 3> planes) {
  const auto channels = planes.shape(0), height = planes.shape(1), width = planes.shape(2);
  require(channels >= 1 && channels <= 64, "planes must be [C, h, w], C at most 64");
  require(!mix || (has_shape(*mix, 3, 3) && channels >= 3), "mix must be [3, 3], for three channels or more");
  const sgi::Texture texture = texture_of(corner, log_size, amplitudes, channels, int64_t(width), int64_t(height));
  nb::gil_scoped_release release;
  sgi::draw_texture(texture, {0, 1, 0, int64_t(width)}, {0, 1, 0, int64_t(height)}, mix ? mix->data() : nullptr,
                    threads, sgi::choose_isa(isa), planes.data());
}

}  // namespace

void bind_texture(nb::module_ &m) {
  m.def("draw_texture", &draw_texture, "corner"_a, "log_size"_a, "amplitudes"_a, "mix"_a.none(), "threads"_a, "isa"_a,
        "planes"_a);
}
