/// The sections of the report, each HTML from the data alone.
#pragma once

#include <string>

#include "sweep/report/report_data.h"

namespace drumsweep {

/// The answer in a sentence, what is missing in a banner, figures in a strip.
std::string header_html(const ReportData& data);

std::string asked_html(const ReportData& data);         ///< the study in words and numbers
std::string answer_html(ReportData& data);              ///< optimum, region, confirmation, its bed and spectrum
std::string contours_html(ReportData& data);            ///< f over the variables, by stage and together
std::string search_html(const ReportData& data);        ///< the runs in their order, decisions of the stages
std::string samples_html(ReportData& data);             ///< S1's sample points; empty where none is there
std::string drum_html(ReportData& data, bool picture);  ///< rendered picture, steadiness
std::string noise_html(const ReportData& data);         ///< replicates and sigma
std::string trouble_html(const ReportData& data);       ///< untrusted and failed designs
std::string solver_html(const ReportData& data);        ///< residual, overlap, force balance
std::string cost_html(const ReportData& data);          ///< core-hours, ranks, timeline
std::string designs_html(const ReportData& data);       ///< the table
std::string provenance_html(const ReportData& data);    ///< hosts, versions, checksums, how to do it again

/// Names and values of a row's variables.
std::vector<std::pair<std::string, double>> place_of_row(const ReportData& data, const ResultRow& row);
/// So many that each mark has to be said in few bytes.
bool many_runs(const ReportData& data);
/// What is said when the mark of a run is pointed at.
std::string run_tip(const ReportData& data, std::size_t row);

/// Landings, bed, profile and spectrum of one design as a figure. @param id  of this page only, ends in "-"
/// @param maps_only  landings and bed
std::string sample_html(const DetailedDesign& design, const std::string& id, const std::string& caption, bool maps_only,
                        ReportData& data);

}  // namespace drumsweep
