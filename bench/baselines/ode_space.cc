#include <ode/ode.h>

#include "bench/baselines/body_space.h"

namespace halfspace::bench {
namespace {

// A class of geoms that have a box and no shape. ODE's own boxes are made of a
// centre and sides, and so rounded.
int BoxClass() {
  static const int number = [] {
    dInitODE2(0);
    dGeomClass box{};
    box.bytes = sizeof(const Aabb3*);
    box.collider = [](int) -> dColliderFn* { return nullptr; };
    box.aabb = [](dGeomID geom, dReal aabb[6]) {
      const Aabb3& of = **static_cast<const Aabb3**>(dGeomGetClassData(geom));
      for (std::size_t k = 0; k < 3; ++k) {
        aabb[2 * k] = of.min[k];
        aabb[2 * k + 1] = of.max[k];
      }
    };
    return dCreateGeomClass(&box);
  }();
  return number;
}

dGeomID MakeGeom(const Aabb3& box, std::uint32_t id) {
  const dGeomID geom = dCreateGeom(BoxClass());
  *static_cast<const Aabb3**>(dGeomGetClassData(geom)) = &box;
  dGeomSetData(geom, DataOf(id));
  return geom;
}

std::uint32_t IdOf(dGeomID geom) { return IdOfData(dGeomGetData(geom)); }

dSpaceID MakeSpace(OdeSpace kind, std::size_t bodies, const Aabb3& world) {
  if (kind == OdeSpace::kHash) return dHashSpaceCreate(nullptr);
  if (kind == OdeSpace::kSweepAndPrune) {
    return dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
  }
  dVector3 center = {};
  dVector3 extents = {};
  for (std::size_t k = 0; k < 3; ++k) {
    center[k] = 0.5 * (world.min[k] + world.max[k]);
    extents[k] = world.max[k] - world.min[k];
  }
  // About four bodies in a leaf.
  const double depth = std::log2(static_cast<double>(bodies)) / 2 - 1;
  return dQuadTreeSpaceCreate(nullptr, center, extents,
                              std::max(1, static_cast<int>(depth)));
}

class Ode : public BodySpace<3> {
 public:
  Ode(OdeSpace kind, std::size_t bodies, const Aabb3& world)
      : BodySpace(bodies),
        kind_(kind),
        geoms_(bodies),
        query_box_(),
        query_(MakeGeom(query_box_, 0)),
        space_(MakeSpace(kind, bodies, world)) {}
  ~Ode() override {
    dGeomDestroy(query_);
    dSpaceDestroy(space_);  // and its geoms
  }

  void Insert(Ids ids, Boxes boxes) override {
    Store(ids, boxes, [&](std::uint32_t id, const Box& box) {
      boxes_[id] = box;
      geoms_[id] = MakeGeom(boxes_[id], id);
      dSpaceAdd(space_, geoms_[id]);
    });
  }
  void Step(Ids ids, Boxes boxes) override {
    Store(ids, boxes,
          [&](std::uint32_t id, const Box& box) { SetMoved(geoms_[id], box); });
  }

  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    PairsAmong(ids, found, [&](auto function) { ForEachPair(function); });
  }
  std::size_t AllPairs(std::vector<IndexPair>& found) override {
    return AllPairsAmong(found, [&](auto function) { ForEachPair(function); });
  }

  void Find(const BodyQuery<3>& query,
            std::vector<std::uint32_t>& found) const override {
    query_box_ = query.box;
    SetMoved(query_, query_box_);
    struct Data {
      const Ode& space;
      const BodyQuery<3>& query;
      std::vector<std::uint32_t>& found;
    } data{*this, query, found};
    // It goes on after the first.
    dSpaceCollide2(query_, reinterpret_cast<dGeomID>(space_), &data,
                   [](void* context, dGeomID a, dGeomID b) {
                     const Data& to = *static_cast<Data*>(context);
                     if (to.query.is_first && !to.found.empty()) return;
                     const std::uint32_t id =
                         IdOf(a == to.space.query_ ? b : a);
                     if (to.query.Touches(to.space.boxes_[id])) {
                       to.found.push_back(id);
                     }
                   });
  }
  void Cast(const BodyCast<3>& /*cast*/, CastHits& /*hits*/) const override {}
  bool CanFind() const override { return kind_ == OdeSpace::kQuadtree; }
  bool CanCast() const override { return false; }

 private:
  // That it moved is all that its position is for.
  static void SetMoved(dGeomID geom, const Aabb3& box) {
    dGeomSetPosition(geom, box.min[0], box.min[1], box.min[2]);
  }
  template <typename Function>
  void ForEachPair(Function function) {
    dSpaceCollide(space_, &function, [](void* data, dGeomID a, dGeomID b) {
      (*static_cast<Function*>(data))(IdOf(a), IdOf(b));
    });
  }

  OdeSpace kind_;
  std::vector<dGeomID> geoms_;
  mutable Aabb3 query_box_;
  dGeomID query_;
  dSpaceID space_;
};

}  // namespace

BodySpacePtr<3> MakeOdeSpace(OdeSpace kind, std::size_t bodies,
                             const Aabb3& world) {
  return std::make_unique<Ode>(kind, bodies, world);
}

}  // namespace halfspace::bench
