#include "rdoq/texture_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/thread_pool.hpp"
#include "bitstream/texture_coding.hpp"
#include "bitstream/texture_stream.hpp"
#include "rdoq/texture_transform.hpp"
#include "rdoq/texture_trellis.hpp"

namespace sgi {

namespace {

constexpr float kImpossible = std::numeric_limits<float>::infinity();

// What a symbol costs about: the squared error that it leaves, in squared steps, its bits where the amplitude is a
// step, and their growth for each octave of the squared amplitude; bits of a cell beside its symbols.
constexpr float kLeft = 0.05f, kSymbolBits = 2.7f, kOctaveBits = 0.68f, kCellBits = 4;
// A cell is tried whole, or divided, where the estimate says that it costs this much more than the other at most.
constexpr float kDoubt = 1.06f;

// log2 of a positive value, within 0.05.
float about_log2(float value) {
  int32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return float(bits) * 0x1p-23f - 126.96f;
}

// A cell's cost without texture, and estimates of it as one cell and divided.
struct Prospect {
  float nothing = 0, whole = 0, parts = kImpossible;
};

class TextureSearch {
 public:
  TextureSearch(BitModels &models, const TextureAmplitudes &amplitudes, const int8_t *contrast,
                const TextureSteps &steps, const TextureSettings &settings)
      : found_{empty_field(amplitudes.tile_width, amplitudes.tile_height, amplitudes.channels, true), 0, {}, {}, {}},
        models_(models), coding_(models, found_.field, counter_), amplitudes_(amplitudes), contrast_(contrast),
        steps_(steps), settings_(settings) {}

  TextureFound run() {
    each_root(amplitudes_.tile_width, amplitudes_.tile_height, [&](const TextureCell &root) {
      plan_.clear();
      look_ahead(root);
      found_.cost.push_back(decide(root, plan_));
      at_ = 0;
      code_root(root);
    });
    found_.bits = counter_.account.total();
    return std::move(found_);
  }

 private:
  TextureField &field() { return found_.field; }
  int contrast(const TextureCell &cell) const {
    return settings_.has_contrast ? contrast_[found_.field.root(cell.x, cell.y)] : 0;
  }
  bool seen(const TextureCell &cell) const {
    return cell.x < amplitudes_.tile_width && cell.y < amplitudes_.tile_height;
  }
  float cost(const BitContext &context, int bit) const {
    return settings_.lambda * bit_cost(models_.predict(context).one, bit);
  }

  // |amplitudes| of a cell in steps.
  void scale(const TextureCell &cell, int channel, CellValues<float> &scaled) const {
    const float *from = amplitudes_.of(cell, channel), step = steps_.of(channel, contrast(cell));
    const float *growth = steps_.growth(channel, cell.log);
    for (int v = 0; v < cell.side(); ++v)
      for (int u = 0; u < cell.side(); ++u)
        scaled[v * cell.side() + u] = std::abs(from[v * found_.field.width + u]) / (step * growth[v * cell.side() + u]);
  }

  // Symbols of a channel and their cost.
  void choose(const TextureCell &cell, int channel, Choice &choice) const {
    static thread_local CellValues<float> scaled;
    scale(cell, channel, scaled);
    choose_block(models_, found_.field, cell, channel, settings_.lambda, scaled, choice);
    const float *signs = amplitudes_.of(cell, channel);
    for (int v = 0; v < cell.side(); ++v)
      for (int u = 0; u < cell.side(); ++u)
        if (signs[v * found_.field.width + u] < 0) choice.values[v << cell.log | u] *= -1;
  }

  // All channels of a cell with texture, put into the field.
  float choose_leaf(const TextureCell &cell, std::vector<Choice> &choices) {
    field().mark(cell, cell.log);
    float sum = 0;
    bool any = false;
    for (int channel = 0; channel < field().channels; ++channel) {
      choose(cell, channel, choices[channel]);
      field().set(cell, channel, choices[channel].values.data(), choices[channel].last);
      sum += choices[channel].cost;
      any |= choices[channel].last >= 0;
    }
    return any ? sum : kImpossible;
  }

  // What a cell would cost with symbols that are coded one by one, and without any.
  Prospect estimate(const TextureCell &cell) const {
    static thread_local CellValues<float> scaled;
    const float least = kLeft + settings_.lambda * kSymbolBits, growth = settings_.lambda * kOctaveBits;
    float sum = settings_.lambda * kCellBits;
    double nothing = 0;
    for (int channel = 0; channel < found_.field.channels; ++channel) {
      scale(cell, channel, scaled);
      for (int i = 0; i < cell.side() * cell.side(); ++i) {
        const float square = scaled[i] * scaled[i];
        nothing += square;
        sum += std::min(square, least + growth * std::max(about_log2(square), -2.0f));
      }
    }
    return {float(nothing), sum};
  }

  Prospect &prospect(const TextureCell &cell) {
    const int64_t within = (1 << kTextureRoot) - 1, across = 1 << (kTextureRoot - cell.log);
    return prospects_[cell.log - kTextureLeast]
                     [((cell.y & within) >> cell.log) * across + ((cell.x & within) >> cell.log)];
  }

  // Estimates a node and all below; what the cheapest division costs.
  float look_ahead(const TextureCell &cell) {
    Prospect &found = prospect(cell);
    found = estimate(cell);
    if (cell.log == kTextureLeast) return found.whole;
    found.parts = 0;
    for (int number = 0; number < 4; ++number)
      if (seen(cell.child(number))) found.parts += look_ahead(cell.child(number));
    return std::min(found.whole, found.parts);
  }

  // What is best for a node and below; the field shows it afterwards, and `plan` has all nodes in coding order.
  float decide(const TextureCell &cell, std::vector<int> &plan) {
    const BitContext textured = cell_context(field(), cell, CellBit::kTextured);
    const BitContext split = cell_context(field(), cell, CellBit::kSplit);
    const bool splits = cell.log > kTextureLeast;
    const auto [squares, whole, divided] = prospect(cell);
    std::vector<Choice> choices(field().channels);
    float leaf = kImpossible;
    if (whole <= kDoubt * divided)
      leaf = choose_leaf(cell, choices) + cost(textured, 1) + (splits ? cost(split, 0) : 0);
    const float nothing = squares + cost(textured, 0);
    const size_t begin = plan.size();
    plan.push_back(leaf < nothing ? kTextureLeaf : kNoTexture);
    float best = std::min(leaf, nothing);
    if (splits && divided <= kDoubt * whole) {
      std::vector<int> parts{kSplitNode};
      float sum = cost(textured, 1) + cost(split, 1);
      for (int number = 0; number < 4 && sum < best; ++number) {
        const TextureCell child = cell.child(number);
        if (seen(child))
          sum += decide(child, parts);
        else
          field().clear(child);
      }
      if (sum < best && std::find(parts.begin(), parts.end(), kTextureLeaf) != parts.end()) {
        plan.resize(begin);
        plan.insert(plan.end(), parts.begin(), parts.end());
        return sum;
      }
    }
    // What the parts left in the field is painted over.
    if (plan[begin] == kNoTexture) {
      field().clear(cell);
      return best;
    }
    field().mark(cell, cell.log);
    for (int channel = 0; channel < field().channels; ++channel)
      field().set(cell, channel, choices[channel].values.data(), choices[channel].last);
    return best;
  }

  void code_root(const TextureCell &root) {
    const int what = coding_.node(root, plan_[at_++]);
    if (what != kNoTexture && settings_.has_contrast)
      field().contrast[field().root(root.x, root.y)] = int8_t(coding_.contrast(contrast(root)));
    code_inside(root, what);
  }

  // The field has what was decided.
  void code_inside(const TextureCell &cell, int what) {
    if (what == kTextureLeaf) return code_leaf(cell);
    for (int number = 0; number < 4 && what == kSplitNode; ++number) {
      const TextureCell child = cell.child(number);
      if (seen(child)) code_inside(child, coding_.node(child, plan_[at_++]));
    }
  }

  // A choice made with models that have seen all before the root; again with those that have seen more, it costs the
  // same within 0.01 % and a quarter of the time.
  void code_leaf(const TextureCell &cell) {
    const int side = cell.side();
    CellSymbols values;
    for (int channel = 0; channel < field().channels; ++channel) {
      for (int row = 0; row < side; ++row)
        std::copy_n(field().at(channel, cell) + row * field().width, side, &values[row * side]);
      coding_.block(cell, channel, last_diagonal(values.data(), cell.log), values);
      account(cell, channel, values);
    }
  }

  void account(const TextureCell &cell, int channel, const CellSymbols &values) {
    static thread_local CellValues<float> scaled;
    scale(cell, channel, scaled);
    QuantizerState state;
    for (const int i : texture_scan(cell.log)) {
      const int symbol = values[i];
      if (symbol) {
        const size_t group = std::min(std::abs(symbol), 3) - 1;
        found_.count[group] += 1, found_.excess[group] += scaled[i] - state.magnitude(symbol);
      }
      state = state.after(symbol);
    }
  }

  TextureFound found_;
  BitModels &models_;
  BitCounter counter_;
  TextureCoding<BitCounter> coding_;
  const TextureAmplitudes &amplitudes_;
  const int8_t *contrast_;
  const TextureSteps &steps_;
  const TextureSettings settings_;
  std::array<std::array<Prospect, 1 << 2 * (kTextureRoot - kTextureLeast)>, kTextureSizes> prospects_;  // of a root
  std::vector<int> plan_;
  size_t at_ = 0;
};

}  // namespace

TextureAmplitudes::TextureAmplitudes(const float *planes, int channels_, int64_t tile_width_, int64_t tile_height_,
                                     int threads)
    : channels(channels_), tile_width(tile_width_), tile_height(tile_height_),
      width(texture_roots(tile_width_) << kTextureRoot), height(texture_roots(tile_height_) << kTextureRoot) {
  for (auto &plane : sizes_) plane.resize(size_t(width * height * channels));
  parallel_for(kTextureSizes * channels, threads, [&](int64_t job) {
    const int64_t size = job / channels, at = job % channels * width * height;
    analyse_texture(planes + at, width, height, int(size) + kTextureLeast, sizes_[size].data() + at);
  });
}

TextureFound search_texture(BitModels models, const TextureAmplitudes &amplitudes, const int8_t *contrast,
                            const TextureSteps &steps, const TextureSettings &settings) {
  return TextureSearch(models, amplitudes, contrast, steps, settings).run();
}

}  // namespace sgi
