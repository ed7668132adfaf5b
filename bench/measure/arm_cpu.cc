#include "bench/measure/arm_cpu.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

namespace halfspace::bench {
namespace {

struct Core {
  std::uint32_t implementer;
  std::uint32_t part;
  const char* name;
};

// As Linux' cputype.h has them.
constexpr auto kCores = std::to_array<Core>({
    {0x41, 0xd02, "Cortex-A34"},
    {0x41, 0xd03, "Cortex-A53"},
    {0x41, 0xd04, "Cortex-A35"},
    {0x41, 0xd05, "Cortex-A55"},
    {0x41, 0xd06, "Cortex-A65"},
    {0x41, 0xd07, "Cortex-A57"},
    {0x41, 0xd08, "Cortex-A72"},
    {0x41, 0xd09, "Cortex-A73"},
    {0x41, 0xd0a, "Cortex-A75"},
    {0x41, 0xd0b, "Cortex-A76"},
    {0x41, 0xd0c, "Neoverse-N1"},
    {0x41, 0xd0d, "Cortex-A77"},
    {0x41, 0xd0e, "Cortex-A76AE"},
    {0x41, 0xd40, "Neoverse-V1"},
    {0x41, 0xd41, "Cortex-A78"},
    {0x41, 0xd42, "Cortex-A78AE"},
    {0x41, 0xd43, "Cortex-A65AE"},
    {0x41, 0xd44, "Cortex-X1"},
    {0x41, 0xd46, "Cortex-A510"},
    {0x41, 0xd47, "Cortex-A710"},
    {0x41, 0xd48, "Cortex-X2"},
    {0x41, 0xd49, "Neoverse-N2"},
    {0x41, 0xd4a, "Neoverse-E1"},
    {0x41, 0xd4b, "Cortex-A78C"},
    {0x41, 0xd4c, "Cortex-X1C"},
    {0x41, 0xd4d, "Cortex-A715"},
    {0x41, 0xd4e, "Cortex-X3"},
    {0x41, 0xd4f, "Neoverse-V2"},
    {0x41, 0xd80, "Cortex-A520"},
    {0x41, 0xd81, "Cortex-A720"},
    {0x41, 0xd82, "Cortex-X4"},
    {0x41, 0xd83, "Neoverse-V3AE"},
    {0x41, 0xd84, "Neoverse-V3"},
    {0x41, 0xd85, "Cortex-X925"},
    {0x41, 0xd87, "Cortex-A725"},
    {0x41, 0xd8e, "Neoverse-N3"},
    {0x42, 0x516, "ThunderX2"},
    {0x43, 0x0a1, "ThunderX"},
    {0x43, 0x0af, "ThunderX2"},
    {0x46, 0x001, "A64FX"},
    {0x48, 0xd01, "TaiShan-v110"},
    {0x48, 0xd02, "TaiShan-v120"},
    {0x4e, 0x000, "Denver"},
    {0x4e, 0x003, "Denver-2"},
    {0x4e, 0x004, "Carmel"},
    {0x51, 0x001, "Oryon"},
    {0x51, 0x800, "Kryo-2xx-Gold"},
    {0x51, 0x801, "Kryo-2xx-Silver"},
    {0x51, 0x802, "Kryo-3xx-Gold"},
    {0x51, 0x803, "Kryo-3xx-Silver"},
    {0x51, 0x804, "Kryo-4xx-Gold"},
    {0x51, 0x805, "Kryo-4xx-Silver"},
    {0x61, 0x022, "Apple-M1-Icestorm"},
    {0x61, 0x023, "Apple-M1-Firestorm"},
    {0x61, 0x024, "Apple-M1-Pro-Icestorm"},
    {0x61, 0x025, "Apple-M1-Pro-Firestorm"},
    {0x61, 0x028, "Apple-M1-Max-Icestorm"},
    {0x61, 0x029, "Apple-M1-Max-Firestorm"},
    {0x61, 0x032, "Apple-M2-Blizzard"},
    {0x61, 0x033, "Apple-M2-Avalanche"},
    {0x61, 0x034, "Apple-M2-Pro-Blizzard"},
    {0x61, 0x035, "Apple-M2-Pro-Avalanche"},
    {0x61, 0x038, "Apple-M2-Max-Blizzard"},
    {0x61, 0x039, "Apple-M2-Max-Avalanche"},
    {0xc0, 0xac3, "Ampere-1"},
    {0xc0, 0xac4, "Ampere-1a"},
    {0xc0, 0xac5, "Ampere-1b"},
});

// As the kernel's asm/hwcap.h has them.
struct Extension {
  int word;
  int bit;
  const char* name;
};
constexpr auto kExtensions = std::to_array<Extension>({
    {1, 1, "asimd"},    {1, 3, "aes"},       {1, 8, "atomics"},
    {1, 9, "fphp"},     {1, 10, "asimdhp"},  {1, 12, "asimdrdm"},
    {1, 14, "fcma"},    {1, 20, "asimddp"},  {1, 23, "asimdfhm"},
    {2, 13, "i8mm"},    {2, 14, "bf16"},     {1, 22, "sve"},
    {2, 1, "sve2"},     {2, 36, "sve2p1"},   {2, 4, "svebitperm"},
    {2, 9, "svei8mm"},  {2, 10, "svef32mm"}, {2, 11, "svef64mm"},
    {2, 12, "svebf16"}, {2, 23, "sme"},      {2, 37, "sme2"},
});

std::uint32_t ImplementerOf(std::uint32_t midr) { return midr >> 24; }
std::uint32_t PartOf(std::uint32_t midr) { return midr >> 4 & 0xFFF; }

std::string CoreName(std::uint32_t midr) {
  for (const Core& core : kCores) {
    if (core.implementer == ImplementerOf(midr) && core.part == PartOf(midr)) {
      return core.name;
    }
  }
  std::ostringstream text;
  text << std::hex << "implementer 0x" << ImplementerOf(midr) << ", part 0x"
       << PartOf(midr);
  return text.str();
}

// The number after the colon of "key : 0x41"; nothing if the line has another
// key.
std::optional<std::uint32_t> ValueOf(std::string_view line,
                                     std::string_view key) {
  if (!line.starts_with(key)) return std::nullopt;
  const std::size_t prefix = line.find("0x");
  if (prefix == std::string_view::npos) return std::nullopt;
  const std::string_view digits = line.substr(prefix + 2);
  std::uint32_t value = 0;
  const auto [stop, error] = std::from_chars(
      digits.data(), digits.data() + digits.size(), value, /*base=*/16);
  if (error != std::errc()) return std::nullopt;
  return value;
}

}  // namespace

std::vector<std::uint32_t> MidrsOf(std::string_view cpuinfo) {
  std::vector<std::uint32_t> midrs;
  std::uint32_t implementer = 0;  // none
  while (!cpuinfo.empty()) {
    const std::string_view line = cpuinfo.substr(0, cpuinfo.find('\n'));
    cpuinfo.remove_prefix(std::min(line.size() + 1, cpuinfo.size()));
    if (const auto value = ValueOf(line, "CPU implementer")) {
      implementer = *value;
    }
    if (const auto part = ValueOf(line, "CPU part"); part && implementer != 0) {
      midrs.push_back((implementer & 0xFF) << 24 | (*part & 0xFFF) << 4);
      implementer = 0;
    }
  }
  return midrs;
}

std::string ArmCoreNames(const std::vector<std::uint32_t>& midrs) {
  std::vector<std::pair<std::string, int>> counts;
  for (const std::uint32_t midr : midrs) {
    const std::string name = CoreName(midr);
    auto known = std::find_if(counts.begin(), counts.end(),
                              [&](const auto& c) { return c.first == name; });
    if (known == counts.end()) known = counts.insert(known, {name, 0});
    ++known->second;
  }
  std::string text;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " x " + name;
  }
  return text;
}

std::vector<std::string> ArmExtensions(std::uint64_t hwcap,
                                       std::uint64_t hwcap2, int sve_bits) {
  std::vector<std::string> names;
  for (const Extension& extension : kExtensions) {
    const std::uint64_t word = extension.word == 1 ? hwcap : hwcap2;
    if ((word >> extension.bit & 1) == 0) continue;
    names.emplace_back(extension.name);
    if (names.back() == "sve" && sve_bits > 0) {
      names.back() += "(" + std::to_string(sve_bits) + ")";
    }
  }
  return names;
}

}  // namespace halfspace::bench
