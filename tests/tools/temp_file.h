// A file for as long as a test needs it.
#ifndef HALFSPACE_TESTS_TOOLS_TEMP_FILE_H_
#define HALFSPACE_TESTS_TOOLS_TEMP_FILE_H_

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

namespace halfspace::bench {

class TempFile {
 public:
  // Tests run in several processes at once, so the name is random.
  explicit TempFile(std::string_view content)
      : path_(testing::TempDir() + "halfspace-" +
              std::to_string(std::random_device()()) + "-" +
              std::to_string(std::random_device()())) {
    std::ofstream file(path_, std::ios::binary);
    file << content;
    file.close();
    if (!file) ADD_FAILURE() << "cannot write " << path_;
  }
  ~TempFile() { std::remove(path_.c_str()); }

  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_TESTS_TOOLS_TEMP_FILE_H_
