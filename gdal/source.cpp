#include "source.hpp"

namespace {

int64_t read_file(void *user, uint64_t offset, void *buffer, size_t count) {
  VSILFILE *file = static_cast<VSILFILE *>(user);
  if (VSIFSeekL(file, offset, SEEK_SET) != 0) return -1;
  return int64_t(VSIFReadL(buffer, 1, count, file));
}

}  // namespace

std::shared_ptr<Source> open_source(const char *name, VSILFILE *file) {
  auto source = std::make_shared<Source>();
  source->file.reset(file);
  VSIFSeekL(file, 0, SEEK_END);
  sgi_stream *stream = nullptr;
  source->info.struct_size = sizeof source->info;
  const bool is_open = sgi_open(read_file, file, VSIFTellL(file), nullptr, &stream) == SGI_OK;
  source->stream.reset(stream);
  if (!is_open || sgi_get_info(stream, &source->info) != SGI_OK) {
    CPLError(CE_Failure, CPLE_OpenFailed, "%s: %s", name, sgi_error());
    return nullptr;
  }
  source->described =
      described_by(source->metadata(SGI_METADATA_PLACE), source->metadata(SGI_METADATA_EXIF), source->layout());
  return source;
}
