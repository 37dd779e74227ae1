#pragma once

#include "supple/base/execution.h"

namespace supple {

/// The execution of one part of a computation. Its progress from 0 to 1 is a stretch of the progress of the whole.
class PartOfExecution {
 public:
  /// The part begins at `first` of the whole and takes `share` of it.
  PartOfExecution(const Execution& whole, double first, double share)
      : progress_(whole.progress, first, share), execution_(whole) {
    if (whole.progress) execution_.progress = &progress_;
  }
  PartOfExecution(const PartOfExecution&) = delete;
  PartOfExecution& operator=(const PartOfExecution&) = delete;

  const Execution& execution() const { return execution_; }

 private:
  class Stretch : public ProgressSink {
   public:
    Stretch(ProgressSink* outer, double first, double share) : outer_(outer), first_(first), share_(share) {}
    void report(double fraction, std::string_view stage) override { outer_->report(first_ + share_ * fraction, stage); }
    void publish(std::string_view partial) override { outer_->publish(partial); }

   private:
    ProgressSink* outer_;
    double first_;
    double share_;
  };

  Stretch progress_;
  Execution execution_;
};

}  // namespace supple
