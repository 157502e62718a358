#include "model/restoration_network.hpp"

#include <cstdlib>
#include <stdexcept>

namespace sgi {
namespace {

constexpr int kMostLayers = 6, kMostWidth = 64, kInputs = 3;

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

void read_weights(Reader &reader, int inputs, int outputs, RestorationLayer &layer) {
  layer.pairs = (inputs + 1) / 2, layer.blocks = (outputs + kRestorationBlock - 1) / kRestorationBlock;
  layer.weights.assign(size_t(layer.blocks) * layer.pairs * kRestorationTaps * kRestorationBlock, 0);
  layer.biases.assign(size_t(layer.blocks) * kRestorationBlock, 0);
  std::vector<int64_t> most(outputs, 0);
  for (int o = 0; o < outputs; ++o)
    for (int i = 0; i < inputs; ++i)
      for (int tap = 0; tap < kRestorationTaps; ++tap) {
        const int weight = reader.weight();
        const size_t block = o / kRestorationBlock, lane = o % kRestorationBlock;
        int32_t &pair =
            layer.weights[((block * layer.pairs + i / 2) * kRestorationTaps + tap) * kRestorationBlock + lane];
        pair = int32_t(uint32_t(pair) | uint32_t(uint16_t(weight)) << (i % 2 ? 16 : 0));
        most[o] += std::abs(weight) * int64_t(kRestorationMost);
      }
  for (int o = 0; o < outputs; ++o) {
    layer.biases[o] = 64 * reader.bias();
    require(most[o] + std::abs(layer.biases[o]) < int64_t(1) << 31);
  }
}

}  // namespace

RestorationNetwork parse_restoration(Bytes file) {
  Reader reader(file);
  RestorationNetwork network;
  const int count = reader.byte();
  network.shift = reader.byte();
  require(count >= 2 && count <= kMostLayers && network.shift < 31);
  std::vector<int> inputs, outputs;
  for (int i = 0; i < count; ++i) {
    inputs.push_back(reader.byte()), outputs.push_back(reader.byte());
    network.layers.push_back({0, 0, reader.byte(), {}, {}});
    require(outputs[i] <= kMostWidth && network.layers[i].shift < 31);
    require(inputs[i] == (i ? outputs[i - 1] : kInputs) && outputs[i] && (i + 1 == count || outputs[i] % 4 == 0));
  }
  require(outputs.back() == kInputs);
  for (int i = 0; i < count; ++i) read_weights(reader, inputs[i], outputs[i], network.layers[i]);
  require(reader.at_end());
  return network;
}

}  // namespace sgi
