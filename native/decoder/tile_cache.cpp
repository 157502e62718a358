#include "decoder/tile_cache.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr size_t kMinTiles = 4;         // those that meet in a corner
constexpr int64_t kOverhead = 1 << 14;  // bytes that a tile counts for besides its arrays: an empty one is not free

using Tile = std::unique_ptr<TileRenderer>;

// The only tile of a picture may be drawn before all of it is read; what is wrong with one of several is said with its
// number.
Tile decoded_tile(const Header &header, int64_t number, std::vector<uint8_t> payload, int threads,
                  const DecoderSettings &settings) {
  const bool is_single = header.grid().count() == 1;
  try {
    auto tile = std::make_unique<TileRenderer>(header, std::move(payload), threads, settings);
    if (!is_single) tile->complete();
    return tile;
  } catch (const Error &error) {
    if (is_single) throw;
    throw Error(error.fault, "tile " + std::to_string(number) + ": " + error.what());
  }
}

}  // namespace

// Threads that decode tiles ahead of those who ask for them, at most `threads + 1` of them not yet taken.
class TileCache::Prefetch {
 public:
  Prefetch(TileCache &cache, std::deque<int64_t> wanted, const PictureView &view)
      : cache_(cache), wanted_(std::move(wanted)), view_(view) {
    const int threads = resolve_threads(cache.settings_.threads), count = int(wanted_.size());
    each_ = std::max(1, threads / count);
    most_ = size_t(threads) + 1;
    try {
      for (int i = 0; i < std::min(threads, count); ++i) workers_.emplace_back([this] { work(); });
    } catch (const std::system_error &) {  // no more threads to be had: fewer will do, or none
    }
  }

  ~Prefetch() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      ended_ = true;
    }
    wake_.notify_all();
    for (std::thread &worker : workers_) worker.join();
  }

  // A tile once it is there; null for one that was not begun, or was taken before.
  Tile take(int64_t number) {
    fill();
    const auto found = coming_.find(number);
    if (found == coming_.end()) return nullptr;
    std::future<Tile> coming = std::move(found->second);
    coming_.erase(found);
    fill();
    return coming.get();
  }

 private:
  struct Job {
    int64_t number;
    std::vector<uint8_t> payload;
    std::promise<Tile> tile;
  };

  // Payloads are read by the thread that takes tiles: sources are used by one at a time.
  void fill() {
    for (; !workers_.empty() && !wanted_.empty() && coming_.size() < most_; wanted_.pop_front()) {
      Job job{wanted_.front(), cache_.payload(wanted_.front()), {}};
      coming_.emplace(job.number, job.tile.get_future());
      std::lock_guard<std::mutex> lock(mutex_);
      jobs_.push_back(std::move(job));
      wake_.notify_one();
    }
  }

  void work() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      wake_.wait(lock, [&] { return ended_ || !jobs_.empty(); });
      if (ended_) return;
      Job job = std::move(jobs_.front());
      jobs_.pop_front();
      lock.unlock();
      try {
        Tile tile = decoded_tile(cache_.chunks_.header(), job.number, std::move(job.payload), each_, cache_.settings_);
        tile->prepare(view_, 1);
        job.tile.set_value(std::move(tile));
      } catch (...) {
        job.tile.set_exception(std::current_exception());
      }
      lock.lock();
    }
  }

  TileCache &cache_;
  std::deque<int64_t> wanted_;
  const PictureView view_;
  int each_;
  size_t most_;
  std::map<int64_t, std::future<Tile>> coming_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  bool ended_ = false;
  std::vector<std::thread> workers_;
};

TileCache::TileCache(StreamReader &chunks, const DecoderSettings &settings) : chunks_(chunks), settings_(settings) {}

TileCache::~TileCache() = default;

TileRenderer &TileCache::tile(int64_t number) {
  if (tiles_.find(number) == tiles_.end()) {
    Tile tile = prefetch_ ? prefetch_->take(number) : nullptr;
    ahead_ += tile != nullptr;
    if (!tile) tile = decoded_tile(chunks_.header(), number, payload(number), settings_.threads, settings_);
    keep(number, std::move(tile));
  }
  Kept &kept = tiles_.at(number);
  uses_.splice(uses_.end(), uses_, kept.use);
  return *kept.tile;
}

// Reads a chunk; the source is told of those that follow.
std::vector<uint8_t> TileCache::payload(int64_t number) {
  if (expected_ < wanted_.size() && wanted_[expected_] == number) expected_ = chunks_.expect(wanted_, expected_);
  return chunks_.tile(number);
}

void TileCache::keep(int64_t number, Tile tile) {
  ++decoded_;
  tiles_[number] = {std::move(tile), 0, uses_.insert(uses_.end(), number)};
  auto recent = uses_.rbegin();  // tiles may have grown since, if they were rendered
  for (size_t i = 0; i <= kMinTiles && recent != uses_.rend(); ++i, ++recent) weigh(tiles_.at(*recent));
  while (tiles_.size() > kMinTiles && bytes_ > settings_.cache_bytes) {
    bytes_ -= tiles_.at(uses_.front()).bytes;
    tiles_.erase(uses_.front());
    uses_.pop_front();
  }
}

// Counts what a tile takes now.
void TileCache::weigh(Kept &kept) {
  const int64_t now = kept.tile->memory() + kOverhead;
  bytes_ += now - kept.bytes;
  kept.bytes = now;
}

void TileCache::start(const std::vector<int64_t> &numbers, const PictureView &view) {
  wanted_.clear(), expected_ = 0;
  for (const int64_t number : numbers)
    if (tiles_.find(number) == tiles_.end()) wanted_.push_back(number);
  if (resolve_threads(settings_.threads) > 1 && wanted_.size() > 1)
    prefetch_ = std::make_unique<Prefetch>(*this, std::deque<int64_t>(wanted_.begin(), wanted_.end()), view);
}

void TileCache::stop() {
  prefetch_.reset();
  wanted_.clear(), expected_ = 0;
}

void TileCache::for_each_fact(const std::function<void(const TileFacts &)> &body) {
  const Header &header = chunks_.header();
  const int64_t count = header.grid().count(), most = resolve_threads(settings_.threads);
  if (count == 1) return body(tile(0).facts());
  struct Decoded {
    std::vector<uint8_t> payload;
    TileFacts facts;
    std::exception_ptr failure;
  };
  for (int64_t first = 0; first < count; first += most) {
    if (settings_.between) settings_.between();
    std::vector<Decoded> tiles(std::min(most, count - first));
    for (size_t i = 0; i < tiles.size(); ++i) tiles[i].payload = chunks_.tile(first + int64_t(i));
    parallel_for(int64_t(tiles.size()), settings_.threads, [&](int64_t i) {
      try {
        tiles[i].facts = decoded_tile(header, first + i, std::move(tiles[i].payload), 1, settings_)->facts();
      } catch (...) {
        tiles[i].failure = std::current_exception();
      }
    });
    for (const Decoded &tile : tiles) {
      if (tile.failure) std::rethrow_exception(tile.failure);
      body(tile.facts);
    }
  }
}

}  // namespace sgi
