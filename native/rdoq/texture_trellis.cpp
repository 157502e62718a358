#include "rdoq/texture_trellis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace sgi {

namespace {

constexpr float kImpossible = std::numeric_limits<float>::infinity();
constexpr int kMaxSymbol = 16000, kStates = kQuantizerStates;
// docs/notes/2026-11-luma-space.md has a smaller kHopeless.
constexpr float kHopeless = 0.6f;  // squared steps by which a survivor costs more than the best one and is given up
constexpr float kWorth = 0.25f;    // amplitudes in steps below which nothing but 0 is tried

// The best symbols so far that end in a state.
struct Survivor {
  float cost = kImpossible;
  bool any = false;  // on this diagonal
  int known = 0;     // which of the trellis's magnitudes are its own
};

// How a survivor came about: the symbol, and the state before it.
struct Move {
  int16_t symbol;
  uint8_t from;
};

struct Step {
  float cost = kImpossible;
  Move move{};
};

// Bits of the magnitudes of a symbol, whose probabilities are looked up when they are asked for.
class MagnitudeBits {
 public:
  // Those of another context are forgotten.
  void look_up(const BitModels &models, const BitContext &context) {
    context_ = context, known_ = 1;
    ones_[0] = models.predict(context_).one;
    zero_ = bit_cost(ones_[0], 0);
    larger_[0] = 1;  // the sign
  }

  float of(const BitModels &models, int magnitude) {
    if (!magnitude) return zero_;
    const int last = std::min(magnitude, kMagnitudeBits);
    for (; known_ <= last; ++known_) {
      larger_[known_] = larger_[known_ - 1] + bit_cost(ones_[known_ - 1], 1);
      if (known_ < kMagnitudeBits) ones_[known_] = models.predict(SymbolContext::later(context_, known_)).one;
    }
    if (magnitude < kMagnitudeBits) return larger_[magnitude] + bit_cost(ones_[magnitude], 0);
    return larger_[last] + float(2 * std::ilogb(float(magnitude - kMagnitudeBits + 1)) + 1);
  }

 private:
  BitContext context_;
  std::array<int32_t, kMagnitudeBits> ones_;
  std::array<float, kMagnitudeBits + 1> larger_;  // bits that say that a magnitude is at least this, and its sign
  float zero_;
  int known_;  // how many of `larger_` are
};

// The survivors of the symbols so far, in coding order.
class Trellis {
 public:
  Trellis(const BitModels &models, const SymbolContext &context, float lambda)
      : models_(models), context_(context), lambda_(lambda) {
    survivors_[0].cost = 0;
    for (int state = 0; state < kStates; ++state) survivors_[state].known = state;
  }

  // Goes on to the next diagonal.
  void advance() {
    for (int state = 0; state < kStates; ++state) {
      survivors_[state].any = false;
      if (survivors_[state].cost < kImpossible) known_[survivors_[state].known].advance();
    }
  }

  // Goes on to the next symbol. scaled: |amplitude| in steps.
  void add(int u, int v, float scaled) {
    std::array<Step, kStates> best;
    std::array<NearMagnitudes, kStates> near;
    for (int state = 0; state < kStates; ++state) {
      if (survivors_[state].cost == kImpossible) continue;
      near[state] = known_[survivors_[state].known].near(u);
      extend(state, scaled, bits_for(state, near, u, v), best);
    }
    moves_.emplace_back();
    float most = kImpossible;
    for (const Step &step : best) most = std::min(most, step.cost + kHopeless);
    for (Step &step : best)
      if (step.cost > most) step.cost = kImpossible;
    std::array<bool, kStates> taken{};  // magnitudes of survivors, by those that go on from them
    for (int state = 0; state < kStates; ++state) {
      const auto [cost, move] = best[state];
      moves_.back()[state] = move;
      Survivor &next = next_[state];
      next.cost = cost, next.any = false, next.known = -1;
      if (cost == kImpossible) continue;
      next.any = survivors_[move.from].any || move.symbol;
      if (!taken[move.from]) next.known = survivors_[move.from].known, taken[move.from] = true;
    }
    int free = 0;
    for (int state = 0; state < kStates; ++state) {
      Survivor &next = next_[state];
      if (next.known < 0) {  // the others take what nobody goes on from
        while (taken[free]) ++free;
        next.known = survivors_[free++].known;
        const Survivor &from = survivors_[best[state].move.from];
        if (next.cost < kImpossible) known_[next.known] = known_[from.known];
      }
    }
    for (int state = 0; state < kStates; ++state)
      if (next_[state].cost < kImpossible && best[state].move.symbol)
        known_[next_[state].known].set(u, best[state].move.symbol);
    std::swap(survivors_, next_);
  }

  // Of those that have symbols on this diagonal, the best; its state, -1 for none.
  int best_here() const {
    int found = -1;
    for (int state = 0; state < kStates; ++state)
      if (survivors_[state].any && (found < 0 || survivors_[state].cost < survivors_[found].cost)) found = state;
    return found;
  }
  float cost(int state) const { return survivors_[state].cost; }

  // Puts the symbols of the first `count` additions, after which the state was this one, where `scan` has them.
  void trace(size_t count, int state, const std::vector<int16_t> &scan, CellSymbols &values) const {
    while (count--) {
      const Move move = moves_[count][state];
      values[scan[count]] = move.symbol;
      state = move.from;
    }
  }

 private:
  // States of one quantiser that see the same share what has been looked up: most of them do where symbols are rare.
  MagnitudeBits &bits_for(int state, const std::array<NearMagnitudes, kStates> &near, int u, int v) {
    for (int other = state & 1; other < state; other += 2)
      if (survivors_[other].cost < kImpossible && near[other].inside == near[state].inside &&
          near[other].next == near[state].next)
        return bits_[shared_[state] = shared_[other]];
    bits_[shared_[state] = state].look_up(models_, context_.at(near[state], u, v, QuantizerState(state)));
    return bits_[state];
  }

  void extend(int from, float scaled, MagnitudeBits &bits, std::array<Step, kStates> &best) const {
    const QuantizerState state(from);
    const auto try_out = [&](int magnitude) {
      const float error = magnitude ? scaled - state.magnitude(magnitude) : scaled;
      const float cost = survivors_[from].cost + error * error + lambda_ * bits.of(models_, magnitude);
      Step &step = best[state.after(magnitude).index()];
      if (cost < step.cost) step = {cost, {int16_t(magnitude), uint8_t(from)}};
    };
    try_out(0);
    if (scaled < kWorth) return;
    const int below = std::min(int(scaled + (state.odd() ? 0.5f : 0.0f)), kMaxSymbol);
    if (below) try_out(below);
    try_out(below + 1);
    if (below > 1) try_out(below - 1);
  }

  const BitModels &models_;
  const SymbolContext &context_;
  const float lambda_;
  std::array<std::array<Survivor, kStates>, 2> kept_;
  Survivor *survivors_ = kept_[0].data(), *next_ = kept_[1].data();
  std::array<KnownMagnitudes, kStates> known_;
  std::array<MagnitudeBits, kStates> bits_;
  std::array<int, kStates> shared_;
  std::vector<std::array<Move, kStates>> moves_;
};

float extent_bits(const BitModels &models, const ExtentContext &context, int log, int value) {
  float sum = 0;
  for (int node = 1, place = log; place >= 0; --place) {
    sum += bit_cost(models.predict(context.at(node)).one, value >> place & 1);
    node = 2 * node + (value >> place & 1);
  }
  return sum;
}

int diagonal_of(int index, int log) { return (index & ((1 << log) - 1)) + (index >> log); }

}  // namespace

void choose_block(const BitModels &models, const TextureField &field, const TextureCell &cell, int channel,
                  float lambda, const CellValues<float> &scaled, Choice &choice) {
  const std::vector<int16_t> &scan = texture_scan(cell.log);
  float beyond = 0;  // squared error of what has not been chosen yet
  int most = -1;
  for (const int index : scan) {
    beyond += scaled[index] * scaled[index];
    if (scaled[index] > 0.5f) most = diagonal_of(index, cell.log);
  }
  const ExtentContext extent(field, cell, channel);
  choice.values.fill(0);
  choice.last = -1, choice.cost = beyond + lambda * extent_bits(models, extent, cell.log, 0);
  if (most < 0) return;
  const SymbolContext context(field, cell, channel, most);
  Trellis trellis(models, context, lambda);
  size_t count = 0, at = 0;
  int state = 0;
  for (int diagonal = 0; diagonal <= most; ++diagonal) {
    if (diagonal) trellis.advance();
    for (; at < scan.size() && diagonal_of(scan[at], cell.log) == diagonal; ++at) {
      const int index = scan[at];
      beyond -= scaled[index] * scaled[index];
      trellis.add(index & (cell.side() - 1), index >> cell.log, scaled[index]);
    }
    const int best = trellis.best_here();
    if (best < 0) continue;
    const float sum =
        trellis.cost(best) + std::max(beyond, 0.0f) + lambda * extent_bits(models, extent, cell.log, diagonal + 1);
    if (sum < choice.cost) choice.cost = sum, choice.last = diagonal, count = at, state = best;
  }
  trellis.trace(count, state, scan, choice.values);
}

}  // namespace sgi
