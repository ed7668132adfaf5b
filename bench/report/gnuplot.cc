#include "bench/report/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"

extern "C" char** environ;

namespace halfspace::bench {
namespace {

constexpr std::size_t kMostNameChars = 40;

// As GnuplotScript() promises; in single quotes, where gnuplot expands nothing.
std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (char c : text.substr(0, kMostNameChars)) {
    const bool is_alnum = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9');
    quoted += is_alnum || std::string_view(" _.+-*=/,").find(c) !=
                              std::string_view::npos
                  ? c
                  : '_';
  }
  return quoted + "'";
}

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.9g", std::isfinite(value) ? value : 0.0);
  return text;
}

// Colours that nothing else has, to be found again in the SVG.
std::string Color(Ink ink) {
  return " rgb '#01020" + std::to_string(static_cast<int>(ink)) + "'";
}

// `footroom` and `headroom` are parts of the axis, below and above what is
// drawn; the former of a logarithmic one.
std::string AxisScript(const Axis& axis, const std::string& name,
                       double footroom, double headroom) {
  double low = 0.0;
  double high = axis.high * (1.0 + headroom);
  std::string script;
  if (axis.scale != Scale::kLinear) {
    const char* base = axis.scale == Scale::kDecimal ? " 10\n" : " 2\n";
    script += "set logscale " + name + base;
    // Room for the points at both ends, and for one that is alone.
    const double ratio = axis.high / axis.low;
    low = axis.low / (1.02 * std::pow(ratio, footroom));
    high = axis.high * 1.02 * std::pow(ratio, headroom);
  }
  script +=
      "set " + name + "range [" + Number(low) + ":" + Number(high) + "]\n";
  script += "set " + name + "label " + Quoted(axis.label) + "\n";
  std::string tics;
  for (const auto& [at, text] : TicsOf(axis)) {
    tics += (tics.empty() ? "" : ", ") + Quoted(text) + " " + Number(at);
  }
  if (tics.empty()) return script;
  return script + "set " + name + "tics (" + tics + ")\n";
}

// All x axes that have marks are logarithmic.
std::string MarkScript(const Figure& figure) {
  std::vector<Mark> marks = figure.marks;
  std::erase_if(marks, [&figure](const Mark& mark) {
    return !(mark.x >= figure.x.low && mark.x <= figure.x.high);
  });
  std::sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) {
    return std::pair(!a.is_line, a.x) < std::pair(!b.is_line, b.x);
  });
  const std::string color = Color(Ink::kText);
  const double decades = std::log(figure.x.high / figure.x.low);
  std::string script;
  double free = 0.0;  // tics' names start no further to the left
  int lines = 0;
  for (const Mark& mark : marks) {
    const std::string x = Number(mark.x);
    script += "set arrow from " + x + ", graph 0 to " + x + ", graph " +
              (mark.is_line ? "1 nohead dt 3 lw 1" : "0.035 nohead lw 1.5") +
              " lc" + color + "\n";
    script += "set label " + Quoted(mark.name) + " at ";
    if (mark.is_line) {
      // Names stay inside, and off the lines beside them.
      const double place = std::log(mark.x / figure.x.low) / decades;
      const bool is_last = &mark == &marks.back() || !(&mark + 1)->is_line;
      const bool is_right = place < 0.35 || (is_last && place < 0.7);
      script += x + ", graph " + Number(0.96 - 0.07 * lines++) +
                (is_right ? " left offset 0.6,0" : " right offset -0.6,0");
    } else {
      const double at = std::max(mark.x, free);
      free = at * std::exp(0.04 * decades);
      script += Number(at) + ", graph 0.07 center font ',11'";
    }
    script += " tc" + color + "\n";
  }
  return script;
}

std::string StyleOf(const Series& series) {
  const std::string color = " lc" + Color(series.ink);
  if (series.stroke == Stroke::kBar) {
    return "with boxes fs solid noborder" + color;
  }
  if (series.stroke == Stroke::kDashed) return "with lines lw 1 dt 2" + color;
  // A point for each shape, as colours are no help in print.
  const int point = series.ink == Ink::kSimplex ? 7
                    : series.ink == Ink::kAabb  ? 5
                                                : 9;
  const std::size_t every = series.points.size() / 16 + 1;
  return "with linespoints pt " + std::to_string(point) + " ps 0.55 pi " +
         std::to_string(every) + " lw 1.6" + color;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string ReadAll(std::FILE* file) {
  std::string text;
  char part[4096];
  std::rewind(file);
  while (const std::size_t size = std::fread(part, 1, sizeof(part), file)) {
    text.append(part, size);
  }
  return text;
}

// `from` that starts with `before`, up to `after`, removed everywhere.
void Remove(std::string& text, std::string_view before,
            std::string_view after) {
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    const std::size_t end = text.find(after, at + before.size());
    if (end == std::string::npos) return;
    text.erase(at, end + after.size() - at);
  }
}

void Replace(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos;
       at += with.size()) {
    text.replace(at, what.size(), with);
  }
}

}  // namespace

std::string GnuplotScript(const Figure& figure) {
  const std::string text = " tc" + Color(Ink::kText);
  std::string script =
      "set terminal svg size 380,280 dynamic noenhanced font 'sans-serif,12'\n"
      "set border 3 lw 0.8 lc" +
      Color(Ink::kText) +
      "\n"
      "set tics nomirror out scale 0.4" +
      text +
      "\n"
      "set xlabel" +
      text + " offset 0,0.3\nset ylabel" + text +
      " offset 1,0\n"
      "set key above left Left reverse samplen 1.6 width 1 " +
      text +
      "\n"
      "set grid ytics lt 1 lw 0.6 dt 1 lc" +
      Color(Ink::kGrid) +
      "\n"
      "set boxwidth 0.55\n";
  const auto lines =
      std::count_if(figure.marks.begin(), figure.marks.end(),
                    [](const Mark& mark) { return mark.is_line; });
  const bool has_tics = static_cast<std::size_t>(lines) < figure.marks.size();
  script += AxisScript(figure.x, "x", 0.04, 0.04) +
            AxisScript(figure.y, "y", has_tics ? 0.2 : 0.04,
                       0.08 + 0.09 * static_cast<double>(lines));
  script += MarkScript(figure);
  std::string plots;
  std::string data;
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    const Series& series = figure.series[i];
    const std::string name = "$d" + std::to_string(i);
    plots += plots.empty() ? "plot " : ", ";
    const std::string title =
        series.name.empty() ? " notitle" : " title " + Quoted(series.name);
    if (series.points.empty()) {
      plots += "keyentry " + StyleOf(series) + title;
      continue;
    }
    data += name + " << EOD\n";
    for (const auto& [x, y] : series.points) {
      data += Number(x) + " " + Number(y) + "\n";
      if (series.stroke == Stroke::kBar) {
        script += "set label " + Quoted(Fixed(y, 2)) + " at " + Number(x) +
                  "," + Number(y) + " center offset 0,0.6" + text + "\n";
        script += "set xrange [0.4:" + Number(x + 0.6) + "]\n";
      }
    }
    data += "EOD\n";
    plots += name + " using 1:2 " + StyleOf(series) + title;
  }
  return script + data + plots + "\n";
}

std::string InlineSvg(std::string_view svg, const std::string& prefix,
                      const std::string& label) {
  const std::size_t begin = svg.find("<g id=\"gnuplot_canvas\"");
  const std::size_t end = svg.rfind("</svg>");
  if (begin == std::string_view::npos || end == std::string_view::npos ||
      end < begin) {
    return {};
  }
  std::string body(svg.substr(begin, end - begin));
  Remove(body, "<filter ", "</filter>\n");
  Remove(body, "<title>", "</title>");
  Remove(body, " font-family=\"", "\"");
  // They would be what currentColor is.
  for (const char* color : {"black", "white", "gray"}) {
    Replace(body, std::string(" color=\"") + color + "\"", "");
  }
  Replace(body, "stroke=\"black\"", "stroke=\"currentColor\"");
  for (const char* quote : {"'", "\""}) {
    Replace(body, std::string(" id=") + quote, " id=" + (quote + prefix));
    Replace(body, std::string("xlink:href=") + quote + "#",
            "href=" + (quote + ("#" + prefix)));
  }
  for (int ink = 0; ink <= static_cast<int>(Ink::kAabo); ++ink) {
    const std::string number = std::to_string(ink);
    const std::string color = "var(--ink" + number + ")";
    Replace(body, "rgb(  1,   2,   " + number + ")", color);
    Replace(body, "rgb(1,2," + number + ")", color);
  }
  return "<svg viewBox=\"0 0 380 280\" role=\"img\" aria-label=\"" + label +
         "\">\n" + body + "</svg>\n";
}

bool RunGnuplot(const std::string& script, std::string& svg) {
  svg.clear();
  const File in(std::tmpfile());
  const File out(std::tmpfile());
  if (!in || !out ||
      std::fwrite(script.data(), 1, script.size(), in.get()) != script.size()) {
    return true;
  }
  std::rewind(in.get());
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, fileno(in.get()), 0);
  posix_spawn_file_actions_adddup2(&files, fileno(out.get()), 1);
  posix_spawn_file_actions_addopen(&files, 2, "/dev/null", O_WRONLY, 0);
  // Without the user's settings.
  char name[] = "gnuplot";
  char option[] = "-d";
  char* arguments[] = {name, option, nullptr};
  pid_t process = 0;
  const int error =
      posix_spawnp(&process, name, &files, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) return false;
  int status = 0;
  if (waitpid(process, &status, 0) == process && WIFEXITED(status) &&
      WEXITSTATUS(status) == 0) {
    svg = ReadAll(out.get());
  }
  return true;
}

}  // namespace halfspace::bench
