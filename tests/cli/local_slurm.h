/// A real Slurm of one node with two CPUs, on this machine, on loopback, for as long as the object lives. Needs root and
/// the packages slurmctld, slurmd, slurm-client and munge.
#pragma once

#include <sys/stat.h>

#include <memory>
#include <optional>

#include "cli/program.h"

namespace drumsweep {

class LocalSlurm {
 public:
  /// Why there can be none here; empty when there can.
  static std::string missing() {
    if (::geteuid() != 0) return "starting a Slurm needs root";
    for (const char* name : {"/usr/sbin/slurmctld", "/usr/sbin/slurmd", "/usr/bin/sbatch", "/usr/sbin/munged"})
      if (!std::filesystem::exists(name)) return std::string(name) + " is not installed (cluster/packages_test.txt)";
    return "";
  }

  LocalSlurm() {
    write_configuration();
    // For all that is started from here, the job included; it also marks what has to be gone in the end.
    ::setenv("SLURM_CONF", conf().c_str(), 1);
    start({"/usr/sbin/munged", "--foreground", "--force", "--key-file=" + (folder_ / "key"),
           "--socket=" + (folder_ / "munge"), "--pid-file=" + (folder_ / "munged.pid"),
           "--log-file=" + (folder_ / "munged.log"), "--seed-file=" + (folder_ / "seed")});
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "munge"); }));
    start({"/usr/sbin/slurmctld", "-D"});
    start({"/usr/sbin/slurmd", "-D", "-N", "n1"});
    EXPECT_TRUE(eventually([&] { return ask({"sinfo", "-h", "-o", "%T"}) == "idle\n"; })) << file_text(folder_ / "log");
  }

  ~LocalSlurm() {
    ask({"scancel", "--user=root"});
    eventually([&] { return ask({"squeue", "-h"}).empty(); });
    daemons_.clear();
    kill_the_rest();
    ::unsetenv("SLURM_CONF");
  }
  LocalSlurm(const LocalSlurm&) = delete;
  LocalSlurm& operator=(const LocalSlurm&) = delete;

  /// Standard output of one of Slurm's commands; empty when it fails.
  std::string ask(std::vector<std::string> words) const {
    Program program(folder_, std::move(words));
    return program.wait() == 0 ? program.out() : "";
  }

  /// Id of the job, submitted from the folder.
  static std::string submit(const TestFolder& folder, std::vector<std::string> words) {
    words.insert(words.begin(), {"sbatch", "--parsable"});
    Program sbatch(folder, std::move(words));
    EXPECT_EQ(sbatch.wait(), 0) << sbatch.err();
    const std::string out = sbatch.out();
    return out.substr(0, out.find('\n'));
  }

  /// One value of `scontrol show job`: JobState, Reason, Restarts, ExitCode ...
  std::string about(const std::string& job, const std::string& key) const {
    const std::string text = " " + ask({"scontrol", "--oneliner", "show", "job", job});
    const std::size_t at = text.find(" " + key + "=");
    if (at == std::string::npos) return "";
    const std::size_t begin = at + key.size() + 2;
    return text.substr(begin, text.find(' ', begin) - begin);
  }

  /// Waits for the job to be in the queue again, and lets it start soon rather than after Slurm's delay, with time
  /// enough. Not within the second of the requeue: Slurm would kill it with "Job credential revoked". Asks repeatedly,
  /// as Slurm sets the delay once more when it has tidied up after the first start.
  bool restart_requeued(const std::string& job) const {
    if (eventually([&] { return about(job, "Restarts") == "1"; })) sleep_ms(3000);
    const bool restarted = eventually([&] {
      const std::string state = about(job, "JobState");
      if (state == "RUNNING" || state == "COMPLETED") return true;
      if (about(job, "Reason") == "BeginTime")
        ask({"scontrol", "update", "JobId=" + job, "StartTime=now", "TimeLimit=10"});
      return false;
    });
    EXPECT_TRUE(restarted) << ask({"scontrol", "show", "job", job}) << ask({"scontrol", "show", "node"})
                           << file_text(folder_ / "log");
    return restarted;
  }

  /// State in which the job has ended.
  std::string wait_for_end(const std::string& job) const {
    std::string state;
    EXPECT_TRUE(eventually([&] {
      state = about(job, "JobState");
      return !state.empty() && state != "PENDING" && state != "RUNNING" && state != "COMPLETING";
    })) << state
        << ", " << about(job, "Reason");
    return state;
  }

  /// Asks four times a second for at most a minute.
  static bool eventually(const std::function<bool()>& happened) {
    const auto begin = std::chrono::steady_clock::now();
    while (!happened()) {
      if (std::chrono::steady_clock::now() - begin > std::chrono::minutes(1)) return false;
      sleep_ms(250);
    }
    return true;
  }

 private:
  struct Daemon {
    TestFolder folder;
    Program program;
    explicit Daemon(std::vector<std::string> words) : program(folder, std::move(words)) {}
  };

  std::string conf() const { return folder_ / "slurm.conf"; }

  void start(std::vector<std::string> words) { daemons_.insert(daemons_.begin(), std::make_unique<Daemon>(words)); }

  void write_configuration() const {
    write_text(folder_ / "key", std::string(64, 'k'));
    ::chmod((folder_ / "key").c_str(), 0400);
    ::chmod(folder_.path.c_str(), 0755);
    std::string host(256, '\0');
    ::gethostname(host.data(), host.size() - 1);
    host = host.substr(0, std::min(host.find('.'), host.find('\0')));
    const int port = 20000 + 2 * (::getpid() % 6000);  // tests run side by side; below the ports given to clients
    write_text(conf(),
               "ClusterName=test\nSlurmctldHost=" + host +
                   "(127.0.0.1)\n"
                   "SlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\n"
                   "AuthInfo=socket=" +
                   (folder_ / "munge") +
                   ",cred_expire=5\n"
                   "CommunicationParameters=NoCtldInAddrAny,NoInAddrAny\nSlurmctldPort=" +
                   std::to_string(port) + "\nSlurmctldPidFile=" + (folder_ / "slurmctld.pid") +
                   "\nSlurmdPidFile=" + (folder_ / "slurmd.pid") + "\nStateSaveLocation=" + (folder_ / "state") +
                   "\nSlurmdSpoolDir=" + (folder_ / "spool") + "\nSlurmctldLogFile=" + (folder_ / "log") +
                   "\nSlurmdLogFile=" + (folder_ / "slurmd.log") +
                   "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n"
                   "JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\n"
                   "MpiDefault=none\nSelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n"
                   "ReturnToService=2\nJobRequeue=1\nKillWait=5\nSlurmdTimeout=10\n"
                   "SchedulerParameters=batch_sched_delay=0,sched_interval=1\nSlurmdParameters=config_overrides\n"
                   "NodeName=n1 NodeHostname=" +
                   host + " NodeAddr=127.0.0.1 Port=" + std::to_string(port + 1) +
                   " CPUs=2 RealMemory=1000\n"
                   "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n");
    std::filesystem::create_directory(folder_ / "state");
    std::filesystem::create_directory(folder_ / "spool");
  }

  /// A slurmstepd does not belong to its slurmd, nor do the processes of a job whose step was killed.
  void kill_the_rest() const {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
      const pid_t pid = std::atoi(entry.path().filename().c_str());
      if (pid > 1 && pid != ::getpid() &&
          file_text(entry.path().string() + "/environ").find("SLURM_CONF=" + conf()) != std::string::npos)
        ::kill(pid, SIGKILL);
    }
  }

  TestFolder folder_;
  std::vector<std::unique_ptr<Daemon>> daemons_;  ///< the last one started first
};

}  // namespace drumsweep
