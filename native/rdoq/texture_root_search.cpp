#include "rdoq/texture_root_search.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace sgi {

namespace {

constexpr float kImpossible = std::numeric_limits<float>::infinity();

// What a symbol costs about: the squared error that it leaves, in squared steps, its bits where the amplitude is a
// step, and their growth for each octave of the squared amplitude; bits of a cell beside its symbols.
constexpr float kLeft = 0.05f, kSymbolBits = 2.7f, kOctaveBits = 0.68f, kCellBits = 4;

// log2 of a positive value, within 0.05.
float about_log2(float value) {
  int32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return float(bits) * 0x1p-23f - 126.96f;
}

}  // namespace

float TextureRootSearch::decide(const TextureCell &root, const BitModels &models, std::vector<int> &plan) {
  models_ = &models;
  plan.clear();
  if (sought_.division) {
    follow_node(root, plan);
    return 0;
  }
  look_ahead(root);
  return decide_node(root, plan);
}

float TextureRootSearch::cost(const BitContext &context, int bit) const {
  return sought_.settings.lambda * bit_cost(models_->predict(context).one, bit);
}

// Symbols of a channel and their cost.
void TextureRootSearch::choose(const TextureCell &cell, int channel, Choice &choice) const {
  static thread_local CellValues<float> scaled;
  sought_.scale(field_, cell, channel, scaled);
  choose_block(*models_, field_, cell, channel, sought_.settings.lambda, scaled, choice);
  const float *signs = sought_.amplitudes.of(cell, channel);
  for (int v = 0; v < cell.side(); ++v)
    for (int u = 0; u < cell.side(); ++u)
      if (signs[v * field_.width + u] < 0) choice.values[v << cell.log | u] *= -1;
}

// All channels of a cell with texture, put into the field.
float TextureRootSearch::choose_leaf(const TextureCell &cell, std::vector<Choice> &choices) {
  field_.mark(cell, cell.log);
  float sum = 0;
  bool any = false;
  for (int channel = 0; channel < field_.channels; ++channel) {
    choose(cell, channel, choices[channel]);
    field_.set(cell, channel, choices[channel].values.data(), choices[channel].last);
    sum += choices[channel].cost;
    any |= choices[channel].last >= 0;
  }
  return any ? sum : kImpossible;
}

// What a cell would cost with symbols that are coded one by one, and without any.
TextureProspect TextureRootSearch::estimate(const TextureCell &cell) const {
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
  std::vector<Choice> choices(field_.channels);
  float leaf = kImpossible;
  if (whole <= sought_.settings.doubt * divided)
    leaf = choose_leaf(cell, choices) + cost(textured, 1) + (splits ? cost(split, 0) : 0);
  const float nothing = squares + cost(textured, 0);
  const size_t begin = plan.size();
  plan.push_back(leaf < nothing ? kTextureLeaf : kNoTexture);
  float best = std::min(leaf, nothing);
  if (splits && divided <= sought_.settings.doubt * whole) {
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
  for (int channel = 0; channel < field_.channels; ++channel)
    field_.set(cell, channel, choices[channel].values.data(), choices[channel].last);
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
    std::vector<Choice> choices(field_.channels);
    if (choose_leaf(cell, choices) == kImpossible) plan[begin] = kNoTexture;
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
