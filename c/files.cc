#include "c/files.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>
#include <windows.h>
#else
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace halfspace::c {
namespace {

[[noreturn]] void FailFile(const Call& call, const char* path, const char* what,
                           const std::error_code& error) {
#if !defined(_WIN32)
  errno = error.value();
#endif
  call.Fail(HS_IO_ERROR, "path", "\"%.256s\" cannot be %s: %s", path, what,
            error.message().c_str());
}

// The error of the last call of the C library or of POSIX.
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

// Opens a file that does not exist yet. Programs that this one starts do not
// have it.
std::FILE* OpenNew(const std::filesystem::path& path,
                   [[maybe_unused]] NewFile::Life life) {
#if defined(_WIN32)
  const int flags = _O_CREAT | _O_EXCL | _O_RDWR | _O_BINARY | _O_NOINHERIT |
                    (life == NewFile::kTemporary ? _O_TEMPORARY : 0);
  const int file = _wopen(path.c_str(), flags, _S_IREAD | _S_IWRITE);
  if (file < 0) return nullptr;
  std::FILE* const stream = _fdopen(file, "w+b");
#else
  const int file =
      open(path.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
  if (file < 0) return nullptr;
  if (life == NewFile::kTemporary) unlink(path.c_str());
  std::FILE* const stream = fdopen(file, "w+b");
#endif
  if (stream == nullptr) {
    const int error = errno;
#if defined(_WIN32)
    _close(file);
#else
    close(file);
#endif
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    errno = error;
  }
  return stream;
}

// The end of the name of a new file. It is short, as the longest name of a file
// can be 255 bytes.
std::array<char, 16> NewSuffix() {
  static std::atomic<std::uint32_t> calls{0};
  const auto now = static_cast<std::uint32_t>(
      std::chrono::steady_clock::now().time_since_epoch().count());
  std::array<char, 16> suffix;
  std::snprintf(suffix.data(), suffix.size(), ".%08x.tmp",
                static_cast<unsigned>(now + calls.fetch_add(1) * 0x9E3779B9));
  return suffix;
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

// A file that was never written to its end.
[[noreturn]] void FailEmpty(const Call& call, const char* path) {
  call.Fail(HS_CORRUPT, "path",
            "expected a stored BVH, got the empty file "
            "\"%.256s\"",
            path);
}

std::size_t SizeOf(const Call& call, const char* path, std::uint64_t size) {
  if (size > PTRDIFF_MAX) throw std::bad_alloc();
  if (size == 0) FailEmpty(call, path);
  return static_cast<std::size_t>(size);
}

#if defined(_WIN32)
std::error_code LastWindowsError() {
  return {static_cast<int>(GetLastError()), std::system_category()};
}

struct CloseHandleOf {
  void operator()(HANDLE handle) const { CloseHandle(handle); }
};
using Handle = std::unique_ptr<void, CloseHandleOf>;

// Maps the first bytes of a file, or returns null. To be written, the file gets
// room for them.
std::byte* MapOpen(std::FILE* file, std::size_t size, bool is_written,
                   std::error_code& error) {
  const auto bytes = static_cast<std::uint64_t>(size);
  const Handle mapping(CreateFileMappingW(
      reinterpret_cast<HANDLE>(_get_osfhandle(_fileno(file))), nullptr,
      is_written ? PAGE_READWRITE : PAGE_READONLY,
      static_cast<DWORD>(bytes >> 32), static_cast<DWORD>(bytes), nullptr));
  void* const mapped =
      mapping != nullptr
          ? MapViewOfFile(mapping.get(),
                          is_written ? FILE_MAP_WRITE : FILE_MAP_READ, 0, 0,
                          size)
          : nullptr;
  if (mapped == nullptr) error = LastWindowsError();
  return static_cast<std::byte*>(mapped);
}

bool IsOnDisk(std::FILE* file, std::byte* mapped, std::size_t size) {
  if (mapped != nullptr && FlushViewOfFile(mapped, size) == 0) return false;
  return _commit(_fileno(file)) == 0;
}
#else
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

// Gives a file at least `size` bytes. Returns an error number or 0.
int Reserve(int file, std::size_t size) {
  const auto bytes = static_cast<off_t>(size);
#if defined(__APPLE__)
  fstore_t room = {F_ALLOCATEALL, F_PEOFPOSMODE, 0, bytes, 0};
  struct stat status;
  if (fstat(file, &status) != 0) return errno;
  if (status.st_size >= bytes) return 0;
  return fcntl(file, F_PREALLOCATE, &room) == -1 || ftruncate(file, bytes) != 0
             ? errno
             : 0;
#else
  return posix_fallocate(file, 0, bytes);
#endif
}

// Maps the first bytes of a file, or returns null. To be written, the file gets
// room for them.
std::byte* MapOpen(std::FILE* file, std::size_t size, bool is_written,
                   std::error_code& error) {
  int number = 0;
  do {
    number = is_written ? Reserve(fileno(file), size) : 0;
  } while (number == EINTR);
  if (number != 0) {
    error = {number, std::generic_category()};
    return nullptr;
  }
  void* const mapped =
      mmap(nullptr, size, PROT_READ | (is_written ? PROT_WRITE : 0), MAP_SHARED,
           fileno(file), 0);
  if (mapped == MAP_FAILED) {
    error = LastError();
    return nullptr;
  }
  return static_cast<std::byte*>(mapped);
}

bool IsOnDisk(std::FILE* file, std::byte* mapped, std::size_t size) {
  if (mapped != nullptr && msync(mapped, size, MS_SYNC) != 0) return false;
  return fsync(fileno(file)) == 0;
}
#endif

}  // namespace

#if defined(_WIN32)
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

NewFile::NewFile(const Call& call, const char* path, Life life) : path_(path) {
  const std::filesystem::path given = PathOf(call, path);
  CheckIsReplaceable(call, path, given);
  // The folder of the process can change before the file is removed.
  std::error_code error;
  name_ = std::filesystem::absolute(given, error);
  if (given.filename().empty()) {
    error = std::make_error_code(std::errc::no_such_file_or_directory);
  }
  if (error) FailWritten(call, error);
  for (int attempt = 0; file_ == nullptr; ++attempt) {
    const std::array<char, 16> suffix = NewSuffix();
    next_to_ = name_;
    next_to_ += suffix.data();
    file_ = OpenNew(next_to_, life);
    if (file_ == nullptr && (errno != EEXIST || attempt == 100)) {
      error = LastError();
      FailFile(call, (path_ + suffix.data()).c_str(), "created", error);
    }
  }
}

NewFile::~NewFile() {
  UnmapOwn();
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(next_to_, ignored);
}

void NewFile::FailWritten(const Call& call,
                          const std::error_code& error) const {
  FailFile(call, path_.c_str(), "written", error);
}

std::string NewFile::AbsolutePath() const {
#if defined(_WIN32)
  const std::u8string text = name_.u8string();
  return {text.begin(), text.end()};
#else
  return name_.string();
#endif
}

void NewFile::Write(const Call& call, Span<const std::byte> bytes) {
  if (bytes.empty()) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) {
    FailWritten(call, LastError());
  }
}

void NewFile::Flush(const Call& call) {
  if (std::fflush(file_) != 0) FailWritten(call, LastError());
}

std::fpos_t NewFile::Position(const Call& call) {
  std::fpos_t position;
  if (std::fgetpos(file_, &position) != 0) FailWritten(call, LastError());
  return position;
}

void NewFile::Return(const std::fpos_t& position) {
  std::clearerr(file_);
  std::fsetpos(file_, &position);
}

Span<const std::byte> NewFile::MapWritten(const Call& call,
                                          std::size_t size) const {
  std::error_code error;
  const std::byte* const bytes = MapOpen(file_, size, false, error);
  if (bytes == nullptr) FailFile(call, path_.c_str(), "mapped", error);
  return {bytes, size};
}

std::byte* NewFile::Map(const Call& call, std::size_t size) {
  std::error_code error;
  mapped_ = MapOpen(file_, size, true, error);
  if (mapped_ == nullptr) FailWritten(call, error);
  mapped_bytes_ = size;
  return mapped_;
}

void NewFile::UnmapOwn() {
  if (mapped_bytes_ != 0) Unmap({mapped_, mapped_bytes_});
  mapped_bytes_ = 0;
}

void NewFile::Publish(const Call& call) {
  std::error_code error;
  if (std::fflush(file_) != 0 ||
      !IsOnDisk(file_, mapped_bytes_ != 0 ? mapped_ : nullptr, mapped_bytes_)) {
    error = LastError();
  }
  // Windows renames no file that is mapped or open.
  UnmapOwn();
  if (std::fclose(std::exchange(file_, nullptr)) != 0 && !error) {
    error = LastError();
  }
  if (!error) std::filesystem::rename(next_to_, name_, error);
  if (!error) return;
  std::error_code ignored;
  std::filesystem::remove(next_to_, ignored);
  FailWritten(call, error);
}

}  // namespace halfspace::c
