// In which colours a texture layer is coded (docs/format.md, "Colours of texture").
#pragma once
#include <array>
#include <cstdint>

namespace sgi {

// As indices of the stream. shares: of the layer's first channel in the two differences; turn: of its other two
// channels, in which these may be independent of each other.
struct TextureColours {
  static constexpr int kSameShare = 32, kSameTurn = 8;

  std::array<int, 2> shares{kSameShare, kSameShare};
  int turn = kSameTurn;

  // Whether the layer's channels are those of its tile.
  bool same() const { return shares[0] == kSameShare && shares[1] == kSameShare && turn == kSameTurn; }
  // [3, 3]; rows: one of the tile's channels each as a mix of the layer's.
  std::array<double, 9> matrix() const;
  // Rows: one channel of the layer each as a mix of the tile's.
  std::array<double, 9> inverse() const;
};

std::array<double, 9> transposed(const std::array<double, 9> &matrix);

// The first `count` values of three planes, `plane` apart, mixed in place.
void mix_colours(const std::array<double, 9> &matrix, float *planes, int64_t plane, int64_t count);

}  // namespace sgi
