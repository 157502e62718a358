#include "decoder/arriving_texture.hpp"

#include <utility>

namespace sgi {

ArrivingTexture::ArrivingTexture(std::unique_ptr<TileReader> reader, std::vector<uint8_t> payload, int threads)
    : reader_(std::move(reader)), payload_(std::move(payload)), task_(threads, [this] { read(); }) {}

void ArrivingTexture::read() {
  struct Ending {
    ArrivingTexture &of;
    ~Ending() {
      const std::lock_guard<std::mutex> lock(of.mutex_);
      of.ended_ = true;
      of.arrived_.notify_all();
    }
  } const ending{*this};
  reader_->texture_cells(cells_, [&](int64_t rows, const Texture &cells) {
    const std::lock_guard<std::mutex> lock(mutex_);
    rows_ = rows, there_ = cells;
    arrived_.notify_all();
  });
  end_ = reader_->finish();
  reader_.reset();
  payload_ = {};
}

Texture ArrivingTexture::first_rows(int64_t rows) {
  task_.begin();
  {
    std::unique_lock<std::mutex> lock(mutex_);
    arrived_.wait(lock, [&] { return ended_ || rows_ >= rows; });
    if (rows_ >= rows) return there_;
  }
  wait();
  return there_;
}

void ArrivingTexture::wait() { task_.wait(); }

bool ArrivingTexture::has_ended() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return ended_;
}

}  // namespace sgi
