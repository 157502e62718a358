// What predicts a seed's place (docs/format.md, "Predicted flags"): inputs of a batch of nodes, and from a level's split
// nodes to those of the next.
#pragma once
#include <cstdint>

#include "../../model/cpp/network.hpp"

namespace sgi {

// Neighbours of a node: (-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1).
constexpr int kSides = 8;
constexpr int kBeside = 1 + 3 * kSides;  // own seed; split, seed, exists of each neighbour
constexpr int kAround = 6;               // seed, splits, seeds in 3 x 3 nodes: of the parent and of its parent
constexpr int kDetail = 5;               // numbers that the base layer adds
constexpr int kHead = 11;                // level (6), quality, rates (4)
constexpr int kFixedInputs = kHead + kDetail + kBeside + kAround;

// The split nodes of one level in Morton order; their children have four slots each, of one more row for those of
// nodes that are not split or not there, all zeros.
struct SplitNodes {
  const int32_t *x, *y;     // [P]
  const int32_t *neighbour; // [P, kSides] indices among them, P for none
  const uint8_t *beside;    // [P, kBeside]
  const uint8_t *around;    // [P, kAround]
  int64_t count;
};

struct Slots {
  const uint8_t *exists, *split, *seed;  // [P + 1, 4]
};

// Inputs that child number `child` has: kFixedInputs and two for each of the nodes around it that are coded before.
int tree_input_count(int child);

// How much the base layer [C, rows, columns] varies at each of its cells, in eighths of an octave: out [rows, columns,
// kDetail].
void base_detail(const int64_t *base, int64_t channels, int64_t rows, int64_t columns, int16_t *out);

struct BaseDetail {
  const int16_t *values;  // [rows, columns, kDetail], or none
  int64_t rows, columns, cell;
};

// Which children lie in a picture of width x height pixels: exists [P + 1, 4], the last row zeros.
void children_inside(const SplitNodes &parents, int level, int64_t width, int64_t height, uint8_t *exists);

// The parents whose child number `child` exists, and which of these children must not be empty, being the last of their
// parent's where none is occupied [P] so far; their number. members and needed have room for P + 1.
int64_t begin_batch(int64_t count, const uint8_t *exists, const uint8_t *occupied, int child, int32_t *members,
                    uint8_t *needed);

// Puts the flags of a batch into their slots.
void end_batch(const int32_t *members, int64_t n, int child, const uint8_t *split_flags, const uint8_t *seed_flags,
               uint8_t *split, uint8_t *seed, uint8_t *occupied);

// Rows of inputs for child number `child`, a node of `level`, of each of n parents; head [kHead].
void tree_inputs(const SplitNodes &parents, const Slots &slots, const BaseDetail &detail, const int16_t *head, int level,
                 int child, const int32_t *members, int64_t n, int16_t *out);

// What a network whose outputs are log-odds in 1/256 says of them: rows [n, outputs], the odds in units of 2^`shift`,
// clipped to +-most and moved by most.
void tree_rows(const Network &network, const SplitNodes &parents, const Slots &slots, const BaseDetail &detail,
               const int16_t *head, int level, int child, const int32_t *members, int64_t n, int shift, int most,
               int threads, int16_t *rows);

// The nodes in the m given slots, ascending, which are the split ones: everything of SplitNodes but x and y, which are
// written too. `number` [P + 1, 4] is scratch.
void split_children(const SplitNodes &parents, const Slots &slots, const int32_t *found, int64_t m, int32_t *number,
                    int32_t *x, int32_t *y, int32_t *neighbour, uint8_t *beside, uint8_t *around);

}  // namespace sgi
