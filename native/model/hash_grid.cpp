#include "model/hash_grid.hpp"

#include <algorithm>

#include "model/constants.hpp"

namespace sgi {

HashGrid::HashGrid(const ContextSpec &context, int64_t width, int64_t height)
    : longer_(2 * std::max(width, height)), features_(context.hash_features) {
  int64_t first = 0;
  for (const int resolution : context.hash_resolutions) {
    const int64_t across = resolution + 1, rows = across * (2 * height) / longer_ + 2;
    const int64_t size = std::min(across * rows, int64_t(1) << context.hash_log2_entries);
    levels_.push_back({resolution, across, size, across * rows <= size, first});
    first += size * features_;
  }
}

std::vector<int64_t> HashGrid::counts() const {
  std::vector<int64_t> counts;
  for (const Level &level : levels_) counts.push_back(level.size * features_);
  return counts;
}

void HashGrid::corners(int resolution, const int32_t *half_pixels, int64_t *entries, int *weights) const {
  constexpr int kOne = 1 << kInputBits;
  const Level &level = levels_[resolution];
  int64_t cell[2], fraction[2];
  for (int axis = 0; axis < 2; ++axis) {
    const int64_t position = int64_t(half_pixels[axis]) * (level.resolution * kOne) / longer_;
    cell[axis] = position >> kInputBits, fraction[axis] = position & (kOne - 1);
  }
  for (int c = 0; c < 4; ++c) {
    const int dx = c & 1, dy = c >> 1;
    const int64_t x = cell[0] + dx, y = cell[1] + dy;
    entries[c] = (level.is_dense ? y * level.across + x : x ^ (y * 2654435761)) % level.size;
    weights[c] = int(dx ? fraction[0] : kOne - fraction[0]) * int(dy ? fraction[1] : kOne - fraction[1]);
  }
}

void HashGrid::write_inputs(const uint8_t *signs, const int32_t *half_pixels, const int64_t *members, int64_t n,
                            int16_t *out, int64_t stride) const {
  for (int64_t i = 0; i < n; ++i, out += stride) {
    int16_t *to = out;
    for (int resolution = 0; resolution < resolutions(); ++resolution) {
      int64_t entries[4];
      int weights[4];
      corners(resolution, half_pixels + 2 * members[i], entries, weights);
      const uint8_t *table = signs + levels_[resolution].first;
      for (int feature = 0; feature < features_; ++feature) {
        int sum = 0;
        for (int c = 0; c < 4; ++c) sum += table[entries[c] * features_ + feature] ? weights[c] : -weights[c];
        *to++ = int16_t(sum >> kInputBits);
      }
    }
  }
}

}  // namespace sgi
