#include "bitstream/mask.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "bitstream/bit_model.hpp"
#include "bitstream/symbol_coder.hpp"

namespace sgi {

namespace {

// As many squares as masks of two megapixels have, a KiB each, and more for each byte: those of an outline take two
// bits at least, those of noise 32 bytes.
constexpr int64_t kFreeMixed = 1 << 13, kMixedPerByte = 32;

}  // namespace

// Codes a mask square by square, writing where a mask is given and else reading.
template <class Coder>
class MaskCoding {
 public:
  MaskCoding(Coder &coder, Mask &mask, const uint8_t *given, int64_t most)
      : coder_(coder), mask_(mask), given_(given), most_(most) {
    mask.large_.assign(size_t(mask.across() * mask.down()), Mask::kUnknown);
  }

  void code() {
    for (int64_t y = 0; y < mask_.height_; y += kLarge)
      for (int64_t x = 0; x < mask_.width_; x += kLarge) {
        large(x, y);
        coder_.record(flags_.data(), int64_t(flags_.size()));
        flags_.clear();
      }
  }

  int64_t mixed = 0;

 private:
  // Throws Error (corrupt) where a square is said to be mixed which is not.
  void large(int64_t x, int64_t y) {
    int32_t &link = mask_.large_[mask_.large_at(x, y)];
    const State state = code_state(x, y, 2 * kLog);
    if (state != kMixedState) {
      link = state == kSetState ? Mask::kSet : Mask::kClear;
      return;
    }
    link = int32_t(mask_.small_.size());
    mask_.small_.emplace_back().fill(Mask::kUnknown);
    const int64_t right = std::min(x + kLarge, mask_.width_), bottom = std::min(y + kLarge, mask_.height_);
    for (int64_t below = y; below < bottom; below += kSmall)
      for (int64_t beside = x; beside < right; beside += kSmall) small(beside, below);
    const Mask::Links &links = mask_.small_.back();  // of squares outside the tile unknown
    const auto is_other = [&](int32_t of) { return of >= 0 || (of != Mask::kUnknown && of != links.front()); };
    if (std::none_of(links.begin(), links.end(), is_other)) refuse_payload();
  }

  static constexpr int kLog = Mask::kLogSide, kSmall = 1 << kLog, kLarge = 1 << 2 * kLog;
  enum State { kClearState, kSetState, kMixedState, kUnknownState };
  // Of pixels: models by 4, 6, 10 and 8 pixels around, whose numbers follow each other.
  static constexpr std::array<uint32_t, 4> kFirst{0, 16, 16 + 64, 16 + 64 + 1024};
  static constexpr uint32_t kModels = kFirst[3] + 256;
  // What is known around a square of 16 pixels: two rows above, three columns to each side.
  static constexpr int kAbove = 2, kBeside = 3, kStride = kSmall + 2 * kBeside;
  using Window = std::array<std::array<uint8_t, kStride>, kAbove + kSmall>;

  void small(int64_t x, int64_t y) {
    const State state = code_state(x, y, kLog);
    int32_t link = state == kSetState ? Mask::kSet : Mask::kClear;
    if (state == kMixedState) {
      link = int32_t(mask_.pixels_.size());
      mask_.pixels_.push_back(code_pixels(x, y));
    }
    mask_.small_.back()[size_t((y >> kLog & (kSmall - 1)) << kLog | (x >> kLog & (kSmall - 1)))] = link;
  }

  // What a square at (x, y) is, under what those to the left, above, above left and above right are.
  State code_state(int64_t x, int64_t y, int log_side) {
    const int64_t side = int64_t(1) << log_side;
    const State state = given_ ? given_state(x, y, side) : kClearState;
    uint32_t context = log_side > kLog;
    constexpr int kX[4] = {-1, 0, -1, 1}, kY[4] = {0, -1, -1, -1};
    for (int i = 0; i < 4; ++i)
      context = 4 * context + uint32_t(state_at(x + kX[i] * side, y + kY[i] * side, log_side > kLog));
    int is_mixed = state == kMixedState, is_set = state == kSetState;
    alone(2 * context, is_mixed);
    if (!is_mixed) alone(2 * context + 1, is_set);
    if (is_mixed && ++mixed > most_)
      throw Error(Fault::limit, "a mask of too many squares for its length: more than " + std::to_string(most_) +
                                    " are mixed; it is refused");
    return is_mixed ? kMixedState : is_set ? kSetState : kClearState;
  }

  State given_state(int64_t x, int64_t y, int64_t side) const {
    const int64_t right = std::min(x + side, mask_.width_), bottom = std::min(y + side, mask_.height_);
    const uint8_t first = given_[y * mask_.width_ + x];
    for (int64_t row = y; row < bottom; ++row) {
      const uint8_t *const pixels = given_ + row * mask_.width_;
      if (std::any_of(pixels + x, pixels + right, [&](uint8_t pixel) { return pixel != first; })) return kMixedState;
    }
    return first ? kSetState : kClearState;
  }

  int state_at(int64_t x, int64_t y, bool is_large) const {
    if (x < 0 || y < 0 || x >= mask_.width_ || y >= mask_.height_) return kUnknownState;
    const int32_t link = is_large ? mask_.large_[mask_.large_at(x, y)] : mask_.link(x, y);
    return link >= 0              ? kMixedState
           : link == Mask::kSet   ? kSetState
           : link == Mask::kClear ? kClearState
                                  : kUnknownState;
  }

  Mask::Pixels code_pixels(int64_t x, int64_t y) {
    Mask::Pixels pixels{};
    Window window;
    bool has_both = false;
    int before = -1;
    for (int row = 0; row < kAbove + kSmall; ++row)
      for (int column = 0; column < kStride; ++column)
        window[size_t(row)][size_t(column)] = mask_.at(x + column - kBeside, y + row - kAbove);
    const int64_t columns = std::min<int64_t>(kSmall, mask_.width_ - x),
                  rows = std::min<int64_t>(kSmall, mask_.height_ - y);
    for (int64_t row = 0; row < rows; ++row) {
      uint8_t *const at = window[size_t(row + kAbove)].data() + kBeside;
      for (int64_t column = 0; column < columns; ++column) {
        int bit = given_ ? given_[(y + row) * mask_.width_ + x + column] != 0 : 0;
        code_bit(coder_.range(), models_of(at + column), kQuick, bit);
        flags_.push_back(bit);
        at[column] = uint8_t(bit);
        has_both |= before >= 0 && bit != before;
        before = bit;
        pixels[size_t(row)] = uint16_t(pixels[size_t(row)] | bit << column);
      }
      std::fill_n(at + columns, kStride - kBeside - columns, at[columns - 1]);  // what follows is not known
    }
    if (!has_both) refuse_payload();
    return pixels;
  }

  std::array<BitModel *, 4> models_of(const uint8_t *at) {
    const auto bits = [&](int row, int first, int last) {
      uint32_t all = 0;
      for (int column = first; column <= last; ++column) all = 2 * all + at[row * kStride + column];
      return all;
    };
    const uint32_t four = 2 * bits(-1, -1, 1) + bits(0, -1, -1);
    return {&models_[kFirst[0] + four], &models_[kFirst[1] + 4 * four + 2 * bits(0, -2, -2) + bits(-2, 0, 0)],
            &models_[kFirst[2] + (bits(-2, -1, 1) << 7 | bits(-1, -2, 2) << 2 | bits(0, -2, -1))],
            &models_[kFirst[3] + 2 * bits(-1, -3, 3) + bits(0, -1, -1)]};
  }

  void alone(uint32_t model, int &flag) {
    code_bit(coder_.range(), states_[model], kQuick, flag);
    flags_.push_back(flag);
  }

  Coder &coder_;
  Mask &mask_;
  const uint8_t *given_;
  int64_t most_;
  std::vector<int32_t> flags_;  // that were coded since the last record
  std::vector<BitModel> states_ = std::vector<BitModel>(1024), models_ = std::vector<BitModel>(kModels);
};

int64_t max_mixed(int64_t payload_bytes) { return kFreeMixed + kMixedPerByte * payload_bytes; }

Mask Mask::read(Bytes payload, int64_t width, int64_t height) {
  Mask mask(width, height);
  SymbolReader reader(payload);
  MaskCoding(reader, mask, nullptr, max_mixed(int64_t(payload.size))).code();
  reader.finish();
  return mask;
}

WrittenMask::WrittenMask(const uint8_t *mask, int64_t width, int64_t height) {
  Mask written(width, height);
  SymbolWriter writer;
  MaskCoding coding(writer, written, mask, INT64_MAX);
  coding.code();
  payload = writer.finish(), mixed = coding.mixed;
}

int32_t Mask::link(int64_t x, int64_t y) const {
  const int32_t large = large_[large_at(x, y)];
  if (large < 0) return large;
  return small_[size_t(large)][size_t((y >> kLogSide & (kSide - 1)) << kLogSide | (x >> kLogSide & (kSide - 1)))];
}

bool Mask::is_mixed() const {
  return !small_.empty() ||
         std::any_of(large_.begin(), large_.end(), [&](int32_t link) { return link != large_.front(); });
}

bool Mask::at(int64_t x, int64_t y) const {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return false;
  if (large_.empty()) return true;
  const int32_t square = link(x, y);
  return square < 0 ? square == kSet : pixels_[size_t(square)][size_t(y & (kSide - 1))] >> (x & (kSide - 1)) & 1;
}

void Mask::sample(const int64_t *x, int64_t columns, const int64_t *y, int64_t rows, uint8_t *out) const {
  if (large_.empty()) std::fill_n(out, rows * columns, uint8_t(1));
  for (int64_t row = 0; row < rows && !large_.empty(); ++row, out += columns)
    for (int64_t first = 0, end = 0; first < columns; first = end) {
      while (end < columns && x[end] >> kLogSide == x[first] >> kLogSide) ++end;
      const int32_t square = link(x[first], y[row]);
      const unsigned pixels = square < 0 ? 0 : pixels_[size_t(square)][size_t(y[row] & (kSide - 1))];
      if (square < 0) std::fill(out + first, out + end, uint8_t(square == kSet));
      for (int64_t i = first; square >= 0 && i < end; ++i) out[i] = pixels >> (x[i] & (kSide - 1)) & 1;
    }
}

int64_t Mask::memory() const {
  return int64_t(large_.size() * sizeof(int32_t) + small_.size() * sizeof(Links) + pixels_.size() * sizeof(Pixels));
}

}  // namespace sgi
