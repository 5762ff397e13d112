/// One finished design looked at closely, as in a column of S1's Fig. 9: where the balls landed, the bed they made, its
/// mean profile, its spectrum. From landings alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/config/study.h"
#include "core/state/landing.h"
#include "postproc/gnuplot.h"
#include "postproc/objective.h"

namespace drumsweep {

/// A landing in the frame that moves with the belt.
struct BeltLanding {
  double time_s = 0;                 ///< since the window began
  double along_m = 0, across_m = 0;  ///< along the strip [0, length), across from the belt's edge
  std::uint8_t exit = 0;             ///< see Exit: slot 1 ... n, or over the outlet's end
};

struct DesignSample {
  std::string title;                     ///< the study's name
  std::vector<std::string> notes;        ///< lines under it: which design, what to know about it
  double turns = 0, strip_length_m = 0;  ///< of belt that passed in these turns
  double belt_width_m = 0;
  double footprint_begin_m = 0, footprint_end_m = 0;  ///< y_1, y_2 of S1: what lies under the outlet
  bool footprint_counts = false;                      ///< the window of f is the footprint, else the whole belt
  std::int64_t num_slots = 0;
  std::vector<BeltLanding> landings;  ///< in their order
  Evaluation evaluation;
  std::vector<double> sigma_height_m;  ///< (cells across) standard error of the mean profile
};

/// @param study  of the design: with its values put in. @throws InputError as evaluate()
DesignSample design_sample(std::span<const Landing> landings, double t_begin, double turns, const Study& study);

/// Spectrum in the window of f: |a_n| / a_0, n = 0 ... N.
std::vector<double> mode_ratios(const DesignSample& sample);

/// File name -> CSV with units in the header: landings.csv, surface.csv, profile.csv, spectrum.csv.
std::map<std::string, std::string> sample_tables(const DesignSample& sample);

struct SampleLook {
  bool page = false;              ///< transparent, for a page; sample_for_page() sets it
  std::size_t most_landings = 0;  ///< draws every k-th landing so that no more are drawn, and says so; 0: all
  bool maps_only = false;         ///< landings and bed, without profile and spectrum
};

/// The column of four panels, as a gnuplot script that reads the tables above; picture.png or .svg.
FigureFiles sample_figure(const DesignSample& sample, const std::string& picture_name, const SampleLook& look = {});

struct SampleFiles {
  std::vector<std::string> names;
  std::string no_picture;  ///< why there is none (gnuplot is missing, or failed); empty: there is
};
/// Writes the tables, sample.png, sample.svg, and sample.gp, which draws sample.png from the tables, into a folder that
/// is there. Without gnuplot all but the pictures.
SampleFiles write_sample(const DesignSample& sample, const std::filesystem::path& folder);

/// The figure as an element of an HTML page, for light and dark; about 100 bytes a landing drawn.
std::string sample_for_page(const DesignSample& sample, const PageFigure& page, SampleLook look);

}  // namespace drumsweep
