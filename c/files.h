// Files: new ones next to a path, which replace it when they are complete, and
// files in memory.
#ifndef HALFSPACE_C_FILES_H_
#define HALFSPACE_C_FILES_H_

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include "c/call.h"
#include "halfspace/span.h"

#if !defined(_WIN32) && !defined(__ANDROID__)
#include <pthread.h>
#endif

namespace halfspace::c {

#if defined(_WIN32) || defined(__ANDROID__)
struct NoCancel {
  NoCancel() {}
};
#else
// A thread that is canceled in a system call would leave the call by another
// way than a return: through functions that are noexcept, and with open files.
class NoCancel {
 public:
  NoCancel() { pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &before_); }
  ~NoCancel() { pthread_setcancelstate(before_, nullptr); }
  NoCancel(const NoCancel&) = delete;
  NoCancel& operator=(const NoCancel&) = delete;

 private:
  int before_ = 0;
};
#endif

// The bytes of a file, which are no longer valid after Unmap().
Span<const std::byte> MapFile(const Call& call, const char* path);
void Unmap(Span<const std::byte> bytes);

// Unmaps bytes at the end of its life.
struct Mapped {
  ~Mapped() {
    if (!bytes.empty()) Unmap(bytes);
  }
  const Span<const std::byte> bytes;
};

// A new file next to `path`, which is removed unless Publish() was called.
// Functions fail with HS_IO_ERROR.
class NewFile {
 public:
  // A temporary file has no name where the system can remove it at once, and
  // cannot be published.
  enum Life : bool { kToPublish, kTemporary };

  NewFile(const Call& call, const char* path, Life life);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  // `path` from the root, so that it stays when the process changes its folder.
  std::string AbsolutePath() const;

  // Writes behind what was written before.
  void Write(const Call& call, Span<const std::byte> bytes);
  // Reports an error of what was written and is still in memory.
  void Flush(const Call& call);
  // The end of what was written, to which it can return after an error.
  std::fpos_t Position(const Call& call);
  void Return(const std::fpos_t& position);
  // Maps bytes that were written and flushed. Call Unmap() at their end.
  Span<const std::byte> MapWritten(const Call& call, std::size_t size) const;

  // Maps `size` bytes of a file without others for reading and writing. The
  // disk has room for them then, since a write to a page without room would end
  // the process.
  std::byte* Map(const Call& call, std::size_t size);
  // What Map() returned, also after Publish().
  const std::byte* mapped() const { return mapped_; }

  // Replaces `path` by the file, which is closed and no longer mapped. Its
  // bytes are on the disk before it has the name: a crash leaves the old file
  // or the new one.
  void Publish(const Call& call);

 private:
  [[noreturn]] void FailWritten(const Call& call,
                                const std::error_code& error) const;
  void UnmapOwn();

  std::string path_;            // as the caller wrote it
  std::filesystem::path name_;  // absolute, as the next
  std::filesystem::path next_to_;
  std::FILE* file_ = nullptr;
  std::byte* mapped_ = nullptr;
  std::size_t mapped_bytes_ = 0;
};

}  // namespace halfspace::c

#endif  // HALFSPACE_C_FILES_H_
