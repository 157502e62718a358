#include "bitstream/tile.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "bitstream/arrays.hpp"
#include "bitstream/context_model.hpp"
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

}  // namespace

TileReader::TileReader(const Header &header, Bytes payload, const TileReading &how)
    : header_(header), spec_(header.spec), how_(how), reader_(payload), payload_bytes_(int64_t(payload.size)),
      memory_(how.memory) {
  check_model(spec_, header.width, header.height);
}

TileModel TileReader::model() {
  TileModel model;
  read_plan(model);
  read_base_layer(model);
  read_seeds(model);
  read_decoders(model);
  read_attributes(model);
  reader_.begin(Part::restoration);
  if (spec_.restoration) model.restoration = read_restoration_part(reader_, header_.own_network);
  reader_.begin(Part::texture);
  if (spec_.texture) texture_ = read_texture_indices(reader_, header_.width, header_.height, spec_.channels, memory_);
  return model;
}

CodedTexture TileReader::texture() {
  return read_texture_layer(reader_, std::move(*texture_), header_.width, header_.height, spec_.channels);
}

void TileReader::texture_cells(TextureCells &cells, const TextureRows &rows_read) {
  read_texture_cells(reader_, *texture_, header_.width, header_.height, spec_.channels, cells, rows_read);
}

TileEnd TileReader::finish() {
  reader_.finish(how_.checked);
  return {reader_.bits(), reader_.crc()};
}

void TileReader::read_plan(TileModel &model) {
  reader_.begin(Part::steps);
  for (const SeedGroup &group : spec_.groups()) {
    GroupSteps steps{default_steps(spec_, group, header_.quality), 0};
    const std::vector<int64_t> differences = read_weights(reader_, int64_t(steps.base.size()));
    for (size_t i = 0; i < differences.size(); ++i) {
      steps.base[i] += differences[i];
      if (steps.base[i] < 0 || steps.base[i] >= kStepCount)
        throw Error(Fault::corrupt, "steps: an index is outside the table of steps");
    }
    if (follows_amplitude(spec_, group)) steps.gamma = reader_.number(kGammaFieldBits);
    model.coding.plan.push_back(std::move(steps));
  }
}

void TileReader::read_base_layer(TileModel &model) {
  if (!spec_.base_cell) return;
  reader_.begin(Part::base);
  const int64_t rows = (header_.height + spec_.base_cell - 1) / spec_.base_cell;
  const int64_t columns = (header_.width + spec_.base_cell - 1) / spec_.base_cell;
  model.base_step = reader_.number(kBaseStepBits);
  if (model.base_step >= kStepCount) throw Error(Fault::corrupt, "base layer: a step outside the table of steps");
  memory_ = left_by_base(spec_.channels * rows * columns, memory_);
  model.base = read_base(reader_, spec_.channels, rows, columns);
}

void TileReader::read_seeds(TileModel &model) {
  reader_.begin(Part::positions);
  const int64_t width = header_.width, height = header_.height;
  const int64_t most = max_seeds(spec_, width, height, payload_bytes_, memory_);
  const bool is_tree = spec_.layout == SeedLayoutKind::adaptive;
  if (is_tree) check_tree(width, height, memory_);
  Seeds seeds = (is_tree ? read_tree : read_positions)(reader_, width, height, most);
  memory_ = left_by_seeds(spec_, int64_t(seeds.log_size.size()), memory_);
  model.corner = std::move(seeds.corner), model.log_size = std::move(seeds.log_size);
}

void TileReader::read_decoders(TileModel &model) {
  if (!spec_.hidden) return;
  reader_.begin(Part::decoders);
  const int64_t hidden = spec_.hidden, features = spec_.features;
  const int shift = reader_.number(kShiftBits);
  for (const auto &[decoder, values] : {std::pair{&model.colours, spec_.channels}, std::pair{&model.shapes, 3}}) {
    const int64_t outputs = int64_t(spec_.per_seed) * values;
    decoder->shift = shift;
    decoder->w1 = read_weights(reader_, hidden * features), decoder->b1 = read_weights(reader_, hidden);
    decoder->w2 = read_weights(reader_, outputs * hidden), decoder->b2 = read_weights(reader_, outputs);
  }
}

void TileReader::read_attributes(TileModel &model) {
  std::optional<HashGrid> grid;
  reader_.begin(Part::hash_grid);
  if (!spec_.context.hash_resolutions.empty()) {
    grid.emplace(spec_.context, header_.width, header_.height);
    model.coding.signs = read_signs(reader_, grid->counts());
  }
  reader_.begin(Part::context_model);
  TileCoding &coding = model.coding;
  coding.networks = read_networks(reader_, spec_);
  AttributeModel of = attribute_model(spec_, coding.plan, coding.networks, header_.quality, header_.family, how_.isa);
  if (grid) of.grid = &*grid, of.grid_signs = coding.signs.data();
  const TileSeeds seeds(spec_.context, model.corner, model.log_size);
  model.decoded.resize(size_t(seeds.count * spec_.attributes()));
  const std::vector<SeedGroup> groups = spec_.groups();
  const auto read = [&](const AttributeRun &run, int32_t *symbols) {
    reader_.begin(part_of(groups[run.number].name));
    reader_.zero_centred(run.tables, run.count(), symbols);
  };
  code_attributes(read, of, seeds, how_.threads, model.decoded.data());
}

TileModel read_tile(const Header &header, Bytes payload, const TileReading &how) {
  TileReader reader(header, payload, how);
  TileModel model = reader.model();
  if (reader.has_texture()) model.coding.texture = reader.texture();
  model.end = reader.finish();
  return model;
}

}  // namespace sgi
