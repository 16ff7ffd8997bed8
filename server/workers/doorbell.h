// Wakes a thread that waits in poll().
#pragma once

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// Rung by any thread; the descriptor stays readable until it is cleared.
class Doorbell {
 public:
  static api::Result<Doorbell> create();
  void ring() const;
  void clear() const;
  int descriptor() const { return event_.get(); }

 private:
  FileHandle event_;
};

}  // namespace server
