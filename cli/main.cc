/// drumsweep: design of the outlet of a balling drum by particle simulation.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "cli/commands.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "core/io/hdf5_image.h"
#include "core/io/snapshot.h"
#include "sweep/store/output_lock.h"

namespace {

int complain(const std::exception& error, int code) {
  fmt::print(stderr, "drumsweep: {}\n", error.what());
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace drumsweep;
  CLI::App app{
      "drumsweep - particle simulation of a balling drum and sweeps over its outlet's design.\n"
      "A study file (TOML) describes drum, outlet, belt, feed and balls, and the designs to compare; the objective f "
      "is the\n"
      "unevenness of the bed on the belt under the outlet, in metres (0 = even)."};
  app.set_version_flag("--version", DRUMSWEEP_VERSION);
  app.require_subcommand(1);
  app.footer(
      "First steps:\n"
      "  drumsweep init --preset quick study                a commented study file\n"
      "  drumsweep check study/quick.toml                   what it means and costs\n"
      "  mpirun -n 2 drumsweep run study/quick.toml -o out  run it; again = go on\n"
      "  drumsweep contour out -o contour.png               look at it\n"
      "Exit codes: 0 done, 2 bad usage or input, 3 stopped early (run again to go on), 4 finished but some designs "
      "failed,\n"
      "5 refused: does not match what is stored, 6 another run holds the output.");
  // "Stopped early, run again" makes sense for these only; elsewhere a file that cannot be read or written is bad input.
  const std::string command = argc > 1 ? argv[1] : "";
  const bool resumable = command == "run" || command == "simulate" || command == "diagnose";
  int exit_code = exit_done;
  add_init(app, exit_code);
  add_check(app, exit_code);
  add_run(app, exit_code);
  add_status(app, exit_code);
  add_plan(app, exit_code);
  add_why(app, exit_code);
  add_simulate(app, exit_code);
  add_contour(app, exit_code);
  add_sample(app, exit_code);
  add_rescore(app, exit_code);
  add_compare(app, exit_code);
  add_report(app, exit_code);
  add_bench(app, exit_code);
  add_picture(app, exit_code);
  add_export(app, exit_code);
  add_verify(app, exit_code);
  add_diagnose(app, exit_code);
  add_slurm(app, exit_code);
  add_doctor(app, exit_code);

  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_usage;
  } catch (const InputError& error) {
    return complain(error, exit_usage);
  } catch (const MismatchError& error) {
    return complain(error, exit_mismatch);
  } catch (const StoreError& error) {
    return complain(error, exit_mismatch);
  } catch (const LockHeldError& error) {
    return complain(error, exit_held);
  } catch (const WriteError& error) {
    return complain(error, resumable ? exit_stopped : exit_usage);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "drumsweep: out of memory; what is stored stays, run again with fewer ranks on a machine\n");
    return exit_stopped;
  } catch (const std::exception& error) {
    // The machine's trouble (MPI, gnuplot, a file that vanished): nothing stored is harmed.
    return complain(error, resumable ? exit_stopped : exit_usage);
  }
}
