/// A campaign of milliseconds: one ball on inclines. With rolling resistance it rolls with 5/7 g (sin - mu_r cos).
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

namespace drumsweep {

inline std::string small_scene() {
  return "[scene]\ntype = \"incline\"\nangle_deg = 20.0\nduration_s = 0.12\nfit_from_s = 0.04\n[material]\nfriction = "
         "0.8\n"
         "[solver]\nouter_step_s = 0.002\nsub_steps = 1\niterations = 20\n";
}

inline std::string small_campaign_text(int runs = 40) {
  std::string out = fmt::format(
      "name = \"incline\"\nseed = 3\nruns = {}\nnumerics_runs = 2\nbootstraps = 199\nstudy = \"study.toml\"\n"
      "candidates = [\"rolling_resistance\", \"twisting_resistance\", \"sensor_bias:acceleration\"]\n"
      "[[parameter]]\nid = \"friction\"\nkey = \"material.friction\"\nmean = 0.8\nsigma = 0.02\n",
      runs);
  for (int angle = 20; angle <= 42; angle += 2)
    out += fmt::format(
        "[[condition]]\nid = \"at_{0}\"\nfile = \"incline.toml\"\nset = {{ \"scene.angle_deg\" = {0}.0 }}\n{1}", angle,
        angle % 4 == 2 ? "held_out = true\n" : "");
  return out;
}

/// @param rolling  what is hidden
inline std::string small_data(double rolling) {
  std::string out = "condition,quantity,position,value,sigma,unit,use\n";
  for (int angle = 20; angle <= 42; angle += 2) {
    const double a = angle * std::numbers::pi / 180, ripple = 0.03 * std::sin(7.0 * angle);
    out += fmt::format("at_{},acceleration,,{:.5f},0.05,m/s2,{}\n", angle,
                       5.0 / 7 * 9.80665 * (std::sin(a) - rolling * std::cos(a)) + ripple,
                       angle % 4 == 2 ? "holdout" : "fit");
  }
  return out;
}

inline void put(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

inline void write_small_campaign(const std::string& folder, double rolling, int runs = 40) {
  std::filesystem::create_directories(folder);
  put(folder + "/campaign.toml", small_campaign_text(runs));
  put(folder + "/incline.toml", small_scene());
  put(folder + "/measured.csv", small_data(rolling));
  put(folder + "/study.toml", "name = \"drum\"\n[outlet]\nopening_angle_deg = 0.2\n");
}

}  // namespace drumsweep
