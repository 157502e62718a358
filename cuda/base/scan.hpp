// Exclusive sums of integers: sums of chunks, their sums, then each chunk from where it starts.
#pragma once
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"

namespace sgi {

constexpr int kScanThreads = 256, kScanItems = 8, kScanChunk = kScanThreads * kScanItems;

namespace {

using ScanSums = int32_t[2][kScanThreads];

// Turns what every thread has in sums[0] into what all threads before it have; returns the half that holds it.
inline int sum_before(const ThreadBlock<kScanThreads> &block, ScanSums &sums) {
  int from = 0;
  for (int apart = 1; apart < kScanThreads; apart *= 2, from = 1 - from)
    block.each([&](int t) { sums[1 - from][t] = sums[from][t] + (t >= apart ? sums[from][t - apart] : 0); });
  block.each([&](int t) { sums[1 - from][t] = t ? sums[from][t - 1] : 0; });
  return 1 - from;
}

inline int items_of(const ScanArguments &a, int first) {
  const int left = a.count - first;
  return left < 0 ? 0 : left < kScanItems ? left : kScanItems;
}

}  // namespace

SGI_KERNEL(scan_chunks, kScanThreads, ScanArguments) {
  SGI_SHARED(ScanSums, sums);
  block.each([&](int t) {
    const int first = (block.index() * kScanThreads + t) * kScanItems;
    sums[0][t] = 0;
    for (int i = 0; i < items_of(a, first); ++i) sums[0][t] += a.values[first + i];
  });
  const int half = sum_before(block, sums);
  block.each([&](int t) {
    const int first = (block.index() * kScanThreads + t) * kScanItems;
    int sum = sums[half][t];
    for (int i = 0; i < items_of(a, first); ++i) {
      const int value = a.values[first + i];
      a.values[first + i] = sum;
      sum += value;
    }
    if (t == kScanThreads - 1) a.totals[block.index()] = sum;
  });
}

// One block: sums over the chunks' totals.
SGI_KERNEL(scan_totals, kScanThreads, ScanArguments) {
  SGI_SHARED(ScanSums, sums);
  const int chunks = (a.count + kScanChunk - 1) / kScanChunk, share = (chunks + kScanThreads - 1) / kScanThreads;
  const auto end = [&](int t) { return (t + 1) * share < chunks ? (t + 1) * share : chunks; };
  block.each([&](int t) {
    sums[0][t] = 0;
    for (int i = t * share; i < end(t); ++i) sums[0][t] += a.totals[i];
  });
  const int half = sum_before(block, sums);
  block.each([&](int t) {
    int sum = sums[half][t];
    for (int i = t * share; i < end(t); ++i) {
      const int value = a.totals[i];
      a.totals[i] = sum;
      sum += value;
    }
    if (t == kScanThreads - 1) a.values[a.count] = sum;
  });
}

SGI_KERNEL(scan_add, kScanThreads, ScanArguments) {
  block.each([&](int t) {
    const int first = (block.index() * kScanThreads + t) * kScanItems;
    for (int i = 0; i < items_of(a, first); ++i) a.values[first + i] += a.totals[block.index()];
  });
}

}  // namespace sgi
