// Floats in memory that is used again.
#pragma once
#include <cstdint>
#include <memory>
#include <utility>

namespace sgi {

// Memory of one owner, which the next one gets when it ends: given back to the system each time, its pages would be
// cleared and mapped anew, a seventh of a decode (docs/notes/2026-11-decode.md). Safe for use by several threads, one
// owner each.
class KeptFloats {
 public:
  KeptFloats() = default;
  KeptFloats(KeptFloats &&other) noexcept : held_(std::move(other.held_)), size_(std::exchange(other.size_, 0)) {}
  ~KeptFloats() { give_back(); }

  // Room for so many, whatever they hold. What was handed out before is lost.
  float *room(int64_t size);

 private:
  void give_back();

  std::unique_ptr<float[]> held_;
  int64_t size_ = 0;
};

}  // namespace sgi
