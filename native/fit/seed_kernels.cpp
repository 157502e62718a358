// The step, forward and backward.
#include "fit/seed_descent.hpp"
#include "fit/seed_forward.hpp"
#include "fit/seed_gradients.hpp"

namespace sgi {
namespace {

double forward(const SeedState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *) {
  double bits = 0;
  for (int64_t at = begin; at < end; at += LANES) {
    const vf sum = forward_block(s, Block(at, s.count), out);
    for (int i = 0; i < LANES; ++i) bits += lane(sum, i);
  }
  return bits;
}

// Sums over the seeds of one run, as vectors over lanes that are added up at its end.
struct Sums {
  float *lanes;

  explicit Sums(float *memory) : lanes(memory) {
    for (int row = 0; row < kSteps; ++row) store(lanes + row * LANES, vf{});
  }
  void add(int row, vf v) const {
    float *p = lanes + row * LANES;
    store(p, load(p) + v);
  }
  void add_to_lane(int row, int lane, float v) const { lanes[row * LANES + lane] += v; }
  void write(float *out) const {
    for (int row = 0; row < kSteps; ++row) {
      out[row] = 0.0f;
      for (int i = 0; i < LANES; ++i) out[row] += lanes[row * LANES + i];
    }
  }
};

void backward(const SeedState &s, int64_t begin, int64_t end, const SeedGradients &g, float *out, float *memory) {
  const Scratch scratch(s, memory);
  const Sums sums(scratch.sums);
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(at, s.count);
    const float *decoded = s.decoded + block.number() * s.attributes() * LANES;
    read_gradients(s, block, decoded, g, scratch.attributes);
    if (s.rounding == Rounding::kNone) {
      for (int group = 0; group < kGroups; ++group) pass_group(s, block, group, scratch.attributes, g);
      continue;
    }
    const vf loudness = loudness_of(s, decoded);
    for (int group = 0; group < kGroups; ++group)
      descend_group(s, block, group, loudness, decoded, scratch.attributes, g, sums);
  }
  sums.write(out);
}

}  // namespace

const SeedKernel SeedKernel::SGI_ISA{sgi::summarize, sgi::forward, sgi::backward};

}  // namespace sgi
