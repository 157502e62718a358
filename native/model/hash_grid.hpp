// The binary hash grid that MLP_p may see (docs/format.md, "Hash grid").
#pragma once
#include <cstdint>
#include <vector>

#include "model/spec.hpp"

namespace sgi {

class HashGrid {
 public:
  HashGrid(const ContextSpec &context, int64_t width, int64_t height);

  // Signs of every resolution.
  std::vector<int64_t> counts() const;
  // Inputs of a seed, features of one resolution after those of the one before.
  int inputs() const { return int(levels_.size()) * features_; }
  int features() const { return features_; }
  int resolutions() const { return int(levels_.size()); }
  // The four entries around a seed's centre, half pixels, in a resolution's table, and their weights in units of 2^-12,
  // which sum to 4096.
  void corners(int resolution, const int32_t *half_pixels, int64_t *entries, int *weights) const;
  // Of the seeds `members` [n] with these centres [N, 2], from the signs (0 or 1) of all resolutions one after the
  // other: the first columns of out [n, stride].
  void write_inputs(const uint8_t *signs, const int32_t *half_pixels, const int64_t *members, int64_t n, int16_t *out,
                    int64_t stride) const;

 private:
  struct Level {
    int64_t resolution, across, size;
    bool is_dense;
    int64_t first;  // of its signs
  };

  int64_t longer_;  // side of the picture, half pixels
  int features_;
  std::vector<Level> levels_;
};

}  // namespace sgi
