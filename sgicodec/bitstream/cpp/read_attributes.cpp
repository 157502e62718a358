#include "read_attributes.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <future>
#include <iterator>

#include "../../raster/cpp/neighbours.hpp"
#include "stopwatch.hpp"

namespace sgi {
namespace {

// Nearest seeds of earlier passes, pass after pass; searched by a thread of its own if `ahead`.
class NeighboursByPass {
 public:
  NeighboursByPass(const TileSeeds &seeds, int ranks, bool ahead)
      : seeds_(seeds), ranks_(ranks), tables_(ahead ? seeds.passes.size() : 0) {
    if (ahead) worker_ = std::async(std::launch::async, [this] { search_all(); });
  }
  ~NeighboursByPass() { stop_ = true; }

  // [n, ranks] of the next pass, -1 where there is none.
  std::vector<int32_t> next() {
    const size_t pass = pass_++;
    return tables_.empty() ? search(pass) : tables_[pass].get_future().get();
  }

 private:
  using Table = std::vector<int32_t>;

  void search_all() {
    for (size_t pass = 0; pass < tables_.size() && !stop_; ++pass) {
      try {
        tables_[pass].set_value(search(pass));
      } catch (...) {
        tables_[pass].set_exception(std::current_exception());
        return;
      }
    }
  }

  Table search(size_t pass) {
    const std::vector<int64_t> &members = seeds_.passes[pass];
    Table table(members.size() * size_t(ranks_), -1);
    if (!ranks_) return table;
    if (!earlier_.empty())
      nearest_among(seeds_.view.half_pixels, earlier_.data(), int64_t(earlier_.size()), members.data(),
                    int64_t(members.size()), ranks_, 1, table.data());
    std::vector<int64_t> both;
    both.reserve(earlier_.size() + members.size());
    std::merge(earlier_.begin(), earlier_.end(), members.begin(), members.end(), std::back_inserter(both));
    earlier_ = std::move(both);
    return table;
  }

  const TileSeeds &seeds_;
  int ranks_;
  size_t pass_ = 0;
  std::vector<int64_t> earlier_;  // seeds, ascending
  std::atomic<bool> stop_{false};
  std::vector<std::promise<Table>> tables_;
  std::future<void> worker_;  // its end is waited for first
};

class AttributeReader {
 public:
  AttributeReader(RangeDecoder &decoder, const AttributeModel &model, const ZeroCentred &tables, const TileSeeds &seeds,
                  int threads, int64_t *decoded, AttributesRead &read)
      : decoder_(decoder), model_(model), tables_(tables), seeds_(seeds), threads_(threads), decoded_(decoded), read_(read),
        values_{decoded, model.attributes, model.per_seed, model.channels, model.colour, model.shape},
        summary_(size_t(seeds.count) * kSummary) {
    for (const AttributeStep &step : model.steps) stride_ = std::max(stride_, int64_t(step.inputs));
  }

  Reading read_all() {
    NeighboursByPass neighbours(seeds_, model_.ranks, threads_ != 1 && model_.ranks);
    for (const std::vector<int64_t> &members : seeds_.passes) {
      std::vector<int32_t> table;
      {
        Stopwatch watch(read_.seconds.neighbours);
        table = neighbours.next();
      }
      const Reading reading = read_pass(members, table);
      if (reading != Reading::kSound) return reading;
    }
    return Reading::kSound;
  }

 private:
  Reading read_pass(const std::vector<int64_t> &members, const std::vector<int32_t> &table) {
    const auto n = int64_t(members.size());
    std::vector<int16_t> inputs(size_t(n * stride_)), summary(size_t(n) * kSummary);
    std::vector<int32_t> amplitude(members.size());
    std::vector<int8_t> log_size(members.size());
    for (size_t i = 0; i < members.size(); ++i) log_size[i] = seeds_.view.log_size[members[i]];
    {
      Stopwatch watch(read_.seconds.inputs);
      seed_inputs(seeds_.view, {table.data(), model_.ranks}, summary_.data(), members.data(), n, model_.quality, threads_,
                  inputs.data(), stride_);
    }
    size_t number = 0;
    for (size_t s = 0; s < model_.steps.size(); ++s) {
      const AttributeStep &step = model_.steps[s];
      if (s) {
        Stopwatch watch(read_.seconds.inputs);
        summarise(values_, members.data(), n, threads_, summary.data(), amplitude.data());
        own_inputs(summary.data(), n, int(s), model_.steps[0].inputs, threads_, inputs.data(), stride_);
      }
      const int outputs = step.network->outputs();
      std::vector<int64_t> predicted(size_t(n) * size_t(outputs));
      {
        Stopwatch watch(read_.seconds.network);
        evaluate_network(*step.network, inputs.data(), stride_, n, threads_, predicted.data());
      }
      for (const AttributeGroup &group : step.groups) {
        const PredictionView view{predicted.data() + group.prediction,
                                  predicted.data() + step.predicted + group.prediction,
                                  predicted.data() + 2 * step.predicted + group.refinement, outputs};
        const Reading reading = read_group(group, number++, view, s ? amplitude.data() : nullptr, members, log_size);
        if (reading != Reading::kSound) return reading;
      }
    }
    if (model_.ranks) {
      Stopwatch watch(read_.seconds.inputs);
      summarise(values_, members.data(), n, threads_, summary.data(), amplitude.data());
      for (size_t i = 0; i < members.size(); ++i)
        std::copy_n(summary.data() + i * kSummary, kSummary, summary_.data() + size_t(members[i]) * kSummary);
    }
    return Reading::kSound;
  }

  Reading read_group(const AttributeGroup &group, size_t number, const PredictionView &prediction,
                     const int32_t *amplitude, const std::vector<int64_t> &members,
                     const std::vector<int8_t> &log_size) {
    const auto n = int64_t(members.size()), count = n * group.size();
    std::vector<int64_t> mean(static_cast<size_t>(count)), steps(mean.size());
    std::vector<int16_t> keys(mean.size());
    const GroupPlan plan{group.base.data(), group.columns.data(), group.follows_amplitude ? amplitude : nullptr,
                         group.gamma, group.size()};
    {
      Stopwatch watch(read_.seconds.steps);
      quantisers(plan, prediction, log_size.data(), n, threads_, mean.data(), steps.data(), keys.data());
      for (int16_t &key : keys) key = int16_t(key + model_.first_table);
    }
    const size_t first = read_.symbols.size();
    read_.symbols.resize(first + mean.size());
    int32_t *symbols = read_.symbols.data() + first;
    {
      Stopwatch watch(read_.seconds.symbols);
      const Reading reading = read_zero_centred(decoder_, tables_, keys.data(), count, symbols, read_.bits[number]);
      if (reading != Reading::kSound) return reading;
    }
    Stopwatch watch(read_.seconds.steps);
    dequantise(symbols, mean.data(), steps.data(), members.data(), n, group.size(), group.first, threads_, decoded_,
               model_.attributes);
    return Reading::kSound;
  }

  RangeDecoder &decoder_;
  const AttributeModel &model_;
  const ZeroCentred &tables_;
  const TileSeeds &seeds_;
  int threads_;
  int64_t *decoded_;
  AttributesRead &read_;
  AttributesView values_;
  std::vector<int16_t> summary_;  // [N, kSummary] of seeds of earlier passes, zeros for others
  int64_t stride_ = 0;
};

}  // namespace

Reading read_attributes(RangeDecoder &decoder, const AttributeModel &model, const ZeroCentred &tables,
                        const TileSeeds &seeds, int threads, int64_t *decoded, AttributesRead &read) {
  size_t groups = 0;
  for (const AttributeStep &step : model.steps) groups += step.groups.size();
  read.bits.assign(groups, 0.0);
  return AttributeReader(decoder, model, tables, seeds, threads, decoded, read).read_all();
}

}  // namespace sgi
