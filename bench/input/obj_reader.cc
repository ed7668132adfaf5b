#include "bench/input/obj_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "bench/input/text_lines.h"

namespace halfspace::bench {
namespace {

// What the format defines and a mesh of polygons does not need. Statements that
// would bring in other files' geometry or run commands are not among them.
constexpr std::array<std::string_view, 35> kSkipped = {
    "vt",        "vn",     "vp",    "g",        "o",        "s",
    "usemtl",    "mtllib", "l",     "p",        "mg",       "usemap",
    "maplib",    "lod",    "bevel", "c_interp", "d_interp", "shadow_obj",
    "trace_obj", "cstype", "deg",   "bmat",     "step",     "curv",
    "curv2",     "surf",   "parm",  "trim",     "hole",     "scrv",
    "sp",        "end",    "con",   "ctech",    "stech"};

// The blank-separated fields of one statement. A backslash at the end of a line
// carries on with the next line.
class Statement {
 public:
  Statement(TextLines& lines, std::string_view line)
      : lines_(lines), rest_(line), first_line_(lines.number()) {}

  std::size_t first_line() const { return first_line_; }

  // The next field; nothing at the end or at a comment. The line of a field is
  // that of the TextLines until the next call.
  std::optional<std::string_view> Next() {
    rest_ = SkipBlanks(rest_);
    while (rest_ == "\\") Continue();
    if (rest_.empty() || rest_.front() == '#') return std::nullopt;
    std::string_view field(rest_.begin(),
                           std::find_if(rest_.begin(), rest_.end(), IsBlank));
    field_reaches_backslash_ =
        field.size() == rest_.size() && field.ends_with('\\');
    if (field_reaches_backslash_) field.remove_suffix(1);
    rest_.remove_prefix(field.size());
    return field;
  }

 private:
  // The format would join the two halves of a word, other readers see two
  // words: so neither.
  void Continue() {
    const std::optional<std::string_view> line = lines_.Next();
    if (!line) {
      lines_.Fail("the file ends after a backslash, which continues a line",
                  "export the file again, it may be truncated");
    }
    rest_ = SkipBlanks(*line);
    if (field_reaches_backslash_ && rest_.size() == line->size() &&
        !rest_.empty()) {
      lines_.Fail("the backslash before this line splits a word",
                  "write a blank before the backslash");
    }
    field_reaches_backslash_ = false;
  }

  TextLines& lines_;
  std::string_view rest_;
  std::size_t first_line_;
  bool field_reaches_backslash_ = false;
};

bool TakeSlash(std::string_view& text) {
  if (!text.starts_with('/')) return false;
  text.remove_prefix(1);
  return true;
}

// Takes a decimal integer off the front. One that does not fit is as good as
// the largest: no file has so many vertices.
bool TakeInteger(std::string_view& text, std::int64_t& value) {
  using Limits = std::numeric_limits<std::int64_t>;
  const auto [stop, error] =
      std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) {
    value = text.starts_with('-') ? Limits::min() : Limits::max();
  }
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return true;
}

// v, v/vt, v//vn or v/vt/vn, and the v of it. Texture and normal indices must
// be integers; they are not needed, so their range is not checked.
bool ParseCorner(std::string_view text, std::int64_t& vertex) {
  std::int64_t ignored = 0;
  if (!TakeInteger(text, vertex)) return false;
  if (text.empty()) return true;
  if (!TakeSlash(text)) return false;
  if (!text.starts_with('/')) {
    if (!TakeInteger(text, ignored)) return false;
    if (text.empty()) return true;
  }
  return TakeSlash(text) && TakeInteger(text, ignored) && text.empty();
}

class MeshParser {
 public:
  MeshParser(const std::string& path, std::string content,
             const MeshLimits& limits)
      : lines_(path, std::move(content)), limits_(limits) {}

  Mesh Parse() {
    while (const std::optional<std::string_view> line = lines_.Next()) {
      Statement statement(lines_, *line);
      if (const auto keyword = statement.Next()) Read(*keyword, statement);
    }
    CheckComplete();
    return std::move(mesh_);
  }

 private:
  // A face that names a vertex which has not been read yet.
  struct ForwardReference {
    std::int64_t vertex;  // counted from 1
    std::size_t line;
  };

  void Read(std::string_view keyword, Statement& statement) {
    if (keyword == "v") {
      ReadVertex(statement);
    } else if (keyword == "f") {
      ReadFace(statement);
    } else if (std::find(kSkipped.begin(), kSkipped.end(), keyword) !=
               kSkipped.end()) {
      while (statement.Next()) {
      }
    } else {
      lines_.Fail(
          Quoted(keyword) + " is no statement that can be read",
          "remove the line, or export the mesh as polygons to OBJ or glTF");
    }
  }

  void ReadVertex(Statement& statement) {
    std::array<float, 3> position{};
    std::size_t count = 0;
    while (const auto field = statement.Next()) {
      const float value = ParseFloat(lines_, *field);
      if (count < position.size()) position[count] = value;
      ++count;
    }
    if (count != 3 && count != 4 && count != 6) {
      lines_.FailAt(statement.first_line(),
                    "a vertex with " + std::to_string(count) + " numbers",
                    "write v x y z, v x y z w or v x y z r g b");
    }
    if (mesh_.vertices() == limits_.vertices) {
      FailAtLimit(statement, limits_.vertices, "vertices");
    }
    mesh_.coords.insert(mesh_.coords.end(), position.begin(), position.end());
  }

  void ReadFace(Statement& statement) {
    std::uint32_t first = 0;
    std::uint32_t previous = 0;
    std::size_t count = 0;
    while (const auto field = statement.Next()) {
      const std::uint32_t vertex = ReadCorner(*field);
      if (count == 0) first = vertex;
      if (count >= 2) AddTriangle(statement, {first, previous, vertex});
      previous = vertex;
      ++count;
    }
    if (count < 3) {
      lines_.FailAt(statement.first_line(),
                    "a face with " + std::to_string(count) + " corners",
                    "write at least 3, as in f 1 2 3");
    }
  }

  void AddTriangle(const Statement& statement,
                   const std::array<std::uint32_t, 3>& corners) {
    if (mesh_.triangles() == limits_.triangles) {
      FailAtLimit(statement, limits_.triangles, "triangles");
    }
    mesh_.indices.insert(mesh_.indices.end(), corners.begin(), corners.end());
  }

  // The vertex of a corner, counted from 0.
  std::uint32_t ReadCorner(std::string_view field) {
    std::int64_t vertex = 0;
    if (!ParseCorner(field, vertex)) {
      lines_.Fail(Quoted(field) + " is no corner of a face",
                  "write v, v/vt, v//vn or v/vt/vn with whole numbers");
    }
    const auto known = static_cast<std::int64_t>(mesh_.vertices());
    if (vertex == 0) {
      lines_.Fail("vertex 0 in " + Quoted(field),
                  "count vertices from 1, or back from -1");
    }
    if (vertex < -known) {
      lines_.Fail(Quoted(field) + " is out of range: only " +
                      std::to_string(known) + " vertices come before it",
                  "count back from -1, the last vertex before the face");
    }
    if (vertex > limits_.vertices) {
      lines_.Fail(Quoted(field) + " is out of range: a mesh has at most " +
                      std::to_string(limits_.vertices) + " vertices",
                  "name a vertex of this file");
    }
    if (vertex < 0) return static_cast<std::uint32_t>(known + vertex);
    if (vertex > known) AddForwardReference(vertex);
    return static_cast<std::uint32_t>(vertex - 1);
  }

  // Whoever is not above an earlier one cannot be the first to be wrong.
  void AddForwardReference(std::int64_t vertex) {
    if (forward_.empty() || vertex > forward_.back().vertex) {
      forward_.push_back({vertex, lines_.number()});
    }
  }

  void CheckComplete() const {
    constexpr const char* kAdvice =
        "give an OBJ file with v and f lines, it may be truncated";
    if (mesh_.vertices() == 0) {
      lines_.Fail("the file ends without a vertex", kAdvice);
    }
    const auto known = static_cast<std::int64_t>(mesh_.vertices());
    for (const ForwardReference& reference : forward_) {
      if (reference.vertex <= known) continue;
      lines_.FailAt(reference.line,
                    "vertex " + std::to_string(reference.vertex) +
                        " is out of range: the file has " +
                        std::to_string(known) + " vertices",
                    "name a vertex of this file, it may be truncated");
    }
    if (mesh_.triangles() == 0) {
      lines_.Fail("the file ends without a face", kAdvice);
    }
  }

  [[noreturn]] void FailAtLimit(const Statement& statement, std::uint32_t limit,
                                const std::string& what) const {
    lines_.FailAt(statement.first_line(),
                  "more than " + std::to_string(limit) + " " + what,
                  "split the mesh into several files");
  }

  TextLines lines_;
  MeshLimits limits_;
  Mesh mesh_;
  std::vector<ForwardReference> forward_;  // ascending
};

}  // namespace

Mesh ReadObj(const std::string& path, std::string content,
             const MeshLimits& limits) {
  return MeshParser(path, std::move(content), limits).Parse();
}

}  // namespace halfspace::bench
