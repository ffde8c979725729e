// Deadlines that all lie the same time ahead when they are set, so that a list holds them in order:
// setting, clearing and looking for those that have passed cost the same however many there are.
//
//   DeadlineList idle(75'000);
//   idle.set(connection.idle, now);
//   while (Deadline* passed = idle.passed(now)) ...   // cleared when it is given out
#pragma once

#include <cstdint>

namespace meshfront {

class DeadlineList;

// In one list at most. Clears itself at its end.
class Deadline {
 public:
  // `owner` is given back by owner(), for whoever meets a passed one.
  explicit Deadline(void* owner) : owner_(owner) {}
  ~Deadline() { clear(); }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  void clear() {
    previous_->next_ = next_;
    next_->previous_ = previous_;
    previous_ = next_ = this;
  }
  [[nodiscard]] void* owner() const { return owner_; }

 private:
  friend class DeadlineList;
  Deadline* previous_ = this;
  Deadline* next_ = this;
  int64_t due_ = 0;
  void* owner_;
};

// Times are milliseconds of a clock that never goes back.
class DeadlineList {
 public:
  explicit DeadlineList(int64_t ahead) : ahead_(ahead) {}

  // Whatever list it was in.
  void set(Deadline& deadline, int64_t now) {
    deadline.clear();
    deadline.due_ = now + ahead_;
    deadline.previous_ = ends_.previous_;
    deadline.next_ = &ends_;
    ends_.previous_->next_ = &deadline;
    ends_.previous_ = &deadline;
  }
  // The first that has passed, or null.
  [[nodiscard]] Deadline* passed(int64_t now) {
    Deadline* first = ends_.next_;
    if (first == &ends_ || first->due_ > now) return nullptr;
    first->clear();
    return first;
  }
  // When the next one passes; INT64_MAX: there is none.
  [[nodiscard]] int64_t next() const {
    return ends_.next_ == &ends_ ? INT64_MAX : ends_.next_->due_;
  }

 private:
  const int64_t ahead_;
  Deadline ends_{nullptr};
};

}  // namespace meshfront
