// Floats in memory that is used again.
#pragma once
#include <cstdint>
#include <memory>

namespace sgi {

class KeptFloats {
 public:
  // Room for so many, whatever they hold. What was handed out before is lost.
  float *room(int64_t size) {
    if (size > size_) {
      held_.reset();
      held_.reset(new float[size]);
      size_ = size;
    }
    return held_.get();
  }

 private:
  std::unique_ptr<float[]> held_;
  int64_t size_ = 0;
};

}  // namespace sgi
