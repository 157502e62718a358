#include "rdoq/texture_search.hpp"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>

#include "base/thread_pool.hpp"
#include "bitstream/texture_coding.hpp"
#include "bitstream/texture_stream.hpp"
#include "rdoq/texture_root_search.hpp"

namespace sgi {

namespace {

// Superblocks after which the lower one of two rows of them gets the models of the upper one
// (docs/notes/2026-11-encode-speed.md).
constexpr int64_t kStale = 8;

TextureField field_for(const TextureAmplitudes &amplitudes) {
  return empty_field(amplitudes.layout.width, amplitudes.layout.height, amplitudes.channels);
}

// Codes superblocks in order. Of two rows of them the upper one is decided on and coded one by one, and the lower one
// decided on meanwhile: its neighbours above are known, and its models a row behind, however many threads there are.
class TextureSearch {
 public:
  TextureSearch(BitModels &models, const TextureSought &sought)
      : found_{field_for(sought.amplitudes), {}, {}}, models_(models), coding_(models, found_.field, taker_),
        sought_(sought) {}

  TextureFound run() {
    const int64_t side = 1 << kTextureRoot, height = sought_.amplitudes.layout.height;
    const int64_t across = found_.field.width / side;
    upper_.resize(size_t(across)), lower_.resize(size_t(across));
    for (int64_t y = 0; y < height; y += 2 * side) {
      const bool both = y + side < height;
      decided_ = 0, failed_ = false, snapshots_.clear();
      parallel_for(both ? 2 : 1, sought_.amplitudes.threads,
                   [&](int64_t row) { row ? decide_lower(y + side) : decide_upper(y, both); });
      for (int64_t i = 0; both && i < across; ++i) code_root({i * side, y + side, kTextureRoot}, lower_[size_t(i)]);
    }
    return std::move(found_);
  }

 private:
  void decide_upper(int64_t y, bool both) {
    try {
      TextureRootSearch search(sought_, found_.field);
      for (size_t i = 0; i < upper_.size(); ++i) {
        const TextureCell root{int64_t(i) << kTextureRoot, y, kTextureRoot};
        const bool shown = both && i % kStale == 0;
        const auto models = shown ? std::make_shared<const BitModels>(models_) : nullptr;
        search.decide(root, models_, upper_[i]);
        code_root(root, upper_[i]);
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
    TextureRootSearch search(sought_, found_.field);
    for (size_t i = 0; i < lower_.size(); ++i) {
      std::shared_ptr<const BitModels> models;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        progress_.wait(lock, [&] { return failed_ || decided_ > i; });
        if (failed_) return;
        models = snapshots_[i / kStale];
      }
      search.decide({int64_t(i) << kTextureRoot, y, kTextureRoot}, *models, lower_[i]);
    }
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
    ScaledCell scaled(sought_, field(), cell);
    for (int channel = 0; channel < field().channels; ++channel) {
      for (int row = 0; row < side; ++row)
        std::copy_n(field().at(channel, cell) + row * field().width, side, &values[row * side]);
      const int last = last_diagonal(values.data(), cell.side(), cell.log);
      coding_.block(cell, channel, last, values);
      if (last >= 0) account(cell, scaled.of(channel), values, last);
    }
  }

  void account(const TextureCell &cell, const CellValues<float> &scaled, const CellSymbols &values, int last) {
    QuantizerState state;
    for (const Frequency &at : texture_scan(cell.log)) {
      if (at.diagonal() > last) break;
      const int symbol = values[at.index];
      if (symbol) {
        const size_t group = std::min(std::abs(symbol), 3) - 1;
        found_.count[group] += 1, found_.excess[group] += std::abs(scaled[at.index]) - state.magnitude(symbol);
      }
      state = state.after(symbol);
    }
  }

  TextureFound found_;
  BitModels &models_;
  BitTaker taker_;
  TextureCoding<BitTaker> coding_;
  const TextureSought &sought_;
  std::vector<std::vector<int>> upper_, lower_;  // what was decided of the roots of both rows
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
                            const TextureSteps &steps, const TextureSettings &settings, const uint8_t *division) {
  const TextureSought sought{amplitudes, contrast, steps, settings, division};
  return TextureSearch(models, sought).run();
}

double estimate_texture(const TextureAmplitudes &amplitudes, const int8_t *contrast, const TextureSteps &steps,
                        const TextureSettings &settings) {
  const TextureSought sought{amplitudes, contrast, steps, settings, nullptr};
  TextureField field = field_for(amplitudes);
  TextureRootSearch search(sought, field);
  double sum = 0;
  each_root(amplitudes.width, amplitudes.height, [&](const TextureCell &root) { sum += search.estimated(root); });
  return sum;
}

}  // namespace sgi
