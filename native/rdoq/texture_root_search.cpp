#include "rdoq/texture_root_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rdoq/texture_estimate.hpp"

namespace sgi {

namespace {

constexpr float kImpossible = std::numeric_limits<float>::infinity();

constexpr float kCellBits = 4;  // of a cell beside its symbols, about

}  // namespace

void TextureSought::scale(const TextureField &field, const TextureCell &cell, int channel,
                          CellValues<float> &scaled) const {
  const float *from = amplitudes.of(cell, channel), step = steps.of(channel, contrast(field, cell));
  const float *growth = steps.growth(channel, cell.log);
  for (int v = 0; v < cell.side(); ++v)
    for (int u = 0; u < cell.side(); ++u)
      scaled[v * cell.side() + u] = from[v * field.width + u] / (step * growth[v * cell.side() + u]);
}

const CellValues<float> &ScaledCell::of(int channel) {
  sought_.scale(field_, cell_, channel, scaled_);
  const float share = channel ? sought_.amplitudes.share(channel) : 0;
  if (share == 0) return scaled_;
  if (!has_left_) find_left();
  const int contrast = sought_.contrast(field_, cell_), count = cell_.side() * cell_.side();
  const float ratio = share * sought_.steps.of(0, contrast) / sought_.steps.of(channel, contrast);
  const float *ours = sought_.steps.growth(channel, cell_.log), *theirs = sought_.steps.growth(0, cell_.log);
  for (int i = 0; i < count; ++i) scaled_[i] += ratio * left_[i] * theirs[i] / ours[i];
  return scaled_;
}

void ScaledCell::find_left() {
  sought_.scale(field_, cell_, 0, left_);
  const int16_t *symbols = field_.at(0, cell_);
  const int last = field_.last_at_most(0, cell_);
  QuantizerState state;
  for (const Frequency &at : texture_scan(cell_.log)) {
    if (at.diagonal() > last) break;
    const int symbol = symbols[at.v * field_.width + at.u];
    if (symbol) left_[at.index] -= std::copysign(state.magnitude(symbol), float(symbol));
    state = state.after(symbol);
  }
  has_left_ = true;
}

void TextureRootSearch::decide(const TextureCell &root, const BitModels &models, std::vector<int> &plan) {
  models_ = &models;
  plan.clear();
  if (sought_.division) return follow_node(root, plan);
  look_ahead(root);
  decide_node(root, plan);
}

float TextureRootSearch::cost(const BitContext &context, int bit) const {
  return sought_.settings.lambda * bit_cost(models_->predict(context), bit);
}

// All channels of a cell with texture, put into the field.
float TextureRootSearch::choose_leaf(const TextureCell &cell) {
  field_.mark(cell, cell.log);
  ScaledCell scaled(sought_, field_, cell);
  float sum = 0;
  bool any = false;
  for (int channel = 0; channel < field_.channels; ++channel) {
    Choice &choice = choices(cell)[size_t(channel)];
    choose_block(*models_, field_, cell, channel, sought_.settings.lambda, scaled.of(channel), choice);
    field_.set(cell, channel, choice.values.data(), choice.last);
    sum += choice.cost;
    any |= choice.last >= 0;
  }
  return any ? sum : kImpossible;
}

// What a cell would cost with symbols that are coded one by one, and without any.
TextureProspect TextureRootSearch::estimate(const TextureCell &cell) const {
  CellValues<float> scaled;
  const SymbolEstimate symbol(sought_.settings.lambda);
  float sum = sought_.settings.lambda * kCellBits;
  double nothing = 0;
  for (int channel = 0; channel < field_.channels; ++channel) {
    sought_.scale(field_, cell, channel, scaled);
    for (int i = 0; i < cell.side() * cell.side(); ++i) {
      const float square = scaled[i] * scaled[i];
      nothing += square;
      sum += symbol.of(square);
    }
  }
  return {float(nothing), sum};
}

TextureProspect &TextureRootSearch::prospect(const TextureCell &cell) {
  const int64_t within = (1 << kTextureRoot) - 1, across = 1 << (kTextureRoot - cell.log);
  return prospects_[cell.log - kTextureLeast]
                   [((cell.y & within) >> cell.log) * across + ((cell.x & within) >> cell.log)];
}

// Estimates a node and all below; what the cheapest division costs.
float TextureRootSearch::look_ahead(const TextureCell &cell) {
  TextureProspect &found = prospect(cell);
  found = estimate(cell);
  if (cell.log == kTextureLeast) return found.whole;
  found.parts = 0;
  for (int number = 0; number < 4; ++number)
    if (sought_.seen(cell.child(number))) found.parts += look_ahead(cell.child(number));
  return std::min(found.whole, found.parts);
}

// What is best for a node and below; the field shows it afterwards, and `plan` has all nodes in coding order.
float TextureRootSearch::decide_node(const TextureCell &cell, std::vector<int> &plan) {
  const BitContext textured = cell_context(field_, cell, CellBit::kTextured);
  const BitContext split = cell_context(field_, cell, CellBit::kSplit);
  const bool splits = cell.log > kTextureLeast;
  const auto [squares, whole, divided] = prospect(cell);
  float leaf = kImpossible;
  if (whole <= sought_.settings.split_margin * divided)
    leaf = choose_leaf(cell) + cost(textured, 1) + (splits ? cost(split, 0) : 0);
  const float nothing = squares + cost(textured, 0);
  const size_t begin = plan.size();
  plan.push_back(leaf < nothing ? kTextureLeaf : kNoTexture);
  float best = std::min(leaf, nothing);
  if (splits && divided <= sought_.settings.split_margin * whole) {
    std::vector<int> parts{kSplitNode};
    float sum = cost(textured, 1) + cost(split, 1);
    for (int number = 0; number < 4 && sum < best; ++number) {
      const TextureCell child = cell.child(number);
      if (sought_.seen(child))
        sum += decide_node(child, parts);
      else
        field_.clear(child);
    }
    if (sum < best && std::find(parts.begin(), parts.end(), kTextureLeaf) != parts.end()) {
      plan.resize(begin);
      plan.insert(plan.end(), parts.begin(), parts.end());
      return sum;
    }
  }
  // What the parts left in the field is painted over.
  if (plan[begin] == kNoTexture) {
    field_.clear(cell);
    return best;
  }
  field_.mark(cell, cell.log);
  for (int channel = 0; channel < field_.channels; ++channel) {
    const Choice &choice = choices(cell)[size_t(channel)];
    field_.set(cell, channel, choice.values.data(), choice.last);
  }
  return best;
}

// The largest cell that the given layer has within a node, 0 for none: the node's own if it is a leaf.
int TextureRootSearch::given_log(const TextureCell &cell) const {
  int most = 0;
  for (int64_t y = cell.y; y < cell.y + cell.side(); y += kUnit)
    for (int64_t x = cell.x; x < cell.x + cell.side(); x += kUnit)
      most = std::max<int>(most, sought_.division[field_.unit(x, y)]);
  return most;
}

// The cells of the given layer, but for those whose symbols would all be 0.
void TextureRootSearch::follow_node(const TextureCell &cell, std::vector<int> &plan) {
  const size_t begin = plan.size();
  const int log = given_log(cell);
  plan.push_back(log == 0 ? kNoTexture : log == cell.log ? kTextureLeaf : kSplitNode);
  if (plan[begin] == kTextureLeaf) {
    if (choose_leaf(cell) == kImpossible) plan[begin] = kNoTexture;
  } else if (plan[begin] == kSplitNode) {
    for (int number = 0; number < 4; ++number) {
      const TextureCell child = cell.child(number);
      if (sought_.seen(child))
        follow_node(child, plan);
      else
        field_.clear(child);
    }
    if (std::find(plan.begin() + int64_t(begin), plan.end(), kTextureLeaf) == plan.end())
      plan.resize(begin), plan.push_back(kNoTexture);
  }
  if (plan[begin] == kNoTexture) field_.clear(cell);
}

}  // namespace sgi
