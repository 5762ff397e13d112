#include "postproc/sample_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/io/durable_file.h"
#include "postproc/result_table.h"

namespace drumsweep {
namespace {

// Layout [pixels].
constexpr double width = 660, left = 88, plot_width = 430, graph_height = 190, title_height = 54, line_height = 21;
constexpr double panel_head = 36, key_height = 34, tics_height = 26, label_height = 34, foot = 14;

/// How the balls of an exit look: dark, middle, light and in shapes of their own, so that they differ without colour.
struct Mark {
  const char* colour;
  int shape;  ///< gnuplot's point type
};
constexpr std::array<Mark, 6> slot_marks = {
    {{"#16263d", 7}, {"#c2412d", 9}, {"#e8a93a", 5}, {"#2f7f6f", 11}, {"#7f5aa8", 13}, {"#8fb8d8", 15}}};
constexpr Mark end_mark = {"#8a8a8a", 1};

/// A panel from `top` down, and the canvas it is on.
struct Panel {
  double top, height, canvas;

  std::string margins() const {
    return fmt::format(
        "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n"
        "set bmargin at screen {:.5f}\n",
        left / width, (left + plot_width) / width, 1 - top / canvas, 1 - (top + height) / canvas);
  }
  /// Words above its left corner.
  std::string title(const std::string& words, double above = 12) const {
    return fmt::format("set label 1 {} at screen {:.5f},{:.5f} left\n", single_quoted(words), (left - 60) / width,
                       1 - (top - above) / canvas);
  }
};

std::string axis(const std::string& name, double low, double high, int most_tics) {
  const double step = nice_step((high - low) / most_tics);
  return fmt::format("set {0}range [{1:.9g}:{2:.9g}]\nset {0}tics {3:.9g}\nset format {0} '%.{4}f'\n", name, low, high,
                     step, decimals_of(step));
}

/// How much of the strip is shown: whole turns that make a panel no taller than this many widths, one at least.
double shown_turns(const DesignSample& sample) {
  constexpr double tallest = 1.25;
  const double whole = std::floor(tallest * sample.belt_width_m * sample.turns / sample.strip_length_m + 1e-9);
  return std::clamp(whole, std::min(1.0, sample.turns), sample.turns);
}

/// y_1 and y_2 of S1.
/// @param colour  dark on coloured ground, the page's ink elsewhere
std::string footprint_marks(const DesignSample& sample, const char* colour) {
  std::string text;
  int tag = 10;
  for (const double y : {sample.footprint_begin_m, sample.footprint_end_m})
    if (y > 0 && y < sample.belt_width_m)
      text += fmt::format(
          "set arrow {} from {:.9g},graph 0 to {:.9g},graph 1 nohead lw 1.2 dt (10,7) lc rgb '{}' "
          "front\n",
          tag++, y, y, colour);
  return text;
}

/// Balls by exit: slots, then those over the end.
std::vector<std::size_t> counts_by_exit(const DesignSample& sample) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(sample.num_slots) + 1, 0);
  for (const BeltLanding& landing : sample.landings)
    ++counts[landing.exit >= 1 && landing.exit <= sample.num_slots ? landing.exit - 1u : counts.size() - 1];
  return counts;
}

/// Where along one turn's strip a slot's landings lie, if they make a stripe: the mean direction on the circle.
std::vector<std::pair<std::size_t, double>> stripes(const DesignSample& sample) {
  std::vector<std::pair<std::size_t, double>> found;
  const double turn = sample.strip_length_m / sample.turns;
  for (std::size_t slot = 1; slot <= static_cast<std::size_t>(sample.num_slots); ++slot) {
    double c = 0, s = 0, n = 0;
    for (const BeltLanding& landing : sample.landings) {
      if (landing.exit != slot) continue;
      const double angle = 2 * std::numbers::pi * landing.along_m / turn;
      c += std::cos(angle);
      s += std::sin(angle);
      ++n;
    }
    constexpr double least_concentration = 0.25;
    if (n < 10 || std::hypot(c, s) < least_concentration * n) continue;
    const double angle = std::atan2(s, c);
    found.emplace_back(slot, turn * (angle < 0 ? angle / (2 * std::numbers::pi) + 1 : angle / (2 * std::numbers::pi)));
  }
  return found;
}

/// @param exit  0 ... num_slots - 1: slots; num_slots: over the end
std::string look_of(std::size_t exit, const DesignSample& sample, double size) {
  const bool end = exit == static_cast<std::size_t>(sample.num_slots);
  const Mark mark = end ? end_mark : slot_marks[exit % slot_marks.size()];
  return fmt::format("pt {} ps {:.2f} lw {} lc rgb '{}'", mark.shape, size, end ? 1.2 : 1.0, mark.colour);
}

std::string landings_panel(const DesignSample& sample, const Panel& panel, const SampleLook& look) {
  const double turns = shown_turns(sample), length = sample.strip_length_m * turns / sample.turns;
  const auto shown =
      static_cast<std::size_t>(std::count_if(sample.landings.begin(), sample.landings.end(),
                                             [&](const BeltLanding& landing) { return landing.along_m <= length; }));
  const std::size_t every =
      look.most_landings == 0 ? 1 : std::max<std::size_t>(1, (shown + look.most_landings - 1) / look.most_landings);

  std::string text = panel.margins();
  text += panel.title(fmt::format("(a) landings by slot; right: where one prevails{}{}",
                                  turns < sample.turns ? fmt::format("; {:g} of {:g} turns", turns, sample.turns) : "",
                                  every > 1 ? fmt::format("; one ball of {} is drawn", every) : ""),
                      30);
  text += axis("x", 0, sample.belt_width_m, 8) + axis("y", 0, length, 6);
  text += "set ylabel 'along the belt (m)'\nset xlabel ''\n" + footprint_marks(sample, "#505050");
  // Coloured marks keep a light ground of their own, the key's too.
  if (look.page)
    text += fmt::format(
        "set object 1 rectangle from graph 0,0 to graph 1,1 behind fc rgb '{0}' fs solid noborder\n"
        "set object 2 rectangle from screen {1:.5f},{2:.5f} to screen {3:.5f},{4:.5f} behind fc rgb '{0}' "
        "fs solid noborder\n",
        "#f6f6f3", left / width, 1 - (panel.top + panel.height + tics_height + key_height) / panel.canvas,
        (left + plot_width) / width, 1 - (panel.top + panel.height + tics_height + 10) / panel.canvas);
  // y_1 and y_2 by name; each stripe with the number of its slot in the margin.
  int tag = 20;
  for (const auto& [name, y] : {std::pair{"y₁", sample.footprint_begin_m}, {"y₂", sample.footprint_end_m}})
    if (y > 0 && y < sample.belt_width_m)
      text += fmt::format("set label {} '{}' at {:.9g},graph 1 center offset 0,0.5\n", tag++, name, y);
  for (const auto& [slot, place] : stripes(sample))
    for (double k = 0; k < turns; ++k)
      if (const double along = place + k * sample.strip_length_m / sample.turns; along <= length)
        text += fmt::format("set label {} 'slot {}' at graph 1.02,first {:.9g} left\n", tag++, slot, along);

  // Many balls are small dots; few are large enough to show their shapes.
  const double drawn = static_cast<double>(shown) / static_cast<double>(every);
  const double size = std::clamp(0.5 * std::sqrt(1400.0 / std::max(1.0, drawn)), 0.2, 0.6);
  const std::vector<std::size_t> counts = counts_by_exit(sample);
  const double all = std::max<double>(1, static_cast<double>(sample.landings.size()));
  std::string plot;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const bool end = k + 1 == counts.size();
    // The key, four in a row.
    const double column = 0.02 + 0.255 * static_cast<double>(k % 4), row = std::floor(static_cast<double>(k) / 4);
    text += fmt::format("set label {} '{} {:.0f} %' at screen {:.5f},{:.5f} left point {} offset 1,0{}\n", tag++,
                        end ? "end" : fmt::format("slot {}", k + 1), 100 * static_cast<double>(counts[k]) / all,
                        (left + column * plot_width) / width,
                        1 - (panel.top + panel.height + tics_height + 22 + 18 * row) / panel.canvas,
                        look_of(k, sample, 1.0), look.page ? " tc rgb '#101010'" : "");
    // An exit that no ball took has no points, of which gnuplot would complain.
    if (counts[k] > 0)
      plot += fmt::format("{}'landings.csv' skip 1 every {} using ($4=={}?$3:NaN):2 with points {} notitle",
                          plot.empty() ? "plot " : ", \\\n     ", every, end ? 0 : k + 1, look_of(k, sample, size));
  }
  if (plot.empty()) plot = "plot NaN notitle";
  return text + plot + "\nunset object\nunset label\nunset arrow\n";
}

std::string surface_panel(const DesignSample& sample, const Panel& panel, bool lowest) {
  const double turns = shown_turns(sample);
  std::string text = panel.margins() + panel.title("(b) bed on the belt, toppled to its friction angle");
  text += axis("x", 0, sample.belt_width_m, 8) + axis("y", 0, sample.strip_length_m * turns / sample.turns, 6);
  text += fmt::format("set ylabel 'along the belt (m)'\nset xlabel '{}'\n", lowest ? "across the belt (m)" : "");
  text += footprint_marks(sample, "#505050") + pale_viridis;
  const std::vector<double>& heights = sample.evaluation.bed.height_m;
  const double highest = 1e3 * *std::max_element(heights.begin(), heights.end());
  text += fmt::format("set cbrange [0:{:.6g}]\nset cblabel 'height (mm)'\n", highest > 0 ? highest : 1.0);
  text += fmt::format("set colorbox user origin {:.5f},{:.5f} size {:.5f},{:.5f}\n", (left + plot_width + 16) / width,
                      1 - (panel.top + panel.height) / panel.canvas, 16 / width, panel.height / panel.canvas);
  // Whole rows, as an SVG does not cut an image at the panel's edge.
  const BedGrid& grid = sample.evaluation.bed.grid;
  const double rows = std::round(grid.num_along * turns / sample.turns);
  return text + fmt::format(
                    "plot 'surface.csv' skip 1 every ::0::{:.0f} using 2:1:(1e3*$3) with image notitle\n"
                    "unset label\nunset arrow\n",
                    rows * grid.num_across - 1);
}

/// The mean that an even bed would have all over the window of f.
double even_height(const DesignSample& sample) {
  const Profile& window = sample.footprint_counts ? sample.evaluation.footprint : sample.evaluation.belt;
  double mean = 0;
  for (const double height : window.height_m) mean += height / static_cast<double>(window.height_m.size());
  return mean;
}

std::string profile_panel(const DesignSample& sample, const Panel& panel) {
  const Profile& belt = sample.evaluation.belt;
  double highest = 0;
  for (std::size_t i = 0; i < belt.height_m.size(); ++i)
    highest = std::max(
        highest, 1e3 * (belt.height_m[i] + (std::isfinite(sample.sigma_height_m[i]) ? sample.sigma_height_m[i] : 0.0)));
  const double top = highest > 0 ? 1.3 * highest : 1.0, mean = 1e3 * even_height(sample);
  const double from = sample.footprint_counts ? std::max(0.0, sample.footprint_begin_m) : 0.0;
  const double to =
      sample.footprint_counts ? std::min(sample.belt_width_m, sample.footprint_end_m) : sample.belt_width_m;
  std::string text = panel.margins() + panel.title("(c) height averaged over the turns, ± 1 sigma");
  text += axis("x", 0, sample.belt_width_m, 8) + axis("y", 0, top, 5);
  text += "set ylabel 'height (mm)'\nset xlabel 'across the belt (m)'\n" + footprint_marks(sample, "black");
  // The window that counts, and what an even bed would be in it.
  text += fmt::format(
      "set arrow 20 from {0:.9g},graph 0.88 to {1:.9g},graph 0.88 heads size screen 0.008,90 lw 1.6 lc rgb "
      "'black'\nset label 20 'window of f' at {2:.9g},graph 0.88 center offset 0,0.6\n",
      from, to, 0.5 * (from + to));
  text += fmt::format(
      "set arrow 21 from {0:.9g},{2:.6g} to {1:.9g},{2:.6g} nohead lw 1.4 dt (8,6) lc rgb 'black'\n"
      "set label 21 'even bed' at graph 1.02,first {2:.6g} left\n",
      from, to, mean);
  return text +
         "plot 'profile.csv' skip 1 using 1:(1e3*($2-$3)):(1e3*($2+$3)) with filledcurves fs solid 0.45 noborder lc "
         "rgb "
         "'#8bb2c1' notitle, \\\n     'profile.csv' skip 1 using 1:(1e3*$2) with linespoints pt 7 ps 0.35 lw 2 lc rgb "
         "'#3f87b5' notitle\nunset label\nunset arrow\n";
}

std::string spectrum_panel(const DesignSample& sample, const Panel& panel) {
  const std::vector<double> ratios = mode_ratios(sample);
  double highest = 0;
  for (std::size_t n = 1; n < ratios.size(); ++n) highest = std::max(highest, ratios[n]);
  const double last = static_cast<double>(ratios.size()) - 0.5;
  std::string text = panel.margins() + panel.title("(d) modes of the height in the window of f");
  text += axis("x", 0.5, last, 10) + axis("y", 0, std::max(0.13, 1.1 * highest), 5);
  text += fmt::format("set xtics {}\nset format x '%.0f'\n", ratios.size() > 12 ? 2 : 1);
  text += "set ylabel '|aₙ| / a₀'\nset xlabel 'mode n'\n";
  text += fmt::format(
      "set arrow 20 from {:.6g},0.1 to {:.6g},0.1 nohead lw 1.8 dt (12,7) lc rgb 'black'\n"
      "set label 20 'a₀/10' at graph 1.02,first 0.1 left\n",
      0.5, last);
  return text +
         "plot 'spectrum.csv' skip 2 using 1:4 with impulses lw 5 lc rgb '#3f87b5' notitle\nunset label\nunset arrow\n";
}

std::string csv_of_landings(const DesignSample& sample) {
  std::string csv = "time_s,along_m,across_m,slot\n";
  for (const BeltLanding& landing : sample.landings)
    csv += fmt::format("{:.6f},{:.6f},{:.6f},{}\n", landing.time_s, landing.along_m, landing.across_m,
                       landing.exit >= 1 && landing.exit <= sample.num_slots ? landing.exit : 0);
  return csv;
}

std::string csv_of_surface(const DesignSample& sample) {
  const Bed& bed = sample.evaluation.bed;
  std::string csv = "along_m,across_m,height_m\n";
  for (int i = 0; i < bed.grid.num_along; ++i)
    for (int j = 0; j < bed.grid.num_across; ++j)
      csv += fmt::format("{:.6f},{:.6f},{}\n", (i + 0.5) * bed.grid.cell_along_m, (j + 0.5) * bed.grid.cell_across_m,
                         csv_number(bed.height_m[bed.index(i, j)]));
  return csv;
}

std::string csv_of_profile(const DesignSample& sample) {
  const Profile &belt = sample.evaluation.belt, &footprint = sample.evaluation.footprint;
  const double end = footprint.y_begin_m + footprint.cell_m * static_cast<double>(footprint.height_m.size());
  std::string csv = "across_m,height_m,sigma_height_m,under_outlet\n";
  for (std::size_t i = 0; i < belt.height_m.size(); ++i) {
    const double y = belt.centre_m(i);
    csv += fmt::format("{:.6f},{},{},{}\n", y, csv_number(belt.height_m[i]), csv_number(sample.sigma_height_m[i]),
                       y > footprint.y_begin_m && y < end ? 1 : 0);
  }
  return csv;
}

std::string csv_of_spectrum(const DesignSample& sample) {
  const std::vector<double> ratios = mode_ratios(sample);
  const std::vector<double>& moduli =
      sample.footprint_counts ? sample.evaluation.footprint_amplitudes_m : sample.evaluation.belt_amplitudes_m;
  const Profile& window = sample.footprint_counts ? sample.evaluation.footprint : sample.evaluation.belt;
  const double window_m = window.cell_m * static_cast<double>(window.height_m.size());
  std::string csv = "mode,wavelength_m,amplitude_m,amplitude_over_a0\n";
  for (std::size_t n = 0; n < moduli.size(); ++n)
    csv += fmt::format("{},{},{},{}\n", n, csv_number(n == 0 ? std::nan("") : window_m / static_cast<double>(n)),
                       csv_number(moduli[n]), csv_number(ratios[n]));
  return csv;
}

}  // namespace

DesignSample design_sample(std::span<const Landing> landings, double t_begin, double turns, const Study& study) {
  DesignSample out;
  out.title = study.name;
  out.turns = turns;
  out.evaluation = evaluate_in_detail(landings, t_begin, turns, study);
  const BedGrid& grid = out.evaluation.bed.grid;
  out.strip_length_m = grid.cell_along_m * grid.num_along;
  out.belt_width_m = study.belt.width_m;
  out.footprint_begin_m = study.belt.outlet_begin_m;
  out.footprint_end_m = study.belt.outlet_begin_m +
                        study.outlet.length_m * std::cos(study.drum.inclination_deg * std::numbers::pi / 180.0);
  out.footprint_counts = study.objective.window == "footprint";
  out.num_slots = study.outlet.num_slots;
  out.sigma_height_m = standard_error(out.evaluation.belt_blocks);
  const double duration = duration_of_turns(turns, study.drum);
  for (const Landing& landing : landings)
    if (landing.time >= t_begin && landing.time < t_begin + duration)
      out.landings.push_back({landing.time - t_begin, place_on_strip(landing, t_begin, study.belt, out.strip_length_m),
                              landing.y, landing.exit});
  return out;
}

std::vector<double> mode_ratios(const DesignSample& sample) {
  std::vector<double> ratios =
      sample.footprint_counts ? sample.evaluation.footprint_amplitudes_m : sample.evaluation.belt_amplitudes_m;
  const double a0 = ratios.empty() ? 0.0 : ratios.front();
  for (double& ratio : ratios) ratio = a0 > 0 ? ratio / a0 : 0.0;
  return ratios;
}

std::map<std::string, std::string> sample_tables(const DesignSample& sample) {
  return {{"landings.csv", csv_of_landings(sample)},
          {"surface.csv", csv_of_surface(sample)},
          {"profile.csv", csv_of_profile(sample)},
          {"spectrum.csv", csv_of_spectrum(sample)}};
}

FigureFiles sample_figure(const DesignSample& sample, const std::string& picture_name, const SampleLook& look) {
  std::vector<std::string> notes;
  for (const std::string& note : sample.notes)
    for (std::string& line : wrapped(note, 84)) notes.push_back(std::move(line));
  const double shown = sample.strip_length_m * shown_turns(sample) / sample.turns;
  const double map_height = plot_width * std::clamp(shown / sample.belt_width_m, 0.4, 1.6);
  // From top to bottom: each panel has its words above and its numbers below.
  double at = title_height + line_height * static_cast<double>(notes.size()) + panel_head + 18;
  std::array<Panel, 4> panels{};
  panels[0] = {at, map_height, 0};
  at += map_height + tics_height + panel_head + key_height * std::ceil((static_cast<double>(sample.num_slots) + 1) / 4);
  panels[1] = {at, map_height, 0};
  at += map_height;
  if (!look.maps_only) {
    panels[2] = {at + tics_height + panel_head, graph_height, 0};
    panels[3] = {panels[2].top + graph_height + tics_height + label_height + panel_head, graph_height, 0};
    at = panels[3].top + graph_height;
  }
  const double canvas = std::round(at + tics_height + label_height + foot);
  for (Panel& panel : panels) panel.canvas = canvas;

  std::string first = terminal(picture_name, static_cast<int>(width), static_cast<int>(canvas));
  if (look.page) first.replace(first.find(" background 'white'"), 19, "");
  std::string script = fmt::format(
      "# One design: landings, bed, mean profile, spectrum.\n# Run gnuplot in this folder; reads landings.csv, "
      "surface.csv, profile.csv and spectrum.csv, writes {}.\n{}set datafile separator ','\nset tics out nomirror\n"
      "set border 3 lw 1.2\nset multiplot\nunset key\n",
      single_quoted(picture_name), first);
  script += fmt::format("set label 1000 {} at screen 0.5,{:.5f} center font ',{}'\n",
                        single_quoted(shortened(sample.title, 60)), 1 - 0.5 * title_height / canvas,
                        font_size(picture_name, 13));
  for (std::size_t k = 0; k < notes.size(); ++k)
    script += fmt::format("set label {} {} at screen 0.5,{:.5f} center\n", 1001 + k, single_quoted(notes[k]),
                          1 - (title_height + line_height * (static_cast<double>(k) + 0.2)) / canvas);
  script += landings_panel(sample, panels[0], look) + surface_panel(sample, panels[1], look.maps_only);
  if (!look.maps_only) script += profile_panel(sample, panels[2]) + spectrum_panel(sample, panels[3]);
  script += "unset multiplot\n";
  return {script, sample_tables(sample)};
}

SampleFiles write_sample(const DesignSample& sample, const std::filesystem::path& folder) {
  SampleFiles files;
  const auto write = [&](const std::string& name, const std::string& text) {
    write_durably(folder / name, text);
    files.names.push_back(name);
  };
  for (const auto& [name, text] : sample_tables(sample)) write(name, text);
  write("sample.gp", sample_figure(sample, "sample.png").script);
  // Enough points for the eye; the picture in pixels has them all.
  constexpr std::size_t most_in_svg = 8000;
  for (const char* picture : {"sample.png", "sample.svg"}) {
    const SampleLook look{.most_landings = picture == std::string("sample.svg") ? most_in_svg : 0};
    std::string drawn;
    try {
      drawn = draw(sample_figure(sample, picture, look), picture);
    } catch (const std::runtime_error& error) {
      files.no_picture = error.what();
      break;
    }
    write(picture, drawn);
  }
  return files;
}

std::string sample_for_page(const DesignSample& sample, const PageFigure& page, SampleLook look) {
  look.page = true;
  return for_page(draw(sample_figure(sample, "figure.svg", look), "figure.svg"), page);
}

}  // namespace drumsweep
