// Included by one translation unit per instruction set, each in its own unnamed namespace. No templates of the standard
// library here: the linker might take an instantiation that another processor cannot run.

#include "seed_kernel.hpp"
#include "seed_math.hpp"

namespace sgi {
namespace {

// Limits and constants that model/ and fit/sampler.py define.
constexpr float kInputLimit = 128.0f;  // INPUT_LIMIT in units of 2^-INPUT_BITS
constexpr float kColourInput = 16.0f, kLoudnessOffset = 6.0f, kAmplitudeZero = -20.0f / 6.0f;
constexpr float kLeastStep = 0x1p-16f, kGreatestStep = 2.0f, kLeastScale = 0x1p-4f;
constexpr float kRefineLimit = 4.0f, kScaleLimit = 12.0f;
constexpr float kDeadZone = 0.118f, kDeadZoneLimit = 0.3f;
constexpr float kMinVariance = 0.05f, kShapeLimit = 12.0f;
constexpr float kNeighbourWeights[kMostNeighbours] = {4, 3, 3, 2, 2, 2};
constexpr int kMostOutputs = 7, kMostOwn = 12;

// Memory of one run: what blocks write anew, and the sums over seeds as vectors over lanes.
struct Scratch {
  float *hidden, *attributes, *sums;
  Scratch(const SeedState &s, float *memory)
      : hidden(memory), attributes(hidden + kBatch * s.hidden * LANES),
        sums(attributes + kBatch * s.attributes() * LANES) {}
};

// Seeds behind the last stand for the last one and count nothing.
struct Block {
  int64_t first;
  int64_t seed[LANES];
  vf live;

  Block(const SeedState &s, int64_t begin) : first(begin), live() {
    for (int i = 0; i < LANES; ++i) {
      seed[i] = begin + i < s.count ? begin + i : s.count - 1;
      live[i] = begin + i < s.count ? 1.0f : 0.0f;
    }
  }
  vf gather(const float *rows, int width, int column) const {
    vf v;
    for (int i = 0; i < LANES; ++i) v[i] = rows[seed[i] * width + column];
    return v;
  }
  void scatter(vf v, float *rows, int width, int column) const {
    for (int i = 0; i < LANES; ++i)
      if (live[i] != 0.0f) rows[seed[i] * width + column] = v[i];
  }
  int64_t number() const { return first / LANES; }
};

inline int unit_of(const SeedState &s, int group, int column) {
  if (group == 0) return s.channels >= 3 && column % s.channels < 3 ? column % s.channels : 0;
  return column % kGroupUnits[group];
}

// What the colours [K C] and shapes [3 K] of a block say, in inputs' units, from rows of LANES floats.
inline vf loudness_of(const SeedState &s, const float *decoded) {
  vf energy{};
  for (int j = 0; j < s.group_size(0); ++j) energy += load(decoded + j * LANES) * load(decoded + j * LANES);
  return 0.5f * log2v(maxv(energy, vf{} + 0x1p-24f));
}

inline vf mean_of(const SeedState &s, const float *decoded, int group, int column) {
  const int width = group == 0 ? s.channels : 3;
  vf sum{};
  for (int k = 0; k < s.per_seed; ++k) sum += load(decoded + (s.group_start(group) + k * width + column) * LANES);
  return sum / float(s.per_seed);
}

inline vf colour_input(const SeedState &s, const float *decoded, int channel) {
  if (channel > 0 && s.channels < 3) return vf{};
  return clampv(mean_of(s, decoded, 0, channel) * kColourInput, kInputLimit);
}

// Own earlier groups as inputs of MLP_p at coding step `group`; returns how many.
inline int own_inputs(const SeedState &s, const float *decoded, int group, vf loudness, vf *own) {
  if (group == 0) return 0;
  for (int c = 0; c < 3; ++c) {
    own[c] = colour_input(s, decoded, c);
    own[3 + c] = absv(own[c]);
  }
  own[6] = maxv(loudness + kLoudnessOffset, vf{} - kLoudnessOffset);
  if (group == 1) return kOwnInputs[1];
  for (int c = 0; c < 3; ++c) own[7 + c] = clampv(mean_of(s, decoded, 1, c), kInputLimit);
  own[10] = absv(own[8]);
  own[11] = absv(own[9]);
  return kOwnInputs[2];
}

void summarize(const SeedState &s, int64_t begin, int64_t end, float *memory) {
  float *rows = Scratch(s, memory).attributes;
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(s, at);
    for (int g = 0; g < 2; ++g)
      for (int j = 0; j < s.group_size(g); ++j)
        store(rows + (s.group_start(g) + j) * LANES, block.gather(s.value[g], s.group_size(g), j));
    for (int c = 0; c < 3; ++c) block.scatter(colour_input(s, rows, c), s.summary, kSummary, c);
    const vf loudness = loudness_of(s, rows) + kLoudnessOffset;
    block.scatter(maxv(loudness, vf{} - kLoudnessOffset), s.summary, kSummary, 3);
    for (int c = 0; c < 3; ++c) block.scatter(mean_of(s, rows, 1, c), s.summary, kSummary, 4 + c);
  }
}

// Inputs of one seed in the order of model/context.py, in units of one.
inline void inputs_of_seed(const SeedState &s, int64_t seed, float *out) {
  for (int c = 0; c < kCommonInputs; ++c) out[c] = c <= kLevels ? s.level_inputs[seed * (kLevels + 1) + c] : 0.0f;
  float *count = out + kLevels + 1, *weighted = count + 1, *sizes = weighted + kSummary, *level = sizes + 5,
        *nearest = level + 1, *offset = nearest + kSummary;
  const int32_t *others = s.neighbour + seed * s.neighbours;
  constexpr int kSigned[5] = {0, 1, 2, 5, 6};
  for (int rank = 0; rank < s.neighbours; ++rank) {
    if (others[rank] < 0) continue;
    const float weight = kNeighbourWeights[rank] / 16.0f;
    const float *row = s.summary + int64_t(others[rank]) * kSummary;
    *count += weight;
    for (int c = 0; c < kSummary; ++c) weighted[c] += weight * row[c];
    for (int c = 0; c < 5; ++c) sizes[c] += weight * __builtin_fabsf(row[kSigned[c]]);
    *level += weight * (s.log_size[others[rank]] - s.log_size[seed]);
  }
  if (s.neighbours && others[0] >= 0) {
    for (int c = 0; c < kSummary; ++c) nearest[c] = s.summary[int64_t(others[0]) * kSummary + c];
    for (int axis = 0; axis < 2; ++axis) offset[axis] = s.offset[2 * seed + axis];
  }
  for (int c = 0; c < kCommonInputs; ++c) out[c] = __builtin_fmaxf(__builtin_fminf(out[c], kInputLimit), -kInputLimit);
}

void gather(const SeedState &s, int64_t begin, int64_t end, float *) {
  float one[kCommonInputs];
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(s, at);
    float *inputs = s.inputs + block.number() * kCommonInputs * LANES;
    for (int i = 0; i < LANES; ++i) {
      inputs_of_seed(s, block.seed[i], one);
      for (int c = 0; c < kCommonInputs; ++c) inputs[c * LANES + i] = one[c];
    }
  }
}

void multiply(const SeedState &s, int64_t begin, int64_t end, float *) {
  constexpr int kAtOnce = 4;
  for (int64_t at = begin; at < end; at += LANES) {
    const int64_t number = at / LANES;
    const float *inputs = s.inputs + number * kCommonInputs * LANES;
    for (int g = 0; g < kGroups; ++g) {
      float *product = s.product + (number * kGroups + g) * s.hidden * LANES;
      const int width = inputs_of(g);
      for (int h = 0; h < s.hidden; h += kAtOnce) {
        const int rows = s.hidden - h < kAtOnce ? s.hidden - h : kAtOnce;
        vf sum[kAtOnce] = {};
        const float *w[kAtOnce];
        for (int i = 0; i < kAtOnce; ++i) w[i] = s.first[g] + (h + (i < rows ? i : rows - 1)) * width;
        for (int c = 0; c < kCommonInputs; ++c) {
          const vf x = load(inputs + c * LANES);
          for (int i = 0; i < kAtOnce; ++i) sum[i] += x * w[i][c];
        }
        for (int i = 0; i < rows; ++i) store(product + (h + i) * LANES, sum[i]);
      }
    }
  }
}

// MLP_p at one coding step: hidden values into `scratch`, outputs (means, scales, refinement) into `out`.
template <int OWN, int OUTPUTS>
inline void evaluate_step(const SeedState &s, const Block &block, int group, const vf *own, float *hidden, vf *out) {
  const float *product = s.product + (block.number() * kGroups + group) * s.hidden * LANES;
  const float *b1 = s.rest[group], *w2 = b1 + s.hidden, *b2 = w2 + OUTPUTS * s.hidden;
  const float *w1 = s.first[group] + kCommonInputs;
  constexpr int kWidth = kCommonInputs + OWN;
  for (int o = 0; o < OUTPUTS; ++o) out[o] = vf{} + b2[o];
  for (int h = 0; h < s.hidden; ++h) {
    vf x = load(product + h * LANES) + b1[h];
#pragma GCC unroll 12
    for (int c = 0; c < OWN; ++c) x += own[c] * w1[h * kWidth + c];
    x = maxv(x, vf{});
    store(hidden + h * LANES, x);
#pragma GCC unroll 7
    for (int o = 0; o < OUTPUTS; ++o) out[o] += x * w2[o * s.hidden + h];
  }
}

inline void evaluate(const SeedState &s, const Block &block, int group, const vf *own, float *hidden, vf *out) {
  switch (group) {
    case 0: return evaluate_step<kOwnInputs[0], outputs_of(0)>(s, block, 0, own, hidden, out);
    case 1: return evaluate_step<kOwnInputs[1], outputs_of(1)>(s, block, 1, own, hidden, out);
    default: return evaluate_step<kOwnInputs[2], outputs_of(2)>(s, block, 2, own, hidden, out);
  }
}

// Mean, scale and step of one prediction; the rest is only there when MLP_p has just said it.
struct Unit {
  vf mean, step, scale, base_step, raw_scale;
  vi step_is_free, scale_is_free;  // not at a bound: gradients pass
  vi output_is_free;               // the same for the scale that MLP_p says
};

struct Units {
  Unit unit[3];
  vf refine, loudness;  // refinement before its bound, and how far the amplitude lies above AMPLITUDE_ZERO
};

inline Units units_of(const SeedState &s, const Block &block, int group, const vf *out, vf loudness) {
  const int count = kGroupUnits[group];
  Units u;
  u.refine = out[2 * count];
  u.loudness = group ? loudness - kAmplitudeZero : vf{};
  const float gamma = group ? s.gamma[group - 1] : 0.0f;
  for (int i = 0; i < count; ++i) {
    Unit &v = u.unit[i];
    vf log_base;
    for (int l = 0; l < LANES; ++l) log_base[l] = s.base[(kFirstUnit[group] + i) * kLevels + s.level[block.seed[l]]];
    v.base_step = exp2v(log_base);
    const vf step = exp2v(log_base - gamma * u.loudness + clampv(u.refine, kRefineLimit));
    v.step_is_free = (step > kLeastStep) & (step < kGreatestStep);
    v.step = minv(maxv(step, vf{} + kLeastStep), vf{} + kGreatestStep);
    v.mean = out[i] * v.base_step;
    v.output_is_free = absv(out[count + i]) < kScaleLimit;
    v.raw_scale = exp2v(clampv(out[count + i], kScaleLimit)) * v.base_step;
    v.scale_is_free = v.raw_scale >= v.step * kLeastScale;
    v.scale = maxv(v.raw_scale, v.step * kLeastScale);
  }
  return u;
}

// Predictions of a group that outlive their step.
inline float *kept_units(const SeedState &s, const Block &block, int group) {
  return s.kept + (block.number() * kUnits + kFirstUnit[group]) * 3 * LANES;
}

inline void keep_units(const Units &u, int group, float *to) {
  for (int i = 0; i < kGroupUnits[group]; ++i, to += 3 * LANES) {
    store(to, u.unit[i].mean);
    store(to + LANES, u.unit[i].step);
    store(to + 2 * LANES, u.unit[i].scale);
  }
}

inline void load_units(const float *from, int group, Units &u) {
  for (int i = 0; i < kGroupUnits[group]; ++i, from += 3 * LANES) {
    u.unit[i].mean = load(from);
    u.unit[i].step = load(from + LANES);
    u.unit[i].scale = load(from + 2 * LANES);
  }
}

inline vf rounded(vf value, const Unit &u) {
  const vf position = (value - u.mean) / u.step;
  const vf lean = minv(kDeadZone * u.step / u.scale, vf{} + kDeadZoneLimit);
  return u.mean + u.step * signv(position) * floorv(maxv(absv(position) + 0.5f - lean, vf{}));
}

inline void write_gaussians(const SeedState &s, const Block &block, const float *decoded, const SeedGaussians &out) {
  const int k_count = s.per_seed, channels = s.channels;
  const vf cell = block.gather(s.cell, 1, 0), area = cell * cell;
  for (int k = 0; k < k_count; ++k) {
    const float *colour = decoded + k * channels * LANES;
    for (int c = 0; c < channels; ++c) {
      vf sum{};
      for (int j = 0; j < channels; ++j) sum += load(colour + j * LANES) * s.opponent[j * channels + c];
      block.scatter(sum, out.colours, k_count * channels, k * channels + c);
    }
    const float *shape = decoded + (s.group_start(1) + 3 * k) * LANES;
    const vf a = clampv(load(shape), kShapeLimit), b = load(shape + LANES), c = load(shape + 2 * LANES);
    const SymmetricExp e = symmetric_exp(a, minv(b * b + c * c, vf{} + kShapeLimit * kShapeLimit));
    block.scatter(area * (e.even + e.odd * b) + kMinVariance, out.covariances, 3 * k_count, 3 * k);
    block.scatter(area * e.odd * c, out.covariances, 3 * k_count, 3 * k + 1);
    block.scatter(area * (e.even - e.odd * b) + kMinVariance, out.covariances, 3 * k_count, 3 * k + 2);
    const float *offset = decoded + (s.group_start(2) + 2 * k) * LANES;
    for (int axis = 0; axis < 2; ++axis)
      block.scatter(block.gather(s.centre, 2, axis) + cell * load(offset + axis * LANES), out.means, 2 * k_count,
                    2 * k + axis);
  }
}

double forward(const SeedState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory) {
  const Scratch scratch(s, memory);
  double bits = 0;
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(s, at);
    float *decoded = s.decoded + block.number() * s.attributes() * LANES;
    vf sum{}, loudness{};
    for (int g = 0; g < kGroups; ++g) {
      const int size = s.group_size(g), start = s.group_start(g);
      Units u;
      if (s.predicts) {
        vf own[kMostOwn], outputs[kMostOutputs];
        own_inputs(s, decoded, g, loudness, own);
        evaluate(s, block, g, own, scratch.hidden, outputs);
        u = units_of(s, block, g, outputs, loudness);
        keep_units(u, g, kept_units(s, block, g));
      } else if (s.rounding != Rounding::kNone) {
        load_units(kept_units(s, block, g), g, u);
      }
      for (int j = 0; j < size; ++j) {
        vf value = block.gather(s.value[g], size, j);
        if (s.rounding != Rounding::kNone) {
          const Unit &unit = u.unit[unit_of(s, g, j)];
          value = s.rounding == Rounding::kNoise ? value + unit.step * noise(s.key, s.mirror, start + j, at) : rounded(value, unit);
          sum += laplace_bits(value - unit.mean, unit.step, unit.scale).bits;
        }
        store(decoded + (start + j) * LANES, value);
      }
      if (g == 0 && s.predicts) loudness = loudness_of(s, decoded);
    }
    block.scatter(sum, s.bits, 1, 0);
    sum *= block.live;
    for (int i = 0; i < LANES; ++i) bits += sum[i];
    write_gaussians(s, block, decoded, out);
  }
  return bits;
}

// Gradients of the decoded attributes through the Gaussians, rows of LANES floats.
inline void read_gradients(const SeedState &s, const Block &block, const float *decoded, const SeedGradients &g,
                           float *out) {
  const int k_count = s.per_seed, channels = s.channels;
  const vf cell = block.gather(s.cell, 1, 0), area = cell * cell;
  for (int k = 0; k < k_count; ++k) {
    for (int j = 0; j < channels; ++j) {
      vf sum{};
      for (int c = 0; c < channels; ++c)
        sum += block.gather(g.colours, k_count * channels, k * channels + c) * s.opponent[j * channels + c];
      store(out + (k * channels + j) * LANES, sum);
    }
    const int row = s.group_start(1) + 3 * k;
    const float *shape = decoded + row * LANES;
    const vf raw = load(shape), a = clampv(raw, kShapeLimit), b = load(shape + LANES), c = load(shape + 2 * LANES);
    const vf t = b * b + c * c;
    const SymmetricExp e = symmetric_exp(a, minv(t, vf{} + kShapeLimit * kShapeLimit));
    const vf xx = area * block.gather(g.covariances, 3 * k_count, 3 * k);
    const vf xy = area * block.gather(g.covariances, 3 * k_count, 3 * k + 1);
    const vf yy = area * block.gather(g.covariances, 3 * k_count, 3 * k + 2);
    const vf even = xx + yy, odd = (xx - yy) * b + xy * c;
    const vf along = select(t < kShapeLimit * kShapeLimit, 2.0f * (even * e.odd + odd * e.slope), vf{});
    store(out + row * LANES, select(absv(raw) < kShapeLimit, 2.0f * (even * e.even + odd * e.odd), vf{}));
    store(out + (row + 1) * LANES, (xx - yy) * e.odd + along * b);
    store(out + (row + 2) * LANES, xy * e.odd + along * c);
    for (int axis = 0; axis < 2; ++axis)
      store(out + (s.group_start(2) + 2 * k + axis) * LANES,
            cell * block.gather(g.means, 2 * k_count, 2 * k + axis));
  }
}

// Sums over the seeds of one run, as vectors over lanes that are added up at its end.
struct Sums {
  float *lanes;
  int rest[kGroups], base, gamma, first[kGroups];

  Sums(const SeedState &s, float *memory) : lanes(memory) {
    int at = 0;
    for (int g = 0; g < kGroups; at += s.rest_size(g++)) rest[g] = at;
    base = at;
    gamma = base + kUnits * kLevels;
    at = gamma + kGammas;
    for (int g = 0; g < kGroups; at += s.first_size(g++)) first[g] = at;
    for (int64_t i = 0; i < int64_t(s.sums()) * LANES; ++i) lanes[i] = 0.0f;
  }
  void add(int row, vf v) const {
    float *p = lanes + int64_t(row) * LANES;
    store(p, load(p) + v);
  }
  void add_to_lane(int row, int lane, float v) const { lanes[int64_t(row) * LANES + lane] += v; }
  void write(const SeedState &s, float *out) const {
    for (int row = 0; row < s.sums(); ++row) {
      float part[4] = {};  // four chains of additions hide each other's latency
      for (int i = 0; i < LANES; ++i) part[i % 4] += lanes[int64_t(row) * LANES + i];
      out[row] = (part[0] + part[1]) + (part[2] + part[3]);
    }
  }
};

// What a batch of blocks keeps between its way down to MLP_p's outputs and its way back through it.
struct Batch {
  int64_t first;  // number of its first block
  int blocks;
  vf own[kBatch][kMostOwn], up[kBatch][kMostOutputs];
};

// Back through MLP_p from the gradients `up` of its outputs. A batch at a time, so that sums stay in registers.
template <int GROUP>
inline void descend(const SeedState &s, const Batch &batch, const float *hidden, const Sums &sums) {
  constexpr int kOutputs = outputs_of(GROUP);
  const float *w2 = s.rest[GROUP] + s.hidden;
  const int b1 = sums.rest[GROUP], first_w2 = b1 + s.hidden, b2 = first_w2 + kOutputs * s.hidden;
  for (int b = 0; b < batch.blocks; ++b)
    for (int o = 0; o < kOutputs; ++o) sums.add(b2 + o, batch.up[b][o]);
  for (int h = 0; h < s.hidden; ++h) {
    vf weight[kOutputs], sum[kOutputs] = {}, bias{}, down[kBatch];
    for (int o = 0; o < kOutputs; ++o) weight[o] = vf{} + w2[o * s.hidden + h];
    for (int b = 0; b < batch.blocks; ++b) {
      const vf x = load(hidden + (b * s.hidden + h) * LANES);
      vf d{};
#pragma GCC unroll 7
      for (int o = 0; o < kOutputs; ++o) {
        d += batch.up[b][o] * weight[o];
        sum[o] += batch.up[b][o] * x;
      }
      down[b] = select(x > 0.0f, d, vf{});
      bias += down[b];
    }
    for (int o = 0; o < kOutputs; ++o) sums.add(first_w2 + o * s.hidden + h, sum[o]);
    sums.add(b1 + h, bias);
    if (!s.trains_first) continue;
    const int row = sums.first[GROUP] + h * inputs_of(GROUP);
    for (int c = 0; c < inputs_of(GROUP); ++c) {
      vf total{};
      for (int b = 0; b < batch.blocks; ++b)
        total += down[b] * (c < kCommonInputs ? load(s.inputs + ((batch.first + b) * kCommonInputs + c) * LANES)
                                              : batch.own[b][c - kCommonInputs]);
      sums.add(row + c, total);
    }
  }
}

// One group of a block: gradients of its values, and of MLP_p's outputs `up`.
inline void descend_group(const SeedState &s, const Block &block, int group, const Units &u, const float *decoded,
                          const float *grad, const SeedGradients &g, vf *up, const Sums &sums) {
  const int size = s.group_size(group), start = s.group_start(group), count = kGroupUnits[group];
  vf mean[3] = {}, scale[3] = {}, step[3] = {};
  for (int j = 0; j < size; ++j) {
    const int i = unit_of(s, group, j);
    const Unit &unit = u.unit[i];
    const vf above = load(grad + (start + j) * LANES) * block.live;
    const Bits b = laplace_bits(load(decoded + (start + j) * LANES) - unit.mean, unit.step, unit.scale);
    const vf price = g.lmbda * block.live, slope = price * b.deviation;
    block.scatter(above + slope, g.value[group], size, j);
    mean[i] -= slope;
    scale[i] += price * b.scale;
    if (s.rounding == Rounding::kNoise) step[i] += price * b.step + (above + slope) * noise(s.key, s.mirror, start + j, block.first);
  }
  vf refine{}, gamma{};
  for (int i = 0; i < count; ++i) {
    const Unit &unit = u.unit[i];
    step[i] += select(unit.scale_is_free, vf{}, scale[i] * kLeastScale);
    const vf raw = select(unit.scale_is_free, scale[i] * unit.raw_scale * kLn2, vf{});
    const vf log_step = select(unit.step_is_free, step[i] * unit.step * kLn2, vf{});
    const vf log_base = log_step + mean[i] * unit.mean * kLn2 + raw;
    for (int l = 0; l < LANES; ++l)
      sums.add_to_lane(sums.base + (kFirstUnit[group] + i) * kLevels + s.level[block.seed[l]], l, log_base[l]);
    refine += log_step;
    gamma -= log_step * u.loudness;
    up[i] = mean[i] * unit.base_step;
    up[count + i] = select(unit.output_is_free, raw, vf{});
  }
  up[2 * count] = select(absv(u.refine) < kRefineLimit, refine, vf{});
  if (group) sums.add(sums.gamma + group - 1, gamma);
}

// The same where MLP_p's predictions are constants.
inline void descend_values(const SeedState &s, const Block &block, int group, const float *decoded, const float *grad,
                           const SeedGradients &g) {
  const int size = s.group_size(group), start = s.group_start(group);
  Units u;
  if (s.rounding != Rounding::kNone) load_units(kept_units(s, block, group), group, u);
  for (int j = 0; j < size; ++j) {
    vf slope = load(grad + (start + j) * LANES);
    if (s.rounding != Rounding::kNone) {
      const Unit &unit = u.unit[unit_of(s, group, j)];
      const vf value = load(decoded + (start + j) * LANES);
      slope += g.lmbda * laplace_bits(value - unit.mean, unit.step, unit.scale).deviation;
    }
    block.scatter(slope, g.value[group], size, j);
  }
}

// One coding step of a batch: down to MLP_p's outputs block by block, then back through it.
template <int GROUP>
void backward_group(const SeedState &s, Batch &batch, const Scratch &scratch, const SeedGradients &g,
                    const Sums &sums) {
  const int rows = s.attributes();
  for (int b = 0; b < batch.blocks; ++b) {
    const Block block(s, (batch.first + b) * LANES);
    const float *decoded = s.decoded + block.number() * rows * LANES;
    const float *grad = scratch.attributes + b * rows * LANES;
    if (!s.predicts) {
      descend_values(s, block, GROUP, decoded, grad, g);
      continue;
    }
    vf outputs[kMostOutputs];
    const vf loudness = loudness_of(s, decoded);
    own_inputs(s, decoded, GROUP, loudness, batch.own[b]);
    evaluate(s, block, GROUP, batch.own[b], scratch.hidden + b * s.hidden * LANES, outputs);
    const Units u = units_of(s, block, GROUP, outputs, loudness);
    descend_group(s, block, GROUP, u, decoded, grad, g, batch.up[b], sums);
  }
  if (s.predicts) descend<GROUP>(s, batch, scratch.hidden, sums);
}

void backward(const SeedState &s, int64_t begin, int64_t end, const SeedGradients &g, float *out, float *memory) {
  const Scratch scratch(s, memory);
  const Sums sums(s, scratch.sums);
  Batch batch;
  for (int64_t at = begin; at < end; at += kBatch * LANES) {
    const int64_t left = (end - at + LANES - 1) / LANES;
    batch.first = at / LANES;
    batch.blocks = left < kBatch ? int(left) : kBatch;
    for (int b = 0; b < batch.blocks; ++b) {
      const Block block(s, at + b * LANES);
      const int rows = s.attributes();
      read_gradients(s, block, s.decoded + block.number() * rows * LANES, g, scratch.attributes + b * rows * LANES);
    }
    backward_group<0>(s, batch, scratch, g, sums);
    backward_group<1>(s, batch, scratch, g, sums);
    backward_group<2>(s, batch, scratch, g, sums);
  }
  if (s.predicts) sums.write(s, out);
}

}  // namespace
}  // namespace sgi
