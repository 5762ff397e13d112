#include "sweep/farm/farm.h"

#include <fmt/format.h>
// The C interface only: the old C++ one does not compile without warnings.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <list>
#include <stdexcept>
#include <thread>

namespace drumsweep {
namespace {

/// After a message the next one is likely: napping at once would bound the rate to one design a millisecond and rank.
constexpr auto wakeful = std::chrono::microseconds(500);
constexpr std::size_t piece = std::size_t{16} << 20;  // of a broadcast [bytes]

/// Number of processes that a launcher says it has started, 0 when there is no launcher. SLURM_NTASKS is not asked: it
/// is set for a batch script too, where one process is all there is.
int launched_size() {
  int size = 0;
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* text = std::getenv(name)) size = std::max(size, std::max(1, std::atoi(text)));
  for (const char* name : {"PMIX_RANK", "PMI_RANK"})
    if (std::getenv(name) != nullptr) size = std::max(size, 1);
  return size;
}

void check(int code, const char* what) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw std::runtime_error(fmt::format("MPI: {} failed: {}", what, text.data()));
}

}  // namespace

struct Farm::Impl {
  struct Pending {
    std::string body;
    MPI_Request request = MPI_REQUEST_NULL;
  };
  int rank = 0, size = 1;
  bool mpi = false, closed = false;
  pid_t parent = ::getppid();
  std::list<Pending> sending;  ///< a list: the buffers must not move
  std::chrono::steady_clock::time_point last_message{};

  void forget_sent() {
    for (auto it = sending.begin(); it != sending.end();) {
      int gone = 0;
      check(MPI_Test(&it->request, &gone, MPI_STATUS_IGNORE), "MPI_Test");
      it = gone != 0 ? sending.erase(it) : std::next(it);
    }
  }
};

Farm::Farm() : impl_(std::make_unique<Impl>()) {
  const int launched = launched_size();
  if (launched == 0) return;

  // Only the main thread communicates.
  int provided = 0;
  check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread");
  impl_->mpi = true;
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  check(MPI_Comm_rank(MPI_COMM_WORLD, &impl_->rank), "MPI_Comm_rank");
  check(MPI_Comm_size(MPI_COMM_WORLD, &impl_->size), "MPI_Comm_size");
  if (impl_->size == 1 && launched > 1) {
    MPI_Finalize();
    throw std::runtime_error(fmt::format(
        "the launcher has started {} processes, but they do not see each other, so each would run the whole "
        "sweep: launch with the mpirun of the MPI that drumsweep was built with (Open MPI), or with srun "
        "--mpi=pmix",
        launched));
  }
}

Farm::~Farm() {
  // Without close() others may be dead or busy, and ending MPI would wait for them: leave that to the launcher.
  if (impl_->mpi && impl_->closed) MPI_Finalize();
}

int Farm::rank() const { return impl_->rank; }
int Farm::size() const { return impl_->size; }

void Farm::close() {
  // The last messages must be out, but a dead peer must not keep us here.
  for (int i = 0; i < 2000 && !impl_->sending.empty(); ++i) {
    impl_->forget_sent();
    if (!impl_->sending.empty()) nap();
  }
  impl_->closed = impl_->sending.empty();
}

bool Farm::orphaned() const { return impl_->mpi && ::getppid() != impl_->parent; }
void Farm::nap() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

void Farm::rest() {
  if (std::chrono::steady_clock::now() - impl_->last_message < wakeful)
    std::this_thread::yield();
  else
    nap();
}

std::string Farm::host() const {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

void Farm::send(int to, Tag tag, const std::string& body) {
  Impl::Pending& pending = impl_->sending.emplace_back();
  pending.body = body;
  check(MPI_Isend(pending.body.data(), static_cast<int>(body.size()), MPI_BYTE, to, static_cast<int>(tag),
                  MPI_COMM_WORLD, &pending.request),
        "MPI_Isend");
}

void Farm::send_all(Tag tag, const std::string& body) {
  for (int to = 0; to < impl_->size; ++to)
    if (to != impl_->rank) send(to, tag, body);
}

std::optional<Message> Farm::poll() {
  if (!impl_->mpi) return std::nullopt;
  impl_->forget_sent();
  int there = 0;
  MPI_Message handle;
  MPI_Status status;
  check(MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &handle, &status), "MPI_Improbe");
  if (there == 0) return std::nullopt;

  // A long message arrives piecemeal while its sender is polling.
  int count = 0;
  check(MPI_Get_count(&status, MPI_BYTE, &count), "MPI_Get_count");
  Message message{status.MPI_SOURCE, static_cast<Tag>(status.MPI_TAG),
                  std::string(static_cast<std::size_t>(count), '\0')};
  MPI_Request request;
  check(MPI_Imrecv(message.body.data(), count, MPI_BYTE, &handle, &request), "MPI_Imrecv");
  for (int arrived = 0;;) {
    check(MPI_Test(&request, &arrived, MPI_STATUS_IGNORE), "MPI_Test");
    if (arrived != 0) {
      impl_->last_message = std::chrono::steady_clock::now();
      return message;
    }
    nap();
  }
}

void Farm::broadcast(std::string& bytes) {
  if (!impl_->mpi) return;
  for (std::size_t begin = 0; begin < bytes.size(); begin += piece) {
    const int count = static_cast<int>(std::min(piece, bytes.size() - begin));
    MPI_Request request;
    check(MPI_Ibcast(bytes.data() + begin, count, MPI_BYTE, 0, MPI_COMM_WORLD, &request), "MPI_Ibcast");
    for (int arrived = 0;;) {
      check(MPI_Test(&request, &arrived, MPI_STATUS_IGNORE), "MPI_Test");
      if (arrived != 0) break;
      if (orphaned()) throw std::runtime_error("mpirun has died during a broadcast");
      nap();
    }
  }
}

std::string mpi_library() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  check(MPI_Get_library_version(text.data(), &length), "MPI_Get_library_version");
  // "Open MPI v4.1.4, package: ..., ident: ..."
  const std::string whole = text.data();
  return whole.substr(0, whole.find_first_of(",\n"));
}

}  // namespace drumsweep
