#include "bindings/tile_models.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <numeric>
#include <tuple>

#include "bindings/textures.hpp"
#include "bitstream/restoration_part.hpp"
#include "bitstream/texture_stream.hpp"

namespace nb = nanobind;

namespace sgi {
namespace {

template <class T, int D>
Array<const T, D> array_of(nb::handle object) {
  return nb::cast<Array<const T, D>>(object);
}

// What an array of this shape holds.
template <class T, size_t D>
std::vector<T> held_by(nb::handle object, const std::array<size_t, D> &shape, const char *what) {
  const auto array = array_of<T, int(D)>(object);
  for (size_t axis = 0; axis < D; ++axis) require(array.shape(axis) == shape[axis], what);
  return copy(array);
}

std::vector<GroupSteps> plan_of(const ModelSpec &spec, nb::handle given) {
  std::vector<GroupSteps> plan;
  for (const SeedGroup &group : spec.groups()) {
    const char *const name = kGroupNames[size_t(group.name)];
    const std::array shape{size_t(output_count(spec, group)), size_t(kLevels)};
    plan.push_back({held_by<int64_t>(given.attr("base")[name], shape, "base must be [U, 8]"),
                    nb::cast<int>(given.attr("gamma")[name])});
    for (const int64_t step : plan.back().base)
      require(step >= 0 && step < kStepCount, "a base step is outside the table of steps");
    require(plan.back().gamma >= 0 && plan.back().gamma < 64, "gamma must be 0..63");
  }
  return plan;
}

Networks networks_of(const ModelSpec &spec, nb::handle given) {
  const auto steps = coding_steps(spec);
  Networks networks;
  for (const nb::handle network : given) {
    const size_t step = networks.size();
    require(step < steps.size(), "there is a network for every coding step");
    const auto w1 = array_of<int64_t, 2>(network.attr("w1")), w2 = array_of<int64_t, 2>(network.attr("w2"));
    const size_t outputs = size_t(network_outputs(spec, steps[step]));
    require(has_shape(w1, size_t(spec.context.hidden), size_t(input_count(spec, int(step)))) && w2.shape(0) == outputs,
            "a network has the weights of its coding step");
    networks.push_back(std::make_shared<const IntNetwork>(
        network_of(w1, array_of<int64_t, 1>(network.attr("b1")), w2, array_of<int64_t, 1>(network.attr("b2")),
                   nb::cast<int>(network.attr("shift")), int(outputs - steps[step].size()) / 2)));
  }
  require(networks.size() == steps.size(), "there is a network for every coding step");
  return networks;
}

std::vector<uint8_t> signs_of(const Header &header, nb::handle tables) {
  std::vector<uint8_t> signs;
  for (const nb::handle table : tables)
    for (const int64_t sign : copy(array_of<int64_t, 2>(table))) {
      require(sign == 0 || sign == 1, "signs must be 0 or 1");
      signs.push_back(uint8_t(sign));
    }
  const auto counts = HashGrid(header.spec.context, header.width, header.height).counts();
  require(int64_t(signs.size()) == std::accumulate(counts.begin(), counts.end(), int64_t(0)),
          "signs of every resolution of the hash grid");
  return signs;
}

AttributeDecoder decoder_of(const ModelSpec &spec, nb::handle model, const std::string &name, int values) {
  const auto hidden = size_t(spec.hidden), features = size_t(spec.features);
  const size_t outputs = size_t(spec.per_seed) * size_t(values);
  const auto weights = [&](const char *part, const auto &shape) {
    return held_by<int64_t>(model.attr("decoders")[(name + part).c_str()], shape, "weights of another shape");
  };
  return {weights(".w1", std::array{hidden, features}), weights(".b1", std::array{hidden}),
          weights(".w2", std::array{outputs, hidden}), weights(".b2", std::array{outputs}),
          nb::cast<int>(model.attr("decoder_shift"))};
}

RestorationChoice restoration_of(nb::handle given) {
  if (given.is_none()) return {};
  const nb::object network = given.attr("network");
  return {nb::isinstance<nb::bytes>(network) ? kOwnNetwork : nb::cast<int>(network), nb::cast<int>(given.attr("step"))};
}

}  // namespace

TextureIndices indices_of(nb::handle steps, size_t channels) {
  const auto colours = nb::cast<std::array<int, 3>>(steps.attr("colours"));
  TextureIndices indices{nb::cast<int>(steps.attr("step")),
                         nb::cast<std::vector<int32_t>>(steps.attr("ratios")),
                         nb::cast<std::array<int, 2>>(steps.attr("slopes")),
                         nb::cast<std::array<int, 3>>(steps.attr("excess")),
                         nb::cast<bool>(steps.attr("has_contrast")),
                         {},
                         {{colours[0], colours[1]}, colours[2]}};
  require(indices.ratios.size() + 1 == channels, "ratios [C - 1]");
  require(indices.colours.same() || channels >= 3, "colours are of three channels or more");
  require(indices.slopes[0] >= 0 && indices.slopes[1] >= 0, "slopes must not be negative");
  return indices;
}

CodedTexture texture_of(nb::handle layer) {
  TextureField field =
      field_of(array_of<uint8_t, 2>(layer.attr("log_size")), array_of<int8_t, 2>(layer.attr("contrast")),
               array_of<int16_t, 3>(layer.attr("symbols")));
  TextureIndices indices = indices_of(layer.attr("steps"), size_t(field.channels));
  indices.grid = grid_of(nb::cast<TextureGridFields>(layer.attr("grid")));
  const auto [width, height] = nb::cast<std::pair<int64_t, int64_t>>(layer.attr("size"));
  const auto sides = indices.grid.layer_sides(width, height);
  require(field.width == texture_roots(sides.first) * 32 && field.height == texture_roots(sides.second) * 32,
          "the layer must have the roots of the tile");
  return {std::move(indices), std::move(field)};
}

TileModel seeds_of(const Header &header, nb::handle model) {
  TileModel tile;
  const auto log_size = array_of<int8_t, 1>(model.attr("layout").attr("log_size"));
  require_cells(log_size);
  tile.log_size = copy(log_size);
  tile.corner = held_by<int32_t>(model.attr("layout").attr("corner"), std::array{log_size.size(), size_t(2)},
                                 "corner must be [N, 2], log_size [N]");
  tile.coding.plan = plan_of(header.spec, model.attr("plan"));
  tile.coding.networks = networks_of(header.spec, model.attr("networks"));
  tile.coding.signs = signs_of(header, model.attr("hash_tables"));
  return tile;
}

TileModel tile_model_of(const Header &header, nb::handle model) {
  const ModelSpec &spec = header.spec;
  TileModel tile = seeds_of(header, model);
  if (const auto cell = size_t(spec.base_cell)) {
    const std::array shape{size_t(spec.channels), (size_t(header.height) + cell - 1) / cell,
                           (size_t(header.width) + cell - 1) / cell};
    tile.base_step = nb::cast<int>(model.attr("base_step"));
    tile.base = held_by<int64_t>(model.attr("base"), shape, "base must be [C, rows, columns]");
  }
  if (spec.hidden) {
    tile.colours = decoder_of(spec, model, "colour", spec.channels);
    tile.shapes = decoder_of(spec, model, "shape", 3);
  }
  tile.restoration = restoration_of(model.attr("restoration"));
  const nb::object texture = model.attr("texture");
  if (!texture.is_none()) tile.coding.texture = texture_of(texture);
  return tile;
}

std::vector<double> attributes_of(const Header &header, nb::handle model) {
  const nb::object groups = model.attr("attributes");
  require(!groups.is_none(), "the tile has no attributes: it was read, not fitted");
  const size_t count = nb::len(nb::object(model.attr("layout"))), width = size_t(header.spec.attributes());
  std::vector<double> values(count * width);
  for (const SeedGroup &group : header.spec.groups()) {
    const std::array shape{count, size_t(group.size)};
    const auto own = held_by<double>(groups[kGroupNames[size_t(group.name)]], shape, "attributes must be [N, size]");
    for (size_t i = 0; i < count; ++i)
      std::copy_n(own.data() + i * shape[1], shape[1], values.data() + i * width + size_t(group.start));
  }
  return values;
}

}  // namespace sgi
