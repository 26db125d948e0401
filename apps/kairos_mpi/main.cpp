// kairos-mpi: `kairos render` on the ranks of an MPI job. Rank 0 hands out parts of the job, one to each rank that
// asks, takes some itself, and merges them at the end. Parts are those of `kairos render --part`; each rank has one
// kairos, which keeps the scene and is told of parts on its standard input. What is there already is not rendered
// again, so that a job which lost a rank is run again, and goes on.
//
// Two-sided messages alone: one-sided ones make no progress over TCP while the other side computes.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <mpi.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace {

constexpr int kFailed = 1, kBadUsage = 2;
constexpr int kNoPart = -1;               ///< nothing is left to do
constexpr int kRequest = 1, kAnswer = 2;  ///< tags: a rank's failures so far; a part's index
constexpr int kMostParts = 65536;
constexpr auto kNap = std::chrono::milliseconds(1);  // between looks at messages and at the own part

struct Job {
  std::string kairos = "kairos";    ///< the program
  std::vector<std::string> render;  ///< its arguments, "render" first
  std::vector<std::string> outs;    ///< what of them says where pictures go
  std::string frames;
  int parts = 0;
};

int usage(const std::string& why) {
  std::fprintf(stderr,
               "kairos-mpi: %s; mpirun ... kairos-mpi [--parts N] [--kairos PROGRAM] render SCENE ... -o OUT [...]\n",
               why.c_str());
  return kBadUsage;
}

/// Empty where the arguments are right, else what is wrong.
std::string parse(int argc, char** argv, int ranks, Job& job) {
  int i = 1;
  for (; i + 1 < argc && std::string(argv[i]) != "render"; i += 2) {
    const std::string option = argv[i];
    if (option == "--kairos") {
      job.kairos = argv[i + 1];
    } else if (option == "--parts") {
      char* end = nullptr;
      const long parts = std::strtol(argv[i + 1], &end, 10);
      if (*end != '\0' || parts < 1 || parts > kMostParts) return "--parts takes a number from 1 to 65536";
      job.parts = static_cast<int>(parts);
    } else {
      return "'" + option + "' is not known";
    }
  }
  if (i >= argc || std::string(argv[i]) != "render") return "what it runs is 'render'";
  job.render.assign(argv + i, argv + argc);
  for (size_t k = 1; k + 1 < job.render.size(); ++k) {
    for (const char* name : {"-o", "--output", "--time"})
      if (job.render[k] == name) job.outs.push_back(job.render[k + 1]);
    if (job.render[k] == "--frames") job.frames = job.render[k + 1];
    if (job.render[k] == "--part") return "it chooses --part itself";
  }
  if (job.outs.empty()) return "the picture's name is missing";
  constexpr int kPartsOfRank = 4;  // so that ranks end at much the same time, and most of the time is rendering's
  if (job.parts == 0) job.parts = std::min(kMostParts, kPartsOfRank * ranks);
  return "";
}

/// A kairos that runs, and what it reads and says.
class Process {
 public:
  Process(const std::string& program, const std::vector<std::string>& arguments) {
    std::vector<char*> argv = {const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    int input[2], output[2];
    if (pipe2(input, O_CLOEXEC) != 0 || pipe2(output, O_CLOEXEC) != 0) throw std::bad_alloc();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output[1], STDOUT_FILENO);
    if (posix_spawnp(&id_, program.c_str(), &actions, nullptr, argv.data(), environ) != 0) {
      std::fprintf(stderr, "kairos-mpi: '%s' cannot be run; give --kairos PROGRAM\n", program.c_str());
      id_ = 0;
    }
    posix_spawn_file_actions_destroy(&actions);
    close(input[0]);
    close(output[1]);
    input_ = input[1];
    output_ = output[0];
  }
  ~Process() { end(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void say(const std::string& line) const {
    [[maybe_unused]] const auto written =
        write(input_, line.data(), line.size());  // it may have ended: then it is mute
  }
  /// Unset while it says nothing; true when it has said a line, false when it has ended.
  std::optional<bool> answered(bool wait) const {
    pollfd waiting{output_, POLLIN, 0};
    if (poll(&waiting, 1, wait ? -1 : 0) <= 0) return std::nullopt;
    char byte = 0;
    do {
      if (read(output_, &byte, 1) != 1) return false;
    } while (byte != '\n');
    return true;
  }
  /// Lets it come to its end; true when that was a good one.
  bool end() {
    if (input_ < 0) return false;
    close(input_);
    close(output_);
    input_ = -1;
    int status = 0;
    return id_ != 0 && waitpid(id_, &status, 0) == id_ && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

 private:
  pid_t id_ = 0;
  int input_ = -1, output_ = -1;
};

/// Renders parts, one after the other. The scene stays, but where a part failed: there the next one begins anew.
class Renderer {
 public:
  explicit Renderer(const Job& job) : job_(job) {}

  void begin(int part) {
    std::vector<std::string> arguments = job_.render;
    arguments.insert(arguments.end(), {"--part", "-", "--quiet"});
    if (!process_) process_.emplace(job_.kairos, arguments);
    process_->say(std::to_string(part + 1) + "/" + std::to_string(job_.parts) + "\n");
  }
  /// Unset while it renders; true when that ended well.
  std::optional<bool> ended(bool wait) {
    const std::optional<bool> well = process_->answered(wait);
    if (well && !*well) process_.reset();
    return well;
  }

 private:
  const Job& job_;
  std::optional<Process> process_;
};

/// Asks for parts until there are none.
void work(const Job& job) {
  Renderer renderer(job);
  for (int failures = 0;;) {
    MPI_Send(&failures, 1, MPI_INT, 0, kRequest, MPI_COMM_WORLD);
    int part = kNoPart;
    MPI_Recv(&part, 1, MPI_INT, 0, kAnswer, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (part == kNoPart) return;
    renderer.begin(part);
    failures = renderer.ended(true).value_or(false) ? 0 : 1;
  }
}

/// Hands out the parts; how many of them failed.
int manage(const Job& job, int ranks) {
  int next = 0, failures = 0, workers = ranks - 1, done = 0;
  Renderer own(job);
  bool renders = false;
  const auto finished = [&](int failed) {
    failures += failed;
    std::fprintf(stderr, "%d of %d parts\n", ++done, job.parts);
  };
  std::vector<bool> busy(static_cast<size_t>(ranks));
  while (workers > 0 || renders || next < job.parts) {
    if (renders)
      if (const auto well = own.ended(false)) {
        renders = false;
        finished(*well ? 0 : 1);
      }
    if (!renders && next < job.parts) {
      own.begin(next++);
      renders = true;
    }
    int waits = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kRequest, MPI_COMM_WORLD, &waits, &status);
    if (!waits) {
      std::this_thread::sleep_for(kNap);
      continue;
    }
    const int rank = status.MPI_SOURCE;
    int failed = 0;
    MPI_Recv(&failed, 1, MPI_INT, rank, kRequest, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (busy[static_cast<size_t>(rank)]) finished(failed);
    const int part = next < job.parts ? next++ : kNoPart;
    busy[static_cast<size_t>(rank)] = part != kNoPart;
    if (part == kNoPart) --workers;
    MPI_Send(&part, 1, MPI_INT, rank, kAnswer, MPI_COMM_WORLD);
  }
  return failures;
}

int merge(const Job& job) {
  std::vector<std::string> arguments = {"merge", "--clean"};
  arguments.insert(arguments.end(), job.outs.begin(), job.outs.end());
  if (!job.frames.empty()) arguments.insert(arguments.end(), {"--frames", job.frames});
  return Process(job.kairos, arguments).end() ? 0 : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a kairos that has ended is told of by what it no longer says
  MPI_Init(&argc, &argv);
  int rank = 0, ranks = 1, status = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  Job job;
  if (const std::string wrong = parse(argc, argv, ranks, job); !wrong.empty()) {
    status = rank == 0 ? usage(wrong) : kBadUsage;
  } else if (rank != 0) {
    work(job);
  } else if (const int failures = manage(job, ranks); failures > 0) {
    std::fprintf(stderr, "kairos-mpi: %d of %d parts failed; their messages are above. Run it again for those alone\n",
                 failures, job.parts);
    status = kFailed;
  } else {
    status = merge(job);
  }
  MPI_Finalize();
  return status;
}
