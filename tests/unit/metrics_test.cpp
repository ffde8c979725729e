#include "shared/http/metrics.h"

#include <gtest/gtest.h>

#include <thread>

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

TEST(Metrics, ShowsWhatIsCountedElsewhere) {
  Metrics metrics;
  metrics.countedElsewhere("a_total", "A.", [] { return uint64_t{3}; });
  EXPECT_EQ(metrics.text(), "# HELP a_total A.\n# TYPE a_total counter\na_total 3\n");
}

TEST(Metrics, ShowsHistograms) {
  using std::chrono::milliseconds;
  Metrics metrics;
  constexpr std::array<double, 3> kBounds{0.001, 0.5, 2};
  Histogram& histogram = metrics.histogram("a_seconds", "A.", kBounds);
  EXPECT_EQ(&metrics.histogram("a_seconds", "A.", kBounds), &histogram);
  for (const int duration : {0, 1, 2, 400, 500, 501, 9000})
    histogram.observe(milliseconds(duration));
  histogram.observe(std::chrono::nanoseconds(-5));  // as nothing
  EXPECT_EQ(metrics.text(),
            "# HELP a_seconds A.\n# TYPE a_seconds histogram\n"
            "a_seconds_bucket{le=\"0.001\"} 3\na_seconds_bucket{le=\"0.5\"} 6\n"
            "a_seconds_bucket{le=\"2\"} 7\na_seconds_bucket{le=\"+Inf\"} 8\n"
            "a_seconds_sum 10.404000000\na_seconds_count 8\n");
}

TEST(Metrics, HistogramsLoseNothingBetweenThreads) {
  Histogram histogram(kLatencyBounds);
  constexpr int kThreads = 12;  // more than it has parts
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i)
    threads.emplace_back([&histogram] {
      for (int n = 0; n < 1000; ++n) histogram.observe(std::chrono::microseconds(n));
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(histogram.sums().upTo.back(), 1000U * kThreads);
  EXPECT_NEAR(histogram.sums().seconds, 0.4995 * kThreads, 1e-6);
}

}  // namespace
}  // namespace meshfront
