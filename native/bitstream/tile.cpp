#include "bitstream/tile.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "bitstream/arrays.hpp"
#include "bitstream/context_model.hpp"
#include "bitstream/limits.hpp"
#include "bitstream/positions.hpp"
#include "bitstream/symbol_coder.hpp"
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

// All parts but texture, in their order.
template <class Coder>
class TileParts {
 public:
  // payload_bytes: of a tile that is read. values [N, d_A]: attributes of one that is written.
  TileParts(const Header &header, Coder &coder, const TileReading &how, int64_t payload_bytes, const double *values)
      : header_(header), spec_(header.spec), coder_(coder), how_(how), memory_(how.memory),
        payload_bytes_(payload_bytes), values_(values) {}

  void code(TileModel &model) {
    code_plan(model.coding.plan);
    code_base_layer(model);
    code_seeds(model);
    code_decoders(model);
    code_seed_attributes(model);
    coder_.begin(Part::restoration);
    if (spec_.restoration) code_restoration_part(coder_, header_.own_network, model.restoration);
    coder_.begin(Part::texture);
  }

  int64_t memory() const { return memory_; }  // bytes, what is left

 private:
  void code_plan(std::vector<GroupSteps> &plan) {
    coder_.begin(Part::steps);
    const std::vector<SeedGroup> groups = spec_.groups();
    plan.resize(groups.size());
    for (size_t g = 0; g < groups.size(); ++g) {
      GroupSteps &steps = plan[g];
      const std::vector<int64_t> defaults = default_steps(spec_, groups[g], header_.colour_step);
      std::vector<int64_t> differences(defaults.size());
      steps.base.resize(defaults.size());
      for (size_t i = 0; i < defaults.size(); ++i) differences[i] = steps.base[i] - defaults[i];
      code_weights(coder_, differences);
      for (size_t i = 0; i < defaults.size(); ++i) {
        steps.base[i] = defaults[i] + differences[i];
        if (steps.base[i] < 0 || steps.base[i] >= kStepCount)
          throw Error(Fault::corrupt, "steps: an index is outside the table of steps");
      }
      if (follows_amplitude(spec_, groups[g])) coder_.number(kGammaFieldBits, steps.gamma);
    }
  }

  void code_base_layer(TileModel &model) {
    if (!spec_.base_cell) return;
    coder_.begin(Part::base);
    const int64_t rows = (header_.height + spec_.base_cell - 1) / spec_.base_cell;
    const int64_t columns = (header_.width + spec_.base_cell - 1) / spec_.base_cell;
    coder_.number(kBaseStepBits, model.base_step);
    if (model.base_step >= kStepCount) throw Error(Fault::corrupt, "base layer: a step outside the table of steps");
    memory_ = left_by_base(spec_.channels * rows * columns, memory_);
    model.base.resize(size_t(spec_.channels * rows * columns));
    code_base(coder_, spec_.channels, rows, columns, model.base);
  }

  void code_seeds(TileModel &model) {
    coder_.begin(Part::positions);
    const int64_t width = header_.width, height = header_.height;
    const int64_t most = Coder::kReads ? max_seeds(spec_, width, height, payload_bytes_, memory_) : INT64_MAX;
    const bool is_tree = spec_.layout == SeedLayoutKind::adaptive;
    if (is_tree) check_tree(width, height, memory_);
    Seeds seeds{std::move(model.corner), std::move(model.log_size)};
    (is_tree ? code_tree<Coder> : code_positions<Coder>)(coder_, width, height, most, seeds);
    memory_ = left_by_seeds(spec_, int64_t(seeds.log_size.size()), memory_);
    model.corner = std::move(seeds.corner), model.log_size = std::move(seeds.log_size);
  }

  void code_decoders(TileModel &model) {
    if (!spec_.hidden) return;
    coder_.begin(Part::decoders);
    const auto hidden = size_t(spec_.hidden), features = size_t(spec_.features);
    coder_.number(kShiftBits, model.colours.shift);
    model.shapes.shift = model.colours.shift;
    for (const auto &[decoder, values] : {std::pair{&model.colours, spec_.channels}, std::pair{&model.shapes, 3}}) {
      const size_t outputs = size_t(spec_.per_seed) * size_t(values);
      decoder->w1.resize(hidden * features), decoder->b1.resize(hidden);
      decoder->w2.resize(outputs * hidden), decoder->b2.resize(outputs);
      for (std::vector<int64_t> *weights : {&decoder->w1, &decoder->b1, &decoder->w2, &decoder->b2})
        code_weights(coder_, *weights);
    }
  }

  void code_seed_attributes(TileModel &model) {
    TileCoding &coding = model.coding;
    std::optional<HashGrid> grid;
    coder_.begin(Part::hash_grid);
    if (!spec_.context.hash_resolutions.empty()) {
      grid.emplace(spec_.context, header_.width, header_.height);
      const std::vector<int64_t> counts = grid->counts();
      coding.signs.resize(size_t(std::accumulate(counts.begin(), counts.end(), int64_t(0))));
      code_signs(coder_, counts, coding.signs);
    }
    coder_.begin(Part::context_model);
    code_networks(coder_, spec_, coding.networks);
    AttributeModel of =
        attribute_model(spec_, coding.plan, coding.networks, header_.colour_step, header_.family, how_.isa);
    if (grid) of.grid = &*grid, of.grid_signs = coding.signs.data();
    const TileSeeds seeds(spec_.context, model.corner, model.log_size);
    model.decoded.resize(size_t(seeds.count * spec_.attributes()));
    const std::vector<SeedGroup> groups = spec_.groups();
    const AttributeSymbols nearest = nearest_symbols(of, values_);
    const auto code = [&](const AttributeRun &run, int32_t *symbols) {
      coder_.begin(part_of(groups[run.number].name));
      if (!Coder::kReads) nearest(run, symbols);
      coder_.zero_centred(run.tables, run.count(), symbols);
    };
    code_attributes(code, of, seeds, how_.threads, model.decoded.data());
  }

  const Header &header_;
  const ModelSpec &spec_;
  Coder &coder_;
  const TileReading &how_;
  int64_t memory_;
  const int64_t payload_bytes_;
  const double *values_;
};

}  // namespace

TileReader::TileReader(const Header &header, Bytes payload, const TileReading &how)
    : header_(header), how_(how), reader_(payload), payload_bytes_(int64_t(payload.size)) {
  check_model(header.spec, header.width, header.height);
}

TileModel TileReader::model() {
  TileModel model;
  TileParts parts(header_, reader_, how_, payload_bytes_, nullptr);
  parts.code(model);
  if (header_.spec.texture)
    code_texture_indices(reader_, header_.width, header_.height, header_.spec.channels, texture_, parts.memory());
  return model;
}

CodedTexture TileReader::texture() {
  return read_texture_layer(reader_, std::move(*texture_), header_.width, header_.height, header_.spec.channels);
}

void TileReader::texture_cells(TextureCells &cells, const TextureRows &rows_read) {
  read_texture_cells(reader_, *texture_, header_.width, header_.height, header_.spec.channels, cells, rows_read);
}

TileEnd TileReader::finish() {
  reader_.finish(how_.checked);
  return {reader_.bits(), reader_.crc()};
}

TileModel read_tile(const Header &header, Bytes payload, const TileReading &how) {
  TileReader reader(header, payload, how);
  TileModel model = reader.model();
  if (reader.has_texture()) model.coding.texture = reader.texture();
  model.end = reader.finish();
  return model;
}

std::vector<uint8_t> write_tile(const Header &header, TileModel &model, const double *values, const TileReading &how) {
  const ModelSpec &spec = header.spec;
  check_model(spec, header.width, header.height);
  SymbolWriter writer;
  TileParts(header, writer, how, 0, values).code(model);
  if (spec.texture) write_texture_part(writer, model.coding.texture, header.width, header.height, spec.channels);
  std::vector<uint8_t> payload = writer.finish();
  model.end = {writer.bits(), writer.crc()};
  if (model.seeds() > max_seeds(spec, header.width, header.height, int64_t(payload.size())))
    throw Error(Fault::limit, std::to_string(model.seeds()) + " seeds in a tile of " + std::to_string(payload.size()) +
                                  " bytes; a decoder would refuse it");
  return payload;
}

}  // namespace sgi
