// The program of the README.
#include <halfspace/halfspace.h>

#include <cstdio>

int main() {
  const halfspace::Sphere3 balls[] = {{{0, 0, 0}, 1}, {{9, 0, 0}, 1}};
  halfspace::AaboBroadPhase3 bodies;  // bounds are 8-DOPs
  for (std::uint32_t id = 0; id < 2; ++id)
    bodies.Insert(id, halfspace::BoundSphere(balls[id]));
  bodies.Move(1, halfspace::BoundSphere(halfspace::Sphere3{{1, 1, 0}, 1}));
  bodies.Update();
  bodies.UpdatePairs();
  for (const auto& [a, b] : bodies.began())
    std::printf("bodies %u and %u may touch\n", a, b);
}
