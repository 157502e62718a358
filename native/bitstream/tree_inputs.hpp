// What predicts a seed's place (docs/format.md, "Predicted flags"): inputs of a batch of nodes, and from a level's
// split nodes to those of the next.
#pragma once
#include <cstdint>

#include "model/network.hpp"

namespace sgi {

// Neighbours of a node: (-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1).
constexpr int kSides = 8;
constexpr int kSideX[kSides] = {-1, 0, 1, -1, 1, -1, 0, 1}, kSideY[kSides] = {-1, -1, -1, 0, 0, 1, 1, 1};
// A level is coded child number after child number, in this order: diagonal ones first, so that the other two have
// known neighbours on all four sides.
constexpr int kChildren[4] = {0, 3, 1, 2};
constexpr int kAbove = 1 + 3 * kSides + 6;  // what a split node adds to the inputs of its children, see SplitNodes
constexpr int kDetail = 5;                  // numbers that the base layer adds
constexpr int kHead = 11;                   // level (6), quality, rates (4)
constexpr int kFixedInputs = kHead + kDetail + kAbove;

// The split nodes of one level in Morton order. above: 64 times the own seed and split, seed, exists of each neighbour;
// then of the parent and of its parent 64 times its seed and 16 times the splits and seeds in 3 x 3 nodes around it.
struct SplitNodes {
  const int32_t *x, *y;      // [P]
  const int32_t *neighbour;  // [P, kSides] indices among them, P for none
  const int16_t *above;      // [P, kAbove]
  int64_t count;
};

// Their children, four slots each, and a last row of zeros for those of nodes that are not split or not there.
struct Slots {
  const uint8_t *exists;  // [P + 1, 4]
  const int16_t *flags;   // [P + 1, 4, 2] 64 times split, seed
};

// Inputs that child number `child` has: kFixedInputs and two for each of the nodes around it that are coded before.
int tree_input_count(int child);

// How much the base layer [C, rows, columns] varies at each of its cells, in sixteenths of an octave: out [rows,
// columns, kDetail].
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
               int16_t *flags, uint8_t *occupied);

// Rows of inputs for child number `child`, a node of `level`, of each of n parents; head [kHead].
void tree_inputs(const SplitNodes &parents, const Slots &slots, const BaseDetail &detail, const int16_t *head,
                 int level, int child, const int32_t *members, int64_t n, int16_t *out);

// What a network whose outputs are log-odds in 1/256 says of them: rows [n, outputs], the odds in units of 2^`shift`,
// clipped to +-most and moved by most.
void tree_rows(const Network &network, const SplitNodes &parents, const Slots &slots, const BaseDetail &detail,
               const int16_t *head, int level, int child, const int32_t *members, int64_t n, int shift, int most,
               int threads, int16_t *rows);

// The nodes in the m given slots, ascending, which are the split ones: everything of SplitNodes but x and y, which are
// written too. `number` [P + 1, 4] is scratch.
void split_children(const SplitNodes &parents, const Slots &slots, const int32_t *found, int64_t m, int32_t *number,
                    int32_t *x, int32_t *y, int32_t *neighbour, int16_t *above);

}  // namespace sgi
