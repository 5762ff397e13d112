#include "sweep/store/provenance.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

constexpr std::string_view header = "time_utc,event,design_id,attempt,rank,host,wall_s,cpu_s,program_version,ranks\n";

/// Appends in one write, so that lines of a crash are torn at most at their end.
void append_durably(const std::string& path, std::string_view text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  const char* action = "open";
  bool ok = file >= 0;
  if (ok) {
    action = "write";
    errno = ENOSPC;  // what a short write means
    ok = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  }
  if (ok) {
    action = "fdatasync";
    ok = ::fdatasync(file) == 0;
  }
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!ok) throw WriteError(fmt::format("{}: {} failed: {}", path, action, std::strerror(error)));
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool parse_line(std::string_view text, ProvenanceLine& line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = text.find(',', begin);
    cells.push_back(text.substr(begin, comma - begin));
    if (comma == std::string_view::npos) break;
    begin = comma + 1;
  }
  if (cells.size() != 10) return false;
  line.time_utc = cells[0];
  line.event = cells[1];
  line.design_id = cells[2];
  line.host = cells[5];
  line.program_version = cells[8];
  return parse(cells[3], line.attempt) && parse(cells[4], line.rank) && parse(cells[6], line.wall_s) &&
         parse(cells[7], line.cpu_s) && parse(cells[9], line.ranks);
}

/// Now, to the millisecond.
std::string time_text() {
  const auto ms = static_cast<long long>(now_s() * 1000);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(ms / 1000)), ms % 1000);
}

std::string whole_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

std::vector<ProvenanceLine> read_provenance(const std::string& path) {
  const std::string text = whole_text(path);
  std::vector<ProvenanceLine> lines;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    ProvenanceLine line;
    if (parse_line(std::string_view(text).substr(begin, end - begin), line)) lines.push_back(std::move(line));
  }
  return lines;
}

Provenance::Provenance(std::string path) : path_(std::move(path)), lines_(read_provenance(path_)) {
  for (const ProvenanceLine& line : lines_) index(line);
  const std::string text = whole_text(path_);
  if (text.empty()) append_durably(path_, header);
  if (!text.empty() && text.back() != '\n') append_durably(path_, "\n");
}

void Provenance::add(ProvenanceLine line) { add(std::vector{std::move(line)}); }

void Provenance::add(std::vector<ProvenanceLine> lines) {
  std::string text;
  for (ProvenanceLine& line : lines) {
    line.time_utc = time_text();
    line.program_version = DRUMSWEEP_VERSION;
    // As the file has them, so that this process knows what the next one will read.
    for (double* seconds : {&line.wall_s, &line.cpu_s}) *seconds = std::round(*seconds * 1000) / 1000;
    text += fmt::format("{},{},{},{},{},{},{:.3f},{:.3f},{},{}\n", line.time_utc, line.event, line.design_id,
                        line.attempt, line.rank, line.host, line.wall_s, line.cpu_s, line.program_version, line.ranks);
  }
  append_durably(path_, text);
  for (const ProvenanceLine& line : lines) index(line);
  std::move(lines.begin(), lines.end(), std::back_inserter(lines_));
}

void Provenance::index(const ProvenanceLine& line) {
  if (line.design_id.empty()) return;
  DesignHistory& design = histories_[line.design_id];
  design.open = line.event == "started";
  if (line.event == "started") {
    ++design.attempts;
  } else if (line.event == "crashed") {
    ++design.crashes;
  } else if (line.event == "lost") {
    design.lost.push_back(line.attempt);
  } else if (line.event != "aborted") {
    design.lost.clear();
    if (line.event == "retry") design.crashes = 0;
  }
}

const DesignHistory& Provenance::history(const std::string& design_id) const {
  static const DesignHistory none;
  const auto found = histories_.find(design_id);
  return found == histories_.end() ? none : found->second;
}

std::vector<std::string> Provenance::open_designs() const {
  std::vector<std::string> ids;
  for (const auto& [id, history] : histories_)
    if (history.open) ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

double seconds_of(const std::string& time_utc) {
  std::tm parts{};
  const char* rest = ::strptime(time_utc.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  int ms = 0;
  if (rest == nullptr || std::sscanf(rest, ".%3dZ", &ms) != 1) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(::timegm(&parts)) + 1e-3 * ms;
}

}  // namespace drumsweep
