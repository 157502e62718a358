#include "model/restoration_network.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace sgi {
namespace {

constexpr int kMaxLayers = 6, kMaxWidth = 64, kInputs = 3, kBiasUnit = 64;

void require(bool holds) {
  if (!holds) throw std::logic_error("a network of restoration that cannot be");
}

class Reader {
 public:
  explicit Reader(Bytes file) : file_(file) {}

  int byte() {
    require(at_ < file_.size);
    return file_.data[at_++];
  }
  int weight() { return int8_t(byte()); }
  int bias() {
    const int low = byte();
    return int16_t(uint16_t(low | byte() << 8));
  }
  bool at_end() const { return at_ == file_.size; }

 private:
  Bytes file_;
  size_t at_ = 0;
};

int blocks_of(int outputs) { return (outputs + kRestorationBlock - 1) / kRestorationBlock; }
int pairs_of(int inputs) { return (inputs + 1) / 2; }

// The number that holds a weight, in its upper half where the input is odd.
size_t place_of(const RestorationLayer &layer, int output, int input, int tap) {
  const size_t block = output / kRestorationBlock, lane = output % kRestorationBlock;
  return ((block * pairs_of(layer.inputs) + input / 2) * kRestorationTaps + tap) * kRestorationBlock + lane;
}

void set_weight(RestorationLayer &layer, int output, int input, int tap, int weight) {
  int32_t &pair = layer.weights[place_of(layer, output, input, tap)];
  const int shift = input % 2 ? 16 : 0;
  pair = int32_t((uint32_t(pair) & ~(0xffffu << shift)) | uint32_t(uint16_t(weight)) << shift);
}

// Whether so many times a sum of an output cannot reach 2^31, of inputs up to this size.
bool sums_fit(const RestorationLayer &layer, int output, int64_t largest, int64_t times) {
  int64_t most = std::abs(int64_t(layer.biases[output]));
  for (int input = 0; input < layer.inputs; ++input)
    for (int tap = 0; tap < kRestorationTaps; ++tap) most += std::abs(layer.weight(output, input, tap)) * largest;
  return times * most < int64_t(1) << 31;
}

bool sums_fit(const RestorationLayer &layer, int output) { return sums_fit(layer, output, kRestorationMost, 1); }

// Four times what a place of squares multiplies an input by (model/restoration_squares.hpp). Row 3 and column 3 have
// the signs with which they are added.
int square_weight(const RestorationLayer &layer, int output, int input, int place) {
  constexpr int kShares[4][3] = {{2, 0, 0}, {1, 1, 1}, {1, -1, 1}, {0, 0, -2}};
  int sum = 0;
  for (int tap = 0; tap < kRestorationTaps; ++tap)
    sum += kShares[place / 4][tap / 3] * kShares[place % 4][tap % 3] * layer.weight(output, input, tap);
  return sum;
}

// Of a hidden layer with so many inputs that squares pay. None where weights would not have 16 bits, or sums 32,
// whatever 16 bits they multiply.
std::vector<int32_t> squares_of(const RestorationLayer &layer) {
  if (layer.inputs % kSquareOutputs || layer.inputs > kSquareInputs || layer.outputs % kSquareOutputs) return {};
  const int pairs = pairs_of(layer.inputs);
  std::vector<int32_t> found(size_t(kSquarePlaces) * pairs * layer.outputs);
  for (int output = 0; output < layer.outputs; ++output) {
    if (!sums_fit(layer, output, kRestorationSmall, 4)) return {};
    for (int place = 0; place < kSquarePlaces; ++place) {
      int64_t most = 4 * std::abs(int64_t(layer.biases[output]));
      for (int pair = 0; pair < pairs; ++pair) {
        const int low = square_weight(layer, output, 2 * pair, place);
        const int high = square_weight(layer, output, 2 * pair + 1, place);
        if (std::max(std::abs(low), std::abs(high)) > kRestorationMost) return {};
        most += int64_t(std::abs(low) + std::abs(high)) << 15;
        found[(size_t(place) * pairs + pair) * layer.outputs + output] =
            int32_t(uint32_t(uint16_t(low)) | uint32_t(uint16_t(high)) << 16);
      }
      if (most >= int64_t(1) << 31) return {};
    }
  }
  return found;
}

void read_weights(Reader &reader, RestorationLayer &layer) {
  const int blocks = blocks_of(layer.outputs);
  layer.weights.assign(size_t(blocks) * pairs_of(layer.inputs) * kRestorationTaps * kRestorationBlock, 0);
  layer.biases.assign(size_t(blocks) * kRestorationBlock, 0);
  for (int o = 0; o < layer.outputs; ++o)
    for (int i = 0; i < layer.inputs; ++i)
      for (int tap = 0; tap < kRestorationTaps; ++tap) set_weight(layer, o, i, tap, reader.weight());
  for (int o = 0; o < layer.outputs; ++o) {
    layer.biases[o] = kBiasUnit * reader.bias();
    require(sums_fit(layer, o));
  }
  layer.squares = squares_of(layer);
}

}  // namespace

LayerView RestorationLayer::view() const {
  return {pairs_of(inputs), blocks_of(outputs), shift,
          weights.data(),   biases.data(),      squares.empty() ? nullptr : squares.data()};
}

int RestorationLayer::weight(int output, int input, int tap) const {
  const auto pair = uint32_t(weights[place_of(*this, output, input, tap)]);
  return int16_t(input % 2 ? pair >> 16 : pair);
}

RestorationNetwork parse_restoration(Bytes file) {
  Reader reader(file);
  RestorationNetwork network;
  const int count = reader.byte();
  network.shift = reader.byte();
  require(count >= 2 && count <= kMaxLayers && network.shift < 31);
  int inputs = kInputs;
  for (int i = 0; i < count; ++i) {
    RestorationLayer layer{};
    layer.inputs = reader.byte(), layer.outputs = reader.byte(), layer.shift = reader.byte();
    require(layer.inputs == inputs && layer.outputs && layer.outputs <= kMaxWidth && layer.shift < 31);
    require(i + 1 == count || layer.outputs % kRestorationBlock == 0);
    inputs = layer.outputs;
    network.layers.push_back(std::move(layer));
  }
  require(inputs == kInputs);
  for (RestorationLayer &layer : network.layers) read_weights(reader, layer);
  require(reader.at_end());
  return network;
}

}  // namespace sgi
