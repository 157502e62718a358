#include "rdoq/texture_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "base/thread_pool.hpp"
#include "bitstream/texture_coding.hpp"
#include "bitstream/texture_stream.hpp"
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

constexpr int64_t kStale = 8;  // roots in which the lower one of two rows of roots gets the models of the upper one

// What every part of a search reads.
struct Sought {
  const TextureAmplitudes &amplitudes;
  const int8_t *contrasts;
  const TextureSteps &steps;
  const TextureSettings settings;

  int contrast(const TextureField &field, const TextureCell &cell) const {
    return settings.has_contrast ? contrasts[field.root(cell.x, cell.y)] : 0;
  }
  bool seen(const TextureCell &cell) const { return cell.x < amplitudes.tile_width && cell.y < amplitudes.tile_height; }

  // |amplitudes| of a cell in steps.
  void scale(const TextureField &field, const TextureCell &cell, int channel, CellValues<float> &scaled) const {
    const float *from = amplitudes.of(cell, channel), step = steps.of(channel, contrast(field, cell));
    const float *growth = steps.growth(channel, cell.log);
    for (int v = 0; v < cell.side(); ++v)
      for (int u = 0; u < cell.side(); ++u)
        scaled[v * cell.side() + u] = std::abs(from[v * field.width + u]) / (step * growth[v * cell.side() + u]);
  }
};

// Decides on one root after the other, by models that learn nothing from it.
class RootSearch {
 public:
  RootSearch(const Sought &sought, TextureField &field) : sought_(sought), field_(field) {}

  // What is best for a root costs so much; the field shows it afterwards, and `plan` has all nodes in coding order.
  float decide_root(const TextureCell &root, const BitModels &models, std::vector<int> &plan) {
    models_ = &models;
    plan.clear();
    look_ahead(root);
    return decide(root, plan);
  }

 private:
  TextureField &field() { return field_; }
  bool seen(const TextureCell &cell) const { return sought_.seen(cell); }
  float cost(const BitContext &context, int bit) const {
    return sought_.settings.lambda * bit_cost(models_->predict(context).one, bit);
  }

  // Symbols of a channel and their cost.
  void choose(const TextureCell &cell, int channel, Choice &choice) const {
    static thread_local CellValues<float> scaled;
    sought_.scale(field_, cell, channel, scaled);
    choose_block(*models_, field_, cell, channel, sought_.settings.lambda, scaled, choice);
    const float *signs = sought_.amplitudes.of(cell, channel);
    for (int v = 0; v < cell.side(); ++v)
      for (int u = 0; u < cell.side(); ++u)
        if (signs[v * field_.width + u] < 0) choice.values[v << cell.log | u] *= -1;
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
    const float least = kLeft + sought_.settings.lambda * kSymbolBits, growth = sought_.settings.lambda * kOctaveBits;
    float sum = sought_.settings.lambda * kCellBits;
    double nothing = 0;
    for (int channel = 0; channel < field_.channels; ++channel) {
      sought_.scale(field_, cell, channel, scaled);
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

  const Sought &sought_;
  TextureField &field_;
  const BitModels *models_ = nullptr;
  std::array<std::array<Prospect, 1 << 2 * (kTextureRoot - kTextureLeast)>, kTextureSizes> prospects_;  // of a root
};

// Codes roots in order. Of two rows of roots the upper one is decided on and coded root by root, and the lower one
// decided on meanwhile: its neighbours above are known, and its models a row behind, however many threads there are.
class TextureSearch {
 public:
  TextureSearch(BitModels &models, const Sought &sought)
      : found_{
            empty_field(sought.amplitudes.tile_width, sought.amplitudes.tile_height, sought.amplitudes.channels, true),
            0,
            {},
            {},
            {}},
        models_(models), coding_(models, found_.field, counter_), sought_(sought) {}

  TextureFound run() {
    const int64_t side = 1 << kTextureRoot, height = sought_.amplitudes.tile_height;
    const int64_t across = found_.field.width / side;
    upper_.resize(size_t(across)), lower_.resize(size_t(across));
    for (int64_t y = 0; y < height; y += 2 * side) {
      const bool both = y + side < height;
      decided_ = 0, failed_ = false, snapshots_.clear();
      parallel_for(both ? 2 : 1, sought_.amplitudes.threads,
                   [&](int64_t row) { row ? decide_lower(y + side) : decide_upper(y, both); });
      take(upper_);
      if (!both) continue;
      for (int64_t i = 0; i < across; ++i) code_root({i * side, y + side, kTextureRoot}, lower_[size_t(i)].plan);
      take(lower_);
    }
    found_.bits = counter_.account.total();
    return std::move(found_);
  }

 private:
  struct Decision {
    std::vector<int> plan;
    float cost;
  };

  void decide_upper(int64_t y, bool both) {
    try {
      RootSearch search(sought_, found_.field);
      for (size_t i = 0; i < upper_.size(); ++i) {
        const TextureCell root{int64_t(i) << kTextureRoot, y, kTextureRoot};
        const bool shown = both && i % kStale == 0;
        const auto models = shown ? std::make_shared<const BitModels>(models_) : nullptr;
        upper_[i].cost = search.decide_root(root, models_, upper_[i].plan);
        code_root(root, upper_[i].plan);
        const std::lock_guard<std::mutex> lock(mutex_);
        if (shown) snapshots_.push_back(models);
        decided_ = i + 1;
        progress_.notify_one();
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failed_ = true;
      progress_.notify_one();
      throw;
    }
  }

  void decide_lower(int64_t y) {
    RootSearch search(sought_, found_.field);
    for (size_t i = 0; i < lower_.size(); ++i) {
      std::shared_ptr<const BitModels> models;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        progress_.wait(lock, [&] { return failed_ || decided_ > i; });
        if (failed_) return;
        models = snapshots_[i / kStale];
      }
      lower_[i].cost = search.decide_root({int64_t(i) << kTextureRoot, y, kTextureRoot}, *models, lower_[i].plan);
    }
  }

  void take(const std::vector<Decision> &row) {
    for (const Decision &root : row) found_.cost.push_back(root.cost);
  }

  TextureField &field() { return found_.field; }

  void code_root(const TextureCell &root, const std::vector<int> &plan) {
    plan_ = &plan, at_ = 0;
    const int what = coding_.node(root, (*plan_)[at_++]);
    if (what != kNoTexture && sought_.settings.has_contrast)
      field().contrast[field().root(root.x, root.y)] = int8_t(coding_.contrast(sought_.contrast(field(), root)));
    code_inside(root, what);
  }

  // The field has what was decided.
  void code_inside(const TextureCell &cell, int what) {
    if (what == kTextureLeaf) return code_leaf(cell);
    for (int number = 0; number < 4 && what == kSplitNode; ++number) {
      const TextureCell child = cell.child(number);
      if (sought_.seen(child)) code_inside(child, coding_.node(child, (*plan_)[at_++]));
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
    sought_.scale(field(), cell, channel, scaled);
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
  const Sought &sought_;
  std::vector<Decision> upper_, lower_;  // of the roots of both rows
  const std::vector<int> *plan_ = nullptr;
  size_t at_ = 0;

  std::mutex mutex_;
  std::condition_variable progress_;
  size_t decided_ = 0;  // roots of the upper row
  bool failed_ = false;
  std::vector<std::shared_ptr<const BitModels>> snapshots_;  // before each kStale roots of it
};

}  // namespace

TextureFound search_texture(BitModels models, const TextureAmplitudes &amplitudes, const int8_t *contrast,
                            const TextureSteps &steps, const TextureSettings &settings) {
  const Sought sought{amplitudes, contrast, steps, settings};
  return TextureSearch(models, sought).run();
}

}  // namespace sgi
