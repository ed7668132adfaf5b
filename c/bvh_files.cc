// hs_bvh_...() of blobs and files, and hs_bvh's memory that is a file.
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "c/bvh.h"
#include "c/call.h"

#if defined(__unix__) || defined(__APPLE__)
#define HALFSPACE_C_POSIX
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace halfspace::c {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void FailFile(const Call& call, const char* path, const char* what,
                           int error) {
  call.Fail(HS_IO_ERROR, "path: \"%.256s\" cannot be %s: %s", path, what,
            std::generic_category().message(error).c_str());
}

// A new file next to `path`, which no other call has.
std::string NextTo(const char* path) {
  static std::atomic<unsigned> calls{0};
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return std::string(path) + "." + std::to_string(now) + "." +
         std::to_string(calls.fetch_add(1)) + ".tmp";
}

bool WriteAll(std::FILE* file, Span<const std::byte> bytes) {
  if (!bytes.empty() &&
      std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) {
    return false;
  }
  if (std::fflush(file) != 0) return false;
#if defined(HALFSPACE_C_POSIX)
  // The bytes are on the disk before the new name is: a crash leaves the old
  // file or the new one.
  if (fsync(fileno(file)) != 0) return false;
#endif
  return true;
}

void Save(const Call& call, const char* path, Span<const std::byte> bytes) {
  const std::string next_to = NextTo(path);
  std::FILE* const file = std::fopen(next_to.c_str(), "wbx");
  if (file == nullptr) FailFile(call, next_to.c_str(), "created", errno);
  bool is_written = WriteAll(file, bytes);
  int error = errno;
  if (std::fclose(file) != 0 && is_written) {
    is_written = false;
    error = errno;
  }
  if (is_written) {
    std::error_code result;
    std::filesystem::rename(next_to, path, result);
    if (!result) return;
    error = result.value();
  }
  std::remove(next_to.c_str());
  FailFile(call, path, "written", error);
}

// A file that was never written to its end.
[[noreturn]] void FailEmpty(const Call& call, const char* path) {
  call.Fail(HS_CORRUPT,
            "path: expected a stored BVH, got the empty file "
            "\"%.256s\"",
            path);
}

// The bytes of a file, in memory of its own.
class FileBytes {
 public:
  FileBytes(const Call& call, const char* path, const MemoryResource& memory)
      : memory_(memory) {
    const File file(std::fopen(path, "rb"));
    if (file == nullptr) FailFile(call, path, "opened", errno);
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) FailFile(call, path, "read", error.value());
    if (size > PTRDIFF_MAX) throw std::bad_alloc();
    size_ = static_cast<std::size_t>(size);
    if (size_ == 0) FailEmpty(call, path);
    bytes_ = detail::AllocateBlock(memory_, size_);
    if (std::fread(bytes_, 1, size_, file.get()) != size_) {
      const int read_error = std::ferror(file.get()) != 0 ? errno : EIO;
      detail::FreeBlock(memory_, bytes_, size_);
      FailFile(call, path, "read", read_error);
    }
  }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes() { detail::FreeBlock(memory_, bytes_, size_); }

  Span<const std::byte> span() const {
    return {static_cast<const std::byte*>(bytes_), size_};
  }

 private:
  MemoryResource memory_;
  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

void Verify(const Call& call, const hs_bvh& bvh) {
  if (bvh.tree.Verify()) return;
  call.Fail(HS_CORRUPT,
            "expected the bytes that hs_bvh_blob() returned, got altered ones: "
            "store the BVH again");
}

hs_bvh* FromBytes(const Call& call, const BvhConfig& config,
                  Span<const std::byte> bytes) {
  NewBvh bvh(config.kind, config.options.memory);
  bvh->tree.Load(bytes, /*is_in_place=*/false);
  Verify(call, *bvh.get());
  return bvh.Release();
}

#if defined(HALFSPACE_C_POSIX)
// Closes a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(const char* path)
      : file_(open(path, O_RDONLY | O_CLOEXEC)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (file_ >= 0) close(file_);
  }
  int get() const { return file_; }

 private:
  int file_;
};

void Map(const Call& call, const char* path, hs_bvh& bvh) {
  const Descriptor file(path);
  if (file.get() < 0) FailFile(call, path, "opened", errno);
  struct stat status;
  if (fstat(file.get(), &status) != 0) FailFile(call, path, "read", errno);
  if (!S_ISREG(status.st_mode)) {
    FailFile(call, path, "mapped", S_ISDIR(status.st_mode) ? EISDIR : ENODEV);
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) FailEmpty(call, path);
  void* const bytes =
      mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (bytes == MAP_FAILED) FailFile(call, path, "mapped", errno);
  bvh.mapped = bytes;
  bvh.mapped_bytes = size;
  bvh.tree.Load({static_cast<const std::byte*>(bytes), size},
                /*is_in_place=*/true);
}
#else
void Map(const Call& call, const char*, hs_bvh&) {
  call.Fail(HS_UNSUPPORTED,
            "files cannot be mapped on this system: use hs_bvh_load()");
}
#endif

}  // namespace
}  // namespace halfspace::c

using halfspace::Span;
using halfspace::c::BvhConfig;
using halfspace::c::Call;
using halfspace::c::Run;

hs_bvh::~hs_bvh() {
#if defined(HALFSPACE_C_POSIX)
  if (mapped != nullptr) munmap(mapped, mapped_bytes);
#endif
}

hs_status hs_bvh_blob(const hs_bvh* bvh, const void** data, size_t* size) {
  return Run("hs_bvh_blob", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("data", data);
    call.CheckPointer("size", size);
    const Span<const std::byte> blob = bvh->tree.Blob();
    *data = blob.data();
    *size = blob.size();
  });
}

hs_status hs_bvh_from_blob(const hs_bvh_config* config, const void* data,
                           size_t size, hs_bvh** bvh) {
  return Run(
      "hs_bvh_from_blob",
      [&](const Call& call) {
        call.CheckPointer("bvh", bvh);
        const BvhConfig read(call, config);
        const auto* const bytes = static_cast<const std::byte*>(data);
        call.CheckArray("data", bytes, size);
        *bvh = halfspace::c::FromBytes(call, read, {bytes, size});
      },
      HS_CORRUPT);
}

hs_status hs_bvh_save(const hs_bvh* bvh, const char* path) {
  return Run("hs_bvh_save", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    const Span<const std::byte> blob = bvh->tree.Blob();
    if (!blob.empty()) return halfspace::c::Save(call, path, blob);
    // A file of a BVH that never had an object has a header as well: an empty
    // file is one that was lost.
    halfspace::detail::BvhTree empty(bvh->tree.shape(), bvh->tree.memory());
    empty.Reserve(1);
    halfspace::c::Save(call, path, empty.Blob());
  });
}

hs_status hs_bvh_load(const hs_bvh_config* config, const char* path,
                      hs_bvh** bvh) {
  return Run(
      "hs_bvh_load",
      [&](const Call& call) {
        call.CheckPointer("bvh", bvh);
        call.CheckPointer("path", path);
        const BvhConfig read(call, config);
        const halfspace::c::FileBytes file(call, path, read.options.memory);
        *bvh = halfspace::c::FromBytes(call, read, file.span());
      },
      HS_CORRUPT);
}

hs_status hs_bvh_map(const hs_bvh_config* config, const char* path,
                     hs_bvh** bvh) {
  return Run(
      "hs_bvh_map",
      [&](const Call& call) {
        call.CheckPointer("bvh", bvh);
        call.CheckPointer("path", path);
        const BvhConfig read(call, config);
        halfspace::c::NewBvh mapped(read.kind, read.options.memory);
        halfspace::c::Map(call, path, *mapped.get());
        *bvh = mapped.Release();
      },
      HS_CORRUPT);
}

hs_status hs_bvh_verify(const hs_bvh* bvh) {
  return Run("hs_bvh_verify", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    halfspace::c::Verify(call, *bvh);
  });
}
