/// What every step of a diagnosis looks at: the data that are fitted, in rotated coordinates, and the models that may fit them.
#pragma once

#include <cstdint>

#include "diagnosis/model/fit.h"
#include "diagnosis/model/second_wave.h"

namespace drumsweep {

/// For tests of the tests: each of these must make the suite fail. The program never sets any.
struct Mutation {
  bool drop_simulation_noise = false, skip_refit = false, swap_labels = false, flip_sign = false,
       halve_covariance = false, skip_held_out = false, share_seeds = false;
};

struct DiagnosisOptions {
  std::int64_t seed = 1;
  int num_bootstraps = 1000;
  double alpha = 0.05;
  double adequate_level = 0.99;  ///< of a model's own Q
  double held_out_level = 0.01;
  int adequate_bootstraps = 300;
  bool details = true;  ///< steps that no verdict needs: detection limits, isolation, advice
  Mutation mutation{};
};

inline constexpr double rival_rise = 3.84;  ///< in Q: rivals as near as this stay in the set

class Inquiry {
 public:
  /// @param second_wave  what is better known close to some models  @throws InputError: no more data than free parameters
  Inquiry(const Problem& problem, const Emulator& emulator, const DiagnosisOptions& options,
          const std::vector<LocalRuns>& second_wave = {});

  const Problem& problem;
  const Emulator& emulator;
  const DiagnosisOptions options;
  int num_effects = 0;
  Eigen::MatrixXd covariance;        ///< of the measurements, in units of the emulator's scale
  std::vector<Eigen::Index> fitted;  ///< data that are fitted
  Eigen::VectorXd measured;          ///< (all data), in units of the scale
  Eigen::VectorXd centre;            ///< of the bench priors: 0
  /// Variance by which the campaign's emulator is off whatever the number of its runs (all data): what its residuals have more than
  /// those of the second wave. Empty without one; models with runs of their own do without it.
  Eigen::VectorXd lack_of_fit;
  ModelEmulator plain_emulator;
  SubModel plain_model;
  std::vector<SubModel> single_models;

  bool has_second_wave() const { return !corrections_.empty(); }
  bool listed(int effect) const { return problem.effects[static_cast<std::size_t>(effect)].listed; }
  /// With what the second wave says of this very model, which then stays near where that looked.
  ModelEmulator emulator_of(const std::vector<int>& effects) const;
  SubModel model(const std::vector<int>& effects) const;
  /// Measurement, simulation noise and lack of fit of some data as this emulator predicts them with v.
  Eigen::MatrixXd predictive_covariance(const ModelEmulator& of, double v,
                                        const std::vector<Eigen::Index>& outputs) const;
  /// As the campaign alone has it, so that two models can be compared.
  SubModel campaign_model(const std::vector<int>& effects) const { return viewed(emulator.of_model(effects)); }
  std::shared_ptr<const FitSpace> space_of(const std::vector<Eigen::Index>& outputs,
                                           const Eigen::MatrixXd& covariance_of_all) const;
  /// What was measured of the fitted data, in the model's rotated coordinates.
  Eigen::VectorXd seen_by(const SubModel& m) const;
  ModelFit fit_plain(const Eigen::VectorXd& data, const Eigen::VectorXd& prior_centre) const;

  /// Data and bench measurements as they could have been if `fit` were the truth.
  struct Drawn {
    Eigen::VectorXd z, centre;
  };
  Drawn draw(const SubModel& model, const ModelFit& fit, std::uint64_t index) const;

 private:
  SubModel viewed(const ModelEmulator& of) const;
  const LocalCorrection* correction_of(const std::vector<int>& effects) const;

  /// The campaign's noise first, then that of the second wave.
  std::vector<std::pair<std::shared_ptr<const Eigen::MatrixXd>, std::shared_ptr<const FitSpace>>> spaces_;
  std::vector<LocalCorrection> corrections_;
};

/// Distance in sigma of `truth` (noise-free, in the rival's rotated coordinates) to the nearest point of a model.
double distance_to(const SubModel& rival, const Eigen::VectorXd& truth, const Eigen::VectorXd& centre);

/// Part of the numbers that is at least x, counted with x itself: never 0.
double upper_tail(const std::vector<double>& draws, double x);

}  // namespace drumsweep
