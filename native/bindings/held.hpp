// A Python object that C++ keeps, on whatever thread it lets go of it.
#pragma once
#include <nanobind/nanobind.h>

#include <utility>

namespace sgi {

class Held {
 public:
  explicit Held(nanobind::object object) : object_(std::move(object)) {}
  Held(const Held &) = delete;
  ~Held() {
    const nanobind::gil_scoped_acquire lock;
    object_.reset();
  }
  const nanobind::object &operator*() const { return object_; }

 private:
  nanobind::object object_;
};

}  // namespace sgi
