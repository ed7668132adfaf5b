// Figures drawn by gnuplot, as SVG to stand inside a page.
#ifndef HALFSPACE_BENCH_REPORT_GNUPLOT_H_
#define HALFSPACE_BENCH_REPORT_GNUPLOT_H_

#include <string>
#include <string_view>

#include "bench/report/figures.h"

namespace halfspace::bench {

// What gnuplot is told. Of the figure's texts only letters, digits and "
// _.+-*=/," get there, as gnuplot runs commands that stand in strings.
std::string GnuplotScript(const Figure& figure);

// What gnuplot answers, as one <svg>: colours are those of the style sheet, and
// every id starts with `prefix`. Empty if it is no SVG.
std::string InlineSvg(std::string_view svg, const std::string& prefix,
                      const std::string& label);

// Runs gnuplot; `svg` is empty if it fails. False if it is not installed.
bool RunGnuplot(const std::string& script, std::string& svg);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_GNUPLOT_H_
