// Which cached records have to go: second chance. A hand goes round the table; a record used since
// the hand's last visit is spared once. Records start unused, so that a scan that reads everything
// once pushes out little of what is read again.
#pragma once

#include <cstddef>

#include "shared/store/node_table.h"

namespace meshfront {

class ClockEviction {
 public:
  // Removes entries until `enough()`. Value has wasUsed() and clearUsed(); `drop` is told each
  // value that goes.
  template <typename Value, typename Enough, typename Drop>
  void evict(NodeTable<Value>& table, const Enough& enough, const Drop& drop) {
    // Two rounds: the first may do no more than clear the marks.
    size_t left = 2 * table.places();
    while (table.size() > 0 && left > 0 && !enough()) {
      if (hand_ >= table.places()) hand_ = 0;
      auto& slot = table.place(hand_);
      if (slot.path != 0 && !slot.value.wasUsed()) {
        drop(slot.value);
        table.eraseAt(hand_);  // another entry may have moved here: look again
      } else {
        if (slot.path != 0) slot.value.clearUsed();
        ++hand_;
      }
      --left;
    }
    table.shrinkIfSparse();
  }

 private:
  size_t hand_ = 0;
};

}  // namespace meshfront
