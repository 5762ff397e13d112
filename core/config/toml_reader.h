/// The one TOML reader: study text or file -> Study, and Study -> commented text.
#pragma once

#include <string>
#include <vector>

#include "core/config/study.h"

namespace drumsweep {

/// Reads and validates a study.
/// @throws InputError: missing file; TOML error with line and column; unknown key with "did you mean"; wrong type or
/// range.
/// @param changes  of the command line, see changed_study()
Study read_study(const std::string& path, const std::vector<std::string>& changes = {});

/// The same from text; `source` names it in messages. Keys that the text leaves out are those of `base`.
Study parse_study(const std::string& text, const std::string& source, const Study& base = {});

/// The study with keys changed, all at once, from a command line: "belt.speed_m_s=0.1". The value is TOML, or else a
/// text. An opening angle in the other unit takes the place of the study's.
/// @param source  names the option in messages. @throws InputError as parse_study(); for stages and what they vary
Study changed_study(const Study& study, const std::vector<std::string>& changes, const std::string& source);

/// The study as TOML with every key written out, each with its help and accepted range as a comment when `comments`.
/// parse_study(write_study(s)) gives back s exactly.
std::string write_study(const Study& study, bool comments);

}  // namespace drumsweep
