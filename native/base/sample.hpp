// The types that samples are stored as.
#pragma once

namespace sgi {

enum class SampleType { u8, u16, f32 };

}  // namespace sgi
