/// Pages in a browser without a window.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdint>

#include "cli/program.h"

namespace drumsweep {

inline bool has_browser() {
  const TestFolder folder;
  return Program(folder, {"chromium", "--version"}).wait() == 0;
}

/// Runs the browser on a page; standard error has what the page says on its console.
inline Finished browse(const TestFolder& folder, const std::vector<std::string>& options, const std::string& page) {
  std::vector<std::string> words = {"chromium",
                                    "--headless",
                                    "--no-sandbox",
                                    "--disable-gpu",
                                    "--disable-dev-shm-usage",
                                    "--hide-scrollbars",
                                    "--enable-logging=stderr",
                                    "--v=0",
                                    "--allow-file-access-from-files",
                                    "--host-resolver-rules=MAP * ~NOTFOUND",
                                    "--user-data-dir=" + folder / "profile"};
  words.insert(words.end(), options.begin(), options.end());
  words.push_back("file://" + folder / page);
  Program program(folder, words);
  const int code = program.wait();
  return {code, program.out(), program.err()};
}

/// Shares of a PNG's bytes, as filtered, that differ from zero: near 0 for a picture of one colour.
inline double busy_share(const std::string& png) {
  std::string packed;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8u | static_cast<unsigned char>(png[at + i]);
    return value;
  };
  for (std::size_t at = 8; at + 12 <= png.size(); at += 12 + number(at))
    if (png.compare(at + 4, 4, "IDAT") == 0) packed += png.substr(at + 8, number(at));
  std::string bytes(std::size_t{200} << 20u, '\0');
  uLongf size = bytes.size();
  if (packed.empty() || uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                   reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK)
    return 0;
  const auto zeros = std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), '\0');
  return 1 - static_cast<double>(zeros) / static_cast<double>(size);
}

}  // namespace drumsweep
