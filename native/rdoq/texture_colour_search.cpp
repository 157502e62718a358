#include "rdoq/texture_colour_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <vector>

#include "base/thread_pool.hpp"
#include "rdoq/texture_estimate.hpp"
#include "rdoq/texture_transform.hpp"

namespace sgi {

namespace {

// How colours are chosen, and what small shares gain: docs/notes/2026-11-texture-colours.md.
constexpr int64_t kRoot = 1 << kTextureRoot, kMaxRoots = 96;
constexpr int kLog = 4;                       // of the cells that are looked at
constexpr float kColourBits = 16;             // that colours take
constexpr float kShown = 0.65f;               // steps from which on the first channel has symbols
constexpr float kMatters = 0.16f;             // squared steps below which an amplitude is nothing in any colours
constexpr int kMinShare = 6, kMaxShare = 31;  // smaller ones gain a few thousandths, and the estimate flatters them
constexpr int kTurns = 16, kRounds = 2;
constexpr std::array<int, 3> kBands{4, 8, 14};  // diagonals at which bands of frequencies begin

using Costs = std::array<float, kBands.size() + 1>;  // by band

float sum_of(const Costs &costs) { return std::accumulate(costs.begin(), costs.end(), 0.0f); }

class ColourSearch {
 public:
  ColourSearch(const TextureSteps &steps, float lambda)
      : steps_(steps), estimate_(lambda), finer_{1 / steps.of(1, 0), 1 / steps.of(2, 0)} {}

  // Adds the amplitudes [3, height, width] of a root.
  void add(const float *amplitudes, int64_t plane, int64_t width, int contrast) {
    const float *growth = steps_.growth(1, kLog), *first_growth = steps_.growth(0, kLog);
    const float scale = std::exp2(-float(contrast) / 4), first_step = steps_.of(0, contrast);
    constexpr int kSide = 1 << kLog;
    for (int64_t y = 0; y < kRoot; ++y)
      for (int64_t x = 0; x < kRoot; ++x) {
        const int64_t i = (y % kSide) * kSide + x % kSide;
        const float *at = amplitudes + y * width + x;
        const float by = scale / growth[i], one = at[plane] * by, two = at[2 * plane] * by;
        const float first = std::abs(at[0]) < kShown * first_step * first_growth[i] ? 0 : at[0] * by;
        const float u = one * finer_[0], v = two * finer_[1];
        if (first == 0 && u * u + v * v < kMatters) continue;
        const int64_t diagonal = y % kSide + x % kSide;
        const auto band = std::upper_bound(kBands.begin(), kBands.end(), diagonal) - kBands.begin();
        bands_[size_t(band)].push_back({first, one, two});
      }
  }

  // `price`: of other colours than those of the picture.
  TextureColours cheapest(float price) {
    TextureColours best;
    least_ = sum_of(costs(best)) - price;
    for (int round = 0; round < kRounds; ++round) {
      const float before = least_;
      for (int turn = 0; turn < kTurns; ++turn) take({best.shares, turn}, best);
      unshared_ = costs({TextureColours().shares, best.turn});
      for (size_t which : {0, 1}) {
        for (int share : {-24, -16, -12, -8, -6, 0, 6, 8, 12, 16, 24}) take_share(which, share, best);
        const int near = best.shares[which] - TextureColours::kSameShare;
        for (int by : {-2, 2}) take_share(which, near + by, best);
        const int nearer = best.shares[which] - TextureColours::kSameShare;
        for (int by : {-1, 1}) take_share(which, nearer + by, best);
      }
      if (least_ == before) break;
    }
    return best;
  }

 private:
  void take(const TextureColours &other, TextureColours &best) {
    const float found = sum_of(costs(other));
    if (found < least_) least_ = found, best = other;
  }

  // A share must pay, or cost nothing, in each band of frequencies: where it does not hold, colours appear along the
  // edges of what is grey.
  void take_share(size_t which, int share, TextureColours &best) {
    if (std::abs(share) > kMaxShare || (share != 0 && std::abs(share) < kMinShare)) return;
    TextureColours other = best;
    other.shares[which] = TextureColours::kSameShare + share;
    const Costs found = costs(other);
    for (size_t band = 0; band < found.size(); ++band)
      if (found[band] > unshared_[band]) return;
    if (sum_of(found) < least_) least_ = sum_of(found), best = other;
  }

  Costs costs(const TextureColours &colours) const {
    const std::array<double, 9> matrix = colours.matrix();
    const float one_share = float(matrix[3]), two_share = float(matrix[6]);
    const float cosine = float(matrix[4]), sine = float(matrix[7]);
    Costs found{};
    for (size_t band = 0; band < found.size(); ++band) {
      double sum = 0;
      for (const auto &[first, one, two] : bands_[band]) {
        const float own_one = one - one_share * first, own_two = two - two_share * first;
        const float u = (cosine * own_one + sine * own_two) * finer_[0];
        const float v = (cosine * own_two - sine * own_one) * finer_[1];
        sum += estimate_.of(u * u) + estimate_.of(v * v);
      }
      found[band] = float(sum);
    }
    return found;
  }

  const TextureSteps &steps_;
  const SymbolEstimate estimate_;
  const std::array<float, 2> finer_;
  // By band, of the three channels, without growth and contrast of the last two.
  std::array<std::vector<std::array<float, 3>>, kBands.size() + 1> bands_;
  Costs unshared_{};  // of the best turn without shares
  float least_ = 0;
};

}  // namespace

TextureColours cheapest_colours(const float *planes, int64_t width, int64_t height, const int8_t *contrast,
                                const TextureSteps &steps, float lambda, bool separate, int threads) {
  const int64_t plane = width * height, across = width / kRoot, roots = across * (height / kRoot);
  std::vector<float> amplitudes(size_t(3 * plane));
  parallel_for(3, threads, [&](int64_t channel) {
    analyse_texture(planes + channel * plane, width, height, {width, height, separate}, kLog,
                    &amplitudes[channel * plane]);
  });
  ColourSearch search(steps, lambda);
  const int64_t looked = std::min(roots, kMaxRoots);
  for (int64_t i = 0; i < looked; ++i) {
    const int64_t root = i * roots / looked, at = root / across * kRoot * width + root % across * kRoot;
    search.add(&amplitudes[at], plane, width, contrast[root]);
  }
  return search.cheapest(lambda * kColourBits * float(looked) / float(roots));
}

}  // namespace sgi
