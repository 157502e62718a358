#include "bitstream/positions.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "base/error.hpp"
#include "model/morton.hpp"

namespace sgi {
namespace {

// P(flag = 1) in 1/256 for each 4-bit code.
constexpr int kOnes[16] = {0, 3, 6, 11, 21, 38, 67, 106, 150, 189, 218, 235, 245, 250, 253, 256};
constexpr int kScoreShifts[4] = {0, 1, 2, 4};
constexpr int kSiblings = 8;  // contexts from earlier siblings: 2 (number empty) + (any occupied)
constexpr int kSeedContexts = 4 * kSiblings, kSplitContexts = 9 * kSiblings;
// The four sides on which nodes have neighbours, and what a child's number changes by on the way there.
constexpr int kAcross[4] = {-1, 1, 0, 0}, kDown[4] = {0, 0, -1, 1}, kOther[4] = {1, 1, 2, 2};

using Flags = std::vector<uint8_t>;

const Alphabets &flag_alphabets() {
  static const Alphabets alphabets = [] {
    std::vector<int64_t> frequencies;
    for (const int one : kOnes)
      frequencies.insert(frequencies.end(), {(256 - one) * (kTotalFrequency >> 8), one * (kTotalFrequency >> 8)});
    return Alphabets(frequencies, 2);
  }();
  return alphabets;
}

// Whether the neighbour of a child on a side has the same parent.
bool is_within(int child, int side) {
  const int half = kAcross[side] ? child & 1 : child >> 1;
  return half + kAcross[side] + kDown[side] == (half ^ 1);
}

// The split nodes of one level in Morton order: places in nodes, and by side the index of the neighbour among them,
// their number where it is not split or not there.
struct Parents {
  std::vector<int32_t> x, y;
  std::array<std::vector<int32_t>, 4> beside;

  int32_t count() const { return int32_t(x.size()); }
};

// Nodes of one level that are coded together.
struct Nodes {
  std::vector<uint8_t> score, siblings;

  void add(int score_of, int siblings_of) {
    score.push_back(uint8_t(score_of)), siblings.push_back(uint8_t(siblings_of));
  }
};

class TreeReader {
 public:
  TreeReader(SymbolReader &reader, const TreeShape &shape, int64_t most) : reader_(reader), shape_(shape), most_(most) {
    shift_ = kScoreShifts[reader.number(2)];
    sent_.assign(size_t(kSeedContexts + (shape.root_log - shape.min_log + 1) * kSplitContexts), -1);
  }

  Seeds read() {
    Parents parents = roots();
    for (int level = shape_.root_log - 1; level >= shape_.min_log - 1; --level) {
      int64_t seeds = 0;
      for (const LevelSeeds &found : found_) seeds += int64_t(found.second.size());
      if (std::max<int64_t>(parents.count(), seeds) > most_)
        throw Error(Fault::limit,
                    "positions: more than " + std::to_string(most_) + " seeds at level " + std::to_string(level + 1));
      if (level >= shape_.min_log) parents = read_level(level, parents);
    }
    return seeds_of(found_);
  }

 private:
  // One flag for each context. Probabilities of contexts that have not occurred come first.
  Flags flags(const std::vector<int16_t> &contexts) {
    std::vector<uint8_t> occurs(sent_.size());
    for (const int16_t context : contexts) occurs[size_t(context)] = 1;
    std::vector<size_t> fresh;
    for (size_t context = 0; context < sent_.size(); ++context)
      if (occurs[context] && sent_[context] < 0) fresh.push_back(context);
    const std::vector<int32_t> codes = reader_.values(4, int64_t(fresh.size()));
    for (size_t i = 0; i < fresh.size(); ++i) sent_[fresh[i]] = int16_t(codes[i]);
    std::vector<int16_t> rows(contexts.size());
    for (size_t i = 0; i < rows.size(); ++i) rows[i] = sent_[size_t(contexts[i])];
    std::vector<int32_t> symbols(rows.size());
    reader_.categorical(flag_alphabets().view(), rows.data(), int64_t(rows.size()), symbols.data());
    return {symbols.begin(), symbols.end()};
  }

  // Whether each node is split, and whether it carries a seed.
  std::pair<Flags, Flags> read_nodes(int level, const Nodes &nodes) {
    const size_t n = nodes.score.size();
    std::vector<int16_t> contexts(n);
    Flags split(n);
    if (level > shape_.min_log) {
      const int first = kSeedContexts + (level - shape_.min_log) * kSplitContexts;
      for (size_t i = 0; i < n; ++i)
        contexts[i] = int16_t(first + kSiblings * (nodes.score[i] >> shift_) + nodes.siblings[i]);
      split = flags(contexts);
    }
    for (size_t i = 0; i < n; ++i)
      contexts[i] = int16_t(kSiblings * (2 * (level == shape_.min_log) + split[i]) + nodes.siblings[i]);
    Flags seed = flags(contexts);
    return {std::move(split), std::move(seed)};
  }

  Parents roots() {
    const auto columns = int32_t(shape_.columns()), rows = int32_t(shape_.rows());
    std::vector<std::pair<int64_t, std::pair<int32_t, int32_t>>> order;
    Nodes nodes;
    for (int32_t y = 0; y < rows; ++y)
      for (int32_t x = 0; x < columns; ++x) order.push_back({morton(x, y), {x, y}}), nodes.add(0, 0);
    std::sort(order.begin(), order.end());
    const auto [split, seed] = read_nodes(shape_.root_log, nodes);
    LevelSeeds found{shape_.root_log, {}};
    Parents parents;
    std::vector<int32_t> number(size_t(columns + 2) * size_t(rows + 2), -1);
    const auto place = [&](int32_t x, int32_t y) -> int32_t & {
      return number[size_t(y + 1) * size_t(columns + 2) + size_t(x + 1)];
    };
    for (size_t i = 0; i < order.size(); ++i) {
      const auto [x, y] = order[i].second;
      if (seed[i]) found.second.push_back(order[i].first);
      if (!split[i]) continue;
      place(x, y) = parents.count();
      parents.x.push_back(x), parents.y.push_back(y);
    }
    for (int side = 0; side < 4; ++side)
      for (int32_t p = 0; p < parents.count(); ++p) {
        const int32_t other = place(parents.x[size_t(p)] + kAcross[side], parents.y[size_t(p)] + kDown[side]);
        parents.beside[size_t(side)].push_back(other < 0 ? parents.count() : other);
      }
    found_.push_back(std::move(found));
    return parents;
  }

  // 2 for each neighbour that is known to be split, 1 for each one that is not coded yet and whose parent is split.
  static int score_of(const Parents &parents, const Flags &split, size_t p, int child) {
    int score = 0;
    for (int side = 0; side < 4; ++side) {
      const int other = child ^ kOther[side];
      const size_t owner = is_within(child, side) ? p : size_t(parents.beside[size_t(side)][p]);
      score += other < child ? 2 * split[4 * owner + size_t(other)] : owner != parents.x.size();
    }
    return score;
  }

  Parents read_level(int level, const Parents &parents) {
    const auto count = size_t(parents.count());
    Flags seed(4 * count), split(4 * (count + 1));  // the last four are those of neighbours that are not there
    Flags empty(count), occupied(count);
    std::vector<size_t> members;
    for (int child = 0; child < 4; ++child) {
      Nodes nodes;
      members.clear();
      for (size_t p = 0; p < count; ++p) {
        if ((2 * int64_t(parents.x[p]) + (child & 1)) << level >= shape_.width) continue;
        if ((2 * int64_t(parents.y[p]) + (child >> 1)) << level >= shape_.height) continue;
        members.push_back(p);
        nodes.add(score_of(parents, split, p, child), 2 * empty[p] + occupied[p]);
      }
      const auto [splits, seeds] = read_nodes(level, nodes);
      for (size_t i = 0; i < members.size(); ++i) {
        const size_t p = members[i], slot = 4 * p + size_t(child);
        const bool taken = splits[i] | seeds[i];
        split[slot] = splits[i], seed[slot] = seeds[i];
        empty[p] = uint8_t(empty[p] + !taken), occupied[p] |= uint8_t(taken);
      }
    }
    if (std::find(occupied.begin(), occupied.end(), 0) != occupied.end())
      throw Error(Fault::corrupt, "positions: a split node of level " + std::to_string(level + 1) + " has no children");
    LevelSeeds found{level, {}};
    for (size_t slot = 0; slot < seed.size(); ++slot)
      if (seed[slot])
        found.second.push_back(4 * morton(parents.x[slot >> 2], parents.y[slot >> 2]) + int64_t(slot & 3));
    found_.push_back(std::move(found));
    return split_ones(parents, split);
  }

  // The children that are split: their neighbours are children of the same node or of a neighbour.
  static Parents split_ones(const Parents &parents, const Flags &split) {
    Parents children;
    std::vector<int32_t> number(split.size(), -1);
    std::vector<size_t> found;
    for (size_t slot = 0; slot < 4 * parents.x.size(); ++slot) {
      if (!split[slot]) continue;
      number[slot] = int32_t(found.size());
      found.push_back(slot);
      children.x.push_back(2 * parents.x[slot >> 2] + int32_t(slot & 1));
      children.y.push_back(2 * parents.y[slot >> 2] + int32_t(slot >> 1 & 1));
    }
    for (int side = 0; side < 4; ++side)
      for (const size_t slot : found) {
        const int child = int(slot & 3);
        const size_t p = slot >> 2, owner = is_within(child, side) ? p : size_t(parents.beside[size_t(side)][p]);
        const int32_t other = number[4 * owner + size_t(child ^ kOther[side])];
        children.beside[size_t(side)].push_back(other < 0 ? children.count() : other);
      }
    return children;
  }

  SymbolReader &reader_;
  const TreeShape &shape_;
  int64_t most_;
  int shift_;
  std::vector<int16_t> sent_;  // the probability code of each context, -1 before it occurs
  std::vector<LevelSeeds> found_;
};

}  // namespace

Seeds read_positions(SymbolReader &reader, const TreeShape &shape, int64_t most) {
  return TreeReader(reader, shape, most).read();
}

}  // namespace sgi
