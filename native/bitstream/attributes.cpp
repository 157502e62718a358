#include "bitstream/attributes.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <iterator>

#include "base/thread_pool.hpp"
#include "bitstream/frequency_tables.hpp"
#include "model/coding_passes.hpp"
#include "model/neighbours.hpp"

namespace sgi {
namespace {

using Table = std::vector<int32_t>;

// Nearest seeds of earlier passes, pass after pass; those of the next pass are searched by a thread of its own if
// `ahead`.
class NeighboursByPass {
 public:
  NeighboursByPass(const TileSeeds &seeds, int ranks, Isa isa, bool ahead)
      : seeds_(seeds), ranks_(ranks), isa_(isa), policy_(ahead ? std::launch::async : std::launch::deferred) {
    search_next();
  }

  // [n, ranks] of the next pass, -1 where there is none.
  Table next() {
    Table found = next_.get();
    search_next();
    return found;
  }

 private:
  void search_next() {
    if (pass_ < seeds_.passes.size()) next_ = std::async(policy_, [this] { return search(); });
  }

  Table search() {
    const std::vector<int64_t> &members = seeds_.passes[pass_++];
    Table table(members.size() * size_t(ranks_), -1);
    if (!ranks_) return table;
    if (!earlier_.empty())
      nearest_among(seeds_.view.half_pixels, earlier_.data(), int64_t(earlier_.size()), members.data(),
                    int64_t(members.size()), ranks_, isa_, table.data());
    std::vector<int64_t> both;
    both.reserve(earlier_.size() + members.size());
    std::merge(earlier_.begin(), earlier_.end(), members.begin(), members.end(), std::back_inserter(both));
    earlier_ = std::move(both);
    return table;
  }

  const TileSeeds &seeds_;
  int ranks_;
  Isa isa_;
  std::launch policy_;
  size_t pass_ = 0;
  std::vector<int64_t> earlier_;  // seeds, ascending
  std::future<Table> next_;       // its end is waited for first
};

class AttributeWalk {
 public:
  AttributeWalk(const AttributeSymbols &coder, const AttributeModel &model, const TileSeeds &seeds, int threads,
                int64_t *decoded)
      : coder_(coder), model_(model), seeds_(seeds), threads_(threads), decoded_(decoded),
        values_{decoded, model.attributes, model.channels, model.colour, model.shape},
        summary_(size_t(seeds.count) * kSummary) {
    for (const AttributeStep &step : model.steps) {
      stride_ = std::max(stride_, int64_t(step.inputs));
      coded_.emplace_back(step.groups.size());
    }
  }

  void code_all() {
    NeighboursByPass neighbours(seeds_, model_.ranks, model_.isa, resolve_threads(threads_) > 1 && model_.ranks);
    for (const std::vector<int64_t> &members : seeds_.passes) code_pass(members, neighbours.next());
  }

 private:
  // What a group is coded with [n, size].
  struct Coded {
    std::vector<int64_t> mean, step;
    std::vector<int16_t> tables;
    std::vector<int32_t> symbols;
  };

  template <class T>
  static void grow(std::vector<T> &memory, size_t size) {
    if (memory.size() < size) memory.resize(size);
  }

  // Calls body(begin, count) for runs of n seeds, on several threads. All that happens to a seed between two groups of
  // symbols happens in one run: its numbers stay in the cache, and threads are woken once.
  template <class Body>
  void for_runs(size_t n, Body body) {
    constexpr size_t kRun = 512;
    parallel_for(int64_t((n + kRun - 1) / kRun), threads_, [&](int64_t run) {
      const size_t begin = size_t(run) * kRun;
      body(begin, std::min(n - begin, kRun));
    });
  }

  void code_pass(const std::vector<int64_t> &members, const std::vector<int32_t> &table) {
    const size_t n = members.size();
    grow(inputs_, n * size_t(stride_)), grow(own_summary_, n * kSummary), grow(amplitude_, n), grow(log_size_, n);
    size_t number = 0;
    for (size_t s = 0; s < model_.steps.size(); ++s) {
      make_room(s, n);
      for_runs(n, [&](size_t begin, size_t count) {
        if (s == 0)
          begin_seeds(members, table, begin, count);
        else
          go_on(members, s, begin, count);
        predict(s, begin, count);
      });
      code_step(s, members, number);
    }
    for_runs(n, [&](size_t begin, size_t count) {
      finish(members, model_.steps.size() - 1, begin, count);
      for (size_t i = begin; i < begin + count && model_.ranks; ++i)
        std::copy_n(own_summary_.data() + i * kSummary, kSummary, summary_.data() + size_t(members[i]) * kSummary);
    });
  }

  void make_room(size_t s, size_t n) {
    const AttributeStep &step = model_.steps[s];
    grow(predicted_, n * size_t(step.network->outputs()));
    for (size_t g = 0; g < step.groups.size(); ++g) {
      const size_t count = n * size_t(step.groups[g].size());
      Coded &coded = coded_[s][g];
      grow(coded.mean, count), grow(coded.step, count), grow(coded.tables, count), grow(coded.symbols, count);
    }
  }

  // Inputs of seeds that know nothing of themselves.
  void begin_seeds(const std::vector<int64_t> &members, const std::vector<int32_t> &table, size_t begin, size_t count) {
    for (size_t i = begin; i < begin + count; ++i) log_size_[i] = seeds_.view.log_size[members[i]];
    seed_inputs(seeds_.view, {table.data() + begin * size_t(model_.ranks), model_.ranks}, summary_.data(),
                members.data() + begin, int64_t(count), model_.colour_step, inputs_.data() + begin * size_t(stride_),
                stride_);
    if (model_.grid)
      model_.grid->write_inputs(model_.grid_signs, seeds_.view.half_pixels, members.data() + begin, int64_t(count),
                                inputs_.data() + begin * size_t(stride_) + size_t(first_hashed()), stride_);
  }

  int64_t first_hashed() const { return kLevelInputs + (model_.ranks ? kNeighbourInputs : 0); }

  // The values of a step, and the summaries that follow from them.
  void finish(const std::vector<int64_t> &members, size_t s, size_t begin, size_t count) {
    const AttributeStep &step = model_.steps[s];
    for (size_t g = 0; g < step.groups.size(); ++g) {
      const AttributeGroup &group = step.groups[g];
      const Coded &coded = coded_[s][g];
      const size_t at = begin * size_t(group.size());
      dequantise(group, coded.symbols.data() + at, coded.mean.data() + at, coded.step.data() + at,
                 members.data() + begin, int64_t(count), decoded_, model_.attributes);
    }
    if (model_.ranks || model_.steps.size() > 1)
      summarise(values_, members.data() + begin, int64_t(count), own_summary_.data() + begin * kSummary,
                amplitude_.data() + begin);
  }

  void go_on(const std::vector<int64_t> &members, size_t s, size_t begin, size_t count) {
    finish(members, s - 1, begin, count);
    own_inputs(own_summary_.data() + begin * kSummary, int64_t(count), int(s), model_.steps[0].inputs,
               inputs_.data() + begin * size_t(stride_), stride_);
  }

  void predict(size_t s, size_t begin, size_t count) {
    const AttributeStep &step = model_.steps[s];
    const int64_t outputs = step.network->outputs();
    int64_t *predicted = predicted_.data() + begin * size_t(outputs);
    const std::unique_ptr<double[]> scratch(new double[size_t(step.network->scratch_size())]);
    step.network->evaluate(inputs_.data() + begin * size_t(stride_), stride_, int64_t(count), scratch.get(), predicted);
    for (size_t g = 0; g < step.groups.size(); ++g) {
      const AttributeGroup &group = step.groups[g];
      Coded &coded = coded_[s][g];
      const size_t at = begin * size_t(group.size());
      int16_t *tables = coded.tables.data() + at;
      quantisers(step, group, predicted, amplitude_.data() + begin, log_size_.data() + begin, int64_t(count),
                 coded.mean.data() + at, coded.step.data() + at, tables);
      for (size_t i = 0; i < count * size_t(group.size()); ++i) tables[i] = int16_t(tables[i] + model_.first_table);
    }
  }

  void code_step(size_t s, const std::vector<int64_t> &members, size_t &number) {
    const AttributeStep &step = model_.steps[s];
    for (size_t g = 0; g < step.groups.size(); ++g) {
      Coded &coded = coded_[s][g];
      const AttributeRun run{number++,          step.groups[g],    members,
                             coded.mean.data(), coded.step.data(), coded.tables.data()};
      coder_(run, coded.symbols.data());
    }
  }

  const AttributeSymbols &coder_;
  const AttributeModel &model_;
  const TileSeeds &seeds_;
  int threads_;
  int64_t *decoded_;
  AttributesView values_;
  std::vector<int16_t> summary_;  // [N, kSummary] of seeds of earlier passes, zeros for others
  int64_t stride_ = 0;

  // Of one pass or step; kept, since memory that is new costs more than what is done in it.
  std::vector<int16_t> inputs_, own_summary_;
  std::vector<int32_t> amplitude_;
  std::vector<int8_t> log_size_;
  std::vector<int64_t> predicted_;
  std::vector<std::vector<Coded>> coded_;  // groups by step: a step is finished while the next one is predicted
};

}  // namespace

TileSeeds::TileSeeds(const ContextSpec &context, const std::vector<int32_t> &corner,
                     const std::vector<int8_t> &log_size)
    : half_pixels(corner.size()), view{half_pixels.data(), log_size.data()}, count(int64_t(log_size.size())),
      passes(coding_passes(context, corner, log_size)) {
  for (size_t i = 0; i < corner.size(); ++i) half_pixels[i] = 2 * corner[i] + (int32_t(1) << log_size[i / 2]);
}

std::vector<std::vector<int32_t>> neighbours_by_pass(const TileSeeds &seeds, int ranks, Isa isa) {
  NeighboursByPass neighbours(seeds, ranks, isa, false);
  std::vector<std::vector<int32_t>> found;
  for (size_t pass = 0; pass < seeds.passes.size(); ++pass) found.push_back(neighbours.next());
  return found;
}

AttributeSymbols nearest_symbols(const AttributeModel &model, const double *values) {
  std::array<double, kFamilySize> leans;
  for (int scale = 0; scale < kFamilySize; ++scale)
    leans[size_t(scale)] =
        model.first_table ? std::min(kDeadZone * std::exp2(double(kScaleZero - scale) / kPerOctave), kDeadZoneLimit)
                          : 0;
  return [&model, values, leans](const AttributeRun &run, int32_t *symbols) {
    const int64_t size = run.group.size();
    for (int64_t i = 0; i < run.count(); ++i) {
      const double value = values[run.members[size_t(i / size)] * model.attributes + run.group.first + i % size];
      const double position = (value * (1 << kFractionBits) - double(run.mean[i])) / double(run.step[i]);
      const double size_of = std::floor(std::abs(position) + 0.5 - leans[size_t(run.tables[i] - model.first_table)]);
      symbols[i] = int32_t(std::copysign(std::min(size_of, double(kMaxMagnitude)), position));
    }
  };
}

void code_attributes(const AttributeSymbols &coder, const AttributeModel &model, const TileSeeds &seeds, int threads,
                     int64_t *decoded) {
  AttributeWalk(coder, model, seeds, threads, decoded).code_all();
}

}  // namespace sgi
