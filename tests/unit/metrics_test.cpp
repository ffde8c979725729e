#include "shared/http/metrics.h"

#include <gtest/gtest.h>

namespace meshfront {
namespace {

TEST(Metrics, ShowsPrometheusText) {
  Metrics metrics;
  Counter& plain = metrics.counter("a_total", "Plain.");
  Counter& red = metrics.counter("b_total", "By colour.", "colour=\"red\"");
  metrics.counter("b_total", "By colour.", "colour=\"blue\"");
  metrics.gauge("c_bytes", "A gauge.", [] { return uint64_t{7}; });
  red.add(5);
  EXPECT_EQ(metrics.text(),
            "# HELP a_total Plain.\n# TYPE a_total counter\na_total 0\n"
            "# HELP b_total By colour.\n# TYPE b_total counter\nb_total{colour=\"red\"} 5\n"
            "# HELP c_bytes A gauge.\n# TYPE c_bytes gauge\nc_bytes 7\n");
  EXPECT_EQ(&metrics.counter("a_total", "Plain."), &plain);
}

}  // namespace
}  // namespace meshfront
