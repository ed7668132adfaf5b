// What BVHs and broad phases should answer, from a list of their objects.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_ANSWERS_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "tests/library/bvh/any_bvh.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

struct Object {
  Planes bound{};
  std::uint32_t masks = 0xFFFFFFFF;
};
using Objects = std::map<std::uint32_t, Object>;  // by id

inline Objects ObjectsOf(std::span<const Planes> bounds) {
  Objects objects;
  for (const Planes& bound : bounds) {
    objects[static_cast<std::uint32_t>(objects.size())] = {bound};
  }
  return objects;
}

using PairList = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
// As they come.
PairList PairsFrom(Span<const IdPair> pairs);
// Of two lists in order, those of the first that are not in the second.
PairList Difference(const PairList& of, const PairList& without);
// Sorted. Of one world, the lesser id of each pair is first.
PairList InOrder(Span<const IdPair> pairs, bool is_one_world);

// Those that no plane separates.
PairList PairsIn(const Layout& layout, const Objects& objects);

// The objects that the test of a shape keeps, in order. Not for oriented boxes.
Ids KeptBy(const Layout& layout, const Objects& objects, const Shape& shape,
           std::uint32_t mask);

struct HowToAsk {
  std::vector<Target> targets = {Target()};  // each gives the same answers
  std::uint32_t mask = 0xFFFFFFFF;
  bool is_special = false;
  std::size_t shapes = 3;  // of each kind
};

// Every call for the shapes, which are of one kind. It finds those objects that
// the test of each shape keeps.
void ExpectFinds(const Searches& world, const Objects& objects,
                 std::span<const Shape> shapes, const HowToAsk& how);
// Shapes of one kind near the objects of Scenes. With `is_special`, some of
// their numbers are special values.
std::vector<Shape> SomeShapes(const Layout& layout, Shape::Kind kind,
                              std::size_t count, bool is_special,
                              Random& random);
Motion SomeMotion(const Layout& layout, Motion::Kind kind, bool is_special,
                  Random& random);

// Questions of all kinds, which random numbers choose.
void ExpectAnswers(const Searches& world, const Objects& objects,
                   const HowToAsk& how, Random& random);
// What ExpectAnswers() does, and what BVHs alone have: more pairs, the objects'
// bounds, and the bound of all.
void ExpectIsModel(const AnyBvh& world, const Objects& objects,
                   const HowToAsk& how, Random& random);

// Objects of a cube of side 100.
class Spheres {
 public:
  Spheres(const Layout& layout, float radius, std::uint64_t seed = 1)
      : layout_(layout), radius_(radius), random_(seed) {}
  Planes Next(bool is_query = false);
  std::vector<Planes> Some(std::size_t count);
  Shape NextQuery();

 private:
  Layout layout_;
  float radius_;
  Random random_;
};

// Worlds of every kind: usual ones, and degenerate ones.
struct SceneObject {
  std::size_t i;  // its number
  const Layout& layout;
  Spheres& spheres;
  Random& random;
};
struct Scene {
  const char* name;
  bool is_special;  // so that special questions are asked
  Planes (*bound)(const SceneObject& o);
};
std::span<const Scene> Scenes();
std::vector<Planes> ObjectsIn(const Scene& scene, const Layout& layout,
                              std::size_t size, std::uint64_t seed);

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_ANSWERS_H_
