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

#include "c/bvh.h"
#include "c/call.h"

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>
#include <windows.h>
#else
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace halfspace::c {
namespace {

[[noreturn]] void FailFile(const Call& call, const char* path, const char* what,
                           const std::error_code& error) {
  call.Fail(HS_IO_ERROR, "path", "\"%.256s\" cannot be %s: %s", path, what,
            error.message().c_str());
}

// Of a call of the C library, or of POSIX.
std::error_code LastError() { return {errno, std::generic_category()}; }

std::filesystem::path PathOf([[maybe_unused]] const Call& call,
                             const char* path) {
#if defined(_WIN32)
  try {
    return reinterpret_cast<const char8_t*>(path);
  } catch (const std::system_error&) {
    FailFile(call, path, "read as UTF-8",
             std::make_error_code(std::errc::illegal_byte_sequence));
  }
#else
  return path;
#endif
}

// Opens a file that does not exist yet.
std::FILE* OpenNew(const std::filesystem::path& path) {
#if defined(_WIN32)
  // Not every C library of Windows knows the mode "x".
  const int file =
      _wopen(path.c_str(), _O_CREAT | _O_EXCL | _O_WRONLY | _O_BINARY,
             _S_IREAD | _S_IWRITE);
  if (file < 0) return nullptr;
  std::FILE* const stream = _fdopen(file, "wb");
  if (stream == nullptr) {
    const int error = errno;
    _close(file);
    _wremove(path.c_str());
    errno = error;
  }
  return stream;
#else
  return std::fopen(path.c_str(), "wbx");
#endif
}

// Creates a file next to `path`, with a name that no other file has. The name
// is short, as the longest name of a file can be 255 bytes.
std::FILE* CreateNextTo(const std::filesystem::path& path,
                        std::filesystem::path& name) {
  static std::atomic<std::uint32_t> calls{0};
  for (int attempt = 0;; ++attempt) {
    const auto now = static_cast<std::uint32_t>(
        std::chrono::steady_clock::now().time_since_epoch().count());
    std::array<char, 16> suffix;
    std::snprintf(suffix.data(), suffix.size(), ".%08x.tmp",
                  static_cast<unsigned>(now + calls.fetch_add(1) * 0x9E3779B9));
    name = path;
    name += suffix.data();
    std::FILE* const file = OpenNew(name);
    if (file != nullptr || errno != EEXIST || attempt == 100) return file;
  }
}

bool WriteAll(std::FILE* file, Span<const std::byte> bytes) {
  if (!bytes.empty() &&
      std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) {
    return false;
  }
  if (std::fflush(file) != 0) return false;
    // The bytes are on the disk before the new name is: a crash leaves the old
    // file or the new one.
#if defined(_WIN32)
  return _commit(_fileno(file)) == 0;
#else
  return fsync(fileno(file)) == 0;
#endif
}

// A rename would replace a device or a FIFO, too. /dev/stdout is a link to one.
void CheckIsReplaceable(const Call& call, const char* path,
                        const std::filesystem::path& name) {
  std::error_code error;
  const auto type = std::filesystem::status(name, error).type();
  using std::filesystem::file_type;
  if (type == file_type::regular || type == file_type::not_found) return;
  if (type == file_type::directory) {
    error = std::make_error_code(std::errc::is_a_directory);
  } else if (type != file_type::none) {
    error = std::make_error_code(std::errc::no_such_device);
  }
  FailFile(call, path, "written", error);
}

// Removes a new file, unless Keep() was called.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& name) : name_(name) {}
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() {
    std::error_code ignored;
    if (!is_kept_) std::filesystem::remove(name_, ignored);
  }
  void Keep() { is_kept_ = true; }

 private:
  const std::filesystem::path& name_;
  bool is_kept_ = false;
};

void Save(const Call& call, const char* path, Span<const std::byte> bytes) {
  const std::filesystem::path name = PathOf(call, path);
  CheckIsReplaceable(call, path, name);
  std::filesystem::path next_to;
  std::FILE* const file = CreateNextTo(name, next_to);
  if (file == nullptr) {
    const std::error_code error = LastError();
    const std::u8string text = next_to.u8string();
    FailFile(call, reinterpret_cast<const char*>(text.c_str()), "created",
             error);
  }
  NewFile new_file(next_to);
  bool is_written = WriteAll(file, bytes);
  std::error_code error = LastError();
  if (std::fclose(file) != 0 && is_written) {
    is_written = false;
    error = LastError();
  }
  if (is_written) {
    std::filesystem::rename(next_to, name, error);
    if (!error) return new_file.Keep();
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

std::size_t SizeOf(const Call& call, const char* path, std::uint64_t size) {
  if (size > PTRDIFF_MAX) throw std::bad_alloc();
  if (size == 0) FailEmpty(call, path);
  return static_cast<std::size_t>(size);
}

#if defined(_WIN32)
struct NoCancel {
  NoCancel() {}
};

std::error_code LastWindowsError() {
  return {static_cast<int>(GetLastError()), std::system_category()};
}

struct CloseHandleOf {
  void operator()(HANDLE handle) const { CloseHandle(handle); }
};
using Handle = std::unique_ptr<void, CloseHandleOf>;

// The bytes of a file, which are no longer valid after Unmap().
Span<const std::byte> MapFile(const Call& call, const char* path) {
  const std::filesystem::path name = PathOf(call, path);
  const HANDLE opened = CreateFileW(
      name.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr,
      OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (opened == INVALID_HANDLE_VALUE) {
    FailFile(call, path, "opened", LastWindowsError());
  }
  const Handle file(opened);
  if (GetFileType(file.get()) != FILE_TYPE_DISK) {
    FailFile(call, path, "read",
             std::make_error_code(std::errc::no_such_device));
  }
  LARGE_INTEGER length;
  if (GetFileSizeEx(file.get(), &length) == 0) {
    FailFile(call, path, "read", LastWindowsError());
  }
  const std::size_t size =
      SizeOf(call, path, static_cast<std::uint64_t>(length.QuadPart));
  const Handle mapping(
      CreateFileMappingW(file.get(), nullptr, PAGE_READONLY, 0, 0, nullptr));
  const void* const bytes =
      mapping != nullptr ? MapViewOfFile(mapping.get(), FILE_MAP_READ, 0, 0, 0)
                         : nullptr;
  if (bytes == nullptr) FailFile(call, path, "mapped", LastWindowsError());
  return {static_cast<const std::byte*>(bytes), size};
}

void Unmap(Span<const std::byte> bytes) { UnmapViewOfFile(bytes.data()); }
#else
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

// The bytes of a file, which are no longer valid after Unmap().
Span<const std::byte> MapFile(const Call& call, const char* path) {
  const Descriptor file(path);
  if (file.get() < 0) FailFile(call, path, "opened", LastError());
  struct stat status;
  if (fstat(file.get(), &status) != 0)
    FailFile(call, path, "read", LastError());
  if (!S_ISREG(status.st_mode)) {
    FailFile(call, path, "read",
             std::make_error_code(S_ISDIR(status.st_mode)
                                      ? std::errc::is_a_directory
                                      : std::errc::no_such_device));
  }
  const std::size_t size =
      SizeOf(call, path, static_cast<std::uint64_t>(status.st_size));
  void* const bytes =
      mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (bytes == MAP_FAILED) FailFile(call, path, "mapped", LastError());
  return {static_cast<const std::byte*>(bytes), size};
}

void Unmap(Span<const std::byte> bytes) {
  munmap(const_cast<std::byte*>(bytes.data()), bytes.size());
}
#endif

hs_bvh* Load(const Call& call, const char* path, const BvhConfig& config) {
  struct Mapped {
    ~Mapped() { Unmap(bytes); }
    const Span<const std::byte> bytes;
  };
  const Mapped file{MapFile(call, path)};
  return FromBytes(call, "path", config, file.bytes);
}

hs_bvh* Map(const Call& call, const char* path, const BvhConfig& config) {
  auto bvh = MakeBvh(config.layout, config.options.memory);
  bvh->mapped = MapFile(call, path);
  LoadBytes(call, "path", *bvh, bvh->mapped, /*is_in_place=*/true);
  return bvh.release();
}

}  // namespace
}  // namespace halfspace::c

using halfspace::Span;
using halfspace::c::BvhConfig;
using halfspace::c::Call;
using halfspace::c::Run;

hs_bvh::~hs_bvh() {
  if (!mapped.empty()) halfspace::c::Unmap(mapped);
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
