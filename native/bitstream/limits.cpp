#include "bitstream/limits.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "bitstream/seed_tree.hpp"
#include "bitstream/texture_stream.hpp"
#include "model/hash_grid.hpp"
#include "model/step_plan.hpp"

namespace sgi {
namespace {

constexpr int64_t kMaxSamples = int64_t(1) << 31;
constexpr int64_t kMaxBaseValues = 1 << 22, kMaxBaseLines = 1 << 20;
constexpr int64_t kMaxWeights = 1 << 22;  // of all networks together
constexpr int64_t kMaxSigns = 1 << 22;
// Numbers (kValueBytes each, about) that seeds may take while they are decoded, however short the payload, and how many
// more for each of its bytes; real seeds take two to ten bytes, and a hundred values each.
constexpr int64_t kFreeValues = 1 << 25, kValuesPerByte = 128, kValueBytes = 24;
constexpr int64_t kMaxTreeNodes = 1 << 28;                           // a byte each; those of 800 megapixels
constexpr int64_t kMaxTextureSamples = 1 << 26, kTextureBytes = 12;  // whole roots counted; each while it is decoded

void limit(int64_t count, int64_t most, const std::string &what) {
  if (count > most)
    throw Error(Fault::limit,
                what + " are " + std::to_string(count) + "; a tile holds at most " + std::to_string(most));
}

std::string pixels(int64_t width, int64_t height) {
  return std::to_string(width) + "×" + std::to_string(height) + " pixels: ";
}

int64_t divided_up(int64_t a, int64_t b) { return (a + b - 1) / b; }

int64_t decoder_weights(const ModelSpec &spec) {
  if (!spec.hidden) return 0;
  int64_t weights = 0;
  for (const int64_t outputs : {int64_t(spec.per_seed) * spec.channels, int64_t(spec.per_seed) * 3})
    weights += int64_t(spec.hidden) * (spec.features + 1) + outputs * (spec.hidden + 1);
  return weights;
}

int64_t values_per_seed(const ModelSpec &spec) {
  const ContextSpec &context = spec.context;
  const auto steps = coding_steps(spec);
  int64_t seen = 0;
  for (size_t step = 0; step < steps.size(); ++step)
    seen = std::max(seen, int64_t(context.hidden) + input_count(spec, int(step)) + network_outputs(spec, steps[step]));
  if (!context.hash_resolutions.empty())  // four corners of each cell
    seen += 8 * (int64_t(context.hash_resolutions.size()) + context.hash_features);
  return seen + spec.attributes() + spec.hidden + int64_t(spec.per_seed) * (spec.channels + 8);
}

}  // namespace

void check_model(const ModelSpec &spec, int64_t width, int64_t height) {
  limit(width * height * spec.channels, kMaxSamples, pixels(width, height) + "samples");
  constexpr int64_t kRoot = 1 << kRootLevel;
  limit(divided_up(width, kRoot) * divided_up(height, kRoot), kMaxRoots,
        pixels(width, height) + "cells of " + std::to_string(kRoot) + " pixels");
  if (spec.base_cell) {
    const int64_t rows = divided_up(height, spec.base_cell), columns = divided_up(width, spec.base_cell);
    limit(spec.channels * rows * columns, kMaxBaseValues, "base layer: values");
    limit(spec.channels * (rows + columns), kMaxBaseLines, "base layer: rows and columns of all channels");
  }
  const auto steps = coding_steps(spec);
  int64_t weights = decoder_weights(spec), signs = 0;
  for (size_t step = 0; step < steps.size(); ++step) {
    const int64_t outputs = network_outputs(spec, steps[step]), hidden = spec.context.hidden;
    weights += hidden * (input_count(spec, int(step)) + 1) + outputs * (hidden + 1);
  }
  limit(weights, kMaxWeights, "networks: weights");
  for (const int64_t count : HashGrid(spec.context, width, height).counts()) signs += count;
  limit(signs, kMaxSigns, "hash grid: signs");
}

int64_t max_seeds(const ModelSpec &spec, int64_t width, int64_t height, int64_t payload_bytes, int64_t memory) {
  const int64_t values = std::min(kFreeValues + kValuesPerByte * payload_bytes, memory / kValueBytes);
  return std::min(values / values_per_seed(spec), std::max(int64_t(64), 2 * width * height));
}

int64_t left_by_base(int64_t values, int64_t memory) {
  limit(values, memory / kValueBytes, "base layer: values");
  return memory - kValueBytes * values;
}

int64_t left_by_seeds(const ModelSpec &spec, int64_t count, int64_t memory) {
  return memory - kValueBytes * values_per_seed(spec) * count;
}

void check_tree(int64_t width, int64_t height, int64_t memory) {
  limit(TreeNodes::memory(width, height), std::min(kMaxTreeNodes, memory),
        pixels(width, height) + "nodes of a tree of seeds");
}

void check_texture(int channels, int64_t width, int64_t height, int64_t memory) {
  limit(texture_roots(width) * texture_roots(height) * channels * (1 << 2 * kTextureRoot),
        std::min(kMaxTextureSamples, memory / kTextureBytes), pixels(width, height) + "samples with texture");
}

}  // namespace sgi
