// Stands in for ffmpeg, as one that has been taken over by the pictures it decodes: tries what it must not be
// able to do, and leaves what came of it as the video. Its last word is the output, "file:JOB/videos/NAME";
// after -i comes the input, "file:JOB/artefacts/images/CAMERA/%04d.png".
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace {

using std::filesystem::path;

std::ofstream out;

void attempt(const char* name, const std::function<bool()>& act) {
  errno = 0;
  const bool done = act();
  out << name << ": " << (done ? "done" : strerrorname_np(errno)) << std::endl;
}

bool can_open(const path& file, int flags) {
  const int descriptor = open(file.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  close(descriptor);
  return true;
}

bool can_run(const char* program) {
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    execl(program, program, nullptr);
    _exit(errno);
  }
  int status = 0;
  waitpid(child, &status, 0);
  errno = WEXITSTATUS(status);
  return status == 0;
}

/// Descriptors beside 0, 1 and 2, and `out`.
bool has_inherited_files() {
  int count = 0;
  for (int descriptor = 3; descriptor < 1024; ++descriptor) count += fcntl(descriptor, F_GETFD) >= 0;
  return count > 1;
}

std::string word_in(const path& file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(name + ":")) return line.substr(line.find_last_of(" \t") + 1);
  return "none";
}

void try_files(const path& job, const path& pictures, const path& data) {
  attempt("read a picture", [&] { return can_open(pictures / "0000.png", O_RDONLY); });
  attempt("write a picture", [&] { return can_open(pictures / "0000.png", O_WRONLY); });
  attempt("read the scene", [&] { return can_open(job / "input/scene.obj", O_RDONLY); });
  attempt("read the radiosity", [&] { return can_open(job / "artefacts/radiosity.npy", O_RDONLY); });
  attempt("write the radiosity", [&] { return can_open(job / "artefacts/radiosity.npy", O_WRONLY); });
  attempt("write another video", [&] { return can_open(job / "videos/other.mp4", O_WRONLY | O_CREAT); });
  attempt("write in the job", [&] { return can_open(job / "made", O_WRONLY | O_CREAT); });
  attempt("read the database", [&] { return can_open(data / "keylume.db", O_RDONLY); });
  attempt("write the database", [&] { return can_open(data / "keylume.db", O_WRONLY); });
  attempt("write outside", [&] { return can_open(data.parent_path() / "made", O_WRONLY | O_CREAT); });
  attempt("read the passwords", [] { return can_open("/etc/passwd", O_RDONLY); });
}

void try_processes() {
  attempt("open a socket", [] { return socket(AF_INET, SOCK_STREAM, 0) >= 0; });
  attempt("open a unix socket", [] { return socket(AF_UNIX, SOCK_STREAM, 0) >= 0; });
  attempt("run a program beside", [] { return can_run("/bin/true"); });
  attempt("run a program instead", [] {
    execl("/bin/true", "/bin/true", nullptr);
    return false;
  });
  attempt("run itself again", [] {
    execl("/proc/self/exe", "ffmpeg", nullptr);
    return false;
  });
  attempt("signal the server", [] { return kill(getppid(), 0) == 0; });
  attempt("inherit files", has_inherited_files);
  attempt("lead its own group", [] { return getpgrp() == getpid() && getsid(0) == getpid(); });
  attempt("start a thread", [] {
    std::thread([] {}).join();
    return true;
  });
  out << "no_new_privs: " << word_in("/proc/self/status", "NoNewPrivs") << "\n";
  rlimit core{}, files{};
  getrlimit(RLIMIT_CORE, &core);
  getrlimit(RLIMIT_NOFILE, &files);
  out << "core: " << core.rlim_max << "\nopen files: " << files.rlim_max << "\n";
}

path path_of(const std::string& word) {
  return word.substr(std::strlen("file:"));
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv, argv + argc);
  path pictures;
  for (std::size_t i = 1; i + 1 < words.size(); ++i)
    if (words[i] == "-i") pictures = path_of(words[i + 1]).parent_path();
  if (pictures.empty()) return 64;
  const path to = path_of(words.back()), job = to.parent_path().parent_path();
  out.open(to);
  if (!out) return 1;
  try_files(job, pictures, job.parent_path().parent_path());
  try_processes();
  return out.flush() ? 0 : 1;
}
