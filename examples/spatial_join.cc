// Which boxes of one file meet which of another? Each line of a file is a name
// and the box of what has it: name,min x,min y,max x,max y.
//
//   example_spatial_join ROADS.csv RIVERS.csv
#include <halfspace/halfspace.h>

#include <cstddef>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

struct Layer {
  std::vector<std::string> names;
  std::vector<halfspace::Aabb2> boxes;
};

bool Read(const char* path, Layer& layer) {
  std::ifstream file(path);
  if (!file) {
    std::fprintf(stderr, "%s: cannot be read\n", path);
    return false;
  }
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream fields(line);
    std::string name;
    halfspace::Aabb2 box;
    char comma = ',';
    if (!std::getline(fields, name, ',') ||
        !(fields >> box.min[0] >> comma >> box.min[1] >> comma >> box.max[0] >>
          comma >> box.max[1])) {
      std::fprintf(stderr, "%s:%d: expected name,min x,min y,max x,max y\n",
                   path, number);
      return false;
    }
    layer.names.push_back(name);
    layer.boxes.push_back(box);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_spatial_join FILE FILE\n");
    return 2;
  }
  Layer first;
  Layer second;
  if (!Read(argv[1], first) || !Read(argv[2], second)) return 1;

  const halfspace::AabbBvh2 a(first.boxes);
  const halfspace::AabbBvh2 b(second.boxes);
  ForEachPair(a, b, [&](halfspace::Span<const halfspace::IdPair> pairs) {
    for (const halfspace::IdPair& pair : pairs) {
      std::printf("%s may cross %s\n", first.names[pair.a].c_str(),
                  second.names[pair.b].c_str());
    }
  });
  return 0;
}
