#include "bitstream/tree_walk.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "base/error.hpp"
#include "model/morton.hpp"

namespace sgi {
namespace {

constexpr int16_t kOne = 64;
constexpr int64_t kMaxParents = (int64_t(1) << 28) - 1;  // slots are numbered by 32 bits

// Which share of flags was 1 so far, of split flags and of seed flags of nodes that are not split: on the level before
// and on this one.
class Rates {
 public:
  void next_level() {
    before_ = now_;
    now_ = {};
  }

  void count(const std::vector<uint8_t> &split, const std::vector<uint8_t> &seed, bool has_split) {
    for (size_t i = 0; i < split.size(); ++i) {
      if (has_split) ++now_[0].flags, now_[0].ones += split[i];
      if (!split[i]) ++now_[1].flags, now_[1].ones += seed[i];
    }
  }

  void write(int16_t *out) const {
    for (int kind = 0; kind < 2; ++kind) {
      const int64_t before = (64 * before_[kind].ones + 32) / (before_[kind].flags + 1);
      *out++ = int16_t(2 * before);
      *out++ = int16_t(2 * ((64 * now_[kind].ones + 16 * before) / (now_[kind].flags + 16)));
    }
  }

 private:
  struct Count {
    int64_t flags = 0, ones = 0;
  };
  std::array<Count, 2> now_{}, before_{};
};

void require_few(int64_t count, int64_t most, const std::string &where) {
  if (count > most) throw Error(Fault::limit, "positions: more than " + std::to_string(most) + " seeds" + where);
}

}  // namespace

TreeScenery::TreeScenery(int64_t width, int64_t height, const int64_t *base, int64_t channels, int64_t rows,
                         int64_t columns, int64_t cell, int quality)
    : width_(width), height_(height), rows_(rows), columns_(columns), cell_(cell), quality_(quality) {
  if (cell == 0) return;
  detail_.resize(size_t(rows * columns) * kDetail);
  base_detail(base, channels, rows, columns, detail_.data());
}

BaseDetail TreeScenery::detail() const { return {detail_.empty() ? nullptr : detail_.data(), rows_, columns_, cell_}; }

TreeLevel::TreeLevel(const TreeScenery &scenery) : level_(kRootLevel) {
  const int64_t side = int64_t(2) << kRootLevel;
  const int64_t columns = (scenery.width() + side - 1) / side, rows = (scenery.height() + side - 1) / side;
  const auto count = size_t(columns * rows);
  std::vector<std::pair<int64_t, int32_t>> order(count);
  for (size_t i = 0; i < count; ++i)
    order[i] = {morton(int32_t(int64_t(i) % columns), int32_t(int64_t(i) / columns)), int32_t(i)};
  std::sort(order.begin(), order.end());
  std::vector<int32_t> number(size_t((columns + 2) * (rows + 2)), int32_t(count));
  const auto place = [&](size_t i, int dx, int dy) -> int32_t & {
    return number[size_t((y_[i] + 1 + dy) * (columns + 2) + x_[i] + 1 + dx)];
  };
  x_.resize(count), y_.resize(count), neighbour_.resize(count * kSides), above_.assign(count * kAbove, 0);
  for (size_t i = 0; i < count; ++i) {
    x_[i] = int32_t(order[i].second % columns), y_[i] = int32_t(order[i].second / columns);
    place(i, 0, 0) = int32_t(i);
  }
  for (size_t i = 0; i < count; ++i)
    for (int side_number = 0; side_number < kSides; ++side_number) {
      const int32_t other = place(i, kSideX[side_number], kSideY[side_number]);
      neighbour_[i * kSides + size_t(side_number)] = other;
      int16_t *of = above_.data() + i * kAbove + 1 + 3 * side_number;
      of[0] = of[2] = size_t(other) < count ? kOne : 0;  // split and existing
    }
  open(scenery);
  std::fill(occupied_.begin(), occupied_.end(), uint8_t(1));  // roots may all be empty
}

TreeLevel::TreeLevel(const TreeLevel &above, const TreeScenery &scenery) : level_(above.level_ - 1) {
  std::vector<int32_t> found;
  for (size_t slot = 0; slot < 4 * size_t(above.parents()); ++slot)
    if (above.flags_[2 * slot]) found.push_back(int32_t(slot));
  const size_t count = found.size();
  x_.resize(count), y_.resize(count), neighbour_.resize(count * kSides), above_.resize(count * kAbove);
  std::vector<int32_t> number(above.exists_.size());
  split_children(above.nodes(), above.slots(), found.data(), int64_t(count), number.data(), x_.data(), y_.data(),
                 neighbour_.data(), above_.data());
  open(scenery);
}

void TreeLevel::open(const TreeScenery &scenery) {
  const size_t count = x_.size();
  exists_.resize(4 * (count + 1)), flags_.assign(8 * (count + 1), 0), occupied_.assign(count, 0);
  children_inside(nodes(), level_, scenery.width(), scenery.height(), exists_.data());
}

SplitNodes TreeLevel::nodes() const { return {x_.data(), y_.data(), neighbour_.data(), above_.data(), parents()}; }

std::pair<std::vector<int32_t>, std::vector<uint8_t>> TreeLevel::batch(int child) const {
  std::vector<int32_t> members(x_.size() + 1);
  std::vector<uint8_t> needed(x_.size() + 1);
  const int64_t n = begin_batch(parents(), exists_.data(), occupied_.data(), child, members.data(), needed.data());
  members.resize(size_t(n)), needed.resize(size_t(n));
  return {std::move(members), std::move(needed)};
}

void TreeLevel::take(const std::vector<int32_t> &members, int child, const uint8_t *split, const uint8_t *seed) {
  end_batch(members.data(), int64_t(members.size()), child, split, seed, flags_.data(), occupied_.data());
}

int64_t TreeLevel::code(int64_t parent, int child) const {
  return 4 * morton(x_[size_t(parent)], y_[size_t(parent)]) + child;
}

std::vector<int64_t> TreeLevel::seeds() const {
  std::vector<int64_t> codes;
  for (int64_t slot = 0; slot < 4 * parents(); ++slot)
    if (flags_[2 * size_t(slot) + 1]) codes.push_back(code(slot >> 2, int(slot & 3)));
  return codes;
}

void TreeBatch::inputs(int16_t *out) const {
  tree_inputs(of.nodes(), of.slots(), scenery.detail(), head.data(), of.level(), child, members.data(), size(), out);
}

void TreeBatch::rows(const Network &network, int shift, int most, int threads, int16_t *out) const {
  tree_rows(network, of.nodes(), of.slots(), scenery.detail(), head.data(), of.level(), child, members.data(), size(),
            shift, most, threads, out);
}

void TreeBatch::seed_rows(const int16_t *rows, const uint8_t *split, int16_t certain, int16_t *out) const {
  for (size_t i = 0; i < members.size(); ++i)
    out[i] = split[i] ? rows[3 * i + 2] : needed[i] ? certain : rows[3 * i + 1];
}

std::vector<LevelSeeds> walk_tree(const TreeScenery &scenery, int64_t most, const CodeBatch &code) {
  Rates rates;
  std::vector<LevelSeeds> found;
  int64_t seeds = 0;
  TreeLevel level(scenery);
  most = std::min(most, kMaxParents);
  for (int log_size = kRootLevel; log_size >= kMinLevel; --log_size) {
    if (log_size < kRootLevel) {
      level = TreeLevel(level, scenery);
      require_few(std::max(level.parents(), seeds), most, " at level " + std::to_string(log_size + 1));
    }
    rates.next_level();
    for (const int child : kChildren) {
      auto [members, needed] = level.batch(child);
      TreeBatch batch{scenery, level, child, std::move(members), std::move(needed), {}};
      batch.head[size_t(log_size - kMinLevel)] = kOne;
      batch.head[kHead - 5] = int16_t(scenery.quality());
      rates.write(batch.head.data() + kHead - 4);
      std::vector<uint8_t> split(size_t(batch.size())), seed(size_t(batch.size()));
      code(batch, split.data(), seed.data());
      level.take(batch.members, child, split.data(), seed.data());
      rates.count(split, seed, log_size > kMinLevel);
    }
    found.emplace_back(log_size, level.seeds());
    seeds += int64_t(found.back().second.size());
  }
  require_few(seeds, most, "");
  return found;
}

}  // namespace sgi
