// Whole pixels that repeat others of their block: text, line art, flat ground (docs/format.md, "Repeated pixels").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/bit_model.hpp"

namespace sgi {

// Finds pixels that the next one may repeat, and codes whether it does. Pixels are numbered row by row. `Bits` as in
// bitstream/bits.hpp.
template <class Bits>
class PixelRepeats {
 public:
  PixelRepeats(int64_t width, int64_t height, Bits &bits)
      : width_(width), stride_(width + 2 * kPad), around_(size_t((height + kPad) * stride_)),
        far_(size_t(1) << kTableBits), near_(size_t(1) << kTableBits), models_(kModels),
        chances_(size_t(kSources * kTimes * kPatterns)), bits_(bits) {}

  // Codes which pixel the next one, at (y, x), repeats: its number, or -1 if none or where nothing is coded.
  // is_equal(number) says whether it repeats that one.
  template <class IsEqual>
  int64_t code(int64_t y, int64_t x, const IsEqual &is_equal) {
    look(y, x);
    if (!count_ || probability_of(chance_->word) <= (is_graphic_ ? kMinInGraphics : kLeast)) return -1;
    for (int rank = 0; rank < count_; ++rank) {
      int is_hit = is_equal(candidates_[size_t(rank)].number);
      code_hit(y, x, rank, is_hit);
      hit_ = uint8_t(rank + 1);
      if (is_hit) return candidates_[size_t(rank)].number;
    }
    hit_ = kMost + 1;
    return -1;
  }

  // Instead of `code`, for a pixel of which something is not coded.
  void skip(int64_t y, int64_t x) {
    look(y, x);
    count_ = 0;
  }

  // Learns the colour, a hash of all channels, of the pixel for which one of them was called.
  void learn(int64_t y, int64_t x, uint32_t colour) {
    const int64_t at = place(y, x), first = x ? at : at - kPad, last = x == width_ - 1 ? at + kPad : at;
    for (int64_t i = first; i <= last; ++i) around_[size_t(i)] = {colour, hit_};
    if (count_) {
      const bool is_hit = std::any_of(candidates_.begin(), candidates_.begin() + count_,
                                      [&](const Candidate &candidate) { return candidate.colour == colour; });
      note(*chance_, is_hit), note(usual_, is_hit);
    } else if (is_odd()) {
      note(usual_, 0);
    }
    if (!is_graphic_) return;
    for (Seen *seen : {&seen_far(), &seen_near()}) {
      const bool is_same = seen->last.number >= 0 && seen->last.colour == colour;
      if (!is_same) seen->before = seen->last;
      seen->times = is_same ? std::min(seen->times + 1, kTimesLimit) : 1;
      seen->last = {int32_t(y * width_ + x), colour};
    }
  }

 private:
  static constexpr int kPad = 2, kMost = 5;  // candidates
  static constexpr int kTableBits = 16, kHashBits = 15, kTimesLimit = 8;
  static constexpr uint32_t kSources = 6, kTimes = 64, kPatterns = 64, kHits = 7 * 7 * 7 * 7;
  static constexpr std::array<uint32_t, 4> kFirst{kMost * kSources * kTimes, kMost * (kSources * kTimes + kPatterns),
                                                  kMost * (kSources * kTimes + kPatterns) + (1u << kHashBits),
                                                  kMost * (kSources * kTimes + kPatterns + kHits) + (1u << kHashBits)};
  static constexpr uint32_t kModels = kFirst[3] + kMost * kSources * kPatterns;
  // Where more pixels than that are hit, as in text, tables serve. A hit that is less likely is not coded, there and
  // elsewhere.
  static constexpr int32_t kGraphic = 30000, kMinInGraphics = 2000, kLeast = 40000;

  // What is known of a pixel: its colour, and which candidate it was from 1 on, kMost + 1 for none; 0: not asked.
  struct Around {
    uint32_t colour = 0;
    uint8_t hit = 0;
  };
  struct Candidate {
    int32_t number = -1;
    uint32_t colour = 0;
    uint32_t source = 0;
  };
  // Pixels that were last seen under a hash of what was around them.
  struct Seen {
    struct Pixel {
      int32_t number = -1;
      uint32_t colour = 0;
    };
    Pixel last, before;  // of two colours
    int times = 0;       // how often in a row the last colour was
  };

  int64_t place(int64_t y, int64_t x) const { return (y + kPad) * stride_ + x + kPad; }

  static uint32_t mixed(uint32_t hash, uint32_t more) {
    hash = (hash ^ more) * 0x9e3779b1u;
    return hash ^ hash >> 15;
  }

  Seen &seen_far() { return far_[far_hash_ >> (32 - kTableBits)]; }
  Seen &seen_near() { return near_[near_hash_ >> (32 - kTableBits)]; }

  void look(int64_t y, int64_t x) {
    const Around *here = &around_[size_t(place(y, x))];
    const auto colour = [&](int64_t down, int64_t across) { return here[down * stride_ + across].colour; };
    const uint32_t w = colour(0, -1), n = colour(-1, 0), ne = colour(-1, 1), nw = colour(-1, -1);
    const uint32_t ww = colour(0, -2), nn = colour(-2, 0);
    pattern_ = uint32_t(w == n) | uint32_t(w == nw) << 1 | uint32_t(n == ne) << 2 | uint32_t(n == nw) << 3 |
               uint32_t(w == ww) << 4 | uint32_t(n == nn) << 5;
    hit_ = 0, count_ = 0, times_ = 0;
    is_graphic_ = probability_of(usual_.word) > kGraphic;
    if (is_odd()) return;
    if (is_graphic_) hash(here);
    const Seen &far = seen_far(), &near = seen_near();
    if (is_graphic_) {
      times_ = uint32_t(std::min(far.times, 7)) * 8 + uint32_t(std::min(near.times, 7));
      add(far.last.number, far.last.colour, 0);
      add(near.last.number, near.last.colour, 1);
    }
    const auto number = int32_t(y * width_ + x);
    if (x) add(number - 1, w, 2);
    if (is_graphic_) add(near.before.number, near.before.colour, 3);
    if (y) add(number - int32_t(width_), n, 4);
    if (y && x < width_ - 1) add(number - int32_t(width_) + 1, ne, 5);
    if (count_) chance_ = &chances_[(candidates_[0].source * kTimes + times_) * kPatterns + pattern_];
  }

  // Whether the pixel has no candidates because this is no text and none of its neighbours are alike.
  bool is_odd() const { return !is_graphic_ && !pattern_; }

  // Finds the hashes of what is around a pixel.
  void hash(const Around *here) {
    constexpr int8_t near[][2]{{0, -1}, {-1, 0}, {-1, 1}, {-1, -1}, {0, -2}, {-2, 0}};
    constexpr int8_t far[][2]{{-1, 2}, {-1, -2}, {-2, -1}, {-2, 1}, {-2, -2}, {-2, 2}};
    near_hash_ = 0;
    for (const auto &[down, across] : near) near_hash_ = mixed(near_hash_, here[down * stride_ + across].colour);
    far_hash_ = near_hash_;
    for (const auto &[down, across] : far) far_hash_ = mixed(far_hash_, here[down * stride_ + across].colour);
  }

  static void note(BitModel &chance, int is_hit) {
    chance.learn(is_hit * kCertain - probability_of(chance.word), kSteady);
  }

  // Adds a pixel whose colour no other candidate has.
  void add(int32_t number, uint32_t colour, uint32_t source) {
    if (number < 0 || count_ == kMost) return;
    for (int i = 0; i < count_; ++i)
      if (candidates_[size_t(i)].colour == colour) return;
    candidates_[size_t(count_++)] = {number, colour, source};
  }

  void code_hit(int64_t y, int64_t x, int rank, int &is_hit) {
    const Around *here = &around_[size_t(place(y, x))];
    if (!is_graphic_ && !rank) hash(here);  // else that was done
    const uint32_t hits =
        ((uint32_t(here[-1].hit) * 7 + here[-stride_].hit) * 7 + here[-stride_ + 1].hit) * 7 + here[-stride_ - 1].hit;
    const auto number = uint32_t(rank);
    const uint32_t from = number * kSources + candidates_[size_t(rank)].source;
    const uint32_t alike = number * kPatterns + pattern_;
    const std::array models{&models_[from * kTimes + times_], &models_[kFirst[0] + alike],
                            &models_[kFirst[1] + (mixed(near_hash_, number) >> (32 - kHashBits))],
                            &models_[kFirst[2] + number * kHits + hits],
                            &models_[kFirst[3] + from * kPatterns + pattern_]};
    code_bit(bits_, models, kQuick, is_hit);
  }

  const int64_t width_, stride_;
  std::vector<Around> around_;
  std::vector<Seen> far_, near_;  // under hashes of twelve pixels around, and of six
  std::vector<BitModel> models_;
  std::vector<BitModel> chances_;  // that a pixel is one of its candidates
  BitModel usual_;                 // the same of all pixels
  Bits &bits_;
  // Of the pixel that was looked at last:
  std::array<Candidate, kMost> candidates_;
  int count_ = 0;
  bool is_graphic_ = false;
  BitModel *chance_ = nullptr;
  uint32_t far_hash_ = 0, near_hash_ = 0, pattern_ = 0, times_ = 0;
  uint8_t hit_ = 0;
};

}  // namespace sgi
