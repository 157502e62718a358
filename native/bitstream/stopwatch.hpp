#pragma once
#include <chrono>

namespace sgi {

// Adds the seconds of its life to a number.
class Stopwatch {
 public:
  explicit Stopwatch(double &seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double &seconds_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace sgi
