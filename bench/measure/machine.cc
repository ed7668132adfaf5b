#include "bench/measure/machine.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include "bench/base/text.h"
#include "halfspace/version.h"
#include "hwy/highway.h"

#if defined(__linux__)
#include <sched.h>
#endif
#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>
#endif

namespace halfspace::bench {
namespace {

// The bytes that the limit on addresses (ulimit -v) leaves this process;
// nothing where there is none.
std::optional<std::size_t> BytesUpToLimit() {
#if defined(__linux__)
  rlimit limit;
  std::size_t pages = 0;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
      !(std::ifstream("/proc/self/statm") >> pages)) {
    return std::nullopt;
  }
  const std::size_t used =
      pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
#else
  return std::nullopt;
#endif
}

// The first value of a key in /proc/cpuinfo; empty where there is none.
std::string CpuInfo(const std::string& key) {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const std::size_t colon = line.find(':');
    // The key ends here: "model" must not match "model name".
    if (colon == std::string::npos ||
        line.find_first_not_of(" \t", key.size()) != colon) {
      continue;
    }
    const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return {};
}

std::string FirstLineOf(const char* path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line, '\0');
  return line.substr(0, line.find('\n'));
}

// On arm64, Linux has numbers of the core and the name of the board.
std::string CpuName() {
  std::string name = CpuInfo("model name");
  if (name.empty() && !CpuInfo("CPU part").empty()) {
    name = "implementer " + CpuInfo("CPU implementer") + ", part " +
           CpuInfo("CPU part");
  }
  const std::string board =
      Printable(FirstLineOf("/sys/firmware/devicetree/base/model"));
  if (name.empty() || board.empty()) {
    return name.empty() && board.empty() ? "unknown" : name + board;
  }
  return name + " (" + board + ")";
}

// x86 has a flag for this. On ARM the firmware names the vendor.
bool IsArmGuest() {
  const std::string vendor = FirstLineOf("/sys/class/dmi/id/sys_vendor");
  return !FirstLineOf("/sys/hypervisor/type").empty() ||
         vendor.find("QEMU") != std::string::npos ||
         vendor.find("Amazon EC2") != std::string::npos ||
         vendor.find("Google") != std::string::npos;
}

bool HasWord(const std::string& text, const std::string& word) {
  std::istringstream words(text);
  std::string each;
  while (words >> each) {
    if (each == word) return true;
  }
  return false;
}

// Linux lists only the extensions that programs may use (XCR0 included).
std::vector<std::string> IsaOf(const std::string& flags) {
  constexpr std::array kInteresting = {
      "sse2",     "ssse3",    "sse4_1",       "sse4_2",      "avx",
      "avx2",     "fma",      "bmi2",         "avx512f",     "avx512dq",
      "avx512bw", "avx512vl", "avx512_vbmi2", "avx512_bf16", "avx512_fp16",
      "aes",      "asimd",    "asimddp",      "sve",         "sve2"};
  std::vector<std::string> isa;
  for (const char* name : kInteresting) {
    if (HasWord(flags, name)) isa.push_back(name);
  }
  return isa;
}

}  // namespace

std::size_t Machine::CacheBytes(int level) const {
  for (const Cache& cache : caches) {
    if (cache.level == level) return cache.bytes;
  }
  // Small enough for any machine of the last ten years.
  constexpr std::array<std::size_t, 3> kGuess = {32 << 10, 256 << 10, 8 << 20};
  return kGuess[static_cast<std::size_t>(std::clamp(level, 1, 3) - 1)];
}

bool Machine::HasCache(int level) const {
  return std::any_of(caches.begin(), caches.end(),
                     [=](const Cache& c) { return c.level == level; });
}

std::size_t Machine::LastLevelBytes() const {
  std::size_t bytes = 0;
  for (const Cache& cache : caches) bytes = std::max(bytes, cache.bytes);
  return bytes == 0 ? CacheBytes(3) : bytes;
}

std::string Machine::Model() const {
  if (vendor.empty() || family.empty()) return cpu;
  return vendor + " family " + family + " model " + model;
}

std::string Machine::CachesText() const {
  std::string text;
  for (const Cache& cache : caches) {
    text += (text.empty() ? "L" : ", L") + std::to_string(cache.level) + " " +
            std::to_string(cache.bytes >> 10) + " KiB";
  }
  return text.empty() ? "caches unknown" : text;
}

int UsableCpus() {
#if defined(__linux__)
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof(set), &set) == 0) return CPU_COUNT(&set);
#endif
  return static_cast<int>(std::thread::hardware_concurrency());
}

std::size_t FreeMemory() {
  std::size_t bytes = 0;
  std::ifstream file("/proc/meminfo");
  std::string key;
  std::size_t kibibytes = 0;
  std::string unit;
  while (bytes == 0 && file >> key >> kibibytes) {
    std::getline(file, unit);
    if (key == "MemAvailable:") bytes = kibibytes * 1024;
  }
  if (const std::optional<std::size_t> limit = BytesUpToLimit()) {
    bytes =
        std::max<std::size_t>(1, bytes == 0 ? *limit : std::min(bytes, *limit));
  }
  return bytes;
}

Machine DescribeMachine() {
  Machine machine;
#if defined(__unix__) || defined(__APPLE__)
  utsname name;
  if (uname(&name) == 0) {
    machine.architecture = name.machine;
    machine.system = std::string(name.sysname) + " " + name.release;
  }
#endif
  machine.cpu = CpuName();
  machine.vendor = CpuInfo("vendor_id");
  machine.family = CpuInfo("cpu family");
  machine.model = CpuInfo("model");
  const std::string flags = CpuInfo("flags") + " " + CpuInfo("Features");
  machine.isa = IsaOf(flags);
  machine.is_virtual = HasWord(flags, "hypervisor") || IsArmGuest();
#if defined(__aarch64__) && defined(__linux__)
  // Linux on arm64 does not write this key. So the program runs under an
  // emulator, and reads the file of the host.
  machine.is_emulated = !CpuInfo("vendor_id").empty();
#endif
  machine.cores = static_cast<int>(std::thread::hardware_concurrency());
  machine.available_memory = FreeMemory();
  for (const auto& cache : benchmark::CPUInfo::Get().caches) {
    if (cache.type == "Instruction" || cache.size <= 0) continue;
    machine.caches.push_back(
        {cache.level, static_cast<std::size_t>(cache.size), cache.num_sharing});
  }
  std::sort(machine.caches.begin(), machine.caches.end(),
            [](const Cache& a, const Cache& b) { return a.level < b.level; });
  return machine;
}

Build DescribeBuild() {
  Build build;
  build.version = HALFSPACE_VERSION_STRING;
  build.compiler = HALFSPACE_BENCH_COMPILER;
  build.flags = HALFSPACE_BENCH_FLAGS;
#if defined(NDEBUG)
  build.type = "release";
#else
  build.type = "debug";
#endif
  build.highway = std::to_string(HWY_MAJOR) + "." + std::to_string(HWY_MINOR) +
                  "." + std::to_string(HWY_PATCH);
  return build;
}

}  // namespace halfspace::bench
