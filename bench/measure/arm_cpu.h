// What an ARM CPU is, from the numbers that Linux gives instead of names.
#ifndef HALFSPACE_BENCH_MEASURE_ARM_CPU_H_
#define HALFSPACE_BENCH_MEASURE_ARM_CPU_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace halfspace::bench {

// The main ID registers of the CPUs in the text of /proc/cpuinfo; of what has
// no "CPU implementer" none.
std::vector<std::uint32_t> MidrsOf(std::string_view cpuinfo);

// Each core's name once, in order, with how many there are: "4 x Cortex-A55,
// 2 x Cortex-A76". One that is not known is "implementer 0x41, part 0xfff".
// Empty of none.
std::string ArmCoreNames(const std::vector<std::uint32_t>& midrs);

// Those that matter to vectors, of the bits that the kernel gives a program
// (AT_HWCAP, AT_HWCAP2), with its names of them; "sve(256)" tells the bits of a
// vector, of which 0 is unknown.
std::vector<std::string> ArmExtensions(std::uint64_t hwcap,
                                       std::uint64_t hwcap2, int sve_bits);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_ARM_CPU_H_
