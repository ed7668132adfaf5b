#include "bench/report/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "bench/base/text_table.h"
#include "bench/report/paper.h"
#include "bench/report/results.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kMostText = 600;
constexpr std::size_t kMostTargets = 12;
constexpr double kLeastTest = 1.0;
constexpr double kMostTest = 10'000.0;

struct Shape {
  std::string_view key;
  const char* name;
  Ink ink;
  std::size_t bytes;
};

constexpr std::array<Shape, 3> kShapes = {
    Shape{"simplex", "simplex", Ink::kSimplex, kRecordBytes.simplex},
    Shape{"aabb", "AABB", Ink::kAabb, kRecordBytes.aabb},
    Shape{"aabo", "AABO", Ink::kAabo, kRecordBytes.aabo}};

const Shape* ShapeOf(std::string_view key) {
  const auto* found =
      std::find_if(kShapes.begin(), kShapes.end(),
                   [key](const Shape& shape) { return shape.key == key; });
  return found == kShapes.end() ? nullptr : found;
}

std::string NameOf(const std::string& key) {
  const Shape* shape = ShapeOf(key);
  return shape == nullptr ? key : shape->name;
}

// What is further out is no measurement, and no axis could show it.
bool IsDrawable(double value) { return value >= 1e-9 && value <= 1e15; }

void Add(Series& series, double x, double y) {
  if (IsDrawable(x) && IsDrawable(y)) series.points.emplace_back(x, y);
}

std::string BytesText(double bytes) {
  constexpr std::array<const char*, 4> kUnits = {" B", " KiB", " MiB", " GiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024.0 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024.0;
  return Digits(bytes) + kUnits[unit];
}

// Powers of 2, so many that their names have room.
Tics BinaryTics(const Axis& axis) {
  const int first = static_cast<int>(std::ceil(std::log2(axis.low) - 0.01));
  const int last = static_cast<int>(std::floor(std::log2(axis.high) + 0.01));
  const int step = std::max(1, (last - first + 5) / 5);
  Tics tics;
  for (int i = first; i <= last; i += step) {
    const double at = std::exp2(i);
    tics.emplace_back(at,
                      axis.scale == Scale::kBytes ? BytesText(at) : Digits(at));
  }
  return tics;
}

Tics DecimalTics(const Axis& axis) {
  std::vector<double> steps = {1.0};
  const double ratio = axis.high / axis.low;
  if (ratio < 1e4) steps = {1.0, 2.0, 5.0};
  if (ratio < 10.0) steps = {1.0, 1.5, 2.0, 3.0, 5.0, 7.0};
  if (ratio < 3.0) steps = {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0};
  Tics tics;
  const int first = static_cast<int>(std::floor(std::log10(axis.low)));
  for (int i = first; std::pow(10.0, i) <= axis.high; ++i) {
    for (double step : steps) {
      const double at = step * std::pow(10.0, i);
      if (at >= axis.low * 0.98 && at <= axis.high * 1.02) {
        tics.emplace_back(at, Digits(at));
      }
    }
  }
  return tics;
}

// Sets the axes to what the series need. False if there is nothing to draw.
bool Fit(Figure& figure) {
  std::erase_if(figure.series, [](const Series& series) {
    return series.points.empty() && series.ink != Ink::kText;
  });
  bool is_first = true;
  for (const Series& series : figure.series) {
    for (const auto& [x, y] : series.points) {
      figure.x.low = is_first ? x : std::min(figure.x.low, x);
      figure.x.high = is_first ? x : std::max(figure.x.high, x);
      figure.y.low = is_first ? y : std::min(figure.y.low, y);
      figure.y.high = is_first ? y : std::max(figure.y.high, y);
      is_first = false;
    }
  }
  return !is_first;
}

Series SeriesOf(const Shape& shape, Stroke stroke = Stroke::kSolid) {
  return {shape.name, shape.ink, stroke, {}};
}

std::vector<Figure> Only(Figure figure) {
  std::vector<Figure> figures;
  if (Fit(figure)) figures.push_back(std::move(figure));
  return figures;
}

std::vector<Figure> MakeWork(const ReportField& sections) {
  const auto table1 = sections.Find("table1");
  if (!table1) return {};
  const auto papers = [](std::string_view shape) -> const auto& {
    if (shape == "simplex") return kPaperWork.simplex;
    return shape == "aabb" ? kPaperWork.aabb : kPaperWork.aabo;
  };
  const std::vector<ReportField> widths = table1->At("widths").List();
  Figure figure;
  figure.x = {"w, objects in a batch", Scale::kWidths};
  figure.y = {"half-spaces an object", Scale::kLinear};
  figure.table.push_back({"w"});
  for (const ReportField& width : widths) {
    figure.table.push_back({Digits(width.Number())});
  }
  for (const Shape& shape : kShapes) {
    const ReportField field =
        table1->At("half_spaces").At(std::string(shape.key).c_str());
    const std::vector<ReportField> work = field.List();
    if (work.size() != widths.size()) field.Fail("is not as long as widths");
    Series counted = SeriesOf(shape);
    figure.table[0].emplace_back(shape.name);
    figure.table[0].emplace_back("paper");
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const double width = widths[i].Number();
      Add(counted, width, work[i].Number());
      figure.table[i + 1].push_back(Digits(work[i].Number()));
      const auto* same =
          std::find(kWorkWidths.begin(), kWorkWidths.end(), width);
      figure.table[i + 1].push_back(
          same == kWorkWidths.end()
              ? "-"
              : Fixed(papers(shape.key)[same - kWorkWidths.begin()], 2));
    }
    figure.series.push_back(std::move(counted));
  }
  if (!Fit(figure)) return {};
  for (const Shape& shape : kShapes) {
    Series paper{"", Ink::kText, Stroke::kDashed, {}};
    for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
      Add(paper, static_cast<double>(kWorkWidths[i]), papers(shape.key)[i]);
    }
    figure.series.push_back(std::move(paper));
  }
  figure.series.push_back({"paper", Ink::kText, Stroke::kDashed, {}});
  Fit(figure);
  return {figure};
}

void AddWStar(Figure& figure, const ReportField& crossover,
              const std::string& target, const std::string& set) {
  for (const ReportField& row : crossover.List("targets")) {
    if (row.At("target").Text() != target ||
        row.At("working_set").Text() != set) {
      continue;
    }
    const auto w_star = row.Find("w_star");
    if (!w_star) {
      figure.remarks.emplace_back("No crossover: there is no w*.");
      continue;
    }
    const auto at_most = row.Find("at_most");
    const std::string text =
        std::string(at_most && at_most->Flag() ? "w* at most " : "w* = ") +
        Fixed(w_star->Number(), 0);
    if (IsDrawable(w_star->Number())) {
      figure.marks.push_back({w_star->Number(), text});
    }
  }
}

std::vector<Figure> MakeCrossover(const ReportField& sections) {
  const auto crossover = sections.Find("crossover");
  if (!crossover) return {};
  std::vector<ReportField> rows = crossover->At("rows").List();
  std::erase_if(rows, [](const ReportField& row) {
    return row.At("schedule").Text() != "every-plane";
  });
  if (rows.empty()) return {};
  std::string set = rows.front().At("working_set").Text();
  std::vector<std::string> targets;
  for (const ReportField& row : rows) {
    if (row.At("working_set").Text() == "L2") set = "L2";
    const std::string target = row.At("target").Text();
    if (std::find(targets.begin(), targets.end(), target) == targets.end()) {
      targets.push_back(target);
    }
  }
  if (targets.size() > kMostTargets) crossover->Fail("has too many targets");
  std::vector<Figure> figures;
  for (const std::string& target : targets) {
    Figure figure;
    figure.name = target + ", in " + set;
    figure.x = {"w, objects in a batch", Scale::kWidths};
    figure.y = {"ns an object", Scale::kDecimal};
    figure.series = {SeriesOf(kShapes[0]), SeriesOf(kShapes[1])};
    figure.table.push_back({"w", "simplex, ns", "AABB, ns", "AABO, ns"});
    for (const ReportField& row : rows) {
      if (row.At("target").Text() != target ||
          row.At("working_set").Text() != set) {
        continue;
      }
      const double w = row.At("w").Number();
      std::vector<std::string> cells = {Digits(w)};
      for (const char* key : {"simplex_ns", "aabb_ns", "aabo_ns"}) {
        const auto ns = row.Find(key);
        cells.push_back(ns ? Digits(ns->Number()) : "-");
        const std::size_t i = cells.size() - 2;
        if (ns && i < figure.series.size()) {
          Add(figure.series[i], w, ns->Number());
        }
      }
      figure.table.push_back(std::move(cells));
    }
    // One width is no curve; it is in the tables.
    if (!Fit(figure) || figure.x.low == figure.x.high) continue;
    AddWStar(figure, *crossover, target, set);
    figures.push_back(std::move(figure));
  }
  return figures;
}

// The target whose kernels are drawn: the one that programs get.
std::string TargetOf(const ReportField& sections,
                     const std::vector<ReportField>& rows) {
  std::string chosen;
  if (const auto machine = sections.Find("machine")) {
    chosen = machine->At("targets").At("chosen").Text();
  }
  for (const ReportField& row : rows) {
    if (row.At("target").Text() == chosen) return chosen;
  }
  return rows.front().At("target").Text();
}

std::vector<Figure> MakeBandwidth(const ReportField& sections) {
  const std::vector<ReportField> fastest = FastestKernels(sections);
  if (fastest.empty()) return {};
  Figure figure;
  figure.name = fastest.front().At("target").Text();
  figure.x = {"bytes of the world", Scale::kBytes};
  figure.y = {"GB/s", Scale::kDecimal};
  figure.table.push_back({"set", "shape", "schedule", "objects", "ns an object",
                          "GB/s", "% of reading"});
  Series ceiling{"reading", Ink::kText, Stroke::kDashed, {}};
  for (const Shape& shape : kShapes) figure.series.push_back(SeriesOf(shape));
  for (const ReportField& row : fastest) {
    const std::string key = row.At("shape").Text();
    const double objects = row.At("objects").Number();
    const double rate = row.At("gigabytes_per_second").Number();
    const double percent = row.At("percent_of_read").Number();
    const Shape* shape = ShapeOf(key);
    const std::string set = row.At("working_set").Text();
    if (shape != nullptr) {
      const double bytes = objects * static_cast<double>(shape->bytes);
      Add(figure.series[shape - kShapes.data()], bytes, rate);
      if (percent > 0.0) Add(ceiling, bytes, 100.0 * rate / percent);
      // Named once, where the simplex's planes end.
      if (key == "simplex" && IsDrawable(bytes)) {
        figure.marks.push_back({bytes, set, false});
      }
    }
    figure.table.push_back({row.At("working_set").Text(), NameOf(key),
                            row.At("schedule").Text(), Digits(objects),
                            Digits(row.At("ns_per_object").Number()),
                            Digits(rate), Digits(percent)});
  }
  figure.series.push_back(std::move(ceiling));
  for (Series& series : figure.series) {
    std::sort(series.points.begin(), series.points.end());
  }
  return Only(std::move(figure));
}

std::vector<Figure> MakeSurvivors(const ReportField& sections) {
  const auto quality = sections.Find("quality");
  if (!quality) return {};
  const ReportField survivors = quality->At("survivors");
  const double of_aabb = survivors.At("aabb").Number();
  Figure figure;
  figure.y = {"survivors, AABB = 1", Scale::kLinear};
  figure.table.push_back({"shape", "survivors", "of the AABB's"});
  double place = 1.0;
  for (const Shape& shape : kShapes) {
    const double count = survivors.At(std::string(shape.key).c_str()).Number();
    Series bar{"", shape.ink, Stroke::kBar, {}};
    if (of_aabb > 0.0) Add(bar, place, count / of_aabb);
    figure.table.push_back({shape.name, Digits(count),
                            of_aabb > 0.0 ? Fixed(count / of_aabb, 2) : "-"});
    figure.x.names.emplace_back(place, shape.name);
    figure.series.push_back(std::move(bar));
    place += 1.0;
  }
  return Only(std::move(figure));
}

std::vector<Figure> MakeBreakEven(const ReportField& sections) {
  const auto model = sections.Find("model");
  if (!model) return {};
  Figure figure;
  figure.x = {"ns of an exact test", Scale::kDecimal};
  figure.y = {"ns an object, with exact tests", Scale::kLinear};
  figure.table.push_back(
      {"shape", "schedule", "ns an object", "candidates an object"});
  for (const ReportField& row : model->List("shapes")) {
    const std::string key = row.At("shape").Text();
    const double ns = row.At("ns_per_object").Number();
    const double candidates = row.At("candidates").Number();
    figure.table.push_back({NameOf(key), row.At("schedule").Text(), Digits(ns),
                            Digits(candidates)});
    const Shape* shape = ShapeOf(key);
    if (shape == nullptr) continue;
    Series total = SeriesOf(*shape);
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      const double test =
          kLeastTest * std::pow(kMostTest / kLeastTest, double(i) / kSteps);
      Add(total, test, ns + candidates * test);
    }
    figure.series.push_back(std::move(total));
  }
  const auto is_on_axis = [](double ns) {
    return ns >= kLeastTest && ns <= kMostTest;
  };
  for (const ReportField& row : model->List("break_even")) {
    const std::string against = NameOf(row.At("against").Text());
    const auto ns = row.Find("ns");
    figure.remarks.push_back(
        "The simplex and the " + against +
        (ns ? " break even at " + Digits(ns->Number()) + " ns an exact test."
            : " never break even."));
    if (ns && is_on_axis(ns->Number())) {
      figure.marks.push_back({ns->Number(), "simplex = " + against});
    }
  }
  std::string letter = "a";
  for (const ReportField& row : model->List("exact_tests")) {
    const double ns = row.At("ns").Number();
    const auto quartiles = row.Find("quartiles");
    std::string remark = row.At("name").Text() + ": " + Digits(ns) + " ns";
    if (quartiles) remark += " [" + ValueText(quartiles->json()) + "]";
    if (is_on_axis(ns) && letter[0] <= 'z') {
      figure.marks.push_back({ns, letter, false});
      remark = letter + ", " + remark;
      ++letter[0];
    }
    figure.remarks.push_back(remark);
  }
  return Only(std::move(figure));
}

}  // namespace

const std::array<FigureKind, 5> kFigureKinds = {
    FigureKind{"Work", "table1",
               "Half-spaces evaluated an object, when a batch of w objects "
               "stops after the first half-space that rejects all of them.",
               MakeWork},
    FigureKind{"Survivors", "quality",
               "What each shape keeps, and an exact test must look at.",
               MakeSurvivors},
    FigureKind{"Time by the width of a batch", "crossover",
               "One query, with an early-out after every half-space in "
               "batches of w objects. From w* on the simplex is faster.",
               MakeCrossover, true},
    FigureKind{"Bandwidth", "kernels",
               "Whole records, each shape by its fastest schedule, and what "
               "only reading the same planes reaches. Staged kernels skip "
               "planes, and may pass it.",
               MakeBandwidth},
    FigureKind{"Break-even", "model",
               "Time an object with its share of the exact tests of what "
               "survives, by what an exact test costs.",
               MakeBreakEven}};

std::vector<ReportField> FastestKernels(const ReportField& sections) {
  const auto kernels = sections.Find("kernels");
  if (!kernels) return {};
  const std::vector<ReportField> rows = kernels->At("rows").List();
  if (rows.empty()) return {};
  const std::string target = TargetOf(sections, rows);
  std::vector<ReportField> fastest;
  for (const ReportField& row : rows) {
    if (row.At("target").Text() != target) continue;
    const auto same = std::find_if(
        fastest.begin(), fastest.end(), [&row](const ReportField& other) {
          return other.At("shape").Text() == row.At("shape").Text() &&
                 other.At("working_set").Text() == row.At("working_set").Text();
        });
    if (same == fastest.end()) {
      fastest.push_back(row);
    } else if (row.At("ns_per_object").Number() <
               same->At("ns_per_object").Number()) {
      *same = row;
    }
  }
  return fastest;
}

Tics TicsOf(const Axis& axis) {
  if (!axis.names.empty()) return axis.names;
  if (axis.scale == Scale::kLinear) return {};
  return axis.scale == Scale::kDecimal ? DecimalTics(axis) : BinaryTics(axis);
}

std::string Digits(double value) {
  if (!std::isfinite(value)) return "-";
  const double magnitude = std::abs(value);
  if (magnitude >= 1000.0 && magnitude < 1e15) {
    return (value < 0 ? "-" : "") +
           Grouped(static_cast<std::size_t>(std::llround(magnitude)));
  }
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

std::string ValueText(const Json& value) {
  if (value.is_null()) return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number()) return Digits(value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object() && value.size() == 2 && value.contains("median") &&
      value.contains("quartiles")) {
    return ValueText(value["median"]) + " [" + ValueText(value["quartiles"]) +
           "]";
  }
  std::string text;
  for (const auto& [key, element] : value.items()) {
    if (!text.empty()) text += ", ";
    if (text.size() > kMostText) break;
    if (value.is_object()) text += key + " ";
    text += ValueText(element);
  }
  return text;
}

}  // namespace halfspace::bench
