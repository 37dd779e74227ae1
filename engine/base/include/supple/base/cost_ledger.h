#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// The bill of one computation: what each stage cost, and which effects ran and why. Threads must not share a ledger. A
/// parallel computation gives each task its own ledger and merges them.
class CostLedger {
 public:
  struct Stage {
    std::string name;
    double seconds = 0;
    std::int64_t count = 0;  ///< how often the stage ran
  };
  struct Effect {
    std::string name;
    bool ran = false;
    std::string why;         ///< the reason: the request, or a property of the scene
    std::int64_t count = 0;  ///< how often it ran
    double seconds = 0;
  };
  struct Quantity {
    std::string name;  ///< for example "windows" or "faces_visited"
    double value = 0;
  };

  /// Adds to the stage of that name, which is created at its first use. Stages stay in the order of their first use.
  void add_stage(std::string_view name, double seconds, std::int64_t count = 1);
  /// Adds to the effect of that name. `ran` is true if it was true in any call, and `why` keeps the latest text.
  void add_effect(std::string_view name, bool ran, std::string_view why, std::int64_t count = 0, double seconds = 0);
  /// Adds to the counted quantity of that name.
  void add_quantity(std::string_view name, double value);
  void merge(const CostLedger& other);

  const std::vector<Stage>& stages() const { return stages_; }
  const std::vector<Effect>& effects() const { return effects_; }
  const std::vector<Quantity>& quantities() const { return quantities_; }
  double total_seconds() const;

 private:
  std::vector<Stage> stages_;
  std::vector<Effect> effects_;
  std::vector<Quantity> quantities_;
};

/// Bills the time between its construction and destruction to a stage. A null ledger costs nothing.
class StageTimer {
 public:
  StageTimer(CostLedger* ledger, std::string_view name) : ledger_(ledger), name_(name) {
    if (ledger_) start_ = Clock::now();
  }
  ~StageTimer() {
    if (ledger_) ledger_->add_stage(name_, std::chrono::duration<double>(Clock::now() - start_).count());
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  CostLedger* ledger_;
  std::string_view name_;
  Clock::time_point start_{};
};

}  // namespace supple
