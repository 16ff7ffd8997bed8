// Tries what a worker must not be able to do, in the sandbox of a job folder: that of a run (run) or of a
// check with a preview (check), one that writes below WRITABLE_FOLDER, or that which whoever started it has
// entered (within). Prints one line per attempt: its name and "done", or the error's name.
//
//   sandboxed JOB_FOLDER OUTSIDE_FOLDER run|check|within|WRITABLE_FOLDER
#include <fcntl.h>
#include <mqueue.h>
#include <netinet/in.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ipc.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/msg.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "engine/worker/job_folder.h"
#include "engine/worker/sandbox.h"

namespace {

using std::filesystem::path;

void attempt(const char* name, const std::function<bool()>& act) {
  errno = 0;
  const bool done = act();
  std::printf("%s: %s\n", name, done ? "done" : strerrorname_np(errno));
  std::fflush(stdout);
}

bool can_open(const path& file, int flags) {
  const int descriptor = open(file.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  close(descriptor);
  return true;
}

bool can_fork() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  return child > 0;
}

bool can_run_program() {
  char name[] = "/bin/true";
  char* const words[] = {name, nullptr};
  execv(name, words);
  return false;  // only reached when it failed
}

bool can_start_thread() {
  try {
    std::thread([] {}).join();
    return true;
  } catch (const std::system_error&) {
    return false;
  }
}

void use_files(const path& job, const path& outside) {
  attempt("read a system file", [] { return can_open("/etc/shadow", O_RDONLY); });
  attempt("list the root", [] { return can_open("/", O_RDONLY | O_DIRECTORY); });
  attempt("read another process", [] { return can_open("/proc/1/environ", O_RDONLY); });
  attempt("read outside", [&] { return can_open(outside / "secret", O_RDONLY); });
  attempt("read outside by dots",
          [&] { return can_open(job / ".." / outside.filename() / "secret", O_RDONLY); });
  attempt("write outside", [&] { return can_open(outside / "made", O_WRONLY | O_CREAT); });
  attempt("truncate outside", [&] { return truncate((outside / "secret").c_str(), 0) == 0; });
  attempt("remove outside", [&] { return unlink((outside / "secret").c_str()) == 0; });
  attempt("move in from outside",
          [&] { return rename((outside / "secret").c_str(), (job / "secret").c_str()) == 0; });
  attempt("change a mode outside", [&] { return chmod((outside / "secret").c_str(), 0777) == 0; });
  attempt("change a time outside",
          [&] { return utimensat(AT_FDCWD, (outside / "secret").c_str(), nullptr, 0) == 0; });
  attempt("link to outside",
          [&] { return symlink((outside / "secret").c_str(), (job / "link").c_str()) == 0; });
  attempt("make a device", [&] { return mknod((job / "device").c_str(), S_IFCHR | 0600, 0) == 0; });
  attempt("read a library", [] { return can_open("/etc/ld.so.cache", O_RDONLY); });
  attempt("read inside", [&] { return can_open(job / "input/scene.obj", O_RDONLY); });
  attempt("write a view", [&] { return can_open(job / "views/made", O_WRONLY | O_CREAT); });
  attempt("write inside", [&] { return can_open(job / "artefacts/made", O_WRONLY | O_CREAT); });
  attempt("rename inside",
          [&] { return rename((job / "artefacts/made").c_str(), (job / "artefacts/moved").c_str()) == 0; });
  attempt("write what is said", [&] { return can_open(job / "progress.ndjson", O_WRONLY | O_APPEND); });
  attempt("write what is checked", [&] { return can_open(job / "check.json", O_WRONLY | O_TRUNC); });
  attempt("make a preview", [&] { return can_open(job / "preview/made", O_WRONLY | O_CREAT); });
  attempt("link the input",
          [&] { return link((job / "input/scene.obj").c_str(), (job / "report.json").c_str()) == 0; });
  attempt("change the input", [&] { return can_open(job / "input/scene.obj", O_WRONLY); });
  attempt("cut the input", [&] { return can_open(job / "input/scene.obj", O_WRONLY | O_TRUNC); });
  attempt("add to the input", [&] { return can_open(job / "input/made", O_WRONLY | O_CREAT); });
  attempt("remove the input", [&] { return unlink((job / "input/scene.obj").c_str()) == 0; });
  attempt("rename the input", [&] { return rename((job / "input").c_str(), (job / "gone").c_str()) == 0; });
  attempt("write beside the input", [&] { return can_open(job / "made", O_WRONLY | O_CREAT); });
  attempt("replace the input",
          [&] { return rename((job / "artefacts/moved").c_str(), (job / "input/scene.obj").c_str()) == 0; });
}

void use_processes() {
  attempt("open a socket", [] { return socket(AF_INET, SOCK_STREAM, 0) >= 0; });
  attempt("open a unix socket", [] { return socket(AF_UNIX, SOCK_STREAM, 0) >= 0; });
  attempt("open a pair of sockets", [] {
    int ends[2];
    return socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0;
  });
  attempt("signal the parent", [] { return kill(getppid(), 0) == 0; });
  attempt("limit the parent", [] {
    rlimit limit{};
    return prlimit(getppid(), RLIMIT_CPU, nullptr, &limit) == 0;
  });
  attempt("limit itself", [] {
    rlimit limit{};
    return getrlimit(RLIMIT_CPU, &limit) == 0 && setrlimit(RLIMIT_CPU, &limit) == 0;
  });
  attempt("slow the parent", [] { return setpriority(PRIO_PROCESS, getppid(), 19) == 0; });
  attempt("move the parent", [] {
    cpu_set_t cores;
    return sched_getaffinity(getppid(), sizeof cores, &cores) == 0 &&
           sched_setaffinity(getppid(), sizeof cores, &cores) == 0;
  });
  attempt("reschedule the parent", [] {
    sched_param none{};
    return sched_setscheduler(getppid(), SCHED_BATCH, &none) == 0;
  });
  attempt("slow the parent's disk", [] { return syscall(SYS_ioprio_set, 1, getppid(), 3 << 13) == 0; });
  attempt("share memory", [] { return shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0600) >= 0; });
  attempt("make semaphores", [] { return semget(IPC_PRIVATE, 1, IPC_CREAT | 0600) >= 0; });
  attempt("make a queue", [] { return msgget(IPC_PRIVATE, IPC_CREAT | 0600) >= 0; });
  attempt("make a named queue",
          [] { return mq_open("/keylume-sandboxed", O_CREAT | O_RDWR, 0600, nullptr) >= 0; });
  attempt("have the parent signaled", [] {
    int ends[2];
    return pipe(ends) == 0 && fcntl(ends[0], F_SETOWN, getppid()) == 0;
  });
  attempt("choose a signal", [] {
    int ends[2];
    return pipe(ends) == 0 && fcntl(ends[0], F_SETSIG, SIGKILL) == 0;
  });
  attempt("mount", [] { return mount("none", "/mnt", "tmpfs", 0, "") == 0; });
  attempt("gain a user", [] { return setuid(getuid() + 1) == 0; });
  attempt("fork", can_fork);
  attempt("run a program", can_run_program);
  attempt("trace", [] { return ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0; });
  attempt("start a thread", can_start_thread);
  attempt("signal itself", [] { return kill(getpid(), 0) == 0; });
}

void use_limits(const path& job) {
  attempt("write a huge file", [&] {
    const int file = open((job / "artefacts/huge").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    const bool grown = ftruncate(file, off_t{1} << 39) == 0;
    close(file);
    return grown;
  });
  attempt("open many files", [] {
    for (int i = 0; i < 5000; ++i)
      if (open("/dev/null", O_RDONLY | O_CLOEXEC) < 0) return false;
    return true;
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 64;
  if (const std::string which = argv[3]; which != "within") {
    const auto in_force = which == "run"     ? engine::enter_sandbox(engine::rules_of_run(argv[1]))
                          : which == "check" ? engine::enter_sandbox(engine::rules_of_check(argv[1], true))
                                             : engine::enter_sandbox({.read = {argv[1]}, .write = {which}});
    if (!in_force) {
      std::fprintf(stderr, "%s\n", in_force.error().message.c_str());
      return 1;
    }
    std::printf("in force: %s\n", in_force->c_str());
  }
  use_files(argv[1], argv[2]);
  use_processes();
  use_limits(argv[1]);
  return 0;
}
