// The end of a step: what differences to a prior cost, Adam, and what the host is told.
#pragma once
#include "cuda/fit/state.hpp"
#include "fit/adam_move.hpp"
#include "fit/seed_prediction.hpp"

namespace sgi {

constexpr int kPriceThreads = 128, kReportThreads = 256;

namespace {

using PriceSums = float[kPriceThreads];
using ReportSums = double[2][kReportThreads];

}  // namespace

// Adds to the gradient of the differences λ times that of their cost: each tensor's under the Laplacian of its own mean
// magnitude, in steps of the stream. A block has a tensor: b1, W2 and b2 of every group.
SGI_KERNEL(price_differences, kPriceThreads, FitArguments) {
  SGI_SHARED(PriceSums, sums);
  const SeedState s = state_of(a);
  int first = 0, size = 0;
  for (int tensor = 0; tensor <= block.index(); ++tensor) {
    const int outputs = outputs_of(tensor / 3);
    first += size;
    size = tensor % 3 == 0 ? s.hidden : tensor % 3 == 1 ? outputs * s.hidden : outputs;
  }
  block.each([&](int t) {
    sums[t] = 0.0f;
    for (int i = t; i < size; i += kPriceThreads) sums[t] += absv(a.difference[first + i]) * a.difference_unit;
  });
  block.each([&](int t) {
    if (t) return;
    for (int i = 1; i < kPriceThreads; ++i) sums[0] += sums[i];
  });
  block.each([&](int t) {
    const float mean = (sums[0] / float(size) + 0.05f) * 0.69314718056f, slope = numbers_of(a).lmbda / mean;
    for (int i = t; i < size; i += kPriceThreads)
      a.sums[first + i] += slope * signv(a.difference[first + i]) * a.difference_unit;
  });
}

SGI_KERNEL(move_arrays, 256, AdamArguments) {
  if (a.pairs[0] > a.capacity) return;
  const StepNumbers &n = *static_cast<const StepNumbers *>(a.numbers);
  block.each([&](int t) {
    int at = block.index() * 256 + t, array = 0;
    while (array < a.arrays && at >= a.size[array]) at -= a.size[array++];
    if (array == a.arrays) return;
    const AdamMove move({n.beta1, n.beta2, n.rate[array], n.root_correction[array], n.epsilon});
    move(a.gradient[array][at], a.value[array][at], a.mean[array][at], a.square[array][at]);
  });
}

// One block: the step's error and bits.
SGI_KERNEL(report_step, kReportThreads, FitArguments) {
  SGI_SHARED(ReportSums, sums);
  block.each([&](int t) {
    sums[0][t] = sums[1][t] = 0;
    for (int i = t; i < a.tiles; i += kReportThreads) sums[0][t] += a.errors[2 * i];
    if (a.rounding == int(Rounding::kNone)) return;
    for (int i = t; i < a.count; i += kReportThreads) sums[1][t] += double(a.bits[i]);
  });
  block.each([&](int t) {
    if (t >= 2) return;
    for (int i = 1; i < kReportThreads; ++i) sums[t][0] += sums[t][i];
  });
  block.each([&](int t) {
    if (t == 0) *static_cast<StepReport *>(a.report) = {sums[0][0], sums[1][0], a.pairs[0]};
  });
}

}  // namespace sgi
