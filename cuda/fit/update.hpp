// The end of a step: Adam, and what the host is told.
#pragma once
#include "cuda/fit/state.hpp"
#include "fit/adam_move.hpp"

namespace sgi {

constexpr int kReportThreads = 256;

namespace {

using ReportSums = double[2][kReportThreads];

}  // namespace

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
