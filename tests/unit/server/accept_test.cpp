// A listening socket outlives whatever accept(2) says of one connection, or of a moment. The errors are the
// kernel's own way of failing that call: a filter of the listening thread's system calls hands each call to
// the test, which lets it fail or go on.
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <future>

#include "tests/unit/server/socket_fixture.h"

namespace server {
namespace {

/// Of the calling thread and those that it starts. -> where their calls of accept4 ask what is to become of
/// them; none where the kernel has no such filters, or they are forbidden here
FileHandle ask_before_accept() {
  sock_filter code[]{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_accept4, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  sock_fprog program{static_cast<unsigned short>(std::size(code)), code};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return {};
  return FileHandle(static_cast<int>(
      ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program)));
}

/// The next call fails with this error; 0: it goes on. False: there was none until `over`.
bool answer_next(const FileHandle& asked, int error_number, const std::atomic<bool>& over) {
  pollfd question{asked.get(), POLLIN, 0};
  while (::poll(&question, 1, 20) == 0)
    if (over) return false;
  seccomp_notif call{};
  if ((question.revents & POLLIN) == 0 || ::ioctl(asked.get(), SECCOMP_IOCTL_NOTIF_RECV, &call) != 0)
    return false;
  seccomp_notif_resp answer{};
  answer.id = call.id;
  answer.error = -error_number;
  answer.flags = error_number == 0 ? SECCOMP_USER_NOTIF_FLAG_CONTINUE : 0;
  return ::ioctl(asked.get(), SECCOMP_IOCTL_NOTIF_SEND, &answer) == 0;
}

class AcceptTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    add_service_routes(router_);
    tokens_ = std::make_unique<TokenFolder>(temporary_.path() / "data");
    gate_ = std::make_unique<Gate>(*tokens_, GateRules{}, [this] { return now_ms_.load(); });
    HttpRules rules;
    rules.port = 0;
    rules.threads = 4;
    http_ = std::make_unique<HttpServer>(router_, *gate_, rules);
    ASSERT_TRUE(http_->bind());
  }

  int status_of_health() {
    Connection connection(http_->port());
    connection.say("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return connection.status();
  }

  Router router_;
  std::unique_ptr<TokenFolder> tokens_;
  std::unique_ptr<Gate> gate_;
  std::unique_ptr<HttpServer> http_;
};

TEST_F(AcceptTest, AConnectionThatCannotBeTakenNowDoesNotEndTheService) {
  std::promise<FileHandle> filter;
  std::promise<bool> ended;
  std::thread listener([&] {
    filter.set_value(ask_before_accept());
    ended.set_value(http_->run());
  });
  const FileHandle asked = filter.get_future().get();
  if (!asked) {
    http_->stop();
    listener.join();
    GTEST_SKIP() << "calls cannot be made to fail here: " << std::strerror(errno);
  }
  std::atomic<bool> over = false;
  std::thread fate([&] {
    for (const int error :
         {ECONNABORTED, ENFILE, EPROTO, ENOBUFS, ENETDOWN, ENOMEM, EPERM, EMFILE, EHOSTUNREACH, ETIMEDOUT})
      EXPECT_TRUE(answer_next(asked, error, over)) << error;
    while (answer_next(asked, 0, over)) {
    }
  });
  EXPECT_EQ(status_of_health(), 200);
  EXPECT_EQ(status_of_health(), 200);
  http_->stop();
  EXPECT_TRUE(ended.get_future().get());
  over = true;
  listener.join();
  fate.join();
}

TEST_F(AcceptTest, AStopThatComesBeforeItListensIsNotForgotten) {
  http_->stop();
  EXPECT_TRUE(http_->run());
}

}  // namespace
}  // namespace server
