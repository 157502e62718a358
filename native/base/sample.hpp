// The types that samples are stored as.
#pragma once
#include <cstdint>

namespace sgi {

enum class SampleType { u8, u16, f32 };

constexpr int64_t bytes_of(SampleType type) { return type == SampleType::u8 ? 1 : type == SampleType::u16 ? 2 : 4; }

// The sample that stands for 1 where no range is stated; 0 stands for 0.
constexpr double largest_of(SampleType type) {
  return type == SampleType::u8 ? 255 : type == SampleType::u16 ? 65535 : 1;
}

// What body(a sample of a type) returns.
template <class Body>
auto with_sample(SampleType type, const Body &body) {
  switch (type) {
    case SampleType::u8: return body(uint8_t{});
    case SampleType::u16: return body(uint16_t{});
    default: return body(float{});
  }
}

}  // namespace sgi
