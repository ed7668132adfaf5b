// Draws two broad phases, as docs/broad-phase-2d.svg and broad-phase-3d.svg: in
// 2D the bodies, their bounds, the pairs, a query and a ray cast, in 3D a box
// cast and its hits by t.
//
//   example_broad_phase_svg <folder>
#include <halfspace/broad_phase.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace {

// The same numbers everywhere, from 0 to 1.
class Random {
 public:
  float Next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<float>(state_ >> 40) / 16777216.0f;
  }

 private:
  std::uint64_t state_ = 12;
};

struct Colour {
  const char* name;
  const char* light;
  const char* dark;
};

// A name comes before the names that begin it.
constexpr Colour kColours[] = {
    {"$back", "#fff", "#12161c"},        {"$text", "#222", "#e6e8eb"},
    {"$line", "#8a8f98", "#7d8590"},     {"$body", "#dfe3ea", "#3a424e"},
    {"$side", "#c3c9d3", "#2e353f"},     {"$dark", "#a4abb8", "#232931"},
    {"$pair", "#b3541e", "#f0883e"},     {"$query", "#1f6fb5", "#6cb6ff"},
    {"$found", "#9cc7ee", "#1f4e79"},    {"$cast", "#1b7f4b", "#56d08e"},
    {"$hit-side", "#86cba5", "#1d5c3c"}, {"$hit-dark", "#69b48b", "#15462d"},
    {"$hit", "#a5dfbf", "#27734c"}};

constexpr const char* kRules = R"(text { fill: $text }
.back { fill: $back }
.body { fill: $body; stroke: $line }
.found { fill: $found; stroke: $query }
.hit { fill: $hit; stroke: $cast }
.side { fill: $side } .dark { fill: $dark }
.hit.side { fill: $hit-side } .hit.dark { fill: $hit-dark }
.bound { fill: none; stroke: $line; stroke-width: .8 }
.pair { stroke: $pair; stroke-width: 2.5 }
.query { fill: $query; fill-opacity: .12; stroke: $query; stroke-width: 2 }
.cast { fill: none; stroke: $cast; stroke-width: 2 }
.path { fill: $cast; fill-opacity: .13; stroke: $cast; stroke-dasharray: 5 4 }
.mover, .mover.side, .mover.dark { fill: $cast; fill-opacity: .55; stroke: $cast }
.dot { fill: $cast }
.label { paint-order: stroke; stroke: $back; stroke-width: 3; text-anchor: middle }
)";

// The rules with their colours in place, because some renderers know no CSS
// variables.
std::string Rules(const char* Colour::*scheme) {
  std::string rules = kRules;
  for (const Colour& colour : kColours) {
    const std::string name = colour.name;
    for (std::size_t at = 0;
         (at = rules.find(name, at)) != std::string::npos;) {
      rules.replace(at, name.size(), colour.*scheme);
    }
  }
  return rules;
}

// Collects the elements of a picture.
class Picture {
 public:
  Picture(int width, int height, const std::string& title) {
    text_ =
        "<svg role=\"img\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 "
        "0 " +
        std::to_string(width) + " " + std::to_string(height) +
        "\" font-family=\"sans-serif\" font-size=\"13\">\n<title>" + title +
        "</title>\n<style>\n" + Rules(&Colour::light) +
        "@media (prefers-color-scheme: dark) {\n" + Rules(&Colour::dark) +
        "}\n</style>\n";
    Rect("back",
         {{0, 0}, {static_cast<float>(width), static_cast<float>(height)}});
  }

  void Rect(const char* style, const halfspace::Aabb2& box) {
    Add("<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\""
        " height=\"%.1f\"/>\n",
        style, box.min[0], box.min[1], box.max[0] - box.min[0],
        box.max[1] - box.min[1]);
  }
  void Circle(const char* style, const halfspace::Point2& at, float radius) {
    Add("<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n", style,
        at[0], at[1], radius);
  }
  void Line(const char* style, const halfspace::Point2& a,
            const halfspace::Point2& b) {
    Add("<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\""
        "/>\n",
        style, a[0], a[1], b[0], b[1]);
  }
  void Polygon(const std::string& style,
               const std::vector<halfspace::Point2>& corners) {
    Add("<polygon class=\"%s\" points=\"", style.c_str());
    for (const halfspace::Point2& p : corners) Add("%.1f,%.1f ", p[0], p[1]);
    text_.back() = '"';
    text_ += "/>\n";
  }
  void Text(const char* style, const halfspace::Point2& at,
            const std::string& text) {
    Add("<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", style, at[0], at[1]);
    text_ += text + "</text>\n";
  }

  bool Write(const std::string& path) const {
    std::ofstream file(path, std::ios::binary);
    file << text_ << "</svg>\n";
    if (file.flush()) return true;
    std::fprintf(stderr,
                 "broad_phase_svg: %s cannot be written; name a folder that "
                 "exists\n",
                 path.c_str());
    return false;
  }

 private:
  template <typename... Values>
  void Add(const char* format, Values... values) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, format, values...);
    text_ += buffer;
  }

  std::string text_;
};

struct Hit {
  float t;
  std::uint32_t id;
};

// Hits by t, as no cast sorts them.
void Sort(std::vector<Hit>& hits) {
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    return a.t < b.t || (a.t == b.t && a.id < b.id);
  });
}

halfspace::Point2 Center(const halfspace::Aabb2& box) {
  return {(box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2};
}

bool Draw2D(const std::string& path) {
  constexpr int kColumns = 11;
  constexpr int kRows = 6;

  // Disks and diamonds, in an order by rows.
  struct Body {
    halfspace::Aabb2 bound;
    bool is_disk;
    const char* style = "body";
  };
  std::vector<Body> all;
  Random random;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const float x = 45 + 63 * (static_cast<float>(i % kColumns) +
                               0.7f * random.Next() - 0.35f + 0.25f);
    const float y = 40 + 62 * (static_cast<float>(i / kColumns) +
                               0.7f * random.Next() - 0.35f + 0.25f);
    const float size = 9 + 16 * random.Next();
    const halfspace::Aabb2 bound = {{x - size, y - size}, {x + size, y + size}};
    all.push_back({bound, random.Next() < 0.6f});
  }

  halfspace::AabbBroadPhase2 bodies;
  for (std::uint32_t id = 0; id < all.size(); ++id) {
    bodies.Insert(id, all[id].bound);
  }

  // Each body moves a little.
  for (std::uint32_t id = 0; id < all.size(); ++id) {
    halfspace::Aabb2& bound = all[id].bound;
    for (std::size_t k = 0; k < 2; ++k) {
      const float way = 17 * random.Next() - 8.5f;
      bound.min[k] += way;
      bound.max[k] += way;
    }
    bodies.Move(id, bound);
  }
  bodies.Update();

  const halfspace::Aabb2 query = {{405, 215}, {585, 335}};
  ForEachSurvivor(bodies, query, [&](const auto& ids) {
    for (const std::uint32_t id : ids) all[id].style = "found";
  });
  const halfspace::Ray2 ray = {{12, 345}, {690, -300}, 1};
  std::vector<Hit> hits;
  RayCast(bodies, ray, [&](std::uint32_t id, float t) {
    hits.push_back({t, id});
  });
  Sort(hits);
  for (const Hit& hit : hits) all[hit.id].style = "hit";

  Picture picture(740, 450, "Bodies in 2D, pairs, a query and a ray cast");
  for (const Body& body : all) {
    const halfspace::Aabb2& b = body.bound;
    const halfspace::Point2 center = Center(b);
    picture.Rect("bound", b);
    if (body.is_disk) {
      picture.Circle(body.style, center, center[0] - b.min[0]);
    } else {
      picture.Polygon(body.style, {{center[0], b.min[1]},
                                   {b.max[0], center[1]},
                                   {center[0], b.max[1]},
                                   {b.min[0], center[1]}});
    }
  }
  bodies.UpdatePairs();
  for (const auto& [a, b] : bodies.began()) {
    picture.Line("pair", Center(all[a].bound), Center(all[b].bound));
  }
  picture.Rect("query", query);
  const auto at = [&](float t) {
    return halfspace::Point2{ray.origin[0] + t * ray.direction[0],
                             ray.origin[1] + t * ray.direction[1]};
  };
  picture.Line("cast", ray.origin, at(1));
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const halfspace::Point2 point = at(hits[i].t);
    picture.Circle("dot", point, 3.5f);
    picture.Text("label", {point[0] - 4, point[1] - 7}, std::to_string(i + 1));
  }

  constexpr float kY = 425;
  const auto box = [](float x, float half) {
    return halfspace::Aabb2{{x - half, kY - 5 - half},
                            {x + half, kY - 5 + half}};
  };
  picture.Rect("bound", box(24, 8));
  picture.Circle("body", {24, kY - 5}, 8);
  picture.Text("", {40, kY}, "body and bound");
  picture.Line("pair", {202, kY - 5}, {226, kY - 5});
  picture.Text("", {232, kY}, "pair");
  picture.Rect("query", box(322, 9));
  picture.Circle("found", {346, kY - 5}, 8);
  picture.Text("", {360, kY}, "query, and what it finds");
  picture.Line("cast", {566, kY - 5}, {590, kY - 5});
  picture.Circle("hit", {602, kY - 5}, 8);
  picture.Text("", {615, kY}, "ray, its hits");
  return picture.Write(path);
}

// Looks down along (-1, -1, -1): X goes right and down, Y left and down, Z up.
halfspace::Point2 Project(float x, float y, float z) {
  constexpr float kScale = 34;
  return {405 + kScale * 0.866f * (x - y), 236 + kScale * (0.5f * (x + y) - z)};
}

// The three sides of a box that are seen.
void DrawBox(Picture& picture, const halfspace::Aabb3& box,
             const std::string& style) {
  const auto& [x, y, z] = box.min;
  const auto& [u, v, w] = box.max;
  picture.Polygon(style, {Project(x, y, w), Project(u, y, w), Project(u, v, w),
                          Project(x, v, w)});
  picture.Polygon(style + " side", {Project(x, v, w), Project(u, v, w),
                                    Project(u, v, z), Project(x, v, z)});
  picture.Polygon(style + " dark", {Project(u, y, w), Project(u, v, w),
                                    Project(u, v, z), Project(u, y, z)});
}

bool Draw3D(const std::string& path) {
  constexpr int kSide = 7;

  // Towers on a square, farthest first, so that nearer ones hide them.
  std::vector<halfspace::Aabb3> all;
  Random random;
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto cell = [](int n) {
      return 1.6f * (static_cast<float>(n) - 0.5f * (kSide - 1));
    };
    const float x = cell(i / kSide) + 0.4f * random.Next();
    const float y = cell(i % kSide) + 0.4f * random.Next();
    const float width = 0.5f + 0.5f * random.Next();
    const float height = 0.3f + 1.9f * random.Next() * random.Next();
    all.push_back({{x, y, 0}, {x + width, y + width, height}});
  }
  halfspace::AabbBroadPhase3 bodies;
  std::vector<std::uint32_t> ids(all.size());
  for (std::uint32_t id = 0; id < ids.size(); ++id) ids[id] = id;
  bodies.Insert(ids, all);

  const halfspace::Aabb3 start = {{-7.6f, -1.4f, 0.7f}, {-6.8f, -0.6f, 1.2f}};
  const halfspace::Point3 motion = {14.2f, 2.4f, 0};
  std::vector<Hit> hits;
  BoxCast(bodies, start, motion, 1, [&](std::uint32_t id, float t) {
    hits.push_back({t, id});
  });
  Sort(hits);
  if (hits.empty()) {
    std::fputs("broad_phase_svg: the cast hits no body\n", stderr);
    return false;
  }
  const auto moved = [&](float t) {
    halfspace::Aabb3 box = start;
    for (std::size_t k = 0; k < 3; ++k) {
      box.min[k] += t * motion[k];
      box.max[k] += t * motion[k];
    }
    return box;
  };

  Picture picture(810, 490, "A box cast in 3D and its hits");
  constexpr float kEdge = 6.2f;
  picture.Polygon("bound",
                  {Project(-kEdge, -kEdge, 0), Project(kEdge, -kEdge, 0),
                   Project(kEdge, kEdge, 0), Project(-kEdge, kEdge, 0)});
  for (std::uint32_t id = 0; id < all.size(); ++id) {
    const bool is_hit =
        std::any_of(hits.begin(), hits.end(),
                    [id](const Hit& hit) { return hit.id == id; });
    DrawBox(picture, all[id], is_hit ? "hit" : "body");
  }
  // The outline of all that the box passes.
  const halfspace::Aabb3 end = moved(1);
  const auto& [a, b] = std::pair(start.min, start.max);
  const auto& [c, d] = std::pair(end.min, end.max);
  picture.Polygon("path",
                  {Project(a[0], b[1], a[2]), Project(a[0], b[1], b[2]),
                   Project(a[0], a[1], b[2]), Project(c[0], c[1], d[2]),
                   Project(d[0], c[1], d[2]), Project(d[0], c[1], c[2]),
                   Project(d[0], d[1], c[2]), Project(b[0], b[1], a[2])});
  DrawBox(picture, start, "mover");
  DrawBox(picture, moved(hits[0].t), "mover");
  for (const Hit& hit : hits) {
    const halfspace::Aabb3& box = all[hit.id];
    const halfspace::Point2 top =
        Project((box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2,
                box.max[2]);
    char label[16];
    std::snprintf(label, sizeof label, "%.2f", hit.t);
    picture.Text("label", {top[0], top[1] + 4}, label);
  }
  const auto square = [](float x) {
    return halfspace::Aabb2{{x, 458}, {x + 16, 474}};
  };
  picture.Rect("mover", square(120));
  picture.Text("", {143, 471}, "box, at its start and at its first hit");
  picture.Rect("path", square(392));
  picture.Text("", {415, 471}, "where it passes");
  picture.Rect("hit", square(532));
  picture.Text("", {555, 471}, "bodies that it hits, with t");

  return picture.Write(path);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : ".";
  const bool is_drawn = Draw2D(folder + "/broad-phase-2d.svg") &&
                        Draw3D(folder + "/broad-phase-3d.svg");
  return is_drawn ? 0 : 1;
}
