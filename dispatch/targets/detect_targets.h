// Which of Highway's targets a machine runs. The library uses only Highway's
// headers, so it queries CPU and operating system itself.
//
// The conditions are those of Highway's SupportedTargets(). Where its releases
// differ, the strictest one counts. (1.0.3 does not ask for AVX512CD, GFNI and
// SVE2_128's I8MM and BF16, and trusts an operating system without XSAVE.) SSE4
// needs POPCNT, too: compilers use it where a target has SSE4.2. It needs
// neither AES nor PCLMULQDQ, which no kernel uses: kernels are compiled with
// HWY_DISABLE_PCLMUL_AES, as virtual machines and a few CPUs with AVX2 lack
// them. The conditions are separate from the queries of the machine, so that a
// test can describe other machines.
#ifndef HALFSPACE_DISPATCH_TARGETS_DETECT_TARGETS_H_
#define HALFSPACE_DISPATCH_TARGETS_DETECT_TARGETS_H_

#include <cstdint>
#include <initializer_list>

#include "hwy/detect_targets.h"

namespace halfspace::dispatch {

// Registers of CPUID, by leaf and subleaf. A leaf that the CPU does not have is
// 0.
struct X86Machine {
  std::uint32_t leaf1_eax = 0;
  std::uint32_t leaf1_ecx = 0;
  std::uint32_t leaf1_edx = 0;
  std::uint32_t leaf7_ebx = 0;
  std::uint32_t leaf7_ecx = 0;
  std::uint32_t leaf7_edx = 0;
  std::uint32_t leaf7_1_eax = 0;
  std::uint32_t leaf7_1_edx = 0;
  std::uint32_t leaf24h_ebx = 0;
  std::uint32_t extended1_ecx = 0;
  // The registers that the operating system saves for each thread.
  std::uint32_t xcr0 = 0;
  bool is_amd = false;
  bool is_intel = false;
};

// Linux's capabilities of the CPU, and the length of an SVE vector.
struct Aarch64Machine {
  std::uint64_t hwcap = 0;
  std::uint64_t hwcap2 = 0;
  int sve_bytes = 0;
};

constexpr bool HasBits(std::uint64_t word, std::initializer_list<int> bits) {
  for (int bit : bits) {
    if ((word >> bit & 1) == 0) return false;
  }
  return true;
}

// Each target needs what those before it need.
constexpr std::int64_t TargetsOf(const X86Machine& machine) {
  std::int64_t targets = 0;
  // SSE, SSE2
  if (!HasBits(machine.leaf1_edx, {25, 26})) return targets;
#ifdef HWY_SSE2
  targets |= HWY_SSE2;
#endif
  // SSE3, SSSE3
  if (!HasBits(machine.leaf1_ecx, {0, 9})) return targets;
  targets |= HWY_SSSE3;
  // SSE4.1, SSE4.2, POPCNT
  if (!HasBits(machine.leaf1_ecx, {19, 20, 23})) return targets;
  targets |= HWY_SSE4;
  // FMA, XSAVE, OSXSAVE, AVX, F16C; BMI, AVX2, BMI2; LZCNT; XMM, YMM
  if (!HasBits(machine.leaf1_ecx, {12, 26, 27, 28, 29}) ||
      !HasBits(machine.leaf7_ebx, {3, 5, 8}) ||
      !HasBits(machine.extended1_ecx, {5}) || !HasBits(machine.xcr0, {1, 2})) {
    return targets;
  }
  targets |= HWY_AVX2;
  // AVX512F, DQ, CD, BW, VL; masks, upper halves of ZMM0-15, ZMM16-31
  if (!HasBits(machine.leaf7_ebx, {16, 17, 28, 30, 31}) ||
      !HasBits(machine.xcr0, {5, 6, 7})) {
    return targets;
  }
  targets |= HWY_AVX3;
  // VBMI, VBMI2, GFNI, VAES, VPCLMULQDQ, VNNI, BITALG, VPOPCNTDQ
  if (!HasBits(machine.leaf7_ecx, {1, 6, 8, 9, 10, 11, 12, 14})) return targets;
  targets |= HWY_AVX3_DL;
  // AVX512_BF16
  if (!HasBits(machine.leaf7_1_eax, {5})) return targets;
#ifdef HWY_AVX3_ZEN4
  if (machine.is_amd) targets |= HWY_AVX3_ZEN4;
#endif
  // AVX512_FP16
  if (!HasBits(machine.leaf7_edx, {23})) return targets;
#ifdef HWY_AVX3_SPR
  targets |= HWY_AVX3_SPR;
#endif
  // AVX10, APX; version 2, with 512 bits
  if (!HasBits(machine.leaf7_1_edx, {19, 21}) ||
      (machine.leaf24h_ebx & 0xff) < 2 || !HasBits(machine.leaf24h_ebx, {18})) {
    return targets;
  }
#ifdef HWY_AVX10_2
  targets |= HWY_AVX10_2;
#endif
  return targets;
}

constexpr std::int64_t TargetsOf(const Aarch64Machine& machine) {
  std::int64_t targets = 0;
#ifdef HWY_NEON_WITHOUT_AES
  targets |= HWY_NEON_WITHOUT_AES;
#endif
  // AES
  if (HasBits(machine.hwcap, {3})) {
    targets |= HWY_NEON;
#ifdef HWY_NEON_BF16
    // ASIMDHP, ASIMDDP; BF16
    if (HasBits(machine.hwcap, {10, 20}) && HasBits(machine.hwcap2, {14})) {
      targets |= HWY_NEON_BF16;
    }
#endif
  }
  // SVE
  if (HasBits(machine.hwcap, {22})) {
    targets |= HWY_SVE;
    if (machine.sve_bytes == 32) targets |= HWY_SVE_256;
  }
  // SVE2, SVEAES
  if (HasBits(machine.hwcap2, {1, 2})) {
    targets |= HWY_SVE2;
    // SVEI8MM, SVEBF16
    if (machine.sve_bytes == 16 && HasBits(machine.hwcap2, {9, 12})) {
      targets |= HWY_SVE2_128;
    }
  }
  return targets;
}

// The targets of this build that this machine runs. On x86 and on aarch64 Linux
// these are the targets above. Everywhere they include the plain fall-back, and
// the targets that the compiler was told to use without a check.
std::int64_t DetectTargets();

// The family of a CPU, by leaf 1.
constexpr std::uint32_t FamilyOf(const X86Machine& machine) {
  const std::uint32_t family = machine.leaf1_eax >> 8 & 0xf;
  return family < 0xf ? family : family + (machine.leaf1_eax >> 20 & 0xff);
}

// Returns whether a machine scans planes out of the caches faster if a kernel
// streams them, two at a time. On x86 only AMD's Zen 4 does: family 19h, and
// AVX-512, which a Zen 3 of the same family lacks. Streaming takes this many
// times as long as all planes at once:
//
//   Zen 3 (AVX2)              1.1 to 1.6 in L2 and L3, 1.0 to 1.2 in memory
//   Zen 5 (SSE4 to AVX-512)   1.07 to 1.7 in L2, 0.95 to 1.2 in L3, 1.2 to 2.5
//                             in memory, beside other programs
//   a Xeon of the Sapphire Rapids class
//                             up to 1.26 in L2 (AABB, AVX-512), up to 1.13 in
//                             memory (AABO, SSE4)
constexpr bool IsStreamingFasterOn(const X86Machine& machine) {
  return machine.is_amd && FamilyOf(machine) == 0x19 &&
         (TargetsOf(machine) & HWY_AVX3) != 0;
}

// Returns IsStreamingFasterOn() of this machine, which is detected once.
bool IsStreamingFaster();

// Returns whether one query is tested faster with vectors of 512 bits than with
// 256, if the target has both. On a Xeon (family 6 model 167) all scans took
// 0.66 to 0.84 of the time in L1 and L2, and 0.89 to 1.09 beyond. On a Zen 4
// and a Zen 5 256 bits have the better worst case (docs/performance.md).
// Intel's CPUs before Ice Lake lower their clock for 512 bits.
constexpr bool WideVectorsPayOn(const X86Machine& machine) {
  return machine.is_intel && (TargetsOf(machine) & HWY_AVX3_DL) != 0;
}

// Returns WideVectorsPayOn() of this machine.
bool DetectWideVectorsPay();

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TARGETS_DETECT_TARGETS_H_
