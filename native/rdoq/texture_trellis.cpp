#include "rdoq/texture_trellis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace sgi {

namespace {

constexpr float kImpossible = std::numeric_limits<float>::infinity();
constexpr int kMaxSymbol = 16000, kStates = kQuantizerStates, kHalf = kStates / 2;
// docs/notes/2026-11-luma-space.md has a smaller kHopeless.
constexpr float kHopeless = 0.6f;   // squared steps by which a survivor costs more than the best one and is given up
constexpr float kWorth = 0.25f;     // amplitudes in steps below which nothing but 0 is tried
constexpr float kLastWorth = 0.6f;  // those beyond the last of which nothing is (docs/notes/2026-11-ladder.md)

// What a state may be followed by, for symbols of either parity: the best symbol, and by how much the cost grows.
struct Offer {
  std::array<float, 2> cost;
  std::array<int16_t, 2> symbol;
};
using Offers = std::array<const Offer *, kStates>;  // null where there is no survivor

// The best symbols so far that end in each state. known: which of the trellis's magnitudes are a state's own.
struct Survivors {
  std::array<float, kStates> cost;
  std::array<bool, kStates> any;  // on this diagonal
  std::array<int, kStates> known;
};

// How survivors came about: the last symbol of each, and the state before it.
struct Moves {
  std::array<int16_t, kStates> symbol;
  std::array<uint8_t, kStates> from;
};

// Bits of the magnitudes of a symbol, whose probabilities are looked up when they are asked for.
class MagnitudeBits {
 public:
  MagnitudeBits(const BitModels &models, const SymbolPlace &place, const NearMagnitudes &near, QuantizerState state)
      : context_(place.at(near, state)) {
    ones_[0] = models.predict(context_);
    zero_ = bit_cost(ones_[0], 0);
    larger_[0] = 1;  // the sign
  }

  float of(const BitModels &models, int magnitude) {
    if (!magnitude) return zero_;
    const int last = std::min(magnitude, kMagnitudeBits);
    for (; known_ <= last; ++known_) {
      larger_[known_] = larger_[known_ - 1] + bit_cost(ones_[known_ - 1], 1);
      if (known_ < kMagnitudeBits) ones_[known_] = models.predict(SymbolContext::later(context_, known_));
    }
    if (magnitude < kMagnitudeBits) return larger_[magnitude] + bit_cost(ones_[magnitude], 0);
    return larger_[last] + float(2 * std::ilogb(float(magnitude - kMagnitudeBits + 1)) + 1);
  }

 private:
  const BitContext context_;
  std::array<int32_t, kMagnitudeBits> ones_;
  std::array<float, kMagnitudeBits + 1> larger_;  // bits that say that a magnitude is at least this, and its sign
  float zero_;
  int known_ = 1;  // how many of `larger_` are
};

// The survivors of the symbols so far, in coding order. States i and i + 4 are followed by 2 i and 2 i + 1.
class Trellis {
 public:
  Trellis(const BitModels &models, const SymbolContext &context, float lambda)
      : models_(models), context_(context), lambda_(lambda) {
    now_.cost.fill(kImpossible), now_.any.fill(false);
    now_.cost[0] = 0;
    for (int state = 0; state < kStates; ++state) now_.known[state] = state;
  }

  // Goes on to the next diagonal.
  void advance() {
    now_.any.fill(false);
    for (int state = 0; state < kStates; ++state)
      if (is_alive(state)) known_[now_.known[state]].advance();
  }

  // Goes on to the next symbol. scaled: |amplitude| in steps.
  void add(const Frequency &at, float scaled) {
    const SymbolPlace place = context_.place(at);
    Moves &moves = moves_[count_++];
    Survivors next;
    scaled < kWorth ? add_zero(place, at.u, scaled, next, moves) : add_best(place, at.u, scaled, next, moves);
    const float most = *std::min_element(next.cost.begin(), next.cost.end()) + kHopeless;
    for (float &cost : next.cost)
      if (cost > most) cost = kImpossible;
    now_ = next;
  }

  // Of those that have symbols on this diagonal, the best; its state, -1 for none.
  int best_here() const {
    int found = -1;
    for (int state = 0; state < kStates; ++state)
      if (now_.any[state] && is_alive(state) && (found < 0 || now_.cost[state] < now_.cost[found])) found = state;
    return found;
  }
  float cost(int state) const { return now_.cost[state]; }
  bool is_alive(int state) const { return now_.cost[state] < kImpossible; }

  // Puts the symbols of the first `count` additions, after which the state was this one, where `scan` has them, with
  // the signs of the amplitudes.
  void trace(size_t count, int state, const std::vector<Frequency> &scan, const CellValues<float> &scaled,
             CellSymbols &values) const {
    while (count--) {
      const int index = scan[count].index, magnitude = moves_[count].symbol[state];
      values[index] = int16_t(scaled[index] < 0 ? -magnitude : magnitude);
      state = moves_[count].from[state];
    }
  }

 private:
  // What the next symbol has near it, for each survivor.
  using Near = std::array<NearMagnitudes, kStates>;

  // The first survivor of the same quantiser that sees the same: where symbols are rare, most do.
  int alike(int state, const Near &near) const {
    for (int other = state & 1; other < state; other += 2)
      if (is_alive(other) && near[other].inside == near[state].inside && near[other].next == near[state].next)
        return other;
    return state;
  }

  void add_best(const SymbolPlace &place, int u, float scaled, Survivors &next, Moves &moves) {
    Near near;
    Offers offers{};
    for (int state = 0; state < kStates; ++state) {
      if (!is_alive(state)) continue;
      near[state] = known_[now_.known[state]].near(u);
      const int other = alike(state, near);
      offers[state] = other == state ? &make_offer(place, near[state], state, scaled) : offers[other];
    }
    for (int state = 0; state < kHalf; ++state) follow(state, offers, u, next, moves);
  }

  // Each state is followed by another one behind a 0.
  void add_zero(const SymbolPlace &place, int u, float scaled, Survivors &next, Moves &moves) {
    Near near;
    std::array<float, kStates> cost;
    for (int state = 0; state < kStates; ++state) {
      const int to = QuantizerState(state).after(0).index();
      moves.symbol[to] = 0, moves.from[to] = uint8_t(state);
      next.known[to] = now_.known[state], next.any[to] = now_.any[state], next.cost[to] = kImpossible;
      if (!is_alive(state)) continue;
      near[state] = known_[now_.known[state]].near(u);
      const int other = alike(state, near);
      cost[state] = other == state ? zero_cost(place, near[state], state, scaled) : cost[other];
      next.cost[to] = now_.cost[state] + cost[state];
    }
  }

  float zero_cost(const SymbolPlace &place, const NearMagnitudes &near, int state, float scaled) const {
    const int32_t one = models_.predict(place.at(near, QuantizerState(state)));
    return scaled * scaled + lambda_ * bit_cost(one, 0);
  }

  const Offer &make_offer(const SymbolPlace &place, const NearMagnitudes &near, int state, float scaled) {
    Offer &offer = offers_[state];
    offer = {{kImpossible, kImpossible}, {}};
    const QuantizerState quantizer(state);
    MagnitudeBits bits(models_, place, near, quantizer);
    const auto try_out = [&](int magnitude) {
      const int odd = magnitude & 1;
      const float error = magnitude ? scaled - quantizer.magnitude(magnitude) : scaled;
      const float cost = error * error + lambda_ * bits.of(models_, magnitude);
      if (cost < offer.cost[odd]) offer.cost[odd] = cost, offer.symbol[odd] = int16_t(magnitude);
    };
    try_out(0);
    const int below = std::min(int(scaled + (quantizer.odd() ? 0.5f : 0.0f)), kMaxSymbol);
    if (below) try_out(below);
    try_out(below + 1);
    if (below > 1) try_out(below - 1);
    return offer;
  }

  // The two states that follow this one and the one half of them on.
  void follow(int state, const Offers &offers, int u, Survivors &next, Moves &moves) {
    std::array<int, 2> from;
    for (const int i : {0, 1}) {
      const int to = 2 * state + i, other = state + kHalf;
      const float cost = cost_after(state, to, offers), cost_of_other = cost_after(other, to, offers);
      from[i] = cost_of_other < cost ? other : state;
      const int16_t symbol = offers[from[i]] ? offers[from[i]]->symbol[parity(from[i], to)] : int16_t(0);
      next.cost[to] = std::min(cost, cost_of_other);
      next.any[to] = now_.any[from[i]] || symbol;
      moves.symbol[to] = symbol, moves.from[to] = uint8_t(from[i]);
    }
    // If both go on from one, the second gets the magnitudes of the other, which nobody needs.
    const int first = 2 * state, second = first + 1;
    const bool same = from[0] == from[1];
    next.known[first] = now_.known[from[0]];
    next.known[second] = now_.known[same ? 2 * state + kHalf - from[1] : from[1]];
    if (same && next.cost[second] < kImpossible) known_[next.known[second]] = known_[next.known[first]];
    for (const int to : {first, second})
      if (moves.symbol[to]) known_[next.known[to]].set(u, moves.symbol[to]);
  }

  float cost_after(int from, int to, const Offers &offers) const {
    return offers[from] ? now_.cost[from] + offers[from]->cost[parity(from, to)] : kImpossible;
  }

  // Of the symbols that lead from one state to the other.
  static int parity(int from, int to) { return QuantizerState(from).after(0).index() != to; }

  const BitModels &models_;
  const SymbolContext &context_;
  const float lambda_;
  Survivors now_;
  std::array<KnownMagnitudes, kStates> known_;
  std::array<Offer, kStates> offers_;
  size_t count_ = 0;
  std::array<Moves, 1 << 2 * kTextureRoot> moves_;
};

float extent_bits(const BitModels &models, const ExtentContext &context, int log, int value) {
  float sum = 0;
  for (int node = 1, place = log; place >= 0; --place) {
    sum += bit_cost(models.predict(context.at(node)), value >> place & 1);
    node = 2 * node + (value >> place & 1);
  }
  return sum;
}

// The squared error of a block without symbols, and the last diagonal with an amplitude that is worth one, -1 for none.
std::pair<float, int> outlook(const CellValues<float> &scaled, int side) {
  constexpr int kLanes = 1 << kTextureLeast;
  std::array<float, kLanes> sums{};
  int last = -1;
  for (int v = 0; v < side; ++v)
    for (int u = 0; u < side; u += kLanes) {
      std::array<float, kLanes> amplitudes;
      float largest = 0;
      for (size_t i = 0; i < kLanes; ++i) {
        amplitudes[i] = std::abs(scaled[size_t(v * side + u) + i]);
        sums[i] += amplitudes[i] * amplitudes[i];
        largest = largest > amplitudes[i] ? largest : amplitudes[i];
      }
      if (largest <= kLastWorth) continue;
      for (int i = 0; i < kLanes; ++i)
        if (amplitudes[size_t(i)] > kLastWorth) last = std::max(last, v + u + i);
    }
  return {std::accumulate(sums.begin(), sums.end(), 0.0f), last};
}

}  // namespace

void choose_block(const BitModels &models, const TextureField &field, const TextureCell &cell, int channel,
                  float lambda, const CellValues<float> &scaled, Choice &choice) {
  const std::vector<Frequency> &scan = texture_scan(cell.log);
  auto [beyond, most] = outlook(scaled, cell.side());
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
    for (; at < scan.size() && scan[at].diagonal() == diagonal; ++at) {
      const float amplitude = std::abs(scaled[scan[at].index]);
      beyond -= amplitude * amplitude;
      trellis.add(scan[at], amplitude);
    }
    const int best = trellis.best_here();
    if (best < 0) continue;
    const float sum =
        trellis.cost(best) + std::max(beyond, 0.0f) + lambda * extent_bits(models, extent, cell.log, diagonal + 1);
    if (sum < choice.cost) choice.cost = sum, choice.last = diagonal, count = at, state = best;
  }
  trellis.trace(count, state, scan, scaled, choice.values);
}

}  // namespace sgi
