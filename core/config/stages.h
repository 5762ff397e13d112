/// [[stage]] tables of a study: reading, writing, validation, and the ranges that a search has.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "core/config/schema.h"

namespace drumsweep {

/// One [[stage]] table. A list of points may stand in a CSV file beside the study (key `file`): its first line names
/// keys of the study, or their last part; the values become part of the study. @throws InputError with place and key
StageConfig read_stage(const toml::table& node, const std::string& source);

/// The same as TOML.
std::string write_stage(const StageConfig& stage);

/// Known names, sizes and ranges; every end of a range must be an accepted value. @throws InputError
void validate_stages(const Study& study, const Where& where);

/// Does the stage decide from the results of earlier ones?
bool is_search(const StageConfig& stage);

/// A key that says how a design is measured (record.turns, record.replicate), not what it is.
bool is_measuring_key(const std::string& key);

/// Ranges of a search: its own variables, or everything that the earlier stages vary, each over all values that occur
/// there. Stage number num_stages stands for a search after the last. The resolution is filled in: 1/200 of the range, rounded down to 1, 2 or 5 times a power of ten.
std::vector<StageVariable> search_ranges(const Study& study, std::size_t stage);

}  // namespace drumsweep
