// The texture layer of least squared error plus lambda times bits.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"
#include "model/texture_steps.hpp"
#include "rdoq/texture_amplitudes.hpp"

namespace sgi {

struct TextureSettings {
  float lambda;  // squared steps per bit
  bool has_contrast;
  // A cell is tried whole, or divided, where an estimate says that it costs this much more than the other at most.
  float split_margin;
};

struct TextureFound {
  TextureField field;
  // By magnitude 1, 2 and more: how many symbols, and the sum of |amplitude| / step - |symbol|.
  std::array<double, 3> count, excess;
};

// contrast: [roots], indices. division: null, or TextureField::log_size of a layer whose cells are taken, which is
// faster: nothing is tried, and cells go alone whose symbols would all be 0.
TextureFound search_texture(BitModels models, const TextureAmplitudes &amplitudes, const int8_t *contrast,
                            const TextureSteps &steps, const TextureSettings &settings,
                            const uint8_t *division = nullptr);

// What the best layer costs about, its error and lambda times its bits, in squared steps of its roots.
double estimate_texture(const TextureAmplitudes &amplitudes, const int8_t *contrast, const TextureSteps &steps,
                        const TextureSettings &settings);

}  // namespace sgi
