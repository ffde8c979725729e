// Threads: an answer arrives on the transport's thread, which puts the receiver's place into its
// worker's mailbox; the worker's thread steps the receiver. Everything of a receiver but the
// mailbox belongs to its worker.
#include "load/load_run.h"

#include <algorithm>
#include <condition_variable>
#include <thread>
#include <utility>

namespace meshfront {
namespace {

constexpr size_t kMostFailureKinds = 20;
constexpr std::chrono::milliseconds kLongestSleep{200};

}  // namespace

class LoadRun::Worker {
 public:
  Worker(LoadRun& run, uint64_t places) : run_(run), places_(places) {
    for (size_t i = places_.size(); i > 0; --i) free_.push_back(i - 1);
  }
  void start() {
    thread_ = std::thread([this] { work(); });
  }
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    mail_.notify_all();
  }
  void join() {
    if (thread_.joinable()) thread_.join();
  }

 private:
  struct Place {
    std::unique_ptr<SimulatedReceiver> receiver;
    uint64_t tenant = 0;  // tells a receiver from earlier ones in its place
    bool resting = false;
  };
  struct Wake {
    size_t place;
    uint64_t tenant;
  };

  void work() {
    while (true) {
      std::optional<Clock::time_point> due = startReceivers();
      for (const Place& place : places_) {
        if (!place.resting) continue;
        const Clock::time_point wake = place.receiver->wakeAt();
        due = due ? std::min(*due, wake) : wake;
      }
      std::vector<Wake> woken;
      if (!takeMail(due, woken)) break;
      for (const Wake& wake : woken) {
        if (stop_) break;
        if (places_[wake.place].tenant == wake.tenant) step(wake.place);
        (void)startReceivers();  // in the place of one that is done
      }
      stepRested();
    }
    for (Place& place : places_) place.receiver.reset();
  }

  // When to look again.
  std::optional<Clock::time_point> startReceivers() {
    if (free_.empty()) return std::nullopt;
    std::optional<Clock::time_point> later;
    while (!free_.empty()) {
      const std::optional<Ticket> ticket = run_.nextTicket(later);
      if (!ticket) break;
      const size_t index = free_.back();
      free_.pop_back();
      Place& place = places_[index];
      const Wake wake{index, ++lastTenant_};
      place.tenant = wake.tenant;
      place.resting = false;
      place.receiver = std::make_unique<SimulatedReceiver>(run_.options_.url, ticket->view,
                                                           run_.options_.receiver, run_.transport_,
                                                           [this, wake] { put(wake); });
    }
    return later;
  }

  void put(Wake wake) {
    {
      const std::lock_guard lock(mutex_);
      woken_.push_back(wake);
    }
    mail_.notify_one();
  }

  // False: stop.
  bool takeMail(const std::optional<Clock::time_point>& due, std::vector<Wake>& woken) {
    std::unique_lock lock(mutex_);
    const Clock::time_point latest = Clock::now() + kLongestSleep;
    mail_.wait_until(lock, due ? std::min(*due, latest) : latest,
                     [this] { return stop_ || !woken_.empty(); });
    woken.swap(woken_);
    return !stop_;
  }

  void stepRested() {
    if (std::none_of(places_.begin(), places_.end(), [](const Place& p) { return p.resting; }))
      return;
    const Clock::time_point now = Clock::now();
    for (size_t i = 0; i < places_.size(); ++i)
      if (places_[i].resting && places_[i].receiver->wakeAt() <= now) step(i);
  }

  void step(size_t index) {
    Place& place = places_[index];
    if (!place.receiver) return;
    const SimulatedReceiver::State state = place.receiver->step(pixels_);
    place.resting = state == SimulatedReceiver::State::resting;
    if (state == SimulatedReceiver::State::waiting || place.resting) return;
    run_.recordEnd(*place.receiver, state);
    place.receiver.reset();
    place.tenant = 0;
    free_.push_back(index);
  }

  LoadRun& run_;
  std::vector<Place> places_;
  std::vector<size_t> free_;
  uint64_t lastTenant_ = 0;
  ProjectedPixels pixels_;
  std::mutex mutex_;  // guards the mailbox
  std::condition_variable mail_;
  std::vector<Wake> woken_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

LoadRun::LoadRun(LoadRunOptions options, ViewChoice views, Transport& transport)
    : options_(std::move(options)), transport_(transport), views_(std::move(views)) {
  const uint64_t concurrency = std::clamp<uint64_t>(options_.concurrency, 1, options_.receivers);
  const uint64_t count = std::clamp<uint64_t>(options_.workers, 1, concurrency);
  for (uint64_t i = 0; i < count; ++i)
    workers_.push_back(std::make_unique<Worker>(*this, (concurrency + i) / count));
}

LoadRun::~LoadRun() {
  (void)end();
}

void LoadRun::start() {
  begin_ = Clock::now();
  for (const auto& worker : workers_) worker->start();
}

std::optional<LoadRun::Ticket> LoadRun::nextTicket(std::optional<Clock::time_point>& later) {
  const std::lock_guard lock(mutex_);
  if (result_.started == options_.receivers) return std::nullopt;
  if (options_.arrivalRate > 0) {
    const std::chrono::duration<double> after(static_cast<double>(result_.started) /
                                              options_.arrivalRate);
    const Clock::time_point due = begin_ + std::chrono::duration_cast<Clock::duration>(after);
    if (due > Clock::now()) {
      later = due;
      return std::nullopt;
    }
  }
  ++result_.started;
  result_.mostAlive = std::max(result_.mostAlive, ++alive_);
  return Ticket{views_.view(views_.next())};
}

void LoadRun::recordEnd(const SimulatedReceiver& receiver, SimulatedReceiver::State state) {
  const ReceiverStatistics& statistics = receiver.receiver().statistics();
  const std::lock_guard lock(mutex_);
  --alive_;
  result_.resumed += receiver.resumed();
  result_.malformed += statistics.malformed;
  result_.records += statistics.records;
  if (state == SimulatedReceiver::State::settled) {
    ++result_.settled;
    if (receiver.receiver().state() == ReceiverState::complete) ++result_.complete;
    result_.settling.add(Clock::now() - receiver.startedAt());
    return;
  }
  ++result_.failed;
  if (result_.failures.size() < kMostFailureKinds || result_.failures.contains(receiver.reason()))
    ++result_.failures[receiver.reason()];
}

bool LoadRun::finished() const {
  const std::lock_guard lock(mutex_);
  const bool all = result_.started == options_.receivers && alive_ == 0;
  return all || (options_.duration.count() > 0 && Clock::now() - begin_ >= options_.duration);
}

LoadResult LoadRun::progress() const {
  const std::lock_guard lock(mutex_);
  LoadResult result = result_;
  result.unfinished = alive_;
  result.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  return result;
}

LoadResult LoadRun::end() {
  for (const auto& worker : workers_) worker->stop();
  for (const auto& worker : workers_) worker->join();
  return progress();
}

}  // namespace meshfront
