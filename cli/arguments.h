/// Checks of arguments that several commands share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace drumsweep {

/// Accepts numbers from low to high; unlike CLI::Range not NaN.
CLI::Validator number_between(double low, double high);

/// --set KEY=VALUE, any number of times: for read_study().
void add_set_option(CLI::App& command, std::vector<std::string>& changes);

/// Before long work: whether a file can be written there. @throws InputError naming the folder that is missing or closed
void need_place_for(const std::string& file);

}  // namespace drumsweep
