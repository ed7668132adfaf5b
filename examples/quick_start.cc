// The program of the README.
#include <halfspace/halfspace.h>

#include <cstdio>

int main() {
  using halfspace::BoundSphere, halfspace::Sphere3;
  halfspace::AaboBroadPhase3 bodies;  // 8-DOPs; AabbBroadPhase3: boxes
  bodies.Insert(0, BoundSphere(Sphere3{{0, 0, 0}, 1}));
  bodies.Insert(1, BoundSphere(Sphere3{{9, 0, 0}, 1}));
  bodies.Move(1, BoundSphere(Sphere3{{1, 1, 0}, 1}));
  bodies.Update();
  bodies.UpdatePairs();
  for (const auto& [a, b] : bodies.began())
    std::printf("bodies %u and %u may touch\n", a, b);
  std::uint32_t ids[2];
  if (Survivors(bodies, Sphere3{{3, 1, 0}, 1.5f}, ids) == 1)
    std::printf("body %u is near\n", ids[0]);
}
