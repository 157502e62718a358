#include "rdoq/coordinate_descent.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr Window kCorner{0, 0, 1, 1, kWindowPadding};  // stands for no pixels at all

// 0 to count - 1 by reversed bits: neighbours are then far apart, so that threads need not wait for each other.
std::vector<int32_t> scattered(int64_t count) {
  std::vector<int32_t> order;
  order.reserve(count);
  int bits = 0;
  while ((int64_t(1) << bits) < count) ++bits;
  for (int64_t i = 0; i < (int64_t(1) << bits); ++i) {
    int64_t reversed = 0;
    for (int b = 0; b < bits; ++b) reversed |= (i >> b & 1) << (bits - 1 - b);
    if (reversed < count) order.push_back(static_cast<int32_t>(reversed));
  }
  return order;
}

template <class Body>
void for_each_chunk(int64_t count, int threads, Body body) {
  constexpr int64_t kChunk = 64;
  parallel_for((count + kChunk - 1) / kChunk, threads,
               [&](int64_t chunk) { body(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

// The seeds of a pass, and what is chosen of them.
struct Pass {
  std::vector<int16_t> inputs;  // [n, inputs] of the first network
  std::vector<double> values;
  std::vector<float> centre, cell;
  std::vector<int8_t> log_size;
  std::vector<Coded> found;
  std::vector<double> change;
};

void search_pass(const CodingModel &model, const SearchSettings &settings, const Residual &residual, Pass &pass,
                 int threads, const WindowKernel &kernel) {
  const auto count = int64_t(pass.cell.size());
  const int d = model.attributes(), stride = model.step(kColour).inputs;
  const auto seed = [&](int64_t i) {
    return Seed{&pass.inputs[i * stride], &pass.values[i * d], &pass.centre[2 * i], pass.cell[i], pass.log_size[i]};
  };
  std::vector<Window> windows(count);
  for_each_chunk(count, threads, [&](int64_t begin, int64_t end) {
    SeedSearch search(model, settings, kernel);
    for (int64_t i = begin; i < end; ++i) {
      windows[i] = search.reserve(seed(i), residual);
      if (windows[i].empty()) windows[i] = kCorner;
    }
  });
  for_each_window(windows, scattered(count), residual, threads, [&]() -> Worker {
    return [&, search = std::make_shared<SeedSearch>(model, settings, kernel)](int64_t i) {
      pass.change[i] = search->search(seed(i), windows[i], residual, pass.found[i]);
    };
  });
}

}  // namespace

void search_seeds(const TileSeeds &seeds, const CodingModel &model, const SearchSettings &settings,
                  const Residual &residual, const double *values, const FoundSeeds &out, int threads) {
  const AttributeModel &coding = model.coding;
  const WindowKernel &kernel = kernel_for<WindowKernel>(coding.isa);
  const int64_t d = model.attributes(), stride = model.step(kColour).inputs;
  const std::vector<std::vector<int32_t>> neighbours = neighbours_by_pass(seeds, coding.ranks, coding.isa);
  std::vector<int16_t> summary(size_t(seeds.count) * kSummary), own;  // of seeds of earlier passes, zeros for others
  std::vector<int32_t> amplitude;
  for (size_t p = 0; p < neighbours.size(); ++p) {
    const std::vector<int64_t> &members = seeds.passes[p];
    const auto n = members.size();
    Pass pass{std::vector<int16_t>(n * stride), {}, {}, {}, {}, std::vector<Coded>(n), std::vector<double>(n)};
    for (const int64_t i : members) {
      pass.values.insert(pass.values.end(), values + i * d, values + (i + 1) * d);
      pass.log_size.push_back(seeds.view.log_size[i]);
      pass.cell.push_back(std::ldexp(1.0f, pass.log_size.back()));
      for (int axis = 0; axis < 2; ++axis) pass.centre.push_back(0.5f * float(seeds.half_pixels[2 * i + axis]));
    }
    for_each_chunk(int64_t(n), threads, [&](int64_t begin, int64_t end) {
      seed_inputs(seeds.view, {neighbours[p].data() + begin * coding.ranks, coding.ranks}, summary.data(),
                  members.data() + begin, end - begin, coding.colour_step, pass.inputs.data() + begin * stride, stride);
    });
    search_pass(model, settings, residual, pass, threads, kernel);
    for (size_t i = 0; i < n; ++i) {
      const int64_t at = members[i] * d;
      std::copy_n(pass.found[i].decoded, d, out.decoded + at);
      out.change[members[i]] = pass.change[i];
    }
    own.resize(n * kSummary), amplitude.resize(n);
    summarise({out.decoded, d, model.channels(), coding.colour, coding.shape}, members.data(), int64_t(n), own.data(),
              amplitude.data());
    for (size_t i = 0; i < n; ++i)
      std::copy_n(own.data() + i * kSummary, kSummary, summary.data() + size_t(members[i]) * kSummary);
  }
}

}  // namespace sgi
