// What a caller or a stream did wrong. Anything else that is thrown is a defect of this library.
#pragma once
#include <stdexcept>
#include <string>

namespace sgi {

enum class Fault {
  usage,        // an argument that makes no sense
  region,       // a region, level or tile that is not there
  corrupt,      // bytes that no encoder wrote
  unsupported,  // a sound stream that needs another version
  limit,        // a stream that asks for more than the caps, found before memory is taken
  source,       // what was to give bytes failed
};

// `what()` is one line in UTF-8 that a user can read.
class Error : public std::runtime_error {
 public:
  Error(Fault fault, const std::string &text) : std::runtime_error(text), fault(fault) {}
  const Fault fault;
};

}  // namespace sgi
