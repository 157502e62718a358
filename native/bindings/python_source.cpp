#include "bindings/python_source.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "bindings/arrays.hpp"
#include "bindings/held.hpp"

namespace nb = nanobind;

namespace sgi {

namespace {

class BytesSource : public ByteSource {
 public:
  explicit BytesSource(const nb::bytes &bytes) : held_(bytes), memory_(memory_source(bytes_of(bytes))) {}
  std::optional<uint64_t> size() override { return memory_->size(); }
  size_t read(uint64_t offset, uint8_t *out, size_t count) override { return memory_->read(offset, out, count); }

 private:
  const Held held_;
  const std::unique_ptr<ByteSource> memory_;
};

class FileSource : public ByteSource {
 public:
  explicit FileSource(nb::object file) : file_(std::move(file)) {
    if (!nb::cast<bool>((*file_).attr("seekable")())) return;
    start_ = nb::cast<uint64_t>((*file_).attr("tell")());
    size_ = nb::cast<uint64_t>((*file_).attr("seek")(0, 2)) - start_;
    expects_ = nb::hasattr(*file_, "expect");
  }

  std::optional<uint64_t> size() override { return size_; }

  size_t read(uint64_t offset, uint8_t *out, size_t count) override {
    if (size_ && offset >= *size_) return 0;
    const nb::gil_scoped_acquire lock;
    if (size_) (*file_).attr("seek")(start_ + offset);
    size_t found = 0;
    while (found < count) {  // a pipe gives what it has
      const nb::object read = (*file_).attr("read")(count - found);
      if (!nb::isinstance<nb::bytes>(read))
        throw Error(Fault::usage,
                    std::string("reading it gave ") + Py_TYPE(read.ptr())->tp_name + "; give a binary file");
      const auto more = nb::borrow<nb::bytes>(read);
      if (!more.size()) break;
      const size_t taken = std::min(more.size(), count - found);
      std::memcpy(out + found, more.data(), taken);
      found += taken;
    }
    return found;
  }

  void expect(const std::vector<ByteRange> &ranges) override {
    if (!expects_) return;
    const nb::gil_scoped_acquire lock;
    nb::list told;
    for (const ByteRange &range : ranges) told.append(nb::make_tuple(start_ + range.offset, range.count));
    (*file_).attr("expect")(told);
  }

 private:
  const Held file_;
  uint64_t start_ = 0;
  std::optional<uint64_t> size_;
  bool expects_ = false;
};

}  // namespace

std::unique_ptr<ByteSource> python_source(nb::object source) {
  if (nb::isinstance<nb::bytes>(source)) return std::make_unique<BytesSource>(nb::borrow<nb::bytes>(source));
  return std::make_unique<FileSource>(std::move(source));
}

}  // namespace sgi
