/// The one TOML reader: study text or file -> Study, and Study -> commented text.
#pragma once

#include <string>

#include "core/config/study.h"

namespace drumsweep {

/// Reads and validates a study.
/// @throws InputError: missing file; TOML error with line and column; unknown key with "did you mean"; wrong type or
/// range.
Study read_study(const std::string& path);

/// The same from text; `source` names it in messages. Keys that the text leaves out are those of `base`.
Study parse_study(const std::string& text, const std::string& source, const Study& base = {});

/// The study as TOML with every key written out, each with its help and accepted range as a comment when `comments`.
/// parse_study(write_study(s)) gives back s exactly.
std::string write_study(const Study& study, bool comments);

}  // namespace drumsweep
