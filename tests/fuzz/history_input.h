// What the histories of BVHs and of broad phases have in common: the bytes of a
// fuzzer choose what they do.
#ifndef HALFSPACE_TESTS_FUZZ_HISTORY_INPUT_H_
#define HALFSPACE_TESTS_FUZZ_HISTORY_INPUT_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/run_input.h"
#include "tests/library/bvh/history.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

// Each plane of a bound is one of four values, so a bound takes a byte or two.
class ByteChoices final : public Choices {
 public:
  using Palettes = std::array<std::array<float, 4>, 8>;

  ByteChoices(const Layout& layout, const Palettes& palettes, Bytes& bytes)
      : layout_(layout), palettes_(palettes), bytes_(bytes) {}

  std::size_t Below(std::size_t end) override { return bytes_.Below(end); }
  Planes Next() override { return Changed(Planes{}, 0); }
  // On some of its planes.
  Planes Moved(const Planes& bound) override {
    return Changed(bound, bytes_.Byte());
  }
  BodyMasks Masks() override {
    const std::uint8_t choice = bytes_.Byte();
    return {choice & 3u, choice >> 2 & 3u};
  }

 private:
  Planes Changed(Planes bound, std::uint32_t kept) {
    std::uint32_t choice = bytes_.Byte();
    for (std::size_t p = 0; p < layout_.plane_count; ++p) {
      if (p == 4) choice = bytes_.Byte();
      if ((kept >> p & 1) == 0) bound[p] = palettes_[p][choice & 3];
      choice >>= 2;
    }
    return bound;
  }

  Layout layout_;
  const Palettes& palettes_;
  Bytes& bytes_;
};

// Questions of any floats, and the bytes of the changes.
class HistoryInput {
 public:
  HistoryInput(std::span<const Layout> layouts, Bytes& bytes)
      : layout_(layouts[bytes.Below(layouts.size())]),
        most_(1 + bytes.Below(900)),
        how_(bytes.Byte()) {
    for (auto& palette : palettes_) bytes.Fill(palette);
    query_.numbers.resize(8);
    for (float& number : query_.numbers) number = bytes.Float();
    bytes.Fill(motion_.place.min);
    bytes.Fill(motion_.place.max);
    bytes.Fill(motion_.direction);
    motion_.max_t = std::abs(bytes.Float());
    if (std::isnan(motion_.max_t)) motion_.max_t = 1;
    rest_.assign(bytes.Rest().begin(), bytes.Rest().end());
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const HistoryInput& input) {
    out << NameOf(input.layout_) << ", " << input.most_ << " objects\n";
    for (std::size_t p = 0; p < input.layout_.plane_count; ++p) {
      out << "plane " << p << ": query "
          << Print(std::array{input.query_.numbers[p]}) << ", of "
          << Print(input.palettes_[p]) << '\n';
    }
    return out << "cast of " << Print(input.motion_.place.min) << " to "
               << Print(input.motion_.place.max) << " by "
               << Print(input.motion_.direction) << " up to "
               << Print(std::array{input.motion_.max_t}) << '\n';
  }

 protected:
  // With these, and with others that a byte chooses.
  void ExpectAnswersOf(const Searches& world, const Objects& objects,
                       Bytes& bytes) const {
    ExpectFinds(world, objects, {&query_, 1}, {.mask = 1});
    const Shape point{
        Shape::kPoint,
        {motion_.place.min.begin(), motion_.place.min.begin() + layout_.dims}};
    ExpectFinds(world, objects, {&point, 1}, {});
    Motion motion = motion_;
    for (Motion::Kind kind : {Motion::kRay, Motion::kBox}) {
      motion.kind = kind;
      motion.place.is_point = kind == Motion::kRay;
      ExpectHits(world, objects, motion, {.mask = 1});
      ExpectNearest(world, objects, motion.place, motion.max_t, {});
    }
    Random random(bytes.Byte());
    ExpectAnswers(world, objects,
                  {.is_special = random() % 2 == 0, .shapes = 1}, random);
  }

  Layout layout_;
  std::size_t most_;
  std::uint8_t how_;
  ByteChoices::Palettes palettes_{};
  Shape query_;
  Motion motion_;
  std::vector<std::uint8_t> rest_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_HISTORY_INPUT_H_
