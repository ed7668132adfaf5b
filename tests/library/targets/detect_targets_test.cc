// Detection: against Highway's own on this machine, and what each missing
// feature takes away on others.
#include "dispatch/targets/detect_targets.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <ios>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/targets.h"
#include "hwy/highway.h"
#include "hwy/targets.h"

// Targets that not every release of Highway has.
#ifndef HWY_SSE2
#define HWY_SSE2 0
#endif
#ifndef HWY_AVX3_ZEN4
#define HWY_AVX3_ZEN4 0
#endif
#ifndef HWY_AVX3_SPR
#define HWY_AVX3_SPR 0
#endif
#ifndef HWY_AVX10_2
#define HWY_AVX10_2 0
#endif
#ifndef HWY_NEON_WITHOUT_AES
#define HWY_NEON_WITHOUT_AES 0
#endif
#ifndef HWY_NEON_BF16
#define HWY_NEON_BF16 0
#endif

namespace halfspace::dispatch {
namespace {

constexpr std::int64_t kX86[] = {HWY_SSE2,      HWY_SSSE3,    HWY_SSE4,
                                 HWY_AVX2,      HWY_AVX3,     HWY_AVX3_DL,
                                 HWY_AVX3_ZEN4, HWY_AVX3_SPR, HWY_AVX10_2};

// The first `count` of them.
constexpr std::int64_t First(std::size_t count) {
  std::int64_t targets = 0;
  for (std::size_t i = 0; i < count; ++i) targets |= kX86[i];
  return targets;
}

using X86Word = std::uint32_t X86Machine::*;

constexpr X86Word kX86Words[] = {
    &X86Machine::leaf1_ecx,     &X86Machine::leaf1_edx,
    &X86Machine::leaf7_ebx,     &X86Machine::leaf7_ecx,
    &X86Machine::leaf7_edx,     &X86Machine::leaf7_1_eax,
    &X86Machine::leaf7_1_edx,   &X86Machine::leaf24h_ebx,
    &X86Machine::extended1_ecx, &X86Machine::xcr0};

X86Machine EveryX86() {
  X86Machine machine;
  for (X86Word word : kX86Words) machine.*word = 0xffffffff;
  machine.leaf24h_ebx = 0xffffff02;
  machine.is_amd = true;
  return machine;
}

// How many of kX86 a machine without this one feature runs.
struct X86Need {
  X86Word word;
  int bit;
  std::size_t left;
};

// By the manuals of Intel and AMD. AES and PCLMULQDQ take nothing away.
constexpr X86Need kX86Needs[] = {
    {&X86Machine::leaf1_edx, 25, 0},     // SSE
    {&X86Machine::leaf1_edx, 26, 0},     // SSE2
    {&X86Machine::leaf1_ecx, 0, 1},      // SSE3
    {&X86Machine::leaf1_ecx, 9, 1},      // SSSE3
    {&X86Machine::leaf1_ecx, 19, 2},     // SSE4.1
    {&X86Machine::leaf1_ecx, 20, 2},     // SSE4.2
    {&X86Machine::leaf1_ecx, 23, 2},     // POPCNT
    {&X86Machine::leaf1_ecx, 12, 3},     // FMA
    {&X86Machine::leaf1_ecx, 26, 3},     // XSAVE
    {&X86Machine::leaf1_ecx, 27, 3},     // OSXSAVE
    {&X86Machine::leaf1_ecx, 28, 3},     // AVX
    {&X86Machine::leaf1_ecx, 29, 3},     // F16C
    {&X86Machine::extended1_ecx, 5, 3},  // LZCNT
    {&X86Machine::leaf7_ebx, 3, 3},      // BMI1
    {&X86Machine::leaf7_ebx, 5, 3},      // AVX2
    {&X86Machine::leaf7_ebx, 8, 3},      // BMI2
    {&X86Machine::xcr0, 1, 3},           // XMM
    {&X86Machine::xcr0, 2, 3},           // upper halves of YMM
    {&X86Machine::leaf7_ebx, 16, 4},     // AVX512F
    {&X86Machine::leaf7_ebx, 17, 4},     // AVX512DQ
    {&X86Machine::leaf7_ebx, 28, 4},     // AVX512CD
    {&X86Machine::leaf7_ebx, 30, 4},     // AVX512BW
    {&X86Machine::leaf7_ebx, 31, 4},     // AVX512VL
    {&X86Machine::xcr0, 5, 4},           // mask registers
    {&X86Machine::xcr0, 6, 4},           // upper halves of ZMM0 to ZMM15
    {&X86Machine::xcr0, 7, 4},           // ZMM16 to ZMM31
    {&X86Machine::leaf7_ecx, 1, 5},      // AVX512_VBMI
    {&X86Machine::leaf7_ecx, 6, 5},      // AVX512_VBMI2
    {&X86Machine::leaf7_ecx, 8, 5},      // GFNI
    {&X86Machine::leaf7_ecx, 9, 5},      // VAES
    {&X86Machine::leaf7_ecx, 10, 5},     // VPCLMULQDQ
    {&X86Machine::leaf7_ecx, 11, 5},     // AVX512_VNNI
    {&X86Machine::leaf7_ecx, 12, 5},     // AVX512_BITALG
    {&X86Machine::leaf7_ecx, 14, 5},     // AVX512_VPOPCNTDQ
    {&X86Machine::leaf7_1_eax, 5, 6},    // AVX512_BF16
    {&X86Machine::leaf7_edx, 23, 7},     // AVX512_FP16
    {&X86Machine::leaf7_1_edx, 19, 8},   // AVX10
    {&X86Machine::leaf7_1_edx, 21, 8},   // APX
    {&X86Machine::leaf24h_ebx, 1, 8},    // the 2 of AVX10.2
    {&X86Machine::leaf24h_ebx, 18, 8},   // 512 bits
};

TEST(DetectTargetsTest, EachFeatureOfX86) {
  EXPECT_EQ(TargetsOf(X86Machine()), 0);
  EXPECT_EQ(TargetsOf(EveryX86()), First(9));
  for (X86Word word : kX86Words) {
    for (int bit = 0; bit < 32; ++bit) {
      std::size_t left = 9;
      for (const X86Need& need : kX86Needs) {
        if (need.word == word && need.bit == bit) left = need.left;
      }
      X86Machine machine = EveryX86();
      machine.*word &= ~(std::uint32_t{1} << bit);
      EXPECT_EQ(TargetsOf(machine), First(left))
          << "word " << &(machine.*word) - &machine.leaf1_ecx << " bit " << bit;
    }
  }
}

TEST(DetectTargetsTest, Zen4IsOnlyOfAmd) {
  X86Machine machine = EveryX86();
  machine.is_amd = false;
  EXPECT_EQ(TargetsOf(machine), First(9) & ~HWY_AVX3_ZEN4);
}

// Leaf 1 of CPUs: family 6 of Intel, 17h to 1Ah of AMD.
TEST(DetectTargetsTest, FamilyIsOfBothFields) {
  X86Machine machine;
  machine.leaf1_eax = 0x000806f8;
  EXPECT_EQ(FamilyOf(machine), 0x6u);
  machine.leaf1_eax = 0x00a10f11;
  EXPECT_EQ(FamilyOf(machine), 0x19u);
  machine.leaf1_eax = 0x00b00f21;
  EXPECT_EQ(FamilyOf(machine), 0x1au);
}

TEST(DetectTargetsTest, StreamingIsFasterOnZen4Only) {
  X86Machine zen4 = EveryX86();
  zen4.leaf1_eax = 0x00a10f11;
  EXPECT_TRUE(IsStreamingFasterOn(zen4));
  X86Machine machine = zen4;
  machine.leaf7_ebx &= ~(std::uint32_t{1} << 16);  // AVX512F: Zen 3
  EXPECT_FALSE(IsStreamingFasterOn(machine));
  machine = zen4;
  machine.leaf1_eax = 0x00b00f21;  // Zen 5
  EXPECT_FALSE(IsStreamingFasterOn(machine));
  machine = zen4;
  machine.is_amd = false;
  EXPECT_FALSE(IsStreamingFasterOn(machine));
}

TEST(DetectTargetsTest, WideVectorsPayOnIntelFromIceLakeOn) {
  X86Machine machine = EveryX86();
  machine.is_intel = true;
  EXPECT_TRUE(WideVectorsPayOn(machine));
  machine.leaf7_ecx &= ~(std::uint32_t{1} << 6);  // VBMI2: before Ice Lake
  EXPECT_FALSE(WideVectorsPayOn(machine));
  machine = EveryX86();
  EXPECT_FALSE(WideVectorsPayOn(machine));
  // What calls read.
  ResolveIndex({}, "detect_targets_test");
  EXPECT_EQ(WideVectorsPay(), DetectWideVectorsPay());
}

TEST(DetectTargetsTest, EachFeatureOfAarch64) {
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  const auto without = [](int bit) { return ~(std::uint64_t{1} << bit); };
  constexpr std::int64_t kNeon =
      HWY_NEON_WITHOUT_AES | HWY_NEON | HWY_NEON_BF16;
  constexpr std::int64_t kSve = HWY_SVE | HWY_SVE2;
  struct Case {
    Aarch64Machine machine;
    std::int64_t targets;
  };
  const Case cases[] = {
      {{0, 0, 0}, HWY_NEON_WITHOUT_AES},
      {{kAll, kAll, 64}, kNeon | kSve},
      {{kAll, kAll, 32}, kNeon | kSve | HWY_SVE_256},
      {{kAll, kAll, 16}, kNeon | kSve | HWY_SVE2_128},
      {{kAll, 0, 32}, (kNeon & ~HWY_NEON_BF16) | HWY_SVE | HWY_SVE_256},
      {{kAll, 0, 16}, (kNeon & ~HWY_NEON_BF16) | HWY_SVE},
      // AES, ASIMDHP, ASIMDDP, SVE
      {{without(3), kAll, 16}, HWY_NEON_WITHOUT_AES | kSve | HWY_SVE2_128},
      {{without(10), kAll, 64}, (kNeon & ~HWY_NEON_BF16) | kSve},
      {{without(20), kAll, 64}, (kNeon & ~HWY_NEON_BF16) | kSve},
      {{without(22), 0, 32}, kNeon & ~HWY_NEON_BF16},
      // SVE2, SVEAES, SVEI8MM, SVEBF16, BF16
      {{kAll, without(1), 16}, kNeon | HWY_SVE},
      {{kAll, without(2), 16}, kNeon | HWY_SVE},
      {{kAll, without(9), 16}, kNeon | kSve},
      {{kAll, without(12), 16}, kNeon | kSve},
      {{kAll, without(14), 64}, (kNeon & ~HWY_NEON_BF16) | kSve},
  };
  for (const Case& each : cases) {
    EXPECT_EQ(TargetsOf(each.machine), each.targets)
        << std::hex << each.machine.hwcap << ' ' << each.machine.hwcap2 << ' '
        << each.machine.sve_bytes;
  }
}

// Highway only warns if the CPU lacks what the compiler was told it has. Its
// library asks for AES, which ours does not.
TEST(DetectTargetsTest, ThisMachineAsHighwayDoes) {
  std::int64_t supported = 0;
  for (Target target : SupportedTargets()) supported |= target.highway_bit();
  EXPECT_EQ(supported,
            (hwy::SupportedTargets() | HWY_ENABLED_BASELINE) & HWY_TARGETS);
}

}  // namespace
}  // namespace halfspace::dispatch
