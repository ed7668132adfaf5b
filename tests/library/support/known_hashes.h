// Constants that stand for many answers: the same on every target, compiler and
// machine. The other tests compare what runs here with what runs here; only
// constants compare with machines that are elsewhere.
//
// hashes.txt has them, a name and a hash in each line. If answers are meant to
// change, run hash_test with HALFSPACE_UPDATE_HASHES=1 after all other tests
// passed. It writes the new hashes, and those of new names.
// HALFSPACE_TEST_SCALE does not count.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_KNOWN_HASHES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_KNOWN_HASHES_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <ios>
#include <map>
#include <string>

namespace halfspace::testing {

inline ::testing::AssertionResult IsKnown(const std::string& name,
                                          std::uint64_t hash) {
  static std::map<std::string, std::uint64_t> known = [] {
    std::map<std::string, std::uint64_t> read;
    std::ifstream file(HALFSPACE_TEST_HASHES);
    std::string its_name;
    std::uint64_t its_hash;
    while (file >> its_name >> std::hex >> its_hash) read[its_name] = its_hash;
    return read;
  }();
  const auto it = known.find(name);
  if (it != known.end() && it->second == hash) {
    return ::testing::AssertionSuccess();
  }
  if (std::getenv("HALFSPACE_UPDATE_HASHES") != nullptr) {
    known[name] = hash;
    std::ofstream file(HALFSPACE_TEST_HASHES);
    for (const auto& [its_name, its_hash] : known) {
      file << its_name << ' ' << std::hex << its_hash << '\n';
    }
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure()
         << "the hash of " << name << " is " << std::hex << hash;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_KNOWN_HASHES_H_
