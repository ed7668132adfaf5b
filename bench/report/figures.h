// The figures of the page: what is drawn from each section of a report, and the
// same numbers as a table.
#ifndef HALFSPACE_BENCH_REPORT_FIGURES_H_
#define HALFSPACE_BENCH_REPORT_FIGURES_H_

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/report_field.h"

namespace halfspace::bench {

// Each is one colour of the page; the style sheet has both schemes of it.
enum class Ink { kText, kGrid, kSimplex, kAabb, kAabo };

enum class Stroke { kSolid, kDashed, kBar };

// kLinear starts at 0; the others are logarithmic.
enum class Scale { kLinear, kWidths, kBytes, kDecimal };

struct Series {
  std::string name;
  Ink ink = Ink::kText;
  Stroke stroke = Stroke::kSolid;
  std::vector<std::pair<double, double>> points;  // x, y
};

// A place on the x axis: a line through the figure, or a tick with its name.
struct Mark {
  double x = 0.0;
  std::string name;
  bool is_line = true;
};

using Tics = std::vector<std::pair<double, std::string>>;

struct Axis {
  std::string label;
  Scale scale = Scale::kLinear;
  // Of the points; figures that stand side by side have them in common.
  double low = 0.0;
  double high = 0.0;
  Tics names = {};  // of the bars
};

// Where an axis has tics; empty: where gnuplot wants them.
Tics TicsOf(const Axis& axis);

struct Figure {
  std::string name;  // what tells it from those of the same kind; may be empty
  Axis x;
  Axis y;
  std::vector<Series> series;
  std::vector<Mark> marks;
  std::vector<std::string> remarks;             // lines beneath it
  std::vector<std::vector<std::string>> table;  // the first row is the header
};

// The figures of one kind.
struct FigureKind {
  const char* title;
  const char* section;
  const char* caption;
  // Of `sections`; empty where nothing can be drawn of them. Throws
  // std::invalid_argument.
  std::vector<Figure> (*make)(const ReportField& sections);
  // Several of one machine, each with a y axis of its own. Elsewhere machines
  // have it in common.
  bool is_series = false;
};

extern const std::array<FigureKind, 5> kFigureKinds;

// Of `kernels`, the fastest schedule of each shape in each working set, of the
// target that programs get, or else of that which was measured; empty where
// nothing was. Throws std::invalid_argument.
std::vector<ReportField> FastestKernels(const ReportField& sections);

// A value in one line: a number with the digits that count, a ratio with its
// quartiles, a list with commas.
std::string ValueText(const Json& value);

// Up to four digits that count; never "inf" or "nan".
std::string Digits(double value);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_FIGURES_H_
