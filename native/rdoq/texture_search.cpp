#include "rdoq/texture_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/thread_pool.hpp"
#include "bitstream/texture_coding.hpp"
#include "bitstream/texture_stream.hpp"
#include "rdoq/texture_transform.hpp"

namespace sgi {

namespace {

constexpr float kImpossible = std::numeric_limits<float>::infinity();
constexpr int kMostSymbol = 16000;

// What a channel of a cell would be coded as, and its cost.
struct Choice {
  CellSymbols values;
  int last = -1;
  float cost = kImpossible;
};

class TextureSearch {
 public:
  TextureSearch(BitModels &models, const TextureAmplitudes &amplitudes, const int8_t *contrast,
                const TextureSteps &steps, const TextureSettings &settings)
      : found_{TextureField(texture_roots(amplitudes.tile_width), texture_roots(amplitudes.tile_height),
                            amplitudes.channels),
               0,
               {},
               {},
               {}},
        models_(models), coding_(models, found_.field, counter_), amplitudes_(amplitudes), contrast_(contrast),
        steps_(steps), settings_(settings) {}

  TextureFound run() {
    each_root(amplitudes_.tile_width, amplitudes_.tile_height, [&](const TextureCell &root) {
      plan_.clear();
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

  float extent_cost(const ExtentContext &context, int log, int value) const {
    float sum = 0;
    for (int node = 1, place = log; place >= 0; --place) {
      sum += cost(context.at(node), value >> place & 1);
      node = 2 * node + (value >> place & 1);
    }
    return sum;
  }

  // The magnitude at a frequency that costs least; adds its cost.
  int best_magnitude(const BitContext &context, float scaled, float &total) const {
    const int nearest = std::min(int(scaled + 0.5f), kMostSymbol);
    std::array<int32_t, kMagnitudeBits> ones;
    int known = 0, best = 0;
    float least = kImpossible;
    const auto try_out = [&](int magnitude) {
      float sum = (scaled - float(magnitude)) * (scaled - float(magnitude)) + (magnitude ? settings_.lambda : 0);
      for (int j = 0; j < kMagnitudeBits; ++j) {
        if (j == known) ones[known++] = models_.predict(SymbolContext::later(context, j)).one;
        sum += settings_.lambda * bit_cost(ones[j], magnitude > j);
        if (magnitude <= j) break;
      }
      if (magnitude >= kMagnitudeBits)
        sum += settings_.lambda * float(2 * std::ilogb(float(magnitude - kMagnitudeBits + 1)) + 1);
      if (sum < least) least = sum, best = magnitude;
    };
    for (int magnitude = nearest; magnitude >= std::max(0, nearest - 2); --magnitude) try_out(magnitude);
    if (nearest > 2) try_out(0);
    total += least;
    return best;
  }

  // Symbols of a channel, frequency by frequency, and then up to the diagonal where it is best to stop.
  void choose(const TextureCell &cell, int channel, Choice &choice) const {
    static thread_local CellValues<float> scaled;
    scale(cell, channel, scaled);
    const int side = cell.side();
    const std::vector<int16_t> &scan = texture_scan(cell.log);
    float beyond = 0;  // squared error of what has not been chosen yet
    int most = -1;
    for (const int index : scan) {
      beyond += scaled[index] * scaled[index];
      if (scaled[index] > 0.5f) most = (index & (side - 1)) + (index >> cell.log);
    }
    const ExtentContext extent(found_.field, cell, channel);
    KnownMagnitudes known;
    known.clear(side);
    choice.values.fill(0);
    choice.last = -1, choice.cost = beyond + extent_cost(extent, cell.log, 0);
    if (most < 0) return;
    const SymbolContext context(found_.field, cell, channel, most);
    float chosen = 0;
    size_t at = 0;
    for (int diagonal = 0; diagonal <= most; ++diagonal) {
      bool any = false;
      for (; at < scan.size() && (scan[at] & (side - 1)) + (scan[at] >> cell.log) == diagonal; ++at) {
        const int index = scan[at];
        beyond -= scaled[index] * scaled[index];
        const int u = index & (side - 1), v = index >> cell.log;
        const int magnitude = best_magnitude(context.at(known, u, v), scaled[index], chosen);
        if (!magnitude) continue;
        choice.values[index] = int16_t(magnitude);
        known.set(u, v, magnitude);
        any = true;
      }
      if (!any) continue;
      const float sum = chosen + std::max(beyond, 0.0f) + extent_cost(extent, cell.log, diagonal + 1);
      if (sum < choice.cost) choice.cost = sum, choice.last = diagonal;
    }
    const float *signs = amplitudes_.of(cell, channel);
    for (const int index : scan) {
      const int u = index & (side - 1), v = index >> cell.log;
      if (u + v > choice.last) choice.values[index] = 0;
      if (signs[v * found_.field.width + u] < 0) choice.values[index] = int16_t(-choice.values[index]);
    }
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

  float cost_of_nothing(const TextureCell &cell) const {
    static thread_local CellValues<float> scaled;
    double sum = 0;
    for (int channel = 0; channel < found_.field.channels; ++channel) {
      scale(cell, channel, scaled);
      for (int i = 0; i < cell.side() * cell.side(); ++i) sum += scaled[i] * scaled[i];
    }
    return float(sum);
  }

  // What is best for a node and below; the field shows it afterwards, and `plan` has all nodes in coding order.
  float decide(const TextureCell &cell, std::vector<int> &plan) {
    const BitContext textured = cell_context(field(), cell, CellBit::kTextured);
    const BitContext split = cell_context(field(), cell, CellBit::kSplit);
    const bool splits = cell.log > kTextureLeast;
    std::vector<Choice> choices(field().channels);
    float leaf = choose_leaf(cell, choices) + cost(textured, 1) + (splits ? cost(split, 0) : 0);
    const float nothing = cost_of_nothing(cell) + cost(textured, 0);
    const size_t begin = plan.size();
    plan.push_back(leaf < nothing ? kTextureLeaf : kNoTexture);
    float best = std::min(leaf, nothing);
    if (splits) {
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

  void code_inside(const TextureCell &cell, int what) {
    if (what == kNoTexture) return field().clear(cell);
    if (what == kTextureLeaf) return code_leaf(cell);
    for (int number = 0; number < 4; ++number) {
      const TextureCell child = cell.child(number);
      code_inside(child, seen(child) ? coding_.node(child, plan_[at_++]) : kNoTexture);
    }
  }

  // Chooses once more, with models that have seen all before, and codes. A leaf has symbols: where all choices came to
  // none, the last one that had some is kept.
  void code_leaf(const TextureCell &cell) {
    field().mark(cell, cell.log);
    int kept = field().channels - 1;
    while (kept > 0 && !decided(cell, kept)) --kept;
    Choice choice;
    bool any = false;
    for (int channel = 0; channel < field().channels; ++channel) {
      choose(cell, channel, choice);
      if (channel == kept && !any && choice.last < 0) recall(cell, channel, choice);
      coding_.block(cell, channel, choice.last, choice.values);
      field().set(cell, channel, choice.values.data(), choice.last);
      account(cell, channel, choice);
      any = any || choice.last >= 0;
    }
  }

  bool decided(const TextureCell &cell, int channel) const {
    return found_.field.extent[channel * found_.field.unit_count() + found_.field.unit(cell.x, cell.y)] > 0;
  }

  void recall(const TextureCell &cell, int channel, Choice &choice) {
    for (int row = 0; row < cell.side(); ++row)
      std::copy_n(field().at(channel, cell) + row * field().width, cell.side(), &choice.values[row * cell.side()]);
    choice.last = last_diagonal(choice.values.data(), cell.log);
  }

  void account(const TextureCell &cell, int channel, const Choice &choice) {
    static thread_local CellValues<float> scaled;
    scale(cell, channel, scaled);
    for (int i = 0; i < cell.side() * cell.side(); ++i) {
      const int magnitude = std::abs(choice.values[i]);
      if (!magnitude) continue;
      const size_t group = std::min(magnitude, 3) - 1;
      found_.count[group] += 1, found_.excess[group] += scaled[i] - float(magnitude);
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
