// The texture of a tile, drawn from above while it is read.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "base/thread_pool.hpp"
#include "bitstream/tile.hpp"

namespace sgi {

// Reads the texture of a tile on a thread of the pool, of one thread when it is asked for.
class ArrivingTexture {
 public:
  // reader: of a payload that has texture, read up to it.
  ArrivingTexture(std::unique_ptr<TileReader> reader, std::vector<uint8_t> payload, int threads);

  // Cells, among them all that pixels of the first `rows` rows show, as soon as these are there. Throws what reading
  // threw.
  Texture first_rows(int64_t rows);
  // Waits for the end of the payload. Throws what reading threw.
  void wait();
  bool has_ended();  // whether it is complete, or failed

  // Once it is complete.
  const TextureCells &cells() const { return cells_; }
  const TileEnd &end() const { return end_; }

 private:
  void read();

  std::unique_ptr<TileReader> reader_;
  std::vector<uint8_t> payload_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  int64_t rows_ = 0;  // whose cells are there
  Texture there_{};
  bool ended_ = false;
  TextureCells cells_;
  TileEnd end_;
  Task task_;  // the last: its end comes before that of what it writes
};

}  // namespace sgi
