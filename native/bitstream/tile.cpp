#include "bitstream/tile.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "bitstream/arrays.hpp"
#include "bitstream/context_model.hpp"
#include "bitstream/frequency_tables.hpp"
#include "bitstream/limits.hpp"
#include "bitstream/positions.hpp"
#include "bitstream/symbol_reader.hpp"
#include "model/hash_grid.hpp"

namespace sgi {
namespace {

constexpr int kGammaFieldBits = 6, kBaseStepBits = 8;

Part part_of(GroupName name) {
  switch (name) {
    case GroupName::colour: return Part::colour;
    case GroupName::shape: return Part::shape;
    case GroupName::feature: return Part::feature;
    case GroupName::scales: return Part::scales;
    default: return Part::offset;
  }
}

// One reading of a payload, part after part.
class TileReader {
 public:
  TileReader(const Header &header, Bytes payload, int threads, Isa isa, int64_t memory)
      : header_(header), spec_(header.spec), threads_(threads), isa_(isa), reader_(payload),
        payload_bytes_(int64_t(payload.size)), memory_(memory) {}

  TileModel read(bool checked) {
    read_part(Part::steps, &TileReader::read_plan);
    if (spec_.base_cell) read_part(Part::base, &TileReader::read_base_layer);
    read_part(Part::positions, &TileReader::read_seeds);
    if (spec_.hidden) read_part(Part::decoders, &TileReader::read_decoders);
    read_part(Part::hash_grid, &TileReader::read_hash_grid);
    read_part(Part::context_model, &TileReader::read_context_model);
    read_attributes();
    if (spec_.texture) read_part(Part::texture, &TileReader::read_texture);
    if (spec_.restoration) read_part(Part::restoration, &TileReader::read_restoration);
    reader_.finish(checked);
    model_.bits = reader_.bits(), model_.symbol_crc = reader_.crc();
    return std::move(model_);
  }

 private:
  void read_part(Part part, void (TileReader::*read)()) {
    reader_.begin(part);
    (this->*read)();
  }

  void read_plan() {
    for (const SeedGroup &group : spec_.groups()) {
      GroupSteps steps{default_steps(spec_, group, header_.quality), 0};
      const std::vector<int64_t> differences = read_weights(reader_, int64_t(steps.base.size()));
      for (size_t i = 0; i < differences.size(); ++i) {
        steps.base[i] += differences[i];
        if (steps.base[i] < 0 || steps.base[i] >= kStepCount)
          throw Error(Fault::corrupt, "steps: an index is outside the table of steps");
      }
      if (follows_amplitude(spec_, group)) steps.gamma = reader_.number(kGammaFieldBits);
      model_.coding.plan.push_back(std::move(steps));
    }
  }

  void read_base_layer() {
    const int64_t rows = (header_.height + spec_.base_cell - 1) / spec_.base_cell;
    const int64_t columns = (header_.width + spec_.base_cell - 1) / spec_.base_cell;
    model_.base_step = reader_.number(kBaseStepBits);
    if (model_.base_step >= kStepCount) throw Error(Fault::corrupt, "base layer: a step outside the table of steps");
    memory_ = left_by_base(spec_.channels * rows * columns, memory_);
    model_.base = read_base(reader_, spec_.channels, rows, columns);
  }

  void read_seeds() {
    const int64_t width = header_.width, height = header_.height;
    const int64_t most = max_seeds(spec_, width, height, payload_bytes_, memory_);
    const bool is_tree = spec_.layout == SeedLayoutKind::adaptive;
    if (is_tree) check_tree(width, height, memory_);
    Seeds seeds = (is_tree ? read_tree : read_positions)(reader_, width, height, most);
    memory_ = left_by_seeds(spec_, int64_t(seeds.log_size.size()), memory_);
    model_.corner = std::move(seeds.corner), model_.log_size = std::move(seeds.log_size);
  }

  void read_decoders() {
    const int64_t hidden = spec_.hidden, features = spec_.features;
    const int shift = reader_.number(kShiftBits);
    for (const auto &[decoder, values] : {std::pair{&model_.colours, spec_.channels}, std::pair{&model_.shapes, 3}}) {
      const int64_t outputs = int64_t(spec_.per_seed) * values;
      decoder->shift = shift;
      decoder->w1 = read_weights(reader_, hidden * features), decoder->b1 = read_weights(reader_, hidden);
      decoder->w2 = read_weights(reader_, outputs * hidden), decoder->b2 = read_weights(reader_, outputs);
    }
  }

  void read_hash_grid() {
    if (spec_.context.hash_resolutions.empty()) return;
    grid_.emplace(spec_.context, header_.width, header_.height);
    model_.coding.signs = read_signs(reader_, grid_->counts());
  }

  void read_context_model() { model_.coding.networks = read_networks(reader_, spec_); }

  void read_attributes() {
    const TileCoding &coding = model_.coding;
    AttributeModel model = attribute_model(spec_, coding.plan, coding.networks, header_.quality, header_.family, isa_);
    if (grid_) model.grid = &*grid_, model.grid_signs = coding.signs.data();
    const TileSeeds seeds(spec_.context, model_.corner, model_.log_size);
    model_.decoded.resize(size_t(seeds.count * spec_.attributes()));
    const std::vector<SeedGroup> groups = spec_.groups();
    AttributeReader attributes(reader_.decoder(), zero_centred_tables(), groups.size());
    std::vector<int32_t> symbols;
    SymbolReader::require_sound(code_attributes(attributes, model, seeds, threads_, model_.decoded.data(), symbols));
    reader_.record(symbols.data(), int64_t(symbols.size()));
    for (size_t g = 0; g < groups.size(); ++g) reader_.book(part_of(groups[g].name), attributes.bits[g]);
  }

  void read_texture() {
    model_.coding.texture = read_texture_part(reader_, header_.width, header_.height, spec_.channels, memory_);
  }

  void read_restoration() { model_.restoration = read_restoration_part(reader_, header_.own_network); }

  const Header &header_;
  const ModelSpec &spec_;
  int threads_;
  Isa isa_;
  SymbolReader reader_;
  int64_t payload_bytes_, memory_;  // bytes, what is left
  std::optional<HashGrid> grid_;
  TileModel model_;
};

}  // namespace

TileModel read_tile(const Header &header, Bytes payload, int threads, Isa isa, bool checked, int64_t memory) {
  check_model(header.spec, header.width, header.height);
  return TileReader(header, payload, threads, isa, memory).read(checked);
}

}  // namespace sgi
