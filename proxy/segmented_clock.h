// Which cached records have to go, so that one client's download of everything does not push out
// what many ask for again and again.
//
// A record starts on probation. A hand goes round the table: a record on probation that was asked
// for again since it came is proven, any other goes. Proven ones give way only while those on
// probation take no more than a tenth of the places; then the hand takes one use off each it passes
// and removes who has none left. A scan, each of whose records is asked for once, so turns over the
// probation alone. That is S3-FIFO (Yang, Zhang, Qiu, Yue, Rashmi: FIFO queues are all you need for
// cache eviction, SOSP 2023) with marks instead of queues, for the table's places are the only
// memory there is: the order of the hash takes the place of that of arrival, and there is no list
// of who went lately.
#pragma once

#include <cstddef>

#include "shared/store/node_table.h"

namespace meshfront {

class SegmentedClock {
 public:
  // On probation beyond that share of the entries, a proven entry need not go.
  static constexpr size_t kProbationShare = 10;  // one in so many

  // Removes entries until `enough()`. Value has wasUsed(), takeUse(), isProven() and prove(), which
  // takes all uses; `drop` is told each value that goes.
  template <typename Value, typename Enough, typename Drop>
  void evict(NodeTable<Value>& table, const Enough& enough, const Drop& drop) {
    // A proven entry goes after as many visits as it can have uses, and one more.
    size_t left = 5 * table.places();
    while (table.size() > 0 && left > 0 && !enough()) {
      if (hand_ >= table.places()) hand_ = 0;
      auto& slot = table.place(hand_);
      if (slot.path != 0 && mustGo(slot.value, table.size())) {
        if (slot.value.isProven()) --proven_;
        drop(slot.value);
        table.eraseAt(hand_);  // another entry may have moved here: look again
      } else {
        ++hand_;
      }
      --left;
    }
    table.shrinkIfSparse();
  }

  [[nodiscard]] size_t provenCount() const { return proven_; }

 private:
  template <typename Value>
  bool mustGo(Value& value, size_t entries) {
    if (!value.isProven()) {
      if (!value.wasUsed()) return true;
      value.prove();
      ++proven_;
      return false;
    }
    if ((entries - proven_) * kProbationShare > entries) return false;
    if (!value.wasUsed()) return true;
    value.takeUse();
    return false;
  }

  size_t hand_ = 0;
  size_t proven_ = 0;
};

}  // namespace meshfront
