/// Contours and the paper's sample designs, drawn by postproc.
#include <fmt/format.h>

#include "postproc/report/html.h"
#include "sweep/report/sections.h"

namespace drumsweep {

std::string contours_html(ReportData&) { return ""; }
std::string samples_html(const ReportData&) { return ""; }

}  // namespace drumsweep
