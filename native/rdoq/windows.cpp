#include "rdoq/windows.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int kCell = 16;  // pixels per side of what two windows may not share at a time

// The first pixel whose centre is not left of `edge`, within 0 and `size`.
int first_pixel(float edge, int size) {
  return static_cast<int>(std::ceil(std::min(std::max(edge - 0.5f, 0.0f), static_cast<float>(size))));
}

// For each window in turn the earlier ones that touched one of its cells last: when they are done, it may begin.
struct Turns {
  std::vector<int32_t> order;
  std::vector<int64_t> first;    // [order + 1] where each turn's part of `awaited` begins
  std::vector<int32_t> awaited;  // turns
};

Turns turns_of(const std::vector<Window> &windows, const std::vector<int32_t> &order, const Residual &r) {
  const int64_t across = (r.row + kCell - 1) / kCell, down = (r.height + kCell - 1) / kCell;
  std::vector<int32_t> last(across * down, -1);
  Turns turns;
  turns.first.push_back(0);
  for (const int32_t i : order) {
    const Window &w = windows[i];
    if (w.empty()) continue;
    const int32_t turn = static_cast<int32_t>(turns.order.size());
    for (int64_t y = w.y / kCell; y <= (w.y + w.height - 1) / kCell; ++y)
      for (int64_t x = w.x / kCell; x <= (w.x + w.stride - 1) / kCell; ++x) {
        int32_t &cell = last[y * across + x];
        if (cell >= 0) turns.awaited.push_back(cell);
        cell = turn;
      }
    const auto from = turns.awaited.begin() + turns.first.back();
    std::sort(from, turns.awaited.end());
    turns.awaited.erase(std::unique(from, turns.awaited.end()), turns.awaited.end());
    turns.order.push_back(i);
    turns.first.push_back(static_cast<int64_t>(turns.awaited.size()));
  }
  return turns;
}

}  // namespace

Window window_around(const Splat &s, float reach, float shift, const Residual &r) {
  const float rx = reach * s.rx + shift, ry = reach * s.ry + shift;
  Window w;
  w.x = first_pixel(s.x - rx, r.width);
  w.y = first_pixel(s.y - ry, r.height);
  w.width = first_pixel(s.x + rx, r.width) - w.x;
  w.height = first_pixel(s.y + ry, r.height) - w.y;
  w.stride = (w.width + kWindowPadding - 1) / kWindowPadding * kWindowPadding;
  return w;
}

Window around_both(const Window &a, const Window &b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y, 0};
}

Window part_of(const Window &w, const Window &inner) {
  const int left = std::max(inner.x - w.x, 0) / kWindowPadding * kWindowPadding, top = std::max(inner.y - w.y, 0);
  const int right = std::min(inner.x + inner.width - w.x, w.width);
  const int bottom = std::min(inner.y + inner.height - w.y, w.height);
  return {w.x + left, w.y + top, std::max(right - left, 0), std::max(bottom - top, 0), w.stride};
}

bool holds(const Window &w, const Splat &s, const Residual &r) {
  const Window own = window_around(s, 1, 0, r);
  return own.empty() ||
         (own.x >= w.x && own.y >= w.y && own.x + own.width <= w.x + w.width && own.y + own.height <= w.y + w.height);
}

void for_each_window(const std::vector<Window> &windows, const std::vector<int32_t> &order, const Residual &residual,
                     int threads, const std::function<Worker()> &make) {
  const Turns turns = turns_of(windows, order, residual);
  const int64_t count = static_cast<int64_t>(turns.order.size());
  std::vector<std::atomic<bool>> done(count);
  std::atomic<int64_t> next{0};
  std::atomic<bool> failed{false};
  // Turns are taken in order, so the first that is not done waits for none and no thread waits without end.
  const auto take_turns = [&](const Worker &work) {
    for (int64_t turn; (turn = next.fetch_add(1)) < count;) {
      for (int64_t k = turns.first[turn]; k < turns.first[turn + 1]; ++k)
        while (!done[turns.awaited[k]].load(std::memory_order_acquire)) {
          if (failed) return;
          std::this_thread::yield();
        }
      work(turns.order[turn]);
      done[turn].store(true, std::memory_order_release);
    }
  };
  parallel_for(std::min<int64_t>(resolve_threads(threads), count), threads, [&](int64_t) {
    try {
      take_turns(make());
    } catch (...) {
      failed = true;
      throw;
    }
  });
}

}  // namespace sgi
