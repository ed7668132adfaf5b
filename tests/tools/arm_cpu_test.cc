// Names of ARM CPUs, from what Linux shows on such machines.
#include "bench/measure/arm_cpu.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace halfspace::bench {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kBigLittle =
    "processor\t: 0\n"
    "BogoMIPS\t: 48.00\n"
    "Features\t: fp asimd evtstrm aes\n"
    "CPU implementer\t: 0x41\n"
    "CPU architecture: 8\n"
    "CPU variant\t: 0x2\n"
    "CPU part\t: 0xd05\n"
    "CPU revision\t: 0\n"
    "\n"
    "processor\t: 1\n"
    "CPU implementer\t: 0x41\n"
    "CPU part\t: 0xd0b\n"
    "\n"
    "processor\t: 2\n"
    "CPU implementer\t: 0x41\n"
    "CPU part\t: 0xd05\n";

TEST(ArmCpu, ReadsEveryCoreOfCpuInfo) {
  EXPECT_EQ(MidrsOf(kBigLittle),
            (std::vector<std::uint32_t>{0x4100d050, 0x4100d0b0, 0x4100d050}));
  EXPECT_EQ(ArmCoreNames(MidrsOf(kBigLittle)),
            "2 x Cortex-A55, 1 x Cortex-A76");
}

TEST(ArmCpu, FindsNoCoreElsewhere) {
  EXPECT_TRUE(MidrsOf("").empty());
  EXPECT_TRUE(MidrsOf("vendor_id\t: GenuineIntel\nmodel name\t: Xeon").empty());
  EXPECT_TRUE(MidrsOf("CPU implementer\t: 0x41\nCPU part\t:").empty());
  EXPECT_TRUE(MidrsOf("CPU part\t: 0xd05\n").empty());
  EXPECT_TRUE(MidrsOf("CPU implementer\t: 0xg\nCPU part\t: 0xd05\n").empty());
  EXPECT_EQ(ArmCoreNames({}), "");
}

// Registers as midr_el1 shows them, with variant, architecture and revision.
TEST(ArmCpu, NamesCores) {
  EXPECT_EQ(ArmCoreNames({0x413fd0c1}), "1 x Neoverse-N1");
  EXPECT_EQ(ArmCoreNames({0x410fd4f1}), "1 x Neoverse-V2");
  EXPECT_EQ(ArmCoreNames({0x414fd0b1, 0x414fd0b1}), "2 x Cortex-A76");
  EXPECT_EQ(ArmCoreNames({0x461f0010}), "1 x A64FX");
  EXPECT_EQ(ArmCoreNames({0x481fd010}), "1 x TaiShan-v110");
  EXPECT_EQ(ArmCoreNames({0x4e0f0040}), "1 x Carmel");
  EXPECT_EQ(ArmCoreNames({0x512f0010}), "1 x Oryon");
  EXPECT_EQ(ArmCoreNames({0x611f0221, 0x611f0231}),
            "1 x Apple-M1-Icestorm, 1 x Apple-M1-Firestorm");
  EXPECT_EQ(ArmCoreNames({0xc00fac30}), "1 x Ampere-1");
  // The same part of another maker is another core.
  EXPECT_EQ(ArmCoreNames({0x420fd0c0}), "1 x implementer 0x42, part 0xd0c");
}

TEST(ArmCpu, NamesExtensions) {
  EXPECT_EQ(ArmExtensions(0, 0, 0), Names{});
  // A Cortex-A72 without cryptography, as on a Raspberry Pi 4.
  EXPECT_EQ(ArmExtensions(0x887, 0, 0), Names{"asimd"});
  EXPECT_EQ(ArmExtensions(1ull << 1 | 1ull << 20 | 1ull << 22,
                          1ull << 1 | 1ull << 14 | 1ull << 37, 256),
            (Names{"asimd", "asimddp", "bf16", "sve(256)", "sve2", "sme2"}));
  EXPECT_EQ(ArmExtensions(1ull << 22, 0, 0), Names{"sve"});
}

}  // namespace
}  // namespace halfspace::bench
