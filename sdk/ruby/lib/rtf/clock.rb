# frozen_string_literal: true

module RTF
  # The time that a plug-in follows: the simulator's, if its suite has a clock.
  module Clock
    # Set by the runner for tests of such a suite: a file with seconds.
    VARIABLE = "RTF_CLOCK"
    private_constant :VARIABLE

    class << self
      # Whether the time is a simulator's.
      def simulated?
        !ENV.fetch(VARIABLE, "").empty?
      end

      # Seconds of the time that is followed, since a moment that does not matter.
      def now
        @latest = shown || @latest || 0.0
      end

      # What the clock shows; nothing while it is being written.
      def shown
        return Process.clock_gettime(Process::CLOCK_MONOTONIC) unless simulated?

        text = File.read(ENV.fetch(VARIABLE))
        Float(text) if text.end_with?("\n")
      rescue SystemCallError, ArgumentError
        nil
      end
    end

    # Measures how far the time goes on. What it jumps back is no time.
    class Stopwatch
      def initialize
        @before = Clock.shown
        @passed = 0.0
      end

      # Seconds since it was made.
      def passed
        shown = Clock.shown
        return @passed unless shown

        @passed += [0.0, shown - @before].max if @before
        @before = shown
        @passed
      end
    end
  end
end
