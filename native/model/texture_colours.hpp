// In which colours a texture layer is coded (docs/format.md, "Colours of texture").
#pragma once
#include <array>
#include <cstdint>

namespace sgi {

// As indices of the stream. shares: of the layer's first channel in the two opponent colours; turn: of its other two
// channels, in which these may be independent of each other.
struct TextureColours {
  static constexpr int kSameShare = 32, kSameTurn = 8;

  std::array<int, 2> shares{kSameShare, kSameShare};
  int turn = kSameTurn;

  // Whether the layer's channels are the opponent ones.
  bool same() const { return shares[0] == kSameShare && shares[1] == kSameShare && turn == kSameTurn; }
  // [3, 3]; rows: one opponent channel each as a mix of the layer's channels.
  std::array<double, 9> matrix() const;
  // Rows: one channel of the layer each as a mix of the opponent ones.
  std::array<double, 9> inverse() const;
};

std::array<double, 9> transposed(const std::array<double, 9> &matrix);

// The first three of some planes [3, count], mixed in place.
void mix_colours(const std::array<double, 9> &matrix, float *planes, int64_t count);

}  // namespace sgi
