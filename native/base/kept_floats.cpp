#include "base/kept_floats.hpp"

#include <algorithm>
#include <mutex>
#include <vector>

#include "base/per_process.hpp"

namespace sgi {
namespace {

constexpr int64_t kMaxKept = 1 << 21;  // floats without an owner, in all
constexpr size_t kMaxBlocks = 64;
constexpr int64_t kMaxWaste = 2;  // times what is asked for

struct Block {
  std::unique_ptr<float[]> floats;
  int64_t size;
};

// Blocks without an owner.
struct Store {
  Store() { blocks.reserve(kMaxBlocks); }

  std::mutex mutex;
  std::vector<Block> blocks;
  int64_t floats = 0;
};

// The smallest block of at least so many floats, a new one if there is none that fits.
Block taken(int64_t size) {
  Store &from = per_process<Store>();
  {
    const std::lock_guard<std::mutex> lock(from.mutex);
    auto best = from.blocks.end();
    for (auto block = from.blocks.begin(); block != from.blocks.end(); ++block)
      if (block->size >= size && block->size <= kMaxWaste * size &&
          (best == from.blocks.end() || block->size < best->size))
        best = block;
    if (best != from.blocks.end()) {
      std::swap(*best, from.blocks.back());
      Block found = std::move(from.blocks.back());
      from.blocks.pop_back();
      from.floats -= found.size;
      return found;
    }
  }
  return {std::unique_ptr<float[]>(new float[size_t(size)]), size};
}

}  // namespace

float *KeptFloats::room(int64_t size) {
  if (size > size_) {
    give_back();
    Block block = taken(size);
    held_ = std::move(block.floats), size_ = block.size;
  }
  return held_.get();
}

void KeptFloats::give_back() {
  if (!held_) return;
  Block block{std::move(held_), std::exchange(size_, 0)};
  Store &to = per_process<Store>();
  const std::lock_guard<std::mutex> lock(to.mutex);
  if (to.floats + block.size > kMaxKept || to.blocks.size() == kMaxBlocks) return;
  to.floats += block.size;
  to.blocks.push_back(std::move(block));
}

}  // namespace sgi
