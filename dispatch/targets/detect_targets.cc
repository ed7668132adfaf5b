#include "dispatch/targets/detect_targets.h"

#if HWY_ARCH_X86 && __has_include(<cpuid.h>)
#include <cpuid.h>
#elif HWY_ARCH_X86
#include <intrin.h>
#elif HWY_ARCH_ARM_A64 && defined(__linux__)
#include <sys/auxv.h>
#include <sys/prctl.h>
#endif

namespace halfspace::dispatch {
namespace {

#if HWY_ARCH_X86

struct Registers {
  std::uint32_t eax = 0;
  std::uint32_t ebx = 0;
  std::uint32_t ecx = 0;
  std::uint32_t edx = 0;
};

#if __has_include(<cpuid.h>)

// Not __get_cpuid_count, which reads the highest leaf each time: in a virtual
// machine every CPUID takes microseconds.
Registers Cpuid(std::uint32_t leaf, std::uint32_t subleaf = 0) {
  Registers result;
  __cpuid_count(leaf, subleaf, result.eax, result.ebx, result.ecx, result.edx);
  return result;
}

std::uint32_t Xcr0() {
  std::uint32_t lower_half;
  std::uint32_t upper_half;
  asm volatile("xgetbv" : "=a"(lower_half), "=d"(upper_half) : "c"(0));
  return lower_half;
}

#else  // MSVC

Registers Cpuid(std::uint32_t leaf, std::uint32_t subleaf = 0) {
  int of[4];
  __cpuidex(of, static_cast<int>(leaf), static_cast<int>(subleaf));
  return {static_cast<std::uint32_t>(of[0]), static_cast<std::uint32_t>(of[1]),
          static_cast<std::uint32_t>(of[2]), static_cast<std::uint32_t>(of[3])};
}

std::uint32_t Xcr0() { return static_cast<std::uint32_t>(_xgetbv(0)); }

#endif

// "AuthenticAMD"
bool IsAmd(const Registers& leaf0) {
  return leaf0.ebx == 0x68747541 && leaf0.edx == 0x69746e65 &&
         leaf0.ecx == 0x444d4163;
}

// "GenuineIntel"
bool IsIntel(const Registers& leaf0) {
  return leaf0.ebx == 0x756e6547 && leaf0.edx == 0x49656e69 &&
         leaf0.ecx == 0x6c65746e;
}

X86Machine ReadMachine() {
  const Registers leaf0 = Cpuid(0);  // in eax the highest leaf
  const Registers leaf1 = Cpuid(1);
  const Registers leaf7 = leaf0.eax >= 7 ? Cpuid(7) : Registers();
  const Registers leaf7_1 = leaf7.eax >= 1 ? Cpuid(7, 1) : Registers();
  X86Machine machine;
  machine.leaf1_eax = leaf1.eax;
  machine.leaf1_ecx = leaf1.ecx;
  machine.leaf1_edx = leaf1.edx;
  machine.leaf7_ebx = leaf7.ebx;
  machine.leaf7_ecx = leaf7.ecx;
  machine.leaf7_edx = leaf7.edx;
  machine.leaf7_1_eax = leaf7_1.eax;
  machine.leaf7_1_edx = leaf7_1.edx;
  if (leaf0.eax >= 0x24) machine.leaf24h_ebx = Cpuid(0x24).ebx;
  machine.extended1_ecx = Cpuid(0x80000001).ecx;
  // OSXSAVE: xgetbv is allowed
  if (HasBits(machine.leaf1_ecx, {27})) machine.xcr0 = Xcr0();
  machine.is_amd = IsAmd(leaf0);
  machine.is_intel = IsIntel(leaf0);
  return machine;
}

const X86Machine& ThisMachine() {
  static const X86Machine machine = ReadMachine();
  return machine;
}

std::int64_t AskMachine() { return TargetsOf(ThisMachine()); }

#elif HWY_ARCH_ARM_A64 && defined(__linux__)

std::int64_t AskMachine() {
  // Negative on a machine without SVE.
  const int length = prctl(PR_SVE_GET_VL, 0, 0, 0, 0);
  return TargetsOf(Aarch64Machine{
      .hwcap = getauxval(AT_HWCAP),
      .hwcap2 = getauxval(AT_HWCAP2),
      .sve_bytes = length < 0 ? 0 : length & PR_SVE_VL_LEN_MASK,
  });
}

#else

std::int64_t AskMachine() { return 0; }

#endif

}  // namespace

std::int64_t DetectTargets() {
  return (AskMachine() | HWY_ENABLED_BASELINE | HWY_SCALAR | HWY_EMU128) &
         HWY_TARGETS;
}

bool IsStreamingFaster() {
#if HWY_ARCH_X86
  static const bool pays = IsStreamingFasterOn(ThisMachine());
  return pays;
#else
  return true;
#endif
}

bool DetectWideVectorsPay() {
#if HWY_ARCH_X86
  return WideVectorsPayOn(ThisMachine());
#else
  return false;
#endif
}

}  // namespace halfspace::dispatch
