#pragma once

#include "supple/base/execution.h"

namespace supple {

/// The execution of one part of a computation. Its progress from 0 to 1 is an interval of the progress of the whole.
class PartOfExecution {
 public:
  /// The interval is [first, first + length].
  PartOfExecution(const Execution& whole, double first, double length)
      : progress_(whole.progress, first, length), execution_(whole) {
    if (whole.progress) execution_.progress = &progress_;
  }
  PartOfExecution(const PartOfExecution&) = delete;
  PartOfExecution& operator=(const PartOfExecution&) = delete;

  const Execution& execution() const { return execution_; }

 private:
  class ProgressInterval : public ProgressSink {
   public:
    ProgressInterval(ProgressSink* outer, double first, double length)
        : outer_(outer), first_(first), length_(length) {}
    void report(double fraction, std::string_view stage) override {
      outer_->report(first_ + length_ * fraction, stage);
    }
    void publish(std::string_view partial) override { outer_->publish(partial); }
    void saved() override { outer_->saved(); }

   private:
    ProgressSink* outer_;
    double first_;
    double length_;
  };

  ProgressInterval progress_;
  Execution execution_;
};

}  // namespace supple
