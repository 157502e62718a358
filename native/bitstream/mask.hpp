// Masks: which pixels of a tile hold nothing (docs/format.md, "Masks").
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"

namespace sgi {

// A tile in squares of 256 pixels, in squares of 16 where these are mixed, and pixels where those are. Memory follows
// what is mixed, and what a reader takes of that follows the payload.
class Mask {
 public:
  static constexpr int kLogSide = 4, kSide = 1 << kLogSide;  // squares of a larger one, and pixels of a square
  // What a link says instead of a number: no pixel holds nothing, all do, or it is not coded yet.
  static constexpr int32_t kClear = -1, kSet = -2, kUnknown = -3;

  // The whole tile is empty.
  Mask(int64_t width, int64_t height) : width_(width), height_(height) {}
  // Throws Error: corrupt, limit.
  static Mask read(Bytes payload, int64_t width, int64_t height);

  // Whether some pixels hold something and others nothing.
  bool is_mixed() const;
  // Whether a pixel of the tile holds nothing; those that are not coded yet do not, nor those outside the tile.
  bool at(int64_t x, int64_t y) const;
  // That of the pixels at columns x and rows y, ascending both, into out [rows, columns].
  void sample(const int64_t *x, int64_t columns, const int64_t *y, int64_t rows, uint8_t *out) const;
  int64_t memory() const;

 private:
  template <class Coder>
  friend class MaskCoding;
  friend struct WrittenMask;

  using Links = std::array<int32_t, kSide * kSide>;
  using Pixels = std::array<uint16_t, kSide>;  // a bit each, the first one lowest

  int64_t across() const { return (width_ + kSide * kSide - 1) >> 2 * kLogSide; }
  int64_t down() const { return (height_ + kSide * kSide - 1) >> 2 * kLogSide; }
  // The index in `large_` of the square that holds pixel (x, y).
  size_t large_at(int64_t x, int64_t y) const { return size_t((y >> 2 * kLogSide) * across() + (x >> 2 * kLogSide)); }
  // The link of the square that holds pixel (x, y): one of 16 pixels, or of 256 which is not mixed.
  int32_t link(int64_t x, int64_t y) const;

  int64_t width_, height_;
  std::vector<int32_t> large_;  // of squares of 256 pixels, row by row; none where all pixels hold nothing
  std::vector<Links> small_;    // of the mixed ones
  std::vector<Pixels> pixels_;  // of mixed squares of 16
};

// The payload of a mask [height, width], 1 for pixels that hold nothing, and how many of its squares are mixed.
struct WrittenMask {
  WrittenMask(const uint8_t *mask, int64_t width, int64_t height);

  std::vector<uint8_t> payload;
  int64_t mixed;
};

// The mixed squares that a mask with a payload of so many bytes may have.
int64_t max_mixed(int64_t payload_bytes);

}  // namespace sgi
