// hs_bvh_...() of blobs and files, and hs_bvh's memory that is a file.
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "c/bvh.h"
#include "c/call.h"

#if defined(__unix__) || defined(__APPLE__)
#define HALFSPACE_C_POSIX
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace halfspace::c {
namespace {

[[noreturn]] void FailFile(const Call& call, const char* path, const char* what,
                           int error) {
  call.Fail(HS_IO_ERROR, "path", "\"%.256s\" cannot be %s: %s", path, what,
            std::generic_category().message(error).c_str());
}

// Creates a file next to `path`, with a name that no other file has. The name
// is short, as the longest name of a file can be 255 bytes.
std::FILE* CreateNextTo(const char* path, std::string& name) {
  static std::atomic<std::uint32_t> calls{0};
  for (int attempt = 0;; ++attempt) {
    const auto now = static_cast<std::uint32_t>(
        std::chrono::steady_clock::now().time_since_epoch().count());
    std::array<char, 16> suffix;
    std::snprintf(suffix.data(), suffix.size(), ".%08x.tmp",
                  static_cast<unsigned>(now + calls.fetch_add(1) * 0x9E3779B9));
    name = std::string(path) + suffix.data();
    std::FILE* const file = std::fopen(name.c_str(), "wbx");
    if (file != nullptr || errno != EEXIST || attempt == 100) return file;
  }
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

// A rename would replace a device or a FIFO, too. /dev/stdout is a link to one.
void CheckIsReplaceable(const Call& call, const char* path) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  using std::filesystem::file_type;
  if (type == file_type::regular || type == file_type::not_found) return;
  FailFile(call, path, "written",
           type == file_type::none        ? error.value()
           : type == file_type::directory ? EISDIR
                                          : ENODEV);
}

// Removes a new file, unless Keep() was called.
class NewFile {
 public:
  explicit NewFile(const std::string& name) : name_(name) {}
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() {
    if (!is_kept_) std::remove(name_.c_str());
  }
  void Keep() { is_kept_ = true; }

 private:
  const std::string& name_;
  bool is_kept_ = false;
};

void Save(const Call& call, const char* path, Span<const std::byte> bytes) {
  CheckIsReplaceable(call, path);
  std::string next_to;
  std::FILE* const file = CreateNextTo(path, next_to);
  if (file == nullptr) FailFile(call, next_to.c_str(), "created", errno);
  NewFile new_file(next_to);
  bool is_written = WriteAll(file, bytes);
  int error = errno;
  if (std::fclose(file) != 0 && is_written) {
    is_written = false;
    error = errno;
  }
  if (is_written) {
    std::error_code result;
    std::filesystem::rename(next_to, path, result);
    if (!result) return new_file.Keep();
    error = result.value();
  }
  FailFile(call, path, "written", error);
}

// A file that was never written to its end.
[[noreturn]] void FailEmpty(const Call& call, const char* path) {
  call.Fail(HS_CORRUPT, "path",
            "expected a stored BVH, got the empty file "
            "\"%.256s\"",
            path);
}

void Verify(const Call& call, const hs_bvh& bvh) {
  if (bvh.tree.Verify()) return;
  call.Fail(HS_CORRUPT, "",
            "expected the bytes that hs_bvh_blob() returned, got altered ones: "
            "store the BVH again");
}

// Bytes that are no BVH are HS_CORRUPT. A mistake of the caller's is not.
void LoadBytes(const Call& call, const char* argument, hs_bvh& bvh,
               Span<const std::byte> bytes, bool is_in_place) {
  try {
    bvh.tree.Load(bytes, is_in_place);
  } catch (const Error& error) {
    if (error.argument() != "blob") throw;
    call.Fail(HS_CORRUPT, error, argument);
  }
}

hs_bvh* FromBytes(const Call& call, const char* argument,
                  const BvhConfig& config, Span<const std::byte> bytes) {
  auto bvh = MakeBvh(config.layout, config.options.memory);
  LoadBytes(call, argument, *bvh, bytes, /*is_in_place=*/false);
  Verify(call, *bvh);
  return bvh.release();
}

#if defined(HALFSPACE_C_POSIX)
// A thread that is canceled in a system call would leave the call by another
// way than a return: through functions that are noexcept, and with open files.
class NoCancel {
 public:
#if defined(__ANDROID__)
  NoCancel() {}  // has no cancellation
#else
  NoCancel() { pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &before_); }
  ~NoCancel() { pthread_setcancelstate(before_, nullptr); }
#endif
  NoCancel(const NoCancel&) = delete;
  NoCancel& operator=(const NoCancel&) = delete;

 private:
  int before_ = 0;
};

// Closes a file descriptor.
class Descriptor {
 public:
  // Without O_NONBLOCK, a FIFO would be waited for.
  explicit Descriptor(const char* path)
      : file_(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (file_ >= 0) close(file_);
  }
  int get() const { return file_; }

 private:
  int file_;
};

// A file in memory.
class FileBytes {
 public:
  FileBytes(const Call& call, const char* path) {
    const Descriptor file(path);
    if (file.get() < 0) FailFile(call, path, "opened", errno);
    struct stat status;
    if (fstat(file.get(), &status) != 0) FailFile(call, path, "read", errno);
    if (!S_ISREG(status.st_mode)) {
      FailFile(call, path, "read", S_ISDIR(status.st_mode) ? EISDIR : ENODEV);
    }
    if (status.st_size > PTRDIFF_MAX) throw std::bad_alloc();
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ == 0) FailEmpty(call, path);
    bytes_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (bytes_ == MAP_FAILED) FailFile(call, path, "mapped", errno);
  }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes() {
    if (bytes_ != nullptr) munmap(bytes_, size_);
  }

  Span<const std::byte> span() const {
    return {static_cast<const std::byte*>(bytes_), size_};
  }
  // The BVH unmaps them then.
  void GiveTo(hs_bvh& bvh) {
    bvh.mapped = std::exchange(bytes_, nullptr);
    bvh.mapped_bytes = size_;
  }

 private:
  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

hs_bvh* Load(const Call& call, const char* path, const BvhConfig& config) {
  const FileBytes file(call, path);
  return FromBytes(call, "path", config, file.span());
}

hs_bvh* Map(const Call& call, const char* path, const BvhConfig& config) {
  auto bvh = MakeBvh(config.layout, config.options.memory);
  FileBytes file(call, path);
  const Span<const std::byte> bytes = file.span();
  file.GiveTo(*bvh);
  LoadBytes(call, "path", *bvh, bytes, /*is_in_place=*/true);
  return bvh.release();
}
#else
struct NoCancel {
  NoCancel() {}
};

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// A file in memory.
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

hs_bvh* Load(const Call& call, const char* path, const BvhConfig& config) {
  const FileBytes file(call, path, config.options.memory);
  return FromBytes(call, "path", config, file.span());
}

hs_bvh* Map(const Call& call, const char*, const BvhConfig&) {
  call.Fail(HS_UNSUPPORTED, "",
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

hs_status hs_blob_kind(const void* data, size_t size, hs_kind* kind) {
  return Run("hs_blob_kind", [&](const Call& call) {
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    call.CheckPointer("kind", kind);
    const hs_kind found =
        halfspace::c::KindOf(halfspace::detail::LayoutOfBlob({bytes, size}));
    if (found == 0) {
      call.Fail(HS_CORRUPT, "data",
                "expected the bytes of a stored BVH, got others");
    }
    *kind = found;
  });
}

hs_status hs_bvh_from_blob(const hs_bvh_config* config, const void* data,
                           size_t size, hs_bvh** bvh) {
  return Run("hs_bvh_from_blob", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const BvhConfig read(call, config);
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    *bvh = halfspace::c::FromBytes(call, "data", read, {bytes, size});
  });
}

hs_status hs_bvh_in_place(const hs_bvh_config* config, const void* data,
                          size_t size, hs_bvh** bvh) {
  return Run("hs_bvh_in_place", [&](const Call& call) {
    constexpr size_t kAlignment = 64;
    call.CheckPointer("bvh", bvh);
    const BvhConfig read(call, config);
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    auto loaded = halfspace::c::MakeBvh(read.layout, read.options.memory);
    halfspace::c::LoadBytes(
        call, "data", *loaded, {bytes, size},
        reinterpret_cast<std::uintptr_t>(bytes) % kAlignment == 0);
    *bvh = loaded.release();
  });
}

hs_status hs_bvh_save(const hs_bvh* bvh, const char* path) {
  return Run("hs_bvh_save", [&](const Call& call) {
    const halfspace::c::NoCancel no_cancel;
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    const Span<const std::byte> blob = bvh->tree.Blob();
    if (!blob.empty()) return halfspace::c::Save(call, path, blob);
    // A file of a BVH without memory has a header as well: an empty file is one
    // that was lost.
    halfspace::detail::BvhTree empty(halfspace::c::TypeOf(bvh->layout),
                                     bvh->tree.memory());
    empty.Reserve(1);
    halfspace::c::Save(call, path, empty.Blob());
  });
}

hs_status hs_bvh_load(const hs_bvh_config* config, const char* path,
                      hs_bvh** bvh) {
  return Run("hs_bvh_load", [&](const Call& call) {
    const halfspace::c::NoCancel no_cancel;
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    *bvh = halfspace::c::Load(call, path, BvhConfig(call, config));
  });
}

hs_status hs_bvh_map(const hs_bvh_config* config, const char* path,
                     hs_bvh** bvh) {
  return Run("hs_bvh_map", [&](const Call& call) {
    const halfspace::c::NoCancel no_cancel;
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    *bvh = halfspace::c::Map(call, path, BvhConfig(call, config));
  });
}

hs_status hs_bvh_verify(const hs_bvh* bvh) {
  return Run("hs_bvh_verify", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    halfspace::c::Verify(call, *bvh);
  });
}
