#include "engine/worker/system_calls.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "engine/worker/supervision.h"

namespace engine {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;
#endif

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW;
constexpr std::uint32_t kRefuse = SECCOMP_RET_ERRNO | EPERM;
// glibc then falls back to clone, whose flags a filter can see.
constexpr std::uint32_t kUnknown = SECCOMP_RET_ERRNO | ENOSYS;
constexpr std::uint32_t kFirstX32Call = 0x40000000;  // the same calls under other numbers

constexpr std::uint32_t kRefused[] = {
    // sockets, and the ring that opens them without a call
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_io_uring_setup,
    SYS_io_uring_enter,
    SYS_io_uring_register,
    // other processes
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_tkill,
    SYS_kcmp,
    SYS_sched_setaffinity,
    SYS_sched_setattr,
    SYS_sched_setparam,
    SYS_sched_setscheduler,
    SYS_setpriority,
    SYS_ioprio_set,
    SYS_migrate_pages,
    SYS_move_pages,
    // what processes of a user share: memory, semaphores, queues
    SYS_shmget,
    SYS_shmat,
    SYS_shmctl,
    SYS_semget,
    SYS_semop,
    SYS_semtimedop,
    SYS_semctl,
    SYS_msgget,
    SYS_msgsnd,
    SYS_msgrcv,
    SYS_msgctl,
    SYS_mq_open,
    SYS_mq_unlink,
    // what Landlock does not look at; at cutting a file by its name not before version 3
    SYS_truncate,
    SYS_utimensat,
    SYS_fchmod,
    SYS_fchmodat,
    SYS_fchown,
    SYS_fchownat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    SYS_open_by_handle_at,
    SYS_name_to_handle_at,
    // the machine
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_setns,
    SYS_unshare,
    SYS_fsopen,
    SYS_fsmount,
    SYS_move_mount,
    SYS_open_tree,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_acct,
    SYS_quotactl,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_clock_adjtime,
    SYS_adjtimex,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_syslog,
#if defined(__x86_64__)
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
    SYS_iopl,
    SYS_ioperm,
    SYS_modify_ldt,
    SYS_kexec_file_load,
#endif
};

/// What sanitizers do for themselves at the end of a process: look for leaks from a process beside it, and
/// run a program that names addresses.
constexpr std::uint32_t kRefusedUnlessSanitized[] = {
    SYS_ptrace, SYS_execve, SYS_execveat,
#if defined(__x86_64__)
    SYS_fork,   SYS_vfork,
#endif
};

/// With these the kernel would send signals to other processes for us.
constexpr std::uint32_t kRefusedOfFcntl[] = {F_SETOWN, F_SETOWN_EX, F_SETSIG};

/// The instructions of a filter, which begin with the number of the call in the accumulator.
class Filter {
 public:
  void load(std::size_t offset) {
    add(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  }
  void answer(std::uint32_t verdict) { add(BPF_STMT(BPF_RET | BPF_K, verdict)); }
  void answer_if_equal(std::uint32_t value, std::uint32_t verdict) {
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1));
    answer(verdict);
  }
  /// `call` is answered by what its first argument is (low half: flags and process ids are no larger).
  void answer_by_argument(std::uint32_t call, std::uint16_t test, std::uint32_t operand) {
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4));
    load(offsetof(seccomp_data, args[0]));
    add(BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | test | BPF_K), operand, 0, 1));
    answer(kAllow);
    answer(kRefuse);
  }
  /// `call` is refused where its second argument is one of `values`; the rest of it is looked at no more.
  void refuse_by_second_argument(std::uint32_t call, std::span<const std::uint32_t> values) {
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, static_cast<std::uint8_t>(2 * values.size() + 2)));
    load(offsetof(seccomp_data, args[1]));
    for (const std::uint32_t value : values) answer_if_equal(value, kRefuse);
    answer(kAllow);
  }
  /// `call` passes where its first argument is `pointer`, and is refused elsewhere.
  void answer_by_pointer(std::uint32_t call, const void* pointer) {
    const auto whole = static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(pointer));
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 6));
    load(offsetof(seccomp_data, args[0]));  // its low half: both processors put that first
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(whole), 0, 3));
    load(offsetof(seccomp_data, args[0]) + sizeof(std::uint32_t));
    add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(whole >> 32), 0, 1));
    answer(kAllow);
    answer(kRefuse);
  }
  void add(sock_filter instruction) { instructions_.push_back(instruction); }
  std::vector<sock_filter>& instructions() { return instructions_; }

 private:
  std::vector<sock_filter> instructions_;
};

Filter filter(const char* but_run) {
  Filter filter;
  filter.load(offsetof(seccomp_data, arch));
  filter.add(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0));
  filter.answer(kRefuse);
  filter.load(offsetof(seccomp_data, nr));
  filter.add(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, kFirstX32Call, 0, 1));
  filter.answer(kRefuse);
  for (const std::uint32_t call : kRefused) filter.answer_if_equal(call, kRefuse);
  filter.answer_if_equal(SYS_clone3, kUnknown);
  // Of itself only: a limit on processor time would kill whoever started us.
  filter.answer_by_argument(SYS_prlimit64, BPF_JEQ, 0);
  filter.refuse_by_second_argument(SYS_fcntl, kRefusedOfFcntl);
  if (kMemoryCanBeLimited) {  // no sanitizer
    if (but_run) filter.answer_by_pointer(SYS_execve, but_run);
    for (const std::uint32_t call : kRefusedUnlessSanitized) filter.answer_if_equal(call, kRefuse);
    filter.answer_by_argument(SYS_clone, BPF_JSET, CLONE_THREAD);
    // abort() signals the process itself.
    const auto self = static_cast<std::uint32_t>(getpid());
    filter.answer_by_argument(SYS_tgkill, BPF_JEQ, self);
    filter.answer_by_argument(SYS_kill, BPF_JEQ, self);
  }
  filter.answer(kAllow);
  return filter;
}

}  // namespace

api::Result<bool> refuse_system_calls(const char* but_run) {
  const std::uint32_t action = kRefuse & SECCOMP_RET_ACTION_FULL;
  if (kArchitecture == 0 || syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) != 0) return false;
  Filter made = filter(but_run);
  const sock_fprog program{static_cast<unsigned short>(made.instructions().size()),
                           made.instructions().data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) != 0)
    return api::Error{api::Fault::internal, "sandbox: seccomp: " + std::generic_category().message(errno)};
  return true;
}

}  // namespace engine
