// A texture layer's cells and amplitudes, as what draws takes them.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/kept_floats.hpp"
#include "bitstream/texture_field.hpp"
#include "model/texture.hpp"
#include "model/texture_colours.hpp"
#include "model/texture_quantizer.hpp"
#include "model/texture_steps.hpp"

namespace sgi {

struct TextureCells {
  TextureCells() = default;
  TextureCells(TextureCells &&) = default;
  TextureCells &operator=(TextureCells &&) = default;

  // Makes room for the cells of a field: those that are there stay where they are as more are added.
  void reserve(const TextureField &field);
  // Those that are there, of a tile of width x height pixels.
  Texture texture(int channels, int64_t width, int64_t height, TextureGrid grid) const;

  std::vector<int32_t> corner;             // [N, 2]
  std::vector<uint8_t> log_size;           // [N]
  std::vector<const float *> amplitudes;   // [N, C] of each cell [n, n], of which rows behind `waves` are not there
  std::vector<Waves> waves;                // [N, C]
  std::vector<KeptFloats> memory;          // where amplitudes are
  int64_t floats = 0, floats_to_come = 0;  // of that memory; of cells that the field may still have, at most
};

// Finds amplitudes as cells are read, in coding order.
class TextureDequantizer {
 public:
  // excess: what is added to the magnitude of symbols +-1, +-2, and all larger ones. Cells are added to `found`, which
  // must outlive it.
  TextureDequantizer(const TextureSteps &steps, const std::array<float, 3> &excess, const TextureColours &colours,
                     TextureCells &found);

  // Begins a cell, in a root of this contrast.
  void begin(const TextureCell &cell, int contrast);
  // Its next channel. values: symbols, `stride` from one row to the next, none of them behind diagonal `last`.
  void channel(const int16_t *values, int64_t stride, int last);
  // Ends it, behind its last channel.
  void end();

 private:
  // Of symbols up to kSmall either way, by quantiser; contrast: of which they are, none at first.
  static constexpr int kSmall = 15;
  struct Values {
    int contrast = INT32_MIN;
    float of[2][2 * kSmall + 1];
  };

  // Floats of a whole channel of the cell.
  int64_t plane() const { return int64_t(1) << 2 * log_; }
  void take(int64_t floats) { next_ += floats, room_ -= floats; }
  const Values &values_of(int channel);
  float value_of(int symbol, QuantizerState state, float step) const;

  TextureCells &found_;
  const TextureSteps steps_;
  const std::array<float, 4> excess_;
  const bool mixed_;
  const std::array<double, 9> mix_;
  std::vector<Values> values_;  // [C]
  int log_ = 0, contrast_ = 0, channel_ = 0;
  float *next_ = nullptr;  // where amplitudes to come go
  int64_t room_ = 0;       // floats there in the same piece of memory
};

// Gives it all cells of a field with extents.
void read_cells(const TextureField &field, TextureDequantizer &to);

}  // namespace sgi
