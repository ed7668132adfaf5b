// The machine that a measurement ran on.
#ifndef HALFSPACE_BENCH_MEASURE_MACHINE_H_
#define HALFSPACE_BENCH_MEASURE_MACHINE_H_

#include <cstddef>
#include <string>
#include <vector>

namespace halfspace::bench {

struct Cache {
  int level = 0;
  std::size_t bytes = 0;
  int shared_by = 0;  // logical CPUs
};

struct Machine {
  std::string cpu;
  // On x86, these tell CPUs of the same name apart. Empty if unknown.
  std::string vendor;
  std::string family;
  std::string model;
  std::string architecture;
  std::string system;
  int cores = 0;                 // logical CPUs
  bool is_virtual = false;       // a hypervisor is present
  bool is_emulated = false;      // another architecture's CPU runs this program
  std::vector<Cache> caches;     // data caches, from the first level on
  std::vector<std::string> isa;  // extensions that the system lets us use
  std::size_t available_memory = 0;  // bytes; 0 if unknown

  // Bytes of the data cache of `level`, or a stated guess if unknown.
  std::size_t CacheBytes(int level) const;
  std::size_t LastLevelBytes() const;
  bool HasCache(int level) const;
  // "AuthenticAMD family 26 model 2", or the name of the CPU.
  std::string Model() const;
  // "L1 48 KiB, L2 1024 KiB, L3 32768 KiB"
  std::string CachesText() const;
  bool are_caches_known() const { return !caches.empty(); }
};

Machine DescribeMachine();

// Logical CPUs that this thread may use; 0 if unknown.
int UsableCpus();

// Bytes of memory that this process can still take; 0 if unknown.
std::size_t FreeMemory();

// How this program was built.
struct Build {
  std::string version;
  std::string compiler;
  std::string flags;
  std::string type;  // "release" or "debug": NDEBUG of this program
  std::string highway;
};

Build DescribeBuild();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_MACHINE_H_
