// A texture layer's cells and amplitudes, as what draws takes them.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "bitstream/texture_field.hpp"
#include "model/texture.hpp"
#include "model/texture_colours.hpp"
#include "model/texture_steps.hpp"

namespace sgi {

struct TextureCells {
  std::vector<int32_t> corner;          // [N, 2]
  std::vector<uint8_t> log_size;        // [N]
  std::unique_ptr<float[]> amplitudes;  // of each cell [C, n, n]
  int64_t amplitude_count;
  std::vector<Waves> waves;  // [N, C]
};

// Cells in coding order, of a field with extents. excess: what is added to the magnitude of symbols ±1, ±2, and all
// larger ones.
TextureCells texture_cells(const TextureField &field, const TextureSteps &steps, const float *excess,
                           const TextureColours &colours, int threads);

}  // namespace sgi
